#include <gtest/gtest.h>

#include "register/closed_lids.h"
#include "wall_face.h"

namespace vultus::registration {
namespace {

using test::eye_depth;
using test::wall;
using test::WallFace;

LidClosing closing_on(const Mesh& scan, const WallFace& face) {
  const std::vector<bool> all(face.positions.rows(), true);
  return find_lid_closing(face.head, all, face.positions, ScanSurface(scan));
}

// How far a vertex is asked to come down; 0 where nothing is asked of it.
double asked_down(const LidClosing& closing, const WallFace& face, int vertex) {
  for (const PointTerm& term : closing.terms)
    if (term.vertex == vertex) return face.positions(vertex, 1) - term.target.y();
  return 0.0;
}

TEST(ClosedLids, RimsMeetNearTheLowerOneAndSkinAboveFollows) {
  WallFace face;
  constexpr int halfway = 19, brow = 20;  // of the skin above the right eye, whose rims stand 8 mm apart
  face.put(halfway, -30, 58);
  face.put(brow, -30, 64);
  const LidClosing closing = closing_on(wall([](double x, double y) { return eye_depth(x, y, 0.0); }), face);
  EXPECT_EQ(closing.lids, (std::vector<std::string>{"right lids", "left lids"}));
  for (const auto& [upper, lower] : {std::pair(37, 41), std::pair(38, 40), std::pair(43, 47), std::pair(44, 46)}) {
    EXPECT_NEAR(asked_down(closing, face, upper), 0.85 * 8.0, 0.4);  // an arc instead of its chord
    EXPECT_NEAR(asked_down(closing, face, lower), -0.15 * 8.0, 0.4);
  }
  EXPECT_GT(asked_down(closing, face, halfway), 3.0);
  EXPECT_LT(asked_down(closing, face, halfway), 6.0);
  EXPECT_EQ(asked_down(closing, face, brow), 0.0);
  for (const int corner : {36, 39, 42, 45}) EXPECT_EQ(asked_down(closing, face, corner), 0.0);
}

TEST(ClosedLids, OpenEyesAndShutOnesThatWereShutAreLeftAlone) {
  WallFace face;
  EXPECT_TRUE(closing_on(wall([](double x, double y) { return eye_depth(x, y, 8.0); }), face).terms.empty());
  for (const int upper : {37, 38, 43, 44}) face.positions(upper, 1) = 46.5;
  EXPECT_TRUE(closing_on(wall([](double x, double y) { return eye_depth(x, y, 0.0); }), face).terms.empty());
}

}  // namespace
}  // namespace vultus::registration
