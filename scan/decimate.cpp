#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <cmath>

#include "scan/soup.h"

namespace vultus::scan {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexTraits { int source = -1; };
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<Traits>;

HalfEdges half_edges(const Soup& soup) {
  HalfEdges mesh;
  for (int v = 0; v < soup.positions.rows(); ++v) {
    const auto handle = mesh.add_vertex({soup.positions(v, 0), soup.positions(v, 1), soup.positions(v, 2)});
    mesh.data(handle).source = v;
  }
  for (const auto& t : soup.triangles)
    mesh.add_face(HalfEdges::VertexHandle(t[0]), HalfEdges::VertexHandle(t[1]), HalfEdges::VertexHandle(t[2]));
  return mesh;
}

}  // namespace

void decimate(Soup& soup, int triangles) {
  if (static_cast<int>(soup.triangles.size()) <= triangles) return;
  HalfEdges mesh = half_edges(soup);
  mesh.request_face_normals();
  mesh.update_face_normals();
  OpenMesh::Decimater::DecimaterT<HalfEdges> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<HalfEdges>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  OpenMesh::Decimater::ModNormalFlippingT<HalfEdges>::Handle flipping;
  decimater.add(flipping);
  decimater.module(flipping).set_max_normal_deviation(60.0f);
  decimater.initialize();
  decimater.decimate_to_faces(0, static_cast<std::size_t>(triangles));
  mesh.garbage_collection();

  std::vector<int> source;
  Points positions(static_cast<int>(mesh.n_vertices()), 3);
  for (const auto vertex : mesh.vertices()) {
    const auto& point = mesh.point(vertex);
    positions.row(vertex.idx()) << point[0], point[1], point[2];
    source.push_back(mesh.data(vertex).source);
  }
  const bool coloured = soup.colours.rows() > 0;
  soup.positions = std::move(positions);
  if (coloured) soup.colours = Points(soup.colours(source, Eigen::all));
  soup.uv_rows.clear();
  soup.triangles.clear();
  for (const auto face : mesh.faces()) {
    std::array<int, 3> triangle{};
    int k = 0;
    for (const auto vertex : mesh.fv_range(face)) triangle[k++] = vertex.idx();
    soup.triangles.push_back(triangle);
  }
}

}  // namespace vultus::scan
