#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace vultus::registration {

/// Triangles over control points (markers, landmarks) that warp the skin around them; each triangle is a planar bone.
struct ControlSurface {
  Points rest;          ///< control_count×3, mm
  Triangles triangles;  ///< bone_count×3 rows of `rest`, counter-clockwise seen from outside
};

/// Discontinuities (§4.3) such as lips and lids, as bits a side: bone j leaves vertex i alone where
/// `bones[j] & barred[i]` is not zero. Both empty: none.
struct BoneMasks {
  std::vector<std::uint32_t> bones;   ///< bone_count: the sides a bone belongs to
  std::vector<std::uint32_t> barred;  ///< vertex_count: the sides that must not move a vertex
};

struct PlanarBoneOptions {
  /// (0, 1]: radius of a bone's influence as a fraction of its distance from the nearest control point connected to it;
  /// below 1 skin at a control point follows that point alone.
  double reach = 0.95;
  /// Skin out of every radius follows the nearest bones it may; false: it stays, and skin on the edge of influence goes
  /// part of the way.
  bool everywhere = false;
  void validate() const;  ///< throws `InputError`
};

/// Place of a vertex in one bone's frame.
struct BoneBinding {
  enum class Region : std::uint8_t { face, edge, apex };
  int bone = 0;
  Region region = Region::face;
  int corner = 0;         ///< edge: the one from this corner to the next; apex: this one
  Eigen::Vector3d local;  ///< in the frame of eq. 2 (face), 7 (edge) or 8 (apex); the last is the height, mm
  double in_plane = 0.0;  ///< D of eq. 10: distance from the apex within the plane, mm
  double weight = 0.0;    ///< (0, 1]
};

/// Planar-bone deformation (Sánchez et al. 2003, §4, eqs. 1–12): constant weights over what each bone makes of the
/// vertex. Linear in the control points within a bone's plane; heights follow the unit normal, hence not linear.
/// Rigid motion and, where no height or edge region is involved, affine motion of all control points carry the skin
/// along exactly.
///
/// The paper leaves open, and here: eq. 11's weights are divided by their sum where it exceeds 1 (always, with
/// `everywhere`), and what they lack of 1 stays at rest; the "closest connected vertex" of a bone is the control point
/// nearest to its triangle among those joined to one of its corners by an edge.
class PlanarBones {
 public:
  /// Binds `vertices` (vertex_count×3, same frame as the surface's rest). Throws `InputError` for wrong indices, bones
  /// without area (named) or masks of another size.
  PlanarBones(ControlSurface surface, const Points& vertices, const BoneMasks& masks = {},
              const PlanarBoneOptions& options = {});

  const ControlSurface& surface() const { return surface_; }
  int vertex_count() const { return static_cast<int>(rest_.rows()); }
  double radius(int bone) const { return radii_[bone]; }  ///< mm
  std::span<const BoneBinding> bindings(int vertex) const {
    return {bindings_.data() + offsets_[vertex], bindings_.data() + offsets_[vertex + 1]};
  }
  /// Control points that move a vertex, sorted.
  std::vector<int> controls_of(int vertex) const;

  /// All vertices (vertex_count×3) for control points moved to `control` (control_count×3, mm).
  Points operator()(const Points& control) const;
  /// Only those named, in that order.
  Points operator()(const Points& control, std::span<const int> vertices) const;

  /// d vertex / d control point; rows and columns x, y, z.
  struct Derivative {
    int control;
    Eigen::Matrix3d matrix;
  };
  struct Derivatives {
    Points positions;          ///< of the vertices asked for
    std::vector<int> offsets;  ///< derivatives of the k-th: [offsets[k], offsets[k+1]), by control
    std::vector<Derivative> entries;
  };
  /// Positions of the named vertices and their exact derivatives.
  Derivatives derivatives(const Points& control, std::span<const int> vertices) const;

 private:
  ControlSurface surface_;
  Points rest_;
  std::vector<double> radii_;
  std::vector<int> offsets_;
  std::vector<BoneBinding> bindings_;
  std::vector<double> at_rest_;  // share of each vertex that no bone moves
};

}  // namespace vultus::registration
