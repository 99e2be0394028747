#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "register/flow_alignment.h"
#include "synthetic_surfaces.h"

namespace vultus::registration {
namespace {

// Freckles: a pattern without direction or repetition.
double freckles(const Eigen::Vector3d& p) {
  return 0.4 + 0.12 * std::sin(0.31 * p.x() + 0.9 * std::sin(0.17 * p.y())) +
         0.12 * std::sin(0.37 * p.y() + 1.1 * std::sin(0.13 * p.x() + 0.2 * p.z()));
}

Mesh freckled(const Mesh& ball, const Eigen::Matrix3d& skin_from_ball) {
  Mesh scan = ball;
  scan.colours.resize(ball.positions.rows(), 3);
  for (int v = 0; v < scan.colours.rows(); ++v)
    scan.colours.row(v).setConstant(freckles(skin_from_ball * Eigen::Vector3d(ball.positions.row(v))));
  return scan;
}

class FlowAlignment : public testing::Test {
 protected:
  Mesh model = test::bumpy_sphere(40, 0.0, 1), ball = test::bumpy_sphere(150, 0.0, 2);
  // The skin has slid by 1.5 degrees about y, 2.5 mm on the front of the ball, and its surface is as before.
  Eigen::Matrix3d slide = Eigen::AngleAxisd(0.026, Eigen::Vector3d::UnitY()).toRotationMatrix();
  std::vector<int> front() const {
    std::vector<int> vertices;
    for (int v = 0; v < model.positions.rows(); ++v)
      if (model.positions.row(v).normalized().z() > 0.8) vertices.push_back(v);
    return vertices;
  }
};

TEST_F(FlowAlignment, FindsSkinThatSlidOverAnUnchangedSurface) {
  const Appearance before(freckled(ball, Eigen::Matrix3d::Identity()));
  const Appearance after(freckled(ball, slide.transpose()));
  const auto terms = flow_targets(*model.topology, front(), {model.positions, before}, {model.positions, after}, {});
  ASSERT_GT(terms.size(), front().size() / 2);
  std::vector<double> unmoved, errors;
  for (const PointTerm& term : terms) {
    const Eigen::Vector3d old = model.positions.row(term.vertex);
    unmoved.push_back((slide * old - old).norm());
    errors.push_back((term.target - slide * old).norm());
  }
  std::nth_element(unmoved.begin(), unmoved.begin() + unmoved.size() / 2, unmoved.end());
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  EXPECT_GT(unmoved[unmoved.size() / 2], 1.5);
  EXPECT_LT(errors[errors.size() / 2], 0.35);  // half a pixel of the pictures, 0.6 mm
}

TEST_F(FlowAlignment, LeavesSkinThatStayed) {
  const Appearance look(freckled(ball, Eigen::Matrix3d::Identity()));
  for (const PointTerm& term :
       flow_targets(*model.topology, front(), {model.positions, look}, {model.positions, look}, {}))
    EXPECT_LT((term.target - model.positions.row(term.vertex).transpose()).norm(), 0.5);
}

TEST_F(FlowAlignment, SaysNothingWhereNothingIsSeen) {
  const Mesh plain = ball;  // no colour, and a ball has no relief to tell places by
  const Appearance look(plain);
  double weight = 0.0;
  const auto vertices = front();
  for (const PointTerm& term :
       flow_targets(*model.topology, vertices, {model.positions, look}, {model.positions, look}, {}))
    weight += term.weight;
  EXPECT_LT(weight, 0.35 * static_cast<double>(vertices.size()));
}

}  // namespace
}  // namespace vultus::registration
