#include <gtest/gtest.h>

#include "register/quality.h"
#include "register/template.h"
#include "synthetic_surfaces.h"

namespace vultus::registration {
namespace {

class JudgeTest : public testing::Test {
 protected:
  Mesh model = test::bumpy_sphere(40, 0.0, 1), scan = test::bumpy_sphere(90, 0.0, 2);
  Template head;
  Quality judged(const Points& positions, const Mesh& on, const std::vector<LandmarkResidual>& landmarks = {}) {
    const ScanSurface surface(on);
    const std::vector<bool> all(positions.rows(), true);
    return judge(head, *model.topology, all, model.positions, positions, surface, landmarks);
  }
  bool says(const Quality& quality, const std::string& word) {
    for (const std::string& reason : quality.reasons)
      if (reason.find(word) != std::string::npos) return true;
    return false;
  }
};

TEST_F(JudgeTest, APerfectFitPasses) {
  const Quality quality = judged(model.positions, scan);
  EXPECT_EQ(quality.verdict, Verdict::pass) << (quality.reasons.empty() ? "" : quality.reasons.front());
  EXPECT_GT(quality.sets.at("all").coverage, 0.95);
  EXPECT_LT(quality.sets.at("all").scan_to_mesh_mean, 0.15);  // facets of 7 mm on a ball of 90 mm: 0.07 mm
  EXPECT_EQ(quality.flipped_triangles, 0);
  EXPECT_EQ(quality.stretched_triangles, 0);
}

TEST_F(JudgeTest, DistanceIsMeasuredAsItIs) {
  const Points shifted = 91.0 / 90.0 * model.positions;  // about 1 mm outside everywhere
  const Quality quality = judged(shifted, scan);
  EXPECT_NEAR(quality.sets.at("all").mesh_to_scan_mean, 1.0, 0.1);
  EXPECT_NEAR(quality.sets.at("all").scan_to_mesh_mean, 1.0, 0.1);
  EXPECT_NE(quality.verdict, Verdict::pass);
  EXPECT_TRUE(says(quality, "from the mesh on average"));
}

TEST_F(JudgeTest, CountsAFoldByHand) {
  Points folded = model.positions;
  // A vertex carried across its neighbours turns triangles over; four of them are more than lids may.
  for (const int v : {1600, 1610, 1620, 1630})
    folded.row(v) = 2.0 * model.positions.row(v + 3) - model.positions.row(v);
  const Quality quality = judged(folded, scan);
  EXPECT_GE(quality.flipped_triangles, 4);
  EXPECT_LE(quality.flipped_triangles, 32);
  EXPECT_TRUE(says(quality, "folded over"));
}

TEST_F(JudgeTest, CrumplesAndCrossingsAreCounted) {
  Points crumpled = model.positions;
  // Every second vertex of a patch stands 12 mm off a ball whose edges are 7 mm long.
  for (int row = 18; row < 24; ++row)
    for (int column = 10; column < 20; ++column)
      if ((row + column) % 2 == 0) crumpled.row(row * 80 + column) *= 1.13;
  const Quality rough = judged(crumpled, scan);
  EXPECT_GT(rough.crumpled_triangles, 60);
  EXPECT_TRUE(says(rough, "crumpled"));
  // One side of the ball pushed through the other: a dent as deep as the ball is thick.
  Points dented = model.positions;
  for (auto p : dented.rowwise())
    if (p.z() > 60.0) p.z() -= 180.0;
  const Quality through = judged(dented, scan);
  EXPECT_GT(through.crossing_triangles, 20);
  EXPECT_TRUE(says(through, "pass through others"));
  EXPECT_EQ(judged(model.positions, scan).crossing_triangles, 0);
  EXPECT_EQ(judged(model.positions, scan).crumpled_triangles, 0);
}

TEST_F(JudgeTest, HalfAScanIsNoPass) {
  std::vector<bool> keep(scan.positions.rows());
  for (int v = 0; v < scan.positions.rows(); ++v) keep[v] = scan.positions(v, 0) > 5.0;
  const Quality quality = judged(model.positions, sub_mesh(scan, keep).mesh);
  EXPECT_NE(quality.verdict, Verdict::pass);
  EXPECT_TRUE(says(quality, "of the face lies on data"));
  EXPECT_TRUE(quality.vertex_distance.array().isNaN().any());
}

TEST_F(JudgeTest, AnInsideOutScanFails) {
  Triangles turned = scan.topology->triangles();
  turned.col(0).swap(turned.col(1));
  Mesh inside_out = scan;
  inside_out.topology = Topology::from_triangles(static_cast<int>(scan.positions.rows()), turned);
  EXPECT_EQ(judged(model.positions, inside_out).verdict, Verdict::fail);
}

TEST_F(JudgeTest, LandmarksFarFromTheirPlacesFail) {
  const Quality quality = judged(model.positions, scan, {{"a", 30.0, 1.0}, {"b", 0.0, 0.0}});
  EXPECT_NEAR(quality.landmark_mean, 30.0, 1e-12);  // the one without confidence does not count
  EXPECT_EQ(quality.verdict, Verdict::fail);
  EXPECT_TRUE(says(quality, "landmarks"));
}

TEST_F(JudgeTest, KnowsOpenAndSealedLips) {
  Ibug68 ibug{};
  ibug.fill(-1);
  ibug[62] = 10;
  ibug[66] = 20;
  head.ibug68 = ibug;
  Points closed = model.positions;
  closed.row(20) = closed.row(10);
  EXPECT_TRUE(judged(closed, scan).lips_sealed);
  const Quality open = judged(model.positions, scan);
  EXPECT_FALSE(open.lips_sealed);
  EXPECT_NEAR(open.mouth_gap, (model.positions.row(10) - model.positions.row(20)).norm(), 1e-9);
}

// A scan cropped at ears and neck is whole where it matters; one that lacks a cheek is not.
TEST(Verdict, CoverageIsThatOfTheFront) {
  Quality quality;
  quality.sets["face"].coverage = 0.8;
  quality.sets["front"].coverage = 0.97;
  reach_verdict({}, quality);
  EXPECT_EQ(quality.verdict, Verdict::pass);
  quality.sets["front"].coverage = 0.8;
  reach_verdict({}, quality);
  EXPECT_EQ(quality.verdict, Verdict::warn);
  ASSERT_EQ(quality.reasons.size(), 1u);
  EXPECT_EQ(quality.reasons[0], "only 80 % of the face lies on data");
  quality.sets["front"].coverage = 0.45;
  reach_verdict({}, quality);
  EXPECT_EQ(quality.verdict, Verdict::fail);
}

}  // namespace
}  // namespace vultus::registration
