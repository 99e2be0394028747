#include <gtest/gtest.h>

#include <cmath>

#include "register/settled_skin.h"
#include "shipped_head.h"

namespace vultus::registration {
namespace {

// The head itself as the scan, with a round bump of 3 mm on the forehead.
class SettledSkin : public testing::Test {
 protected:
  static constexpr double radius = 15.0;  // mm
  const RefinedTemplate& model = test::model();
  const Eigen::Vector3d brow = model.head.neutral.row((*model.head.ibug68)[19]).transpose();

  Mesh raised() const {
    Mesh scan = test::shape_of(model.neutral);
    const Points normals = vertex_normals(model.topology(), model.neutral);
    for (int v = 0; v < scan.positions.rows(); ++v) {
      const double distance = (model.neutral.row(v).transpose() - brow).norm();
      if (distance < radius)
        scan.positions.row(v) += 3.0 * std::pow(std::cos(M_PI_2 * distance / radius), 2) * normals.row(v);
    }
    return scan;
  }
  double distance(int vertex, const Eigen::Vector3d& place) const {
    return (model.neutral.row(vertex).transpose() - place).norm();
  }
};

TEST_F(SettledSkin, HoldsWhatLiesOnTheScanAwayFromWhatDoesNot) {
  const Mesh scan = raised();
  const auto terms = settled_skin(model, model.neutral, {}, ScanSurface(scan));
  ASSERT_GT(terms.size(), 1000u);
  double surest = 0.0;
  for (const PointTerm& term : terms) {
    EXPECT_GT(distance(term.vertex, brow), 0.5 * radius) << "skin that has left the scan is held";
    EXPECT_LT((term.target - model.neutral.row(term.vertex).transpose()).norm(), 1e-12);
    EXPECT_GT(term.weight, 0.0);
    EXPECT_LE(term.weight, 1.0);
    EXPECT_TRUE(distance(term.vertex, brow) > radius || term.weight < 0.5) << "beside the bump";
    surest = std::max(surest, term.weight);
  }
  EXPECT_EQ(surest, 1.0) << "far from the bump";
}

TEST_F(SettledSkin, LeavesLipsAndChinAlone) {
  const Mesh scan = test::shape_of(model.neutral);
  const double nose = model.head.neutral((*model.head.ibug68)[33], 1);
  for (const PointTerm& term : settled_skin(model, model.neutral, {}, ScanSurface(scan)))
    EXPECT_GT(model.neutral(term.vertex, 1), nose);
}

TEST_F(SettledSkin, LetsGoAroundALandmarkThatHasMoved) {
  const Mesh scan = test::shape_of(model.neutral);
  Anchors slid;
  slid.names = {"ibug.19"};
  slid.vertices = {(*model.head.ibug68)[19]};
  slid.targets = brow.transpose() + Eigen::RowVector3d(0.0, 6.0, 0.0);
  slid.confidence = Eigen::VectorXd::Ones(1);
  for (const PointTerm& term : settled_skin(model, model.neutral, slid, ScanSurface(scan)))
    EXPECT_GT(distance(term.vertex, brow), 23.0);  // 25 mm from the refined vertex, which subdivision moves
}

}  // namespace
}  // namespace vultus::registration
