#pragma once

#include <utility>
#include <vector>

#include "core/progress.h"
#include "register/graph_fit.h"
#include "register/scan_surface.h"

namespace vultus::registration {

/// What a fit heeds beside the scan's surface.
struct Pulls {
  std::vector<PointTerm> annealed;              ///< what starts the fit and then gives way
  std::vector<PointTerm> kept;                  ///< what holds to the end, such as points placed by hand
  std::vector<std::pair<int, int>> touching{};  ///< vertices that meet in their middle
};

/// How a fit is let go: everything goes geometrically from its first to its last value.
struct Annealing {
  double first_stiffness = 30.0, last_stiffness = 0.0005;  ///< against one unit of data a node
  double first_limit = 15.0, last_limit = 3.0;             ///< mm: farthest correspondence
  double first_points = 2.0, last_points = 0.003;          ///< weight of the annealed points
  int stages = 7, steps_a_stage = 4;
  void validate() const;  ///< throws `InputError`
};

struct NonrigidOptions {
  double fine_spacing = 7.0;   ///< mm between nodes within 25 mm of `detail` points
  double face_spacing = 12.0;  ///< in the set "face"
  double far_spacing = 22.0;   ///< elsewhere
  double least_cosine = 0.5;   ///< between normals
  double rigidity = 0.0;       ///< see `GraphFitWeights`; for scans of the same person
  bool free_scale = true;      ///< the scan is of another person: what hangs on the skin (eyeballs, teeth) may grow
  /// mm: robust weights end at twice this or more, however well most of the skin fits. Less leaves skin behind that has
  /// far to go yet: the throat under an open jaw.
  double least_spread = 1.5;
  Annealing annealing;
  void validate() const;  ///< throws `InputError`
};

struct NonrigidResult {
  Points positions;  ///< vertex_count×3, scan frame
  int steps = 0;
  double initial_error = 0.0, final_error = 0.0;  ///< mean distance of vertices with data from the scan, mm
};

/// Non-rigid refinement: a deformation graph over a rest shape, drawn to the scan's tangent planes by robust weights
/// and to points, its smoothness annealed, then normal projection of what is left (`project_smoothly`). Vertices that
/// are not fitted follow the graph or, in pieces of their own, as one body.
class NonrigidFit {
 public:
  /// `rest` is the shape to keep, `start` where it is thought to be (both vertex_count×3, scan frame, mm). `detail`
  /// (k×3, rest frame) are places that deserve more nodes: eyes, nose, lips. All but it and the options must outlive
  /// this.
  NonrigidFit(const Topology& topology, const Points& rest, const Points& start, const std::vector<bool>& fitted,
              const ScanSurface& scan, const Points& detail, const NonrigidOptions& options);

  /// Steps under points alone, at the given stiffness.
  void follow(const std::vector<PointTerm>& points, double stiffness, int steps);
  /// Steps under the scan's surface and pulls.
  void anneal(const Pulls& pulls, const Annealing& annealing, Progress& progress);
  /// Weight of a term of which every vertex has one, so that all of them weigh as much as the data.
  double unit() const;
  const Points& positions() const { return result_.positions; }  ///< of the graph
  /// Drawn onto the scan, folds undone.
  NonrigidResult finished() const;

 private:
  const Topology& topology_;
  const Points &rest_, &start_;
  const std::vector<bool>& fitted_;
  const ScanSurface& scan_;
  NonrigidOptions options_;
  DeformationGraph graph_;
  GraphPose pose_;
  GraphFit fit_;
  std::vector<int> vertices_;  // fitted
  NonrigidResult result_;
};

/// All of it at once: annealed under data and points, then finished.
NonrigidResult fit_nonrigid(const Topology& topology, const Points& rest, const Points& start,
                            const std::vector<bool>& fitted, const ScanSurface& scan,
                            const std::vector<PointTerm>& points, const Points& detail,
                            const NonrigidOptions& options = {}, Progress& progress = Progress::none());

}  // namespace vultus::registration
