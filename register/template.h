#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// A named feature point of a template.
struct Landmark {
  std::string name;    ///< MPEG-4 feature point ("8.1") or a plain name ("hairline_left")
  int vertex = -1;     ///< of the control mesh
  bool major = false;  ///< one of the points a person would place by hand (Zhu §4.2)
};

/// Vertices of the iBUG/Multi-PIE 68-point scheme in dlib's order (0–16 jaw from the subject's right ear, 17–26 brows,
/// 27–35 nose, 36–47 eyes, 48–67 lips). -1 where the template has no such vertex.
using Ibug68 = std::array<int, 68>;

/// Vertices of two rims that touch when closed.
struct TouchingRims {
  std::string name;                        ///< "lips", "left lids" or "right lids"
  std::vector<std::pair<int, int>> pairs;  ///< control mesh, upper and lower
};

/// What every scan is brought to: one topology with names, and the shape it starts from.
struct Template {
  std::string name;
  std::shared_ptr<const Topology> topology;  ///< sets: face, rigid, lips, …; landmarks by name
  Points neutral;                            ///< vertex_count×3, mm, face frame of DESIGN §1
  std::vector<Landmark> landmarks;
  std::optional<Ibug68> ibug68;
  std::vector<TouchingRims> rims;  ///< where the 68-point scheme's inner lips and lids are too few
  int subdivisions = 0;            ///< Loop levels the chain applies (Zhu §4.4): 2 for a control mesh
};

}  // namespace vultus::registration
