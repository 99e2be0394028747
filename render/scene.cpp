#include "render/scene.h"

#include <string>

#include "core/error.h"
#include "core/neighbours.h"

namespace vultus::render {
namespace {

constexpr Finish skin{0.52f, 1.4f, 0.9f}, lips{0.36f, 1.4f, 1.0f}, wet{0.08f, 1.376f, 1.0f};  // 1.376: cornea

Finish mix(const Finish& a, const Finish& b, float t) {
  return {a.roughness + (b.roughness - a.roughness) * t, a.ior + (b.ior - a.ior) * t,
          a.specular + (b.specular - a.specular) * t};
}

bool in_range(const Finish& f) {
  return f.roughness >= 0.0f && f.roughness <= 1.0f && f.ior >= 1.0f && f.ior <= 3.0f && f.specular >= 0.0f &&
         f.specular <= 1.0f;
}

/// 1 in the set, 0 far from it, falling off over a few edges.
std::vector<float> softened(const std::vector<int>& set, const Topology& topology) {
  const Adjacency neighbours = adjacency(topology);
  std::vector<float> value(topology.vertex_count(), 0.0f), next;
  for (const int v : set) value[v] = 1.0f;
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    next = value;
    for (int v = 0; v < topology.vertex_count(); ++v) {
      const auto near = neighbours.of(v);
      if (near.empty()) continue;
      float mean = 0.0f;
      for (const int n : near) mean += value[n];
      next[v] = 0.5f * value[v] + 0.5f * mean / static_cast<float>(near.size());
    }
    value.swap(next);
  }
  return value;
}

}  // namespace

void Scene::validate() const {
  if (!topology) throw InputError("scene: no mesh");
  const Eigen::Index n = topology->vertex_count();
  if (positions.rows() != n)
    throw InputError("scene: " + std::to_string(positions.rows()) + " positions for " + std::to_string(n) +
                     " vertices");
  if (!positions.allFinite()) throw InputError("scene: the mesh has vertices that are not finite");
  if (vertex_colours.rows() != 0 && vertex_colours.rows() != n)
    throw InputError("scene: " + std::to_string(vertex_colours.rows()) + " colours for " + std::to_string(n) +
                     " vertices");
  if (!albedo.empty() && !topology->has_uvs()) throw InputError("scene: an albedo map needs a mesh with UVs");
  if (finishes.size() != 1 && static_cast<Eigen::Index>(finishes.size()) != n)
    throw InputError("scene: " + std::to_string(finishes.size()) + " finishes for " + std::to_string(n) +
                     " vertices; one each, or one for all");
  for (const Finish& finish : finishes)
    if (!in_range(finish)) throw InputError("scene: finish out of range (roughness 0-1, ior 1-3, specular 0-1)");
  if (camera.width < 1 || camera.height < 1 || !(camera.fx > 0) || !(camera.fy > 0))
    throw InputError("scene: the camera has no pixels or no focal length");
  if (!environment) throw InputError("scene: no environment light");
}

std::vector<Finish> skin_finishes(const Topology& topology) {
  std::vector<Finish> finishes(topology.vertex_count(), skin);
  if (topology.has_set("lips")) {
    const std::vector<float> amount = softened(topology.set("lips"), topology);
    for (std::size_t v = 0; v < finishes.size(); ++v) finishes[v] = mix(skin, lips, amount[v]);
  }
  for (const auto& [name, vertices] : topology.sets())
    if (name.starts_with("eyeball"))
      for (const int v : vertices) finishes[v] = wet;
  return finishes;
}

}  // namespace vultus::render
