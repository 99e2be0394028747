#include "apps/pose_picture.h"

#include <algorithm>

#include "render/face_look.h"
#include "render/portrait.h"
#include "render/preview.h"

namespace vultus::apps {
namespace {

constexpr int size = 288;  // pixels of one panel
const Eigen::Vector3f background(0.8f, 0.8f, 0.8f);
const Eigen::RowVector3d clay(0.55, 0.5, 0.46), red(0.8, 0.03, 0.02), blue(0.05, 0.15, 0.7);

// Small tetrahedra where points were taken out, at most as many as a picture can show.
struct Marks {
  Points positions;
  Triangles triangles;
};

Marks marks_at(const Points& points, double edge) {
  constexpr Eigen::Index most = 20'000;
  const Eigen::Index step = points.rows() / most + 1, count = (points.rows() + step - 1) / step;
  Eigen::Matrix<double, 4, 3> corners;
  corners << 1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1;
  Eigen::Matrix<int, 4, 3> faces;
  faces << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
  Marks marks{Points(4 * count, 3), Triangles(4 * count, 3)};
  for (Eigen::Index i = 0; i < count; ++i) {
    marks.positions.middleRows<4>(4 * i) = (0.35 * edge * corners).rowwise() + points.row(i * step);
    marks.triangles.middleRows<4>(4 * i) = faces.array() + static_cast<int>(4 * i);
  }
  return marks;
}

// The scan in the face frame with invented triangles blue and what was removed in red.
Mesh shown_scan(const scan::CleanScan& scan, const Similarity& face_from_scan) {
  const Marks marks = marks_at(transformed(face_from_scan, scan.removed), 2.4);
  const Triangles& measured = scan.mesh.topology->triangles();
  const auto vertices = static_cast<int>(scan.mesh.positions.rows());
  Triangles triangles(measured.rows() + marks.triangles.rows(), 3);
  triangles << measured, (marks.triangles.array() + vertices).matrix();
  Mesh shown;
  shown.topology = Topology::from_triangles(static_cast<int>(vertices + marks.positions.rows()), triangles);
  shown.positions.resize(shown.topology->vertex_count(), 3);
  shown.positions << transformed(face_from_scan, scan.mesh.positions), marks.positions;
  shown.colours.resize(shown.positions.rows(), 3);
  shown.colours.topRows(vertices).rowwise() = clay;
  shown.colours.bottomRows(marks.positions.rows()).rowwise() = red;
  for (int t = 0; t < measured.rows(); ++t)
    for (int k = 0; k < 3 && scan.invented[t]; ++k) shown.colours.row(measured(t, k)) = blue;
  return shown;
}

void place(Image& picture, int column, int row, const Image& panel) {
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) picture.set_rgb(column * size + x, row * size + y, panel.rgb_at(x, y));
}

}  // namespace

Image pose_picture(const scan::CleanScan& scan, const registration::Registered& registered) {
  constexpr double turn = 0.75, farthest = 1.0;
  const Topology& topology = *registered.mesh.topology;
  const Points& positions = registered.mesh.positions;
  const Mesh shown = shown_scan(scan, registered.face_from_scan);
  render::PreviewOptions plain;
  plain.background = background;
  plain.samples = 9;
  render::PreviewOptions result = plain;
  result.hidden_vertices = render::face_look(topology, positions).hidden_vertices;
  render::PreviewOptions heat = result;
  const Eigen::VectorXf& distance = registered.quality.vertex_distance;
  heat.field = render::VertexField{{distance.data(), distance.data() + distance.size()}, 0.0, farthest};
  Mesh bare = registered.mesh;
  bare.colours.resize(0, 3);

  Image picture = Image::rgb(4 * size, 2 * size);
  for (int row = 0; row < 2; ++row) {
    const Camera close = render::portrait_camera(topology, positions, {size, size, row * turn, 0.0, 1.5});
    const Camera wide = render::portrait_camera(topology, positions, {size, size, row * turn, 0.0, 2.3});
    place(picture, 0, row, render::render_preview(shown, close, plain));
    place(picture, 1, row, render::render_preview(bare, close, result));
    place(picture, 2, row, render::render_preview(bare, close, heat));
    place(picture, 3, row, render::render_preview(shown, wide, plain));
  }
  return picture;
}

}  // namespace vultus::apps
