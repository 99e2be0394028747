#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "apps/virtual_stage/face_model.h"
#include "apps/virtual_stage/folds.h"
#include "register/subdivide.h"

namespace vultus::virtual_stage {

struct DetailOptions {
  int levels = 2;      ///< further Loop subdivisions of the face model's mesh, 0 … 3; 2 puts vertices 0.4 mm apart
  double folds = 1.0;  ///< scale of the folds' depth, 0 … 2
  double pores = 1.0;  ///< scale of pores, lip lines and skin relief, 0 … 3
  std::uint32_t seed = 1;

  void validate() const;  ///< throws `UsageError` naming the option out of range
};

/// The true surface of a virtual actor: the acting face subdivided further and displaced along its normals by folds,
/// which come with the muscles that make them, by the chin's and lips' puckering, and by pores and relief that stay
/// with the skin. This is what scanners and cameras see. Vertex v of the face model is vertex v here.
class DetailedFace {
 public:
  DetailedFace(const FaceModel& face, const DetailOptions& options);

  const std::shared_ptr<const Topology>& topology() const { return subdivision_.refined(); }
  /// Positions (vertex_count×3, mm, face frame) of the fine surface.
  Points pose(const Activations& activations) const;

 private:
  const FaceModel& face_;
  registration::LoopSubdivision subdivision_;
  std::vector<Fold> folds_;
  Eigen::VectorXd relief_;  // mm, whatever the face does
  Eigen::VectorXd chin_, chin_bumps_;
  double fold_scale_;
};

}  // namespace vultus::virtual_stage
