#include "apps/virtual_stage/virtual_actor.h"

#include <algorithm>

#include "apps/virtual_stage/actor.h"
#include "apps/virtual_stage/hair_paint.h"
#include "apps/virtual_stage/skin.h"
#include "core/texture_space.h"

namespace vultus::virtual_stage {
namespace {

constexpr int albedo_size = 1024;  // texels; finer than the scans' vertices, which are all that shows it

DetailOptions detail_of(std::uint64_t seed) {
  DetailOptions options;
  options.seed = static_cast<std::uint32_t>(seed) * 97 + 5;
  return options;
}

// Rows of `uvs` are shared along no seam, so a vertex's colour is looked up at any of its corners.
Points vertex_colours(const Topology& topology, const Image& albedo) {
  Points colours = Points::Zero(topology.vertex_count(), 3);
  for (Eigen::Index t = 0; t < topology.triangles().rows(); ++t)
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector2d uv = topology.uvs().row(topology.triangle_uvs()(t, c));
      const double x = uv.x() * albedo.width(), y = (1.0 - uv.y()) * albedo.height();
      for (int channel = 0; channel < 3; ++channel)
        colours(topology.triangles()(t, c), channel) = albedo.sample(x, y, channel);
    }
  return colours;
}

}  // namespace

VirtualActor::VirtualActor(const registration::Template& head, std::uint64_t seed)
    : head_(head), seed_(seed), face_(head, identity(head, seed)) {}

VisibleActor::VisibleActor(const VirtualActor& actor) : detailed_(actor.face(), detail_of(actor.seed())) {
  const FaceModel& face = actor.face();
  const registration::LoopSubdivision to_face(actor.head().topology, actor.head().subdivisions);
  const Points template_face = to_face(actor.head().neutral);
  const Complexion complexion = random_complexion(actor.seed());
  const TextureSpace space(face.topology(), albedo_size, albedo_size);
  albedo_ = skin_albedo(space, template_face, complexion);
  colours_ = vertex_colours(*topology(), albedo_);

  const registration::LoopSubdivision to_fine(face.topology(), 2);
  const Points template_fine = to_fine(template_face);
  hair_ = Eigen::VectorXd::Zero(topology()->vertex_count());
  std::vector<bool> skin(topology()->vertex_count(), false);
  for (const int v : topology()->set("skin")) skin[v] = true;
  for (Eigen::Index v = 0; v < hair_.size(); ++v)
    if (skin[v]) hair_[v] = std::clamp(scalp_coverage(template_fine.row(v), complexion.seed), 0.0, 1.0);
}

ScanSubject VisibleActor::subject(const Activations& activations) const {
  ScanSubject subject;
  subject.surface.topology = topology();
  subject.surface.positions = pose(activations);
  subject.surface.colours = colours_;
  subject.hair = hair_;
  return subject;
}

}  // namespace vultus::virtual_stage
