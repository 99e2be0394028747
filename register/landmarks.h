#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "register/template.h"

namespace vultus::registration {

/// A feature point found or placed on a scan.
struct ScanLandmark {
  std::string name;                                    ///< a template's landmark name, or `ibug_name(i)`
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< scan frame
  double confidence = 1.0;                             ///< [0, 1]; 1 for points placed by hand
  bool pictured = false;                               ///< seen in pictures, whose bias is alike on every face
};
using ScanLandmarks = std::vector<ScanLandmark>;

/// Distance between two of them; 0 where one is missing.
double distance_between(const ScanLandmarks& landmarks, const std::string& a, const std::string& b);

/// Name of point `index` (0 … 67) of the 68-point scheme: "ibug.0" … "ibug.67".
std::string ibug_name(int index);
/// The index in such a name, or nothing for any other name.
std::optional<int> ibug_index(const std::string& name);
/// True for the jaw contour (0–16), which is an outline in a picture and no fixed place on the skin.
inline bool is_contour(int ibug) { return ibug < 17; }

/// Vertex of the template's control mesh that carries `name` (its own landmarks first, then the 68-point scheme).
std::optional<int> landmark_vertex(const Template& head, const std::string& name);

/// Landmarks with a place on both the template and the scan; rows correspond.
struct LandmarkPairs {
  std::vector<std::string> names;
  std::vector<int> vertices;   ///< control mesh
  Points scan;                 ///< scan frame
  Eigen::VectorXd confidence;  ///< [0, 1]
  std::vector<bool> pictured;
  int size() const { return static_cast<int>(vertices.size()); }
};
/// Pairs every landmark that the template knows; contour points are left out (save, with `chin`, 7 to 9: the same chin
/// in two pictures of one person), and a second name for a vertex already paired too. Throws `InputError` (with the
/// nearest name) when a name given with confidence 1 is unknown.
LandmarkPairs pair_landmarks(const Template& head, const ScanLandmarks& landmarks, bool chin = false);

/// Reads `landmarks/<pose>.json`: {"points": {"NAME": [x, y, z], …}} in the scan's units, or a plain list of 68 points
/// under "points". Positions are multiplied by `mm_per_unit`. Throws `InputError` naming file and entry.
ScanLandmarks read_landmarks(const std::filesystem::path& file, double mm_per_unit = 1.0);
void write_landmarks(const std::filesystem::path& file, const ScanLandmarks& landmarks);

}  // namespace vultus::registration
