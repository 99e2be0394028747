#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/neighbours.h"
#include "core/random.h"

namespace vultus {
namespace {

std::shared_ptr<const Topology> polygons(int vertices, const std::vector<std::vector<int>>& faces) {
  TopologyData data;
  data.vertex_count = vertices;
  data.face_offsets.push_back(0);
  for (const auto& face : faces) {
    data.corner_vertex.insert(data.corner_vertex.end(), face.begin(), face.end());
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  return Topology::make(std::move(data));
}

/// Quads of a (n+1)×(n+1) grid of vertices, without those whose column and row are both in [hole_low, hole_high).
std::shared_ptr<const Topology> grid(int n, int hole_low = 0, int hole_high = 0) {
  std::vector<std::vector<int>> faces;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto in_hole = [&](int i) { return i >= hole_low && i < hole_high; };
      if (in_hole(x) && in_hole(y)) continue;
      const int v = y * (n + 1) + x;
      faces.push_back({v, v + 1, v + n + 2, v + n + 1});
    }
  return polygons((n + 1) * (n + 1), faces);
}

using Pairs = std::vector<std::pair<int, int>>;

TEST(Neighbours, EdgesOfAQuadAreItsSides) {
  const auto quad = polygons(5, {{0, 1, 2, 3}});
  EXPECT_EQ(edges(*quad), (Pairs{{0, 1}, {0, 3}, {1, 2}, {2, 3}}));  // no diagonal
  const Adjacency near = adjacency(*quad);
  EXPECT_EQ(std::vector<int>(near.of(0).begin(), near.of(0).end()), (std::vector<int>{1, 3}));
  EXPECT_TRUE(near.of(4).empty());
}

TEST(Neighbours, AdjacencyIsSymmetricAndSorted) {
  const auto topology = grid(6, 2, 4);
  const Adjacency near = adjacency(*topology);
  std::size_t total = 0;
  for (int v = 0; v < topology->vertex_count(); ++v) {
    const auto row = near.of(v);
    total += row.size();
    EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
    for (const int n : row) {
      const auto back = near.of(n);
      EXPECT_TRUE(std::binary_search(back.begin(), back.end(), v));
    }
  }
  EXPECT_EQ(total, 2 * edges(*topology).size());
}

TEST(Neighbours, BoundaryOfATriangleRunsAgainstItsFace) {
  EXPECT_EQ(boundary_loops(*polygons(3, {{0, 1, 2}})), (std::vector<std::vector<int>>{{0, 2, 1}}));
}

TEST(Neighbours, GridWithAHoleHasTwoLoops) {
  const auto loops = boundary_loops(*grid(6, 2, 4));
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_EQ(loops[0].size(), 24u);  // outer first, as the longer
  EXPECT_EQ(loops[1].size(), 8u);
}

TEST(Neighbours, ClosedMeshHasNoBoundary) {
  EXPECT_TRUE(boundary_loops(*polygons(4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})).empty());
}

TEST(Neighbours, HolesThatTouchInAVertexStayApart) {
  // Two one-quad holes that share a grid vertex diagonally.
  std::vector<std::vector<int>> faces;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      if (!(x == 1 && y == 1) && !(x == 2 && y == 2)) {
        const int v = y * 5 + x;
        faces.push_back({v, v + 1, v + 6, v + 5});
      }
  const auto loops = boundary_loops(*polygons(25, faces));
  ASSERT_EQ(loops.size(), 3u);
  EXPECT_EQ(loops[0].size(), 16u);
  EXPECT_EQ(loops[1], (std::vector<int>{6, 7, 12, 11}));
  EXPECT_EQ(loops[2], (std::vector<int>{12, 13, 18, 17}));
}

TEST(Neighbours, NonManifoldMeshesAreAnsweredToo) {
  // Three triangles on one edge (0, 1): OpenMesh refuses the third.
  const auto fin = polygons(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  EXPECT_EQ(edges(*fin).size(), 7u);
  for (const auto& loop : boundary_loops(*fin))
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::pair side = std::minmax({loop[k], loop[(k + 1) % loop.size()]});
      EXPECT_NE(side, (std::pair{0, 1})) << "an edge with faces on both sides is no boundary";
    }
}

TEST(Neighbours, ComponentsAreNumberedByFirstVertex) {
  const auto two = polygons(8, {{4, 5, 6}, {0, 7, 2}});
  EXPECT_EQ(components(*two), (std::vector<int>{0, 1, 0, 2, 3, 3, 3, 0}));
}

TEST(PointTree, AgreesWithBruteForce) {
  Random random(4);
  Points points(700, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i)  // a coarse lattice, so that many distances tie
    for (int k = 0; k < 3; ++k) points(i, k) = random.below(8);
  const PointTree tree(points);
  for (int query = 0; query < 200; ++query) {
    const Eigen::Vector3d p(random.below(8), random.uniform(-2, 10), random.below(8));
    std::vector<std::pair<double, int>> expected;
    for (Eigen::Index i = 0; i < points.rows(); ++i)
      expected.emplace_back((points.row(i) - p.transpose()).squaredNorm(), static_cast<int>(i));
    std::sort(expected.begin(), expected.end());
    const auto found = tree.nearest(p, 20);
    ASSERT_EQ(found.size(), 20u);
    for (int i = 0; i < 20; ++i) {
      EXPECT_EQ(found[i].index, expected[i].second);
      EXPECT_NEAR(found[i].distance, std::sqrt(expected[i].first), 1e-12);
    }
  }
}

TEST(PointTree, GivesWhatThereIs) {
  EXPECT_TRUE(PointTree(Points(0, 3)).nearest({0, 0, 0}, 3).empty());
  EXPECT_EQ(PointTree(Points::Zero(2, 3)).nearest({0, 0, 1}, 9).size(), 2u);
  EXPECT_TRUE(PointTree(Points::Zero(2, 3)).nearest({0, 0, 1}, 0).empty());
  EXPECT_EQ(PointTree(Points::Zero(100, 3)).nearest({0, 0, 1}, 3)[2].index, 2);  // all equal: by index
  Points bad = Points::Zero(3, 3);
  bad(1, 1) = std::nan("");
  EXPECT_THROW(PointTree{bad}, InputError);
}

}  // namespace
}  // namespace vultus
