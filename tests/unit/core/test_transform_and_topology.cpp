#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/mesh.h"
#include "core/progress.h"
#include "core/random.h"
#include "core/transform.h"

namespace vultus {
namespace {

Similarity example() {
  Similarity a_from_b;
  a_from_b.scale = 2.5;
  a_from_b.rotation = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  a_from_b.translation = {10, -20, 30};
  return a_from_b;
}

Points random_points(int count, std::uint64_t seed) {
  Random random(seed);
  Points points(count, 3);
  for (Eigen::Index k = 0; k < points.size(); ++k) points.data()[k] = random.uniform(-80.0, 80.0);
  return points;
}

// 1e-12 relative to coordinates of order 100: some tens of roundings.
constexpr double rounding = 1e-10;

TEST(Similarity, ComposesAndInverts) {
  const Similarity t = example();
  const Eigen::Vector3d x(1, 2, 3);
  EXPECT_LT(((t * t) * x - t * (t * x)).norm(), rounding);
  EXPECT_LT((t.inverse() * (t * x) - x).norm(), rounding);
  EXPECT_LT((transformed(t, x.transpose()).row(0).transpose() - t * x).norm(), rounding);
}

TEST(FitSimilarity, FindsAQuarterTurnByHand) {
  Points source(3, 3), target(3, 3);
  source << 0, 0, 0, 1, 0, 0, 0, 2, 0;
  target << 5, 0, 0, 5, 1, 0, 3, 0, 0;  // a quarter turn about z, then +5 in x
  const Similarity t = fit_similarity(source, target, Scaling::free);
  EXPECT_NEAR(t.scale, 1.0, rounding);
  EXPECT_LT((t.rotation - Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix()).norm(),
            rounding);
  EXPECT_LT((t.translation - Eigen::Vector3d(5, 0, 0)).norm(), rounding);
}

TEST(FitSimilarity, RecoversAnExactMotionAndHonoursWeights) {
  const Similarity truth = example();
  const Points source = random_points(30, 1);
  Points target = transformed(truth, source);
  target.row(7).array() += 500.0;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(30);
  weights(7) = 0.0;
  const Similarity fit = fit_similarity(source, target, Scaling::free, weights);
  EXPECT_NEAR(fit.scale, truth.scale, rounding);
  EXPECT_LT((fit.rotation - truth.rotation).norm(), rounding);
  EXPECT_LT((fit.translation - truth.translation).norm(), rounding);
  EXPECT_EQ(fit_similarity(source, target, Scaling::fixed, weights).scale, 1.0);
}

TEST(FitSimilarity, NeverReflects) {
  const Points source = random_points(20, 2);
  Points mirrored = source;
  mirrored.col(0) *= -1.0;
  const Eigen::Matrix3d rotation = fit_similarity(source, mirrored, Scaling::free).rotation;
  EXPECT_NEAR(rotation.determinant(), 1.0, rounding);
}

TEST(FitSimilarity, RefusesWhatDetermineNoMotion) {
  Points line(4, 3);
  line << 0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3;
  EXPECT_THROW(fit_similarity(line, line, Scaling::fixed), InputError);
  const Points points = random_points(4, 3);
  EXPECT_THROW(fit_similarity(points, points.topRows(3), Scaling::fixed), InputError);
  EXPECT_THROW(fit_similarity(points.topRows(2), points.topRows(2), Scaling::fixed), InputError);
  EXPECT_THROW(fit_similarity(points, points, Scaling::fixed, Eigen::Vector4d(1, 1, 0, 0)), InputError);
  EXPECT_THROW(fit_similarity(points, points, Scaling::fixed, Eigen::Vector4d(1, 1, 1, -1)), InputError);
  Points broken = points;
  broken(1, 1) = std::nan("");
  EXPECT_THROW(fit_similarity(broken, points, Scaling::fixed), InputError);
}

TEST(FitSimilarityRobust, ThrowsOutAQuarterOfBadRows) {
  const Similarity truth = example();
  const Points source = random_points(40, 4);
  Points target = transformed(truth, source);
  for (int row = 0; row < 10; ++row) target.row(row) += Eigen::RowVector3d(30.0 + row, -40, 25);
  const RobustFit fit = fit_similarity_robust(source, target, Scaling::free);
  EXPECT_EQ(fit.weights.head(10).maxCoeff(), 0.0);
  EXPECT_GT(fit.weights.tail(30).minCoeff(), 0.99);
  EXPECT_LT((fit.target_from_source.translation - truth.translation).norm(), 1e-6);  // the loop stops at 1e-9 of weight
  EXPECT_LT(fit.rms, 1e-6);
  EXPECT_GT(fit.residuals.head(10).minCoeff(), 30.0);
}

TopologyData square_with_roof() {
  TopologyData data;
  data.vertex_count = 5;
  data.face_offsets = {0, 4, 7};
  data.corner_vertex = {0, 1, 2, 3, 3, 2, 4};
  data.sets["roof"] = {4, 2, 3, 2};
  data.landmarks["tip"] = 4;
  return data;
}

TEST(Topology, TriangulatesAsFansAndRemembersFaces) {
  const auto topology = Topology::make(square_with_roof());
  EXPECT_EQ(topology->face_count(), 2);
  EXPECT_EQ(topology->triangles(), (Triangles(3, 3) << 0, 1, 2, 0, 2, 3, 3, 2, 4).finished());
  EXPECT_EQ(topology->triangle_face(), (std::vector<int>{0, 0, 1}));
  EXPECT_EQ(topology->set("roof"), (std::vector<int>{2, 3, 4}));
  EXPECT_TRUE(topology->face_uv(0).empty());
}

TEST(Topology, RefusesBadIndicesAndNamesThem) {
  const auto message = [](auto change) {
    TopologyData data = square_with_roof();
    change(data);
    try {
      Topology::make(data);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message([](TopologyData& d) { d.corner_vertex[5] = 5; }).find("face 1"), std::string::npos);
  EXPECT_NE(message([](TopologyData& d) { d.corner_vertex[0] = -1; }).find("face 0"), std::string::npos);
  EXPECT_NE(message([](TopologyData& d) { d.face_offsets = {0, 5, 7}; }).find("face 1"), std::string::npos);
  EXPECT_NE(message([](TopologyData& d) { d.face_offsets = {0, 4}; }).find("offsets"), std::string::npos);
  EXPECT_NE(message([](TopologyData& d) { d.corner_uv.assign(7, 0); }).find("UV 0 of 0"), std::string::npos);
  EXPECT_NE(message([](TopologyData& d) { d.sets["x"] = {9}; }).find("\"x\""), std::string::npos);
  EXPECT_NE(message([](TopologyData& d) { d.landmarks["y"] = -1; }).find("\"y\""), std::string::npos);
  EXPECT_NE(message([](TopologyData& d) { d.face_offsets = {0, -2, 7}; }), "");
}

TEST(Topology, AnUnknownSetSuggestsTheNearest) {
  try {
    Topology::make(square_with_roof())->set("rooof");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("\"roof\""), std::string::npos);
  }
}

TEST(Mesh, NormalsOfAFlatSquareAndOfLonelyVertices) {
  Points positions(5, 3);
  positions << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 9, 9, 9;
  TopologyData data;
  data.vertex_count = 5;
  data.face_offsets = {0, 4};
  data.corner_vertex = {0, 1, 2, 3};
  const auto topology = Topology::make(data);
  const Points normals = vertex_normals(*topology, positions);
  for (int v = 0; v < 4; ++v) EXPECT_EQ(normals.row(v), Eigen::RowVector3d(0, 0, 1));
  EXPECT_EQ(normals.row(4), Eigen::RowVector3d(0, 0, 0));
  EXPECT_EQ(triangle_normals(*topology, positions).row(1), Eigen::RowVector3d(0, 0, 1));
}

TEST(Mesh, SubMeshKeepsWholeFacesAndNames) {
  Mesh mesh;
  mesh.topology = Topology::make(square_with_roof());
  mesh.positions = random_points(5, 5);
  const SubMesh part = sub_mesh(mesh, {false, true, true, true, true});
  EXPECT_EQ(part.parent_vertex, (std::vector<int>{1, 2, 3, 4}));
  EXPECT_EQ(part.mesh.topology->triangles(), (Triangles(1, 3) << 2, 1, 3).finished());
  EXPECT_EQ(part.mesh.topology->set("roof"), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(part.mesh.topology->landmarks().at("tip"), 3);
  EXPECT_EQ(part.mesh.positions.row(3), mesh.positions.row(4));
}

TEST(Mesh, PlacesAndBounds) {
  Points positions(3, 3);
  positions << 0, 0, 0, 4, 0, 0, 0, 8, -2;
  const auto topology = Topology::from_triangles(3, (Triangles(1, 3) << 0, 1, 2).finished());
  EXPECT_EQ(position_of({0, {0.25, 0.25, 0.5}}, *topology, positions), Eigen::Vector3d(1, 4, -1));
  EXPECT_EQ(bounds(positions).min, Eigen::Vector3d(0, 0, -2));
  EXPECT_EQ(bounds(positions).max, Eigen::Vector3d(4, 8, 0));
  EXPECT_THROW(bounds(Points(0, 3)), InputError);
}

class Stopped final : public Progress {
  void begin(std::string_view, std::size_t) override {}
  void advance(std::size_t) override {}
  void note(std::string_view) override {}
  bool cancelled() const override { return true; }
};

TEST(Progress, CheckThrowsOnceCancelled) {
  Stopped stopped;
  EXPECT_THROW(static_cast<Progress&>(stopped).check(), Cancelled);
  EXPECT_NO_THROW(Progress::none().check());
}

}  // namespace
}  // namespace vultus
