#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>

#include "scan/soup.h"

namespace vultus::scan {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Halfedge = SurfaceMesh::Halfedge_index;
using Vertex = SurfaceMesh::Vertex_index;

SurfaceMesh surface_mesh(const Soup& soup) {
  SurfaceMesh mesh;
  for (int v = 0; v < soup.positions.rows(); ++v)
    mesh.add_vertex({soup.positions(v, 0), soup.positions(v, 1), soup.positions(v, 2)});
  for (const auto& t : soup.triangles) mesh.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
  return mesh;
}

double border_length(const SurfaceMesh& mesh, Halfedge start) {
  double length = 0.0;
  Halfedge at = start;
  do {
    length += std::sqrt(CGAL::squared_distance(mesh.point(mesh.source(at)), mesh.point(mesh.target(at))));
    at = mesh.next(at);
  } while (at != start);
  return length;
}

// New vertices take colour and UV row of the nearest vertex on the rim they close.
int nearest_rim_vertex(const SurfaceMesh& mesh, const std::vector<int>& rim, const Kernel::Point_3& point) {
  int best = rim.front();
  for (int v : rim)
    if (CGAL::squared_distance(mesh.point(Vertex(v)), point) < CGAL::squared_distance(mesh.point(Vertex(best)), point))
      best = v;
  return best;
}

// UV row of each vertex by any of its corners; empty without UVs.
std::vector<int> uv_row_of_vertices(const Soup& soup) {
  std::vector<int> row;
  if (soup.uv_rows.empty()) return row;
  row.assign(soup.positions.rows(), 0);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) row[soup.triangles[t][k]] = soup.uv_rows[t][k];
  return row;
}

// What filling added: the soup grows once, however many holes there are.
struct Fills {
  std::vector<int> parent;  // of each new vertex: the one on the rim whose colour and UV row it takes
  std::vector<SurfaceMesh::Face_index> faces;
};

void append(Soup& soup, const SurfaceMesh& mesh, const Fills& fills) {
  const auto first = static_cast<int>(soup.positions.rows());
  const auto added = static_cast<Eigen::Index>(fills.parent.size());
  const std::vector<int> uv_of_vertex = uv_row_of_vertices(soup);
  const bool coloured = soup.colours.rows() == first;
  soup.positions.conservativeResize(first + added, 3);
  if (coloured) soup.colours.conservativeResize(first + added, 3);
  for (int i = 0; i < added; ++i) {
    const auto& point = mesh.point(Vertex(first + i));
    soup.positions.row(first + i) << point.x(), point.y(), point.z();
    if (coloured) soup.colours.row(first + i) = soup.colours.row(fills.parent[i]);
  }
  for (const auto face : fills.faces) {
    std::array<int, 3> triangle{}, uvs{};
    int k = 0;
    for (const Vertex vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh)) {
      const int v = triangle[k] = static_cast<int>(vertex);
      if (!uv_of_vertex.empty()) uvs[k] = uv_of_vertex[v < first ? v : fills.parent[v - first]];
      ++k;
    }
    soup.triangles.push_back(triangle);
    if (!soup.uv_rows.empty()) soup.uv_rows.push_back(uvs);
  }
}

}  // namespace

int fill_holes(Soup& soup, double longest) {
  SurfaceMesh mesh = surface_mesh(soup);
  std::vector<Halfedge> borders;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(borders));
  Fills fills;
  int filled = 0;
  for (const Halfedge border : borders) {
    if (border_length(mesh, border) > longest) continue;
    std::vector<int> rim;
    for (const Halfedge h : CGAL::halfedges_around_face(border, mesh)) rim.push_back(static_cast<int>(mesh.target(h)));
    const std::size_t before = fills.faces.size();
    std::vector<Vertex> vertices;
    PMP::triangulate_refine_and_fair_hole(mesh, border, std::back_inserter(fills.faces), std::back_inserter(vertices),
                                          CGAL::parameters::vertex_point_map(mesh.points()));
    if (fills.faces.size() == before) continue;
    std::sort(vertices.begin(), vertices.end());  // as they are numbered
    for (const Vertex vertex : vertices) fills.parent.push_back(nearest_rim_vertex(mesh, rim, mesh.point(vertex)));
    ++filled;
  }
  append(soup, mesh, fills);
  return filled;
}

}  // namespace vultus::scan
