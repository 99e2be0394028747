#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "register/unfold.h"
#include "synthetic_surfaces.h"

namespace vultus::registration {
namespace {

constexpr int side = 21;

// A shallow dish of 20 by 20 mm, a vertex a millimetre.
Mesh dish() {
  return test::grid(side, side, [](int c, int r) {
    const double x = c - 10.0, y = r - 10.0;
    return Eigen::Vector3d(x, y, 0.02 * (x * x + y * y));
  });
}

long folds(const Mesh& reference, const Points& positions) {
  const auto flags = folded_triangles(*reference.topology, reference.positions, positions);
  return std::count(flags.begin(), flags.end(), true);
}

double moved(const Points& from, const Points& to, int vertex) { return (to.row(vertex) - from.row(vertex)).norm(); }

TEST(Unfold, AVertexBeyondItsNeighbourGoesBackAlone) {
  const Mesh rest = dish();
  constexpr int astray = 10 * side + 10;
  Points positions = rest.positions;
  positions(astray, 0) += 1.6;
  ASSERT_GT(folds(rest, positions), 0);
  const Points result = unfolded(*rest.topology, rest.positions, positions);
  EXPECT_EQ(folds(rest, result), 0);
  EXPECT_LT(moved(rest.positions, result, astray), 1.0);  // within its ring again
  for (int v = 0; v < side * side; ++v) {
    if ((rest.positions.row(v) - rest.positions.row(astray)).norm() > 3.0) {
      EXPECT_EQ(moved(positions, result, v), 0.0);
    }
  }
}

TEST(Unfold, ATangleIsSpreadOutInAStretchedSheet) {
  const Mesh rest = dish();
  Points positions = rest.positions;
  positions.col(0) *= 1.5;  // as skin is stretched: no reason to go back to the reference's lengths
  const Points wanted = positions;
  Random random(1);
  for (int v = 0; v < side * side; ++v)
    if (rest.positions.row(v).head<2>().cwiseAbs().maxCoeff() < 5.5)
      for (int axis = 0; axis < 3; ++axis) positions(v, axis) += random.uniform(-4.0, 4.0);
  ASSERT_GT(folds(rest, positions), 20);
  EXPECT_GT(folds(rest, unfolded(*rest.topology, rest.positions, positions, 0)), 0);  // single vertices do not do
  const Points result = unfolded(*rest.topology, rest.positions, positions);
  EXPECT_EQ(folds(rest, result), 0);
  double before = 0.0, after = 0.0;
  for (int v = 0; v < side * side; ++v) {
    before += moved(wanted, positions, v);
    after += moved(wanted, result, v);
    if (rest.positions.row(v).head<2>().cwiseAbs().maxCoeff() > 9.5) {
      EXPECT_EQ(moved(positions, result, v), 0.0);
    }
  }
  EXPECT_LT(after, before);
}

TEST(Unfold, ASheetWithoutFoldsStaysAsItIs) {
  const Mesh rest = dish();
  const Points bent = 2.0 * rest.positions;
  EXPECT_EQ(unfolded(*rest.topology, rest.positions, bent), bent);
}

}  // namespace
}  // namespace vultus::registration
