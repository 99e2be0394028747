#include "register/texture_transfer.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/rays.h"
#include "core/texture_space.h"

namespace vultus::registration {
namespace {

using Colour = std::optional<Eigen::Vector3d>;

/// Colour of a place on the scan, from its vertices or its texture image.
class ScanColour {
 public:
  explicit ScanColour(const Mesh& scan) : scan_(scan) {
    if (!scan.has_colours()) texture_ = read_image(scan.texture);
  }
  Eigen::Vector3d at(const SurfacePoint& place) const {
    if (scan_.has_colours()) return position_of(place, *scan_.topology, scan_.colours);
    const auto corners = scan_.topology->triangle_uvs().row(place.triangle);
    Eigen::RowVector2d uv = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k) uv += place.barycentric(k) * scan_.topology->uvs().row(corners(k));
    const double x = uv.x() * texture_.width(), y = (1.0 - uv.y()) * texture_.height();
    Eigen::Vector3d colour;
    for (int c = 0; c < 3; ++c) colour(c) = texture_.sample(x, y, std::min(c, texture_.channels() - 1));
    return colour;
  }

 private:
  const Mesh& scan_;
  Image texture_;
};

/// Looks from the registered surface to the scan.
class Looker {
 public:
  Looker(const Mesh& registered, const Mesh& scan, const ColourTransferOptions& options)
      : options_(options), rays_(*scan.topology, scan.positions), colour_(scan),
        normals_(triangle_normals(*scan.topology, scan.positions)),
        own_normals_(vertex_normals(*registered.topology, registered.positions)), registered_(registered) {}

  Colour at(const Eigen::Vector3d& position, const Eigen::Vector3d& normal) const {
    const auto closest = rays_.closest(position, options_.farthest);
    if (!closest) return {};
    if (normals_.row(closest->place.triangle).dot(normal.normalized()) < options_.least_agreement) return {};
    return colour_.at(closest->place);
  }
  Colour at(const SurfacePoint& place) const {
    return at(position_of(place, *registered_.topology, registered_.positions),
              position_of(place, *registered_.topology, own_normals_));
  }
  Colour at_vertex(int v) const { return at(registered_.positions.row(v), own_normals_.row(v)); }

 private:
  const ColourTransferOptions& options_;
  RayScene rays_;
  ScanColour colour_;
  Points normals_, own_normals_;
  const Mesh& registered_;
};

/// Vertices of parts that a scan shows only by chance.
std::vector<bool> hidden_parts(const Topology& topology) {
  constexpr std::array<const char*, 6> prefixes = {"eyeball", "inner_mouth", "mouth_socket", "teeth", "gums", "tongue"};
  std::vector<bool> hidden(topology.vertex_count(), false);
  for (const auto& [name, vertices] : topology.sets())
    if (std::any_of(prefixes.begin(), prefixes.end(), [&](const char* prefix) { return name.starts_with(prefix); }))
      for (const int v : vertices) hidden[v] = true;
  return hidden;
}

/// Seen colours stay; unknown ones become the mean of their neighbours (Gauss–Seidel in vertex order).
void spread(const Topology& topology, const std::vector<bool>& known, Points& colours) {
  constexpr int rounds = 200;  // carries colour across holes of some hundred edges
  const Adjacency neighbours = adjacency(topology);
  std::vector<bool> reached = known;
  for (int round = 0; round < rounds; ++round) {
    for (int v = 0; v < topology.vertex_count(); ++v) {
      if (known[v]) continue;
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      int count = 0;
      for (const int n : neighbours.of(v)) {
        if (!reached[n]) continue;
        sum += colours.row(n);
        ++count;
      }
      if (count == 0) continue;
      colours.row(v) = sum / count;
      reached[v] = true;
    }
  }
}

Points vertex_colours(const Mesh& registered, const Looker& looker, const Points& unseen,
                      const std::vector<bool>& hidden) {
  const Topology& topology = *registered.topology;
  const int vertices = topology.vertex_count();
  std::vector<Colour> seen(vertices);
  tbb::parallel_for(0, vertices, [&](int v) { seen[v] = looker.at_vertex(v); });
  std::vector<bool> known = hidden;
  Points colours = unseen;
  for (int v = 0; v < vertices; ++v) {
    if (!seen[v] || hidden[v]) continue;
    colours.row(v) = *seen[v];
    known[v] = true;
  }
  spread(topology, known, colours);
  return colours;
}

}  // namespace

void ColourTransferOptions::validate() const {
  if (size < 16 || size > 16384) throw InputError("colour map size " + std::to_string(size) + "; 16 to 16384 texels");
  if (!(farthest > 0.0)) throw InputError("the farthest distance of a colour must be more than 0 mm");
  if (!(least_agreement > -1.0 && least_agreement < 1.0)) throw InputError("normal agreement must lie in (-1, 1)");
}

bool has_colour(const Mesh& scan) {
  return scan.has_colours() || (scan.topology->has_uvs() && std::filesystem::is_regular_file(scan.texture));
}

Image transfer_colours(const Mesh& registered, const Mesh& scan, const Points& unseen,
                       const ColourTransferOptions& options) {
  options.validate();
  if (!has_colour(scan)) throw InputError("the scan has no colour to carry to the texture");
  if (unseen.rows() != registered.topology->vertex_count()) throw InputError("one colour a vertex is needed for unseen parts");
  const Looker looker(registered, scan, options);
  const std::vector<bool> hidden = hidden_parts(*registered.topology);
  const Points filled = vertex_colours(registered, looker, unseen, hidden);
  const TextureSpace space(registered.topology, options.size, options.size);
  Image map = space.bake(filled.cast<float>(), {"R", "G", "B"});
  tbb::parallel_for(0, options.size, [&](int y) {
    for (int x = 0; x < options.size; ++x) {
      const SurfacePoint& place = space.at(x, y);
      if (!place.valid() || hidden[registered.topology->triangles()(place.triangle, 0)]) continue;
      if (const Colour colour = looker.at(place)) map.set_rgb(x, y, colour->cast<float>());
    }
  });
  space.dilate(map, 8);
  return map;
}

}  // namespace vultus::registration
