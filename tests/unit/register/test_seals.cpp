#include <gtest/gtest.h>

#include <cmath>

#include "register/seals.h"
#include "wall_face.h"

namespace vultus::registration {
namespace {

using test::eye_depth;
using test::wall;
using test::WallFace;

std::vector<Seal> seals_on(const Mesh& scan) {
  const WallFace face;
  return find_seals(face.head, face.positions, ScanSurface(scan));
}

TEST(Seals, AnOpenMouthIsAsWideAsItsHole) {
  const Mesh scan = wall([](double x, double y) { return std::abs(x) < 20 && std::abs(y) < 5 ? 12.0 : 0.0; });
  const auto seals = seals_on(scan);
  ASSERT_EQ(seals.size(), 3u);
  EXPECT_EQ(seals[0].name, "lips");
  EXPECT_NEAR(seals[0].mesh_gap, 0.4, 1e-9);
  EXPECT_NEAR(seals[0].scan_gap, 10.0, 1.0);  // walls of half a millimetre, probes a third of one apart
}

TEST(Seals, AGrooveIsNoOpening) {
  const Mesh scan = wall([](double, double y) { return std::max(0.0, 4.0 - 2.0 * std::abs(y)); });
  EXPECT_LE(seals_on(scan)[0].scan_gap, 1.2);
  EXPECT_EQ(seals_on(wall([](double, double) { return 0.0; }))[0].scan_gap, 0.0);
}

TEST(Seals, MissingDataBetweenLipsIsAnOpening) {
  Mesh scan = wall([](double, double) { return 0.0; });
  std::vector<bool> keep(scan.positions.rows());
  for (std::size_t v = 0; v < keep.size(); ++v) keep[v] = std::abs(scan.positions(v, 1)) > 4.0;
  EXPECT_NEAR(seals_on(sub_mesh(scan, keep).mesh)[0].scan_gap, 8.5, 1.0);
}

TEST(Seals, LidsShowAsTwoSteps) {
  for (const double gap : {6.0, 10.0}) {
    const auto seals = seals_on(wall([&](double x, double y) { return eye_depth(x, y, gap); }));
    EXPECT_EQ(seals[1].name, "right lids");
    EXPECT_NEAR(seals[1].scan_gap, gap, 0.25 * gap);  // seen from the eyeball's centre, at about its distance
    EXPECT_NEAR(seals[2].scan_gap, gap, 0.25 * gap);
    EXPECT_NEAR(seals[2].mesh_gap, 8.0, 1e-9);
  }
  EXPECT_EQ(seals_on(wall([](double x, double y) { return eye_depth(x, y, 0.0); }))[1].scan_gap, 0.0);
}

// Lids that meet leave a fold, or a groove between two rims; neither is an open eye.
TEST(Seals, AFoldOfClosedLidsIsNoStepOfAnOpenOne) {
  const auto fold = seals_on(wall([](double, double y) { return y < 50.0 ? -8.6 : -9.5; }));
  EXPECT_EQ(fold[1].scan_gap, 0.0);
  const auto groove = seals_on(wall([](double, double y) { return std::abs(y - 50.0) < 0.8 ? -8.2 : -9.0; }));
  EXPECT_GE(groove[1].scan_gap, 0.0);
  EXPECT_LE(groove[1].scan_gap, 2.2);
}

// An upper lid stands out more than twice as far as a lower one: the level eye beside its steep step is no step down.
TEST(Seals, AThinLowerLidBelowAThickUpperOneIsStillThere) {
  const auto seals = seals_on(wall([](double x, double y) {
    if (y < 25.0) return 0.0;
    const bool across = std::abs(std::abs(x) - 30.0) < 12.0;
    return across && std::abs(y - 50.0) < 4.0 ? -7.0 : y < 50.0 ? -8.3 : -10.0;
  }));
  EXPECT_NEAR(seals[1].scan_gap, 8.0, 2.0);
  EXPECT_NEAR(seals[2].scan_gap, 8.0, 2.0);
}

TEST(Seals, WithoutDataTheScanDoesNotTell) {
  Mesh scan = wall([](double, double) { return 0.0; });
  std::vector<bool> keep(scan.positions.rows());
  for (std::size_t v = 0; v < keep.size(); ++v) keep[v] = scan.positions(v, 1) < 30.0 && scan.positions(v, 1) > 25.0;
  for (const Seal& seal : seals_on(sub_mesh(scan, keep).mesh)) EXPECT_EQ(seal.scan_gap, -1.0) << seal.name;
  EXPECT_TRUE(find_seals(Template{}, Points(0, 3), ScanSurface(scan)).empty());
}

}  // namespace
}  // namespace vultus::registration
