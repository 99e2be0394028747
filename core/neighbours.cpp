#include "core/neighbours.h"

#include <tbb/parallel_sort.h>

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <optional>

namespace vultus {
namespace {

using HalfEdges = OpenMesh::PolyMesh_ArrayKernelT<>;

/// The topology as OpenMesh half-edges, or nothing where it is not manifold.
std::optional<HalfEdges> half_edges(const Topology& topology) {
  static std::once_flag quiet;
  std::call_once(quiet, [] { omerr().disable(); });  // a refused face is an answer here, not a message
  HalfEdges mesh;
  for (int v = 0; v < topology.vertex_count(); ++v) mesh.add_vertex({0, 0, 0});
  std::vector<HalfEdges::VertexHandle> corners;
  for (int f = 0; f < topology.face_count(); ++f) {
    corners.clear();
    for (const int v : topology.face(f)) corners.emplace_back(v);
    if (!mesh.add_face(corners).is_valid()) return std::nullopt;
  }
  return mesh;
}

using Loops = std::vector<std::vector<int>>;

Loops manifold_loops(const HalfEdges& mesh) {
  Loops loops;
  std::vector<bool> seen(mesh.n_halfedges(), false);
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || seen[start.idx()]) continue;
    std::vector<int> loop;
    for (HalfEdges::HalfedgeHandle h = start; !seen[h.idx()]; h = mesh.next_halfedge_handle(h)) {
      seen[h.idx()] = true;
      loop.push_back(mesh.from_vertex_handle(h).idx());
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// Chains the directed face edges that have no opposite, in reverse so that they run as boundary half-edges do; at a
/// vertex where several start, the lowest next vertex is taken first. Chains that do not close are left out.
Loops chained_loops(const Topology& topology) {
  std::vector<std::pair<int, int>> directed;
  for (int f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t k = 0; k < face.size(); ++k) directed.emplace_back(face[k], face[(k + 1) % face.size()]);
  }
  std::sort(directed.begin(), directed.end());
  std::vector<std::pair<int, int>> open;
  for (const auto& [a, b] : directed)
    if (!std::binary_search(directed.begin(), directed.end(), std::pair(b, a))) open.emplace_back(b, a);
  std::sort(open.begin(), open.end());

  Loops loops;
  std::vector<bool> used(open.size(), false);
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (used[first]) continue;
    std::vector<int> loop;
    std::size_t edge = first;
    while (true) {
      used[edge] = true;
      loop.push_back(open[edge].first);
      const int at = open[edge].second;
      if (at == open[first].first) {
        loops.push_back(std::move(loop));
        break;
      }
      auto next = std::lower_bound(open.begin(), open.end(), std::pair(at, -1));
      while (next != open.end() && next->first == at && used[next - open.begin()]) ++next;
      if (next == open.end() || next->first != at) break;
      edge = static_cast<std::size_t>(next - open.begin());
    }
  }
  return loops;
}

}  // namespace

std::vector<std::pair<int, int>> edges(const Topology& topology) {
  std::vector<std::pair<int, int>> result;
  result.reserve(topology.data().corner_vertex.size());
  for (int f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const auto [a, b] = std::minmax(face[k], face[(k + 1) % face.size()]);
      if (a != b) result.emplace_back(a, b);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Adjacency adjacency(const Topology& topology) {
  const auto pairs = edges(topology);
  Adjacency result;
  result.offsets.assign(topology.vertex_count() + 1, 0);
  for (const auto& [a, b] : pairs) {
    ++result.offsets[a + 1];
    ++result.offsets[b + 1];
  }
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.vertices.resize(2 * pairs.size());
  std::vector<int> next(result.offsets.begin(), result.offsets.end() - 1);
  // Pairs come sorted, so lower neighbours are all entered before higher ones: each row ends up sorted.
  for (const auto& [a, b] : pairs) result.vertices[next[b]++] = a;
  for (const auto& [a, b] : pairs) result.vertices[next[a]++] = b;
  return result;
}

std::vector<bool> border_vertices(const Topology& topology) {
  std::vector<std::uint64_t> edges;
  const Triangles& triangles = topology.triangles();
  edges.reserve(3 * triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(triangles(t, k), triangles(t, (k + 1) % 3));
      edges.push_back((static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b));
    }
  tbb::parallel_sort(edges.begin(), edges.end());
  std::vector<bool> border(topology.vertex_count(), false);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool shared = (i > 0 && edges[i - 1] == edges[i]) || (i + 1 < edges.size() && edges[i + 1] == edges[i]);
    if (shared) continue;
    border[edges[i] >> 32] = border[edges[i] & 0xffffffffu] = true;
  }
  return border;
}

std::vector<std::vector<int>> boundary_loops(const Topology& topology) {
  const auto mesh = half_edges(topology);
  Loops loops = mesh ? manifold_loops(*mesh) : chained_loops(topology);
  for (auto& loop : loops) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  std::sort(loops.begin(), loops.end(),
            [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() > b.size() : a < b; });
  return loops;
}

std::vector<int> components(const Topology& topology) {
  const Adjacency neighbours = adjacency(topology);
  std::vector<int> component(topology.vertex_count(), -1), stack;
  int count = 0;
  for (int v = 0; v < topology.vertex_count(); ++v) {
    if (component[v] >= 0) continue;
    component[v] = count;
    stack.assign(1, v);
    while (!stack.empty()) {
      const int at = stack.back();
      stack.pop_back();
      for (const int next : neighbours.of(at)) {
        if (component[next] >= 0) continue;
        component[next] = count;
        stack.push_back(next);
      }
    }
    ++count;
  }
  return component;
}

}  // namespace vultus
