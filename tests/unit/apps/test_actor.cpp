#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "apps/virtual_stage/actor.h"
#include "apps/virtual_stage/hair_paint.h"
#include "apps/virtual_stage/skin.h"
#include "core/texture_space.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

const registration::Template& head() {
  static const registration::Template made = registration::template_head();
  return made;
}

const registration::LoopSubdivision& smooth() {
  static const registration::LoopSubdivision loop(head().topology, head().subdivisions);
  return loop;
}

double distance(const Points& p, const std::string& a, const std::string& b) {
  const auto& named = head().topology->landmarks();
  return (p.row(named.at(a)) - p.row(named.at(b))).norm();
}

TEST(Actor, AverageTraitsAreTheTemplate) {
  EXPECT_LT((shaped(head(), Identity{}) - head().neutral).cwiseAbs().maxCoeff(), 1e-9);  // rounding
}

TEST(Actor, SameSeedSamePersonOtherSeedAnother) {
  EXPECT_TRUE(identity(head(), 7) == identity(head(), 7));
  for (std::uint64_t seed = 1; seed < 8; ++seed) {
    const Points difference = identity(head(), seed) - identity(head(), seed + 1);
    EXPECT_GT(std::sqrt(difference.squaredNorm() / static_cast<double>(difference.rows())), 1.0) << seed;
  }
  std::set<std::string> names;
  for (int i = 0; i < trait_count; ++i) EXPECT_TRUE(names.insert(trait_name(i)).second);
}

// iBUG's points of a brow run along its upper edge, which is where finders see them. At its ends, where hair is upright
// or thin, there is no edge to speak of.
TEST(Actor, BrowsArePaintedBelowTheirPointsOfThe68PointScheme) {
  const EyebrowPaint paint(5);
  const auto covered = [&](const Eigen::Vector3d& at, double from, double to) {
    double sum = 0.0;
    int n = 0;
    for (double x = -2.0; x <= 2.0; x += 0.25)
      for (double y = from; y <= to; y += 0.25, ++n) sum += paint.coverage(at + Eigen::Vector3d(x, y, 0.0));
    return sum / n;
  };
  for (int i : {18, 19, 20, 23, 24, 25}) {
    const Eigen::Vector3d at = head().neutral.row((*head().ibug68)[i]);
    EXPECT_GT(covered(at, -4.0, -1.0), 0.3) << i;
    EXPECT_LT(covered(at, 2.5, 5.0), 0.1) << i;
  }
}

TEST(Actor, WithoutAsymmetryBothSidesMirror) {
  const Points p = shaped(head(), random_identity(3, 0.0));
  const auto mirror = registration::template_mirror();
  for (int v = 0; v < p.rows(); ++v)
    EXPECT_LT((p.row(mirror[v]) - Eigen::RowVector3d(-p(v, 0), p(v, 1), p(v, 2))).norm(), 1e-9) << v;
}

// Ranges of adults, about three deviations around the mean (Farkas 1994).
TEST(Actor, EveryPersonIsWithinHumanRange) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Points p = identity(head(), seed);
    EXPECT_NEAR(distance(p, "3.5", "3.6"), 63.0, 11.0) << seed;
    EXPECT_NEAR(distance(p, "sellion", "2.1"), 114.0, 22.0) << seed;
    EXPECT_NEAR(distance(p, "8.3", "8.4"), 51.0, 12.0) << seed;
    EXPECT_NEAR(distance(p, "9.1", "9.2"), 35.0, 9.0) << seed;
    EXPECT_NEAR(distance(p, "2.13", "2.14"), 106.0, 24.0) << seed;
  }
}

TEST(Actor, LipsStaySealedAndLidsOnTheirEyeballs) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Points p = smooth()(identity(head(), seed));
    for (const auto& [upper, lower] : registration::lip_seal()) {
      EXPECT_GT(p(upper, 1) - p(lower, 1), -0.1) << seed;
      EXPECT_LT(p(upper, 1) - p(lower, 1), 0.8) << seed;
    }
    for (const bool left : {true, false}) {
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      const auto& ball = head().topology->set(left ? "eyeball_left" : "eyeball_right");
      const auto eye = left ? registration::eye_sphere_left() : registration::eye_sphere_right();
      // The eyeball moves rigidly: its own vertices give its centre through the pose of the template's.
      const Points neutral = smooth()(head().neutral);
      for (const int v : ball) centre += (p.row(v) - neutral.row(v)).transpose() / static_cast<double>(ball.size());
      centre += eye.centre;
      for (const auto& [upper, lower] : left ? registration::lid_seal_left() : registration::lid_seal_right()) {
        EXPECT_GT(p(upper, 1), p(lower, 1)) << seed;
        for (const int v : {upper, lower})
          EXPECT_NEAR((p.row(v).transpose() - centre).norm() - eye.radius, 1.7, 1.8) << seed;
      }
    }
  }
}

// No triangle of the skin turns over: its normal stays within a right angle of the template's.
TEST(Actor, NoTriangleFoldsOver) {
  const Points before = triangle_normals(*smooth().refined(), smooth()(head().neutral));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Points after = triangle_normals(*smooth().refined(), smooth()(identity(head(), seed)));
    int turned = 0;
    for (int f = 0; f < before.rows(); ++f) turned += before.row(f).dot(after.row(f)) < 0.0 ? 1 : 0;
    EXPECT_EQ(turned, 0) << seed;
  }
}

TEST(Skin, HasEyesLipsAndHairWhereTheyBelong) {
  const Points reference = smooth()(head().neutral);
  const TextureSpace space(smooth().refined(), 512, 512);
  const Complexion who = random_complexion(5);
  const Image albedo = skin_albedo(space, reference, who);
  const auto colour = [&](const std::string& landmark, double below = 0.0) {
    const Eigen::RowVector3d at = reference.row(head().topology->landmarks().at(landmark));
    int vertex = 0;
    (reference.rowwise() - (at - Eigen::RowVector3d(0.0, below, 0.0))).rowwise().squaredNorm().minCoeff(&vertex);
    const Triangles& t = space.topology().triangles();
    for (int f = 0; f < t.rows(); ++f)
      for (int k = 0; k < 3; ++k)
        if (t(f, k) == vertex) {
          const Eigen::Vector2d uv = space.uv({f, Eigen::Vector3d::Unit(k)});
          return albedo.rgb_at(static_cast<int>(uv.x() * 511.99), static_cast<int>((1.0 - uv.y()) * 511.99));
        }
    return Eigen::Vector3f(-1, -1, -1);
  };
  EXPECT_LT(colour("3.5").maxCoeff(), 0.05f);                        // pupil
  EXPECT_LT(colour("11.4").sum(), 0.8f * colour("forehead").sum());  // scalp hair
  EXPECT_LT(colour("brow_middle_left", 3.0).sum(), 0.7f * colour("forehead").sum());
  const Eigen::Vector3f lip = colour("8.2"), skin = colour("forehead");
  EXPECT_GE(lip.x() / lip.y(), skin.x() / skin.y());  // redder than skin
  for (const float value : albedo.pixels()) EXPECT_TRUE(value >= 0.0f && value <= 1.0f);
}

TEST(Complexion, SameSeedSameColours) {
  EXPECT_EQ(random_complexion(4).skin, random_complexion(4).skin);
  EXPECT_NE(random_complexion(4).skin, random_complexion(5).skin);
}

}  // namespace
}  // namespace vultus::virtual_stage
