#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/virtual_stage/actor.h"
#include "apps/virtual_stage/detail.h"
#include "apps/virtual_stage/expressions.h"
#include "apps/virtual_stage/face_features.h"
#include "apps/virtual_stage/face_model.h"
#include "core/error.h"
#include "core/rays.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

const registration::Template& head() {
  static const registration::Template made = registration::template_head();
  return made;
}

// The template itself is mirror symmetric; a person is not.
const FaceModel& symmetric_face() {
  static const FaceModel face(head(), head().neutral);
  return face;
}
const FaceModel& person() {
  static const FaceModel face(head(), identity(head(), 7));
  return face;
}

Activations only(Muscle muscle, Side side, double strength = 1.0) {
  Activations a = at_rest();
  a[channel(muscle, side)] = strength;
  return a;
}

Points moved(const FaceModel& face, const Activations& a) { return face.pose(a) - face.neutral(); }

TEST(Expressions, RestIsTheNeutral) {
  EXPECT_TRUE(symmetric_face().pose(at_rest()) == symmetric_face().neutral());
  EXPECT_EQ(expression("neutral").activations, at_rest());
}

TEST(Expressions, OneSidedMusclesMoveOneSide) {
  const Points& rest = symmetric_face().neutral();
  for (int m = 0; m < muscle_count; ++m) {
    const Points change = moved(symmetric_face(), only(static_cast<Muscle>(m), Side::left));
    double left = 0, right = 0;
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      const double length = change.row(v).norm();
      left = std::max(left, length);
      if (rest(v, 0) < -8.0) right = std::max(right, length);  // a side's share ends 7 mm beyond the middle
    }
    EXPECT_GT(left, 0.5) << channel_names()[2 * m];
    EXPECT_LT(right, 1e-9) << channel_names()[2 * m];
  }
}

TEST(Expressions, MirroredActionsMirrorTheFace) {
  const std::vector<int> mirror = registration::template_mirror();
  Activations a = only(Muscle::zygomaticus, Side::left);
  a[channel(Muscle::lid_closer, Side::right)] = 0.7;
  a[channel(Jaw::left)] = 0.5;
  a[channel(Jaw::open)] = 0.4;
  const Points one = symmetric_face().pose(a), other = symmetric_face().pose(mirrored(a));
  for (std::size_t v = 0; v < mirror.size(); ++v)
    // 1e-3 mm: the smooth fields come from a factorization that does not know of the symmetry.
    EXPECT_LT((one.row(v) - other.row(mirror[v]).cwiseProduct(Eigen::RowVector3d(-1, 1, 1))).norm(), 1e-3) << v;
}

TEST(Expressions, DatabaseIsSymmetricAndNamed) {
  const std::vector<Expression>& database = expression_database();
  ASSERT_GE(database.size(), 22u);
  EXPECT_EQ(database.front().name, "neutral");
  std::set<std::string> names;
  int visemes = 0;
  const std::vector<int> mirror = registration::template_mirror();
  for (const Expression& e : database) {
    names.insert(e.name);
    EXPECT_FALSE(e.tags.empty()) << e.name;
    visemes += std::ranges::any_of(e.tags, [](const std::string& tag) { return tag.starts_with("viseme_"); });
    EXPECT_EQ(mirrored(e.activations), e.activations) << e.name;
    const Points posed = symmetric_face().pose(e.activations);
    double worst = 0;
    for (std::size_t v = 0; v < mirror.size(); ++v)
      worst = std::max(worst, (posed.row(v) - posed.row(mirror[v]).cwiseProduct(Eigen::RowVector3d(-1, 1, 1))).norm());
    EXPECT_LT(worst, 1e-3) << e.name;
  }
  EXPECT_EQ(names.size(), database.size());
  EXPECT_EQ(visemes, 4);
  EXPECT_THROW(expression("smile_teath"), InputError);
}

TEST(Expressions, PosesDiffer) {
  const std::vector<Expression>& database = expression_database();
  std::vector<Points> posed;
  for (const Expression& e : database) posed.push_back(symmetric_face().pose(e.activations));
  for (std::size_t i = 0; i < posed.size(); ++i)
    for (std::size_t j = i + 1; j < posed.size(); ++j)
      EXPECT_GT((posed[i] - posed[j]).rowwise().norm().maxCoeff(), 2.0) << database[i].name << " " << database[j].name;
}

