#include "register/control_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <set>

#include "core/error.h"
#include "core/neighbours.h"

namespace vultus::registration {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
// Skin counts to one side of a slit up to this far from its landmarks, mm …
constexpr double slit_width = 16.0;
// … and only where the other side is farther by this, so that both sides share the corner, mm.
constexpr double slit_end = 6.0;

/// Distances along the edges of the skin from a growing number of sources, and which source is nearest.
class SkinDistance {
 public:
  SkinDistance(const Topology& topology, const Points& positions, const std::vector<bool>& skin)
      : adjacency_(adjacency(topology)),
        positions_(positions),
        skin_(skin),
        distance(skin.size(), infinite),
        source(skin.size(), -1) {}

  void add(int vertex, int number) {
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    distance[vertex] = 0.0;
    source[vertex] = number;
    queue.emplace(0.0, vertex);
    while (!queue.empty()) {
      const auto [reached, v] = queue.top();
      queue.pop();
      if (reached > distance[v]) continue;
      for (int other : adjacency_.of(v)) {
        const double length = reached + (positions_.row(v) - positions_.row(other)).norm();
        if (!skin_[other] || length >= distance[other]) continue;
        distance[other] = length;
        source[other] = number;
        queue.emplace(length, other);
      }
    }
  }

 private:
  Adjacency adjacency_;
  const Points& positions_;
  const std::vector<bool>& skin_;

 public:
  std::vector<double> distance;  // mm
  std::vector<int> source;       // -1 where none reaches
};

// Eyes, nose and lips, then the template's own names, then what is left of the 68 points.
std::vector<int> landmark_vertices(const Template& head) {
  std::vector<int> vertices;
  auto add_scheme = [&](int first, int last) {
    if (!head.ibug68) return;
    for (int i = first; i < last; ++i)
      if ((*head.ibug68)[i] >= 0) vertices.push_back((*head.ibug68)[i]);
  };
  add_scheme(27, 68);
  for (const Landmark& landmark : head.landmarks) vertices.push_back(landmark.vertex);
  add_scheme(0, 27);
  return vertices;
}

// Sets the control points; `cells` knows afterwards which of them each skin vertex belongs to.
std::vector<int> choose_points(const Template& head, const Topology& topology, const std::vector<bool>& skin,
                               const ControlPointOptions& options, SkinDistance& cells) {
  std::vector<int> chosen;
  auto take = [&](int v) {
    cells.add(v, static_cast<int>(chosen.size()));
    chosen.push_back(v);
  };
  for (int v : landmark_vertices(head))
    if (skin[v] && cells.distance[v] > options.least_spacing && static_cast<int>(chosen.size()) < options.most) take(v);
  std::vector<double> spacing(skin.size(), options.face_spacing);
  if (topology.has_set("face")) {
    spacing.assign(skin.size(), options.far_spacing);
    for (int v : topology.set("face")) spacing[v] = options.face_spacing;
  }
  const Adjacency around = adjacency(topology);
  while (static_cast<int>(chosen.size()) < options.most) {
    int farthest = -1;
    double gap = 1.0;
    for (std::size_t v = 0; v < skin.size(); ++v) {
      if (!skin[v] || cells.distance[v] / spacing[v] <= gap || around.of(static_cast<int>(v)).empty()) continue;
      // Pieces that no point reaches yet count as wide gaps, but a finite one, so that the first of them is taken.
      gap = std::min(cells.distance[v] / spacing[v], 1e6);
      farthest = static_cast<int>(v);
    }
    if (farthest < 0) break;
    take(farthest);
  }
  return chosen;
}

// A triangle wherever three cells meet in a face; the corners turn as the face does.
Triangles dual(const Topology& topology, const Points& positions, const std::vector<int>& chosen,
               const std::vector<int>& cell) {
  std::set<std::array<int, 3>> seen;
  std::vector<std::array<int, 3>> bones;
  for (int t = 0; t < topology.triangles().rows(); ++t) {
    std::array<int, 3> bone, sorted;
    for (int k = 0; k < 3; ++k) bone[k] = cell[topology.triangles()(t, k)];
    sorted = bone;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] < 0 || sorted[0] == sorted[1] || sorted[1] == sorted[2] || !seen.insert(sorted).second) continue;
    const Eigen::RowVector3d o = positions.row(chosen[bone[0]]), p = positions.row(chosen[bone[1]]),
                             q = positions.row(chosen[bone[2]]);
    const double longest = std::max({(p - o).norm(), (q - p).norm(), (o - q).norm()});
    // Slivers have no direction that could be trusted; their neighbours reach over them.
    if ((p - o).cross(q - o).norm() > 0.08 * longest * longest) bones.push_back(bone);
  }
  Triangles triangles(bones.size(), 3);
  for (std::size_t j = 0; j < bones.size(); ++j) triangles.row(j) << bones[j][0], bones[j][1], bones[j][2];
  return triangles;
}

