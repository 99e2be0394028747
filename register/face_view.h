#pragma once

#include <array>
#include <optional>
#include <vector>

#include "register/face_finder.h"
#include "register/shaded_view.h"

namespace vultus::registration {

/// Columns: the face's right-to-left (x), up (y) and front (z) axes in the scan.
using FaceFrame = Eigen::Matrix3d;
/// `frame` turned about its own axes: yaw (y), then pitch (x), then roll (z), degrees.
FaceFrame turned(const FaceFrame& frame, double yaw, double pitch, double roll);

/// What should fill a picture.
struct PictureTarget {
  Eigen::Vector3d centre;  ///< scan frame
  double radius;           ///< scan units
};

/// A picture to be taken from the front of `frame`; the light in camera axes as `ScanPictures::shade` takes it.
struct Shot {
  FaceFrame frame;
  PictureTarget target;
  Eigen::Vector3d light;
};
extern const Eigen::Vector3d light_from_above, light_from_front;

/// A face in a picture, cast back to the scan.
struct FaceView {
  FoundFace face;
  std::array<std::optional<Eigen::Vector3d>, 68> points;  ///< scan frame, where the surface faces the camera
  std::array<double, 68> facing{};                        ///< cosine between surface normal and view
};

/// The faces (best first, at most `most`) above `least_score` in the picture of each shot, `pixels` square.
/// Shots in a row that differ by their light alone cost little more than one.
std::vector<std::vector<FaceView>> look(const ScanPictures& pictures, const FaceFinder& finder,
                                        const std::vector<Shot>& shots, int pixels, double least_score, int most = 1);

/// Where a face is and how it is turned.
struct FacePlace {
  FaceFrame frame;
  PictureTarget target;  ///< that a close picture of the face should fill
  double eye_distance;   ///< between the eyes' middles, scan units
};
/// From eyes and mouth; nothing where too few of their points lie on the scan.
std::optional<FacePlace> place_of(const FaceView& view);

}  // namespace vultus::registration