// A closed eye shows no eyeball from the front.
TEST(Lids, SealOnABlink) {
  for (const FaceModel* face : {&symmetric_face(), &person()}) {
    const Points closed = face->pose(expression("eyes_closed").activations);
    const RayScene scene(*face->topology(), closed);
    std::vector<bool> eyeball(face->topology()->vertex_count(), false);
    for (const int v : face->topology()->set("eyeballs")) eyeball[v] = true;
    int seen = 0, rays = 0;
    for (const Side side : {Side::left, Side::right}) {
      const LidMotion& lids = face->lids(side);
      for (double x = -0.95; x <= 0.95; x += 0.05)
        for (double y = -0.7; y <= 0.7; y += 0.02) {
          const Eigen::Vector3d from = lids.centre + Eigen::Vector3d(x * lids.radius, y * lids.radius, 60);
          const auto hit = scene.hit(from, -Eigen::Vector3d::UnitZ());
          ASSERT_TRUE(hit);
          ++rays;
          seen += eyeball[face->topology()->triangles()(hit->place.triangle, 0)];
        }
    }
    EXPECT_LE(seen, rays / 1000);  // a ray may slip between two edges
  }
}

TEST(Lids, StayOutsideTheEyeball) {
  for (const Expression& e : expression_database()) {
    const Points posed = person().pose(e.activations);
    for (const Side side : {Side::left, Side::right}) {
      const LidMotion& lids = person().lids(side);
      for (std::size_t i = 0; i < lids.vertices.size(); ++i) {
        const Eigen::Vector3d now = posed.row(lids.vertices[i]), before = person().neutral().row(lids.vertices[i]);
        const double least = std::min((before - lids.centre).norm(), lids.radius + 1.0);
        EXPECT_GE((now - lids.centre).norm(), least - 1e-6) << e.name;
      }
    }
  }
}

// Signed opening between the lips beyond what they have at rest, mm, for each pair.
std::vector<double> openings(const FaceModel& face, const Points& posed) {
  std::vector<double> gaps;
  for (const auto& [u, l] : face.lip_pairs())
    gaps.push_back(posed(u, 1) - posed(l, 1) - (face.neutral()(u, 1) - face.neutral()(l, 1)));
  return gaps;
}

TEST(Lips, SealedPosesStaySealed) {
  for (const char* name :
       {"brows_up", "eyes_closed", "smile_closed", "frown", "pucker", "lips_pressed", "cheeks_puffed"})
    for (const FaceModel* face : {&symmetric_face(), &person()})
      for (const double gap : openings(*face, face->pose(expression(name).activations)))
        // 1.2 mm: less than the lips' own roundness hides in front of the contact line.
        EXPECT_LT(std::abs(gap), 1.2) << name;
}

TEST(Lips, NeverPassThroughEachOther) {
  for (const Expression& e : expression_database())
    for (const double strength : {0.5, 1.0})
      for (const double gap : openings(person(), person().pose(strength * e.activations)))
        EXPECT_GT(gap, -0.6) << e.name;
}

// Edges of the upper lip that pass through the lower.
int crossings(const FaceModel& face, const Points& posed) {
  const Topology& topology = *face.topology();
  const auto members = [&](const char* set) {
    std::vector<bool> in(topology.vertex_count(), false);
    for (const int v : topology.set(set)) in[v] = true;
    return in;
  };
  const std::vector<bool> upper = members("upper_lip"), lower = members("lower_lip");
  const auto inside = [&](const std::vector<bool>& set, Eigen::Index t) {
    const auto corners = topology.triangles().row(t);
    return set[corners[0]] && set[corners[1]] && set[corners[2]];
  };
  std::vector<int> kept;
  for (Eigen::Index t = 0; t < topology.triangles().rows(); ++t)
    if (inside(lower, t)) kept.push_back(static_cast<int>(t));
  Triangles lower_triangles(kept.size(), 3);
  for (std::size_t t = 0; t < kept.size(); ++t) lower_triangles.row(t) = topology.triangles().row(kept[t]);
  const auto lower_topology = Topology::from_triangles(topology.vertex_count(), lower_triangles);
  const RayScene scene(*lower_topology, posed);
  int count = 0;
  for (Eigen::Index t = 0; t < topology.triangles().rows(); ++t)
    for (int c = 0; c < 3 && inside(upper, t); ++c) {
      const Eigen::Vector3d a = posed.row(topology.triangles()(t, c)),
                            b = posed.row(topology.triangles()(t, (c + 1) % 3));
      count += scene.occluded(a, b - a, 0.0, (b - a).norm());
    }
  return count;
}

