#include "render/scene.h"

#include <string>

#include "core/error.h"

namespace vultus::render {
namespace {

bool in_range(const Finish& f) {
  return f.roughness >= 0.0f && f.roughness <= 1.0f && f.ior >= 1.0f && f.ior <= 3.0f && f.specular >= 0.0f &&
         f.specular <= 1.0f;
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
  for (const int v : hidden_vertices)
    if (v < 0 || v >= n) throw InputError("scene: hidden vertex " + std::to_string(v) + " does not exist");
  if (camera.width < 1 || camera.height < 1 || !(camera.fx > 0) || !(camera.fy > 0))
    throw InputError("scene: the camera has no pixels or no focal length");
  if (!environment) throw InputError("scene: no environment light");
}

}  // namespace vultus::render