// Points that no bone uses would move nothing.
void drop_idle(std::vector<int>& vertices, Triangles& triangles) {
  std::vector<int> number(vertices.size(), -1), kept;
  for (int j = 0; j < triangles.rows(); ++j)
    for (int k = 0; k < 3; ++k) number[triangles(j, k)] = 0;
  for (std::size_t c = 0; c < vertices.size(); ++c)
    if (number[c] == 0) {
      number[c] = static_cast<int>(kept.size());
      kept.push_back(vertices[c]);
    }
  for (int j = 0; j < triangles.rows(); ++j)
    for (int k = 0; k < 3; ++k) triangles(j, k) = number[triangles(j, k)];
  vertices = kept;
}

struct Slit {
  std::vector<int> upper, lower;  // numbers of the 68-point scheme, without the corners
};

const std::array<Slit, 3>& slits() {
  static const std::array<Slit, 3> all = {Slit{{49, 50, 51, 52, 53, 61, 62, 63}, {55, 56, 57, 58, 59, 65, 66, 67}},
                                          Slit{{37, 38}, {40, 41}}, Slit{{43, 44}, {46, 47}}};
  return all;
}

// Bit 2k of a vertex: above slit k; bit 2k + 1: below.
std::vector<std::uint32_t> sides_of_slits(const Template& head, const Topology& topology, const Points& positions,
                                          const std::vector<bool>& skin) {
  std::vector<std::uint32_t> sides(skin.size(), 0u);
  if (!head.ibug68) return sides;
  for (std::size_t k = 0; k < slits().size(); ++k) {
    SkinDistance above(topology, positions, skin), below(topology, positions, skin);
    for (int i : slits()[k].upper)
      if (const int v = (*head.ibug68)[i]; v >= 0 && skin[v]) above.add(v, 0);
    for (int i : slits()[k].lower)
      if (const int v = (*head.ibug68)[i]; v >= 0 && skin[v]) below.add(v, 0);
    for (std::size_t v = 0; v < skin.size(); ++v) {
      const double up = above.distance[v], down = below.distance[v];
      if (std::min(up, down) < slit_width && std::abs(up - down) > slit_end) sides[v] |= 1u << (2 * k + (up > down));
    }
  }
  return sides;
}

std::uint32_t opposite(std::uint32_t sides) {
  constexpr std::uint32_t above = 0x55555555u;
  return ((sides & above) << 1) | ((sides & ~above) >> 1);
}

}  // namespace

void ControlPointOptions::validate() const {
  if (!(face_spacing > 0.0 && far_spacing > 0.0 && least_spacing >= 0.0))
    throw InputError("control surface: spacings must be positive");
  if (most < 4) throw InputError("control surface: at least 4 control points are needed");
}

SkinControls make_controls(const Template& head, const Topology& topology, const Points& positions,
                           const std::vector<bool>& skin, const ControlPointOptions& options) {
  options.validate();
  SkinDistance cells(topology, positions, skin);
  SkinControls controls;
  controls.vertices = choose_points(head, topology, skin, options, cells);
  if (controls.vertices.size() < 4) throw InputError("the template's skin carries fewer than 4 control points");
  controls.triangles = dual(topology, positions, controls.vertices, cells.source);
  drop_idle(controls.vertices, controls.triangles);
  const std::vector<std::uint32_t> sides = sides_of_slits(head, topology, positions, skin);
  std::vector<std::array<int, 3>> bones;
  for (int j = 0; j < controls.triangles.rows(); ++j) {
    std::uint32_t side = 0;
    for (int k = 0; k < 3; ++k) side |= sides[controls.vertices[controls.triangles(j, k)]];
    if (side & opposite(side)) continue;  // it would span the slit
    bones.push_back({controls.triangles(j, 0), controls.triangles(j, 1), controls.triangles(j, 2)});
    controls.masks.bones.push_back(side);
  }
  if (bones.empty()) throw InputError("the template's skin carries no bone: its control points lie apart");
  controls.triangles.resize(bones.size(), 3);
  for (std::size_t j = 0; j < bones.size(); ++j) controls.triangles.row(j) << bones[j][0], bones[j][1], bones[j][2];
  for (std::uint32_t side : sides) controls.masks.barred.push_back(opposite(side));
  drop_idle(controls.vertices, controls.triangles);
  return controls;
}

}  // namespace vultus::registration