TEST(Lips, DoNotIntersect) {
  for (const Expression& e : expression_database())
    EXPECT_EQ(crossings(person(), person().pose(e.activations)), 0) << e.name;
  // The test itself sees lips that do.
  Points crossed = person().neutral();
  for (const int v : person().topology()->set("lower_lip")) crossed(v, 1) += 4.0;
  EXPECT_GT(crossings(person(), crossed), 50);
}

TEST(Lips, PartWhenTheJawOpens) {
  const std::vector<double> gaps = openings(person(), person().pose(expression("jaw_open").activations));
  EXPECT_GT(gaps[gaps.size() / 2], 20.0);
  EXPECT_LT(gaps.front(), 0.35 * gaps[gaps.size() / 2]);  // towards the corners it closes
}

TEST(Jaw, TeethAndEyesAreRigid) {
  const Points posed = person().pose(expression("scream").activations), &rest = person().neutral();
  for (const char* set : {"eyeballs", "teeth_upper"})
    for (const int v : person().topology()->set(set)) EXPECT_LT((posed.row(v) - rest.row(v)).norm(), 1e-9) << set;
  const std::vector<int>& lower = person().topology()->set("teeth_lower");
  const int last = lower.back();
  for (const int v : lower)
    EXPECT_NEAR((posed.row(v) - posed.row(last)).norm(), (rest.row(v) - rest.row(last)).norm(), 1e-9);
  EXPECT_GT((posed.row(last) - rest.row(last)).norm(), 15.0);
}

TEST(Detail, FoldsComeWithTheirMuscle) {
  DetailOptions options;
  options.levels = 1;
  options.pores = 0;
  const DetailedFace folded(symmetric_face(), options);
  options.folds = 0;
  const DetailedFace smooth(symmetric_face(), options);
  const auto depth = [&](double strength, Side side) {
    Activations a = at_rest();
    set_both(a, Muscle::frontalis_inner, side == Side::left ? 0 : strength);
    a[channel(Muscle::frontalis_inner, Side::left)] = strength;
    return (folded.pose(a) - smooth.pose(a)).eval();
  };
  const double none = depth(0.0, Side::right).rowwise().norm().maxCoeff(),
               half = depth(0.5, Side::right).rowwise().norm().maxCoeff(),
               full = depth(1.0, Side::right).rowwise().norm().maxCoeff();
  EXPECT_LT(none, 0.4);  // what an adult face shows at rest
  EXPECT_GT(half, none);
  EXPECT_GT(full, half);
  EXPECT_GT(full, 0.5);

  const Points one_side = depth(1.0, Side::left) - depth(0.0, Side::left);
  for (Eigen::Index v = 0; v < one_side.rows(); ++v)
    if (v < symmetric_face().neutral().rows() && symmetric_face().neutral()(v, 0) < -12) {
      EXPECT_LT(one_side.row(v).norm(), 0.02);
    }
}

TEST(Detail, PoresStayWithTheSkin) {
  DetailOptions options;
  options.levels = 1;
  options.folds = 0;
  const DetailedFace pored(person(), options);
  options.pores = 0;
  const DetailedFace smooth(person(), options);
  const Points& rest = person().neutral();
  const Activations smile = expression("smile_closed").activations;
  const Points at_rest_relief = pored.pose(at_rest()) - smooth.pose(at_rest()),
               in_smile = pored.pose(smile) - smooth.pose(smile);
  for (Eigen::Index v = 0; v < rest.rows(); ++v)
    EXPECT_NEAR(at_rest_relief.row(v).norm(), in_smile.row(v).norm(), 1e-9);
  const double height = at_rest_relief.rowwise().norm().maxCoeff();
  EXPECT_GT(height, 0.03);
  EXPECT_LT(height, 0.3);
}

}  // namespace
}  // namespace vultus::virtual_stage
