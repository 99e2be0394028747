#pragma once

#include <string>
#include <vector>

#include "core/rbf.h"
#include "core/transform.h"
#include "mocap/take.h"
#include "rig/actor.h"
#include "rig/markers.h"

namespace vultus::retarget {

struct PlacementOptions {
  std::string face_set = "face";   ///< vertex set markers may sit on; the whole head where the topology lacks it
  double max_distance = 30.0;      ///< mm; a warped marker farther from the face is no face marker (jig, headband); > 0
  double suspect_distance = 6.0;   ///< mm; farther than this is placed but reported; ≥ 0
  double suspect_stretch = 2.0;    ///< markers whose spacing changes by more than this against the rest are reported; > 1

  void validate() const;  ///< throws `InputError`
};

/// A mocap actor's markers on the rig's neutral.
struct MarkerPlacement {
  std::vector<std::string> labels;         ///< placed markers, in the order given
  std::vector<SurfacePoint> places;        ///< on the rig's topology
  Points neutral;                          ///< markers×3, mm, mocap space
  Points on_rig;                           ///< markers×3, mm, the places on the rig's neutral
  std::vector<double> surface_distances;   ///< mm, warped marker to its place
  Similarity rig_from_mocap;               ///< from the anchors
  double anchor_rms = 0.0;                 ///< mm, anchors after the similarity
  std::vector<std::string> left_out;       ///< "LABEL: reason"
  std::vector<std::string> suspects;       ///< "LABEL: reason"

  rig::MarkerPlaces by_label() const;
};

/// Sánchez et al. 2003 §5.1 and §6: similarity by the anchors, RBF with inverse multiquadrics and affine term through
/// the anchors, then each warped marker goes to the closest point of the face. `neutral` is labels×3 in mocap space;
/// rows with NaN are left out. `anchors` are places by label; those not in `labels` are ignored. Throws `InputError`
/// for fewer than 3 usable anchors; with 3 or coplanar ones the similarity alone warps.
MarkerPlacement place_markers(const std::vector<std::string>& labels, const Points& neutral,
                              const rig::MarkerPlaces& anchors, const rig::Actor& actor,
                              const PlacementOptions& options = {});

/// The map of space for whole frames, mocap → rig: inverse multiquadrics with affine term (Sánchez eq. 13–16) through
/// every marker's neutral position and its place.
RbfMap rig_from_mocap(const MarkerPlacement& placement);

/// The placed markers of every frame, moved by `map`; missing samples stay missing.
mocap::Take to_rig(const mocap::Take& take, const MarkerPlacement& placement, const RbfMap& map);

/// Zhu 2006 §6.2: the neutral's places moved by the markers' motion, turned and scaled by one factor; `placement`
/// gives the turn, `scale` the factor (eq. 6.1).
mocap::Take to_rig_by_scale(const mocap::Take& take, const MarkerPlacement& placement, double scale);

/// Zhu 2006 eq. 6.1: the mean of four ratios rig / mocap of marker distances. As in his figure 6.3 two are horizontal
/// (the widest pair above and below the middle) and two vertical (the tallest pair on each side). Needs 4 markers.
struct ZhuScale {
  double factor = 1.0;
  std::vector<std::string> pairs;  ///< "A–B: ratio", for the report
};
ZhuScale zhu_scale(const MarkerPlacement& placement);

}  // namespace vultus::retarget
