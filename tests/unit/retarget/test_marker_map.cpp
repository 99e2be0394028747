#include "retarget/marker_map.h"

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "core/error.h"
#include "retarget/anchors.h"
#include "small_face.h"

namespace vultus::retarget {
namespace {

using testing::SmallFace;

struct Session {
  rig::Actor actor = SmallFace::actor();
  std::vector<SurfacePoint> places = SmallFace::places(6);
  std::vector<std::string> labels = SmallFace::labels(36);
  Points on_rig = SmallFace::positions(actor, places, actor.neutral());

  rig::MarkerPlaces anchors(const std::vector<int>& rows) const {
    rig::MarkerPlaces result;
    for (int row : rows) result[labels[row]] = places[row];
    return result;
  }
};

const std::vector<int> kSpread = {0, 5, 14, 21, 30, 35, 17};

Similarity mocap_from_rig() {
  Similarity result;
  result.scale = 0.8;
  result.rotation = Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  result.translation = {120, 900, -40};
  return result;
}

TEST(MarkerMap, SimilarActorsMarkersComeBackToTheirPlaces) {
  const Session session;
  const Points neutral = transformed(mocap_from_rig(), session.on_rig);
  const auto placement = place_markers(session.labels, neutral, session.anchors(kSpread), session.actor);
  EXPECT_EQ(placement.labels, session.labels);
  EXPECT_LE((placement.on_rig - session.on_rig).cwiseAbs().maxCoeff(), 1e-3);  // Embree works in float32
  EXPECT_LE(placement.anchor_rms, 1e-9);
  EXPECT_NEAR(placement.rig_from_mocap.scale, 1.0 / 0.8, 1e-9);
  EXPECT_TRUE(placement.suspects.empty());
  EXPECT_TRUE(placement.left_out.empty());
}

TEST(MarkerMap, AnotherFaceIsWarpedOntoTheRig) {
  // A wider, flatter face: the similarity cannot take that up, the RBF with its affine term does.
  const Session session;
  Points neutral = session.on_rig;
  neutral.col(0) *= 1.15;
  neutral.col(2) *= 0.8;
  const auto placement = place_markers(session.labels, neutral, session.anchors(kSpread), session.actor);
  EXPECT_LE((placement.on_rig - session.on_rig).rowwise().norm().maxCoeff(), 0.1);
  EXPECT_GT(placement.anchor_rms, 1.0);
}

TEST(MarkerMap, WholeFramesGoThroughTheSpaceMap) {
  const Session session;
  Points neutral = session.on_rig;
  neutral.col(0) *= 1.1;
  neutral.col(1) *= 0.95;
  const auto placement = place_markers(session.labels, neutral, session.anchors(kSpread), session.actor);
  const RbfMap map = rig_from_mocap(placement);
  mocap::Take take = SmallFace::take(session.labels, {neutral, neutral.rowwise() + Eigen::RowVector3d(1.1, 0.95, 1)});
  take.drop(1, 4);
  const mocap::Take moved = to_rig(take, placement, map);
  ASSERT_EQ(moved.frames(), 2);
  for (int q = 0; q < 36; ++q) {
    EXPECT_LE((moved.at(0, q) - session.on_rig.row(q).transpose()).norm(), 1e-3);  // float32 samples
    if (q == 4) continue;
    // The faces differ by an axis-wise scale, so a shift of (1.1, 0.95, 1) mm is about (1, 1, 1) on the rig.
    EXPECT_LE((moved.at(1, q) - moved.at(0, q) - Eigen::Vector3d::Ones()).norm(), 0.2);
  }
  EXPECT_FALSE(moved.has(1, 4));
}

TEST(MarkerMap, ZhuScaleIsTheRatioOfTheFaces) {
  const Session session;
  const Points neutral = transformed(mocap_from_rig(), session.on_rig);
  const auto placement = place_markers(session.labels, neutral, session.anchors(kSpread), session.actor);
  const ZhuScale scale = zhu_scale(placement);
  EXPECT_NEAR(scale.factor, 1.0 / 0.8, 1e-5);
  EXPECT_EQ(scale.pairs.size(), 4u);

  const Points pose = SmallFace::positions(session.actor, session.places, session.actor.poses[1].positions);
  const mocap::Take take = SmallFace::take(session.labels, {transformed(mocap_from_rig(), pose)});
  const mocap::Take moved = to_rig_by_scale(take, placement, scale.factor);
  EXPECT_LE((moved.frame(0) - pose).cwiseAbs().maxCoeff(), 2e-3);  // float32 at 1 m: 6e-5 mm, times float32 of Embree
}

TEST(MarkerMap, ZhuScaleByHand) {
  // Ratios 2 (both horizontal pairs) and 1 (both vertical ones): mean 1.5.
  MarkerPlacement placement;
  placement.labels = {"ul", "ur", "ll", "lr"};
  placement.neutral.resize(4, 3);
  placement.neutral << 10, 10, 0, -10, 10, 0, 10, -10, 0, -10, -10, 0;
  placement.on_rig = placement.neutral;
  placement.on_rig.col(0) *= 2.0;
  EXPECT_NEAR(zhu_scale(placement).factor, 1.5, 1e-12);
}

TEST(MarkerMap, SuspectsAndStrangersAreNamed) {
  const Session session;
  Points neutral = session.on_rig;
  neutral.row(8) = session.on_rig.row(26);                // swapped label: sits at another marker's spot
  neutral.row(10) += Eigen::RowVector3d(0, 0, 200);       // a jig marker in front of the face
  neutral.row(11).setConstant(std::nan(""));
  const auto placement = place_markers(session.labels, neutral, session.anchors(kSpread), session.actor);
  ASSERT_EQ(placement.left_out.size(), 2u);
  EXPECT_TRUE(placement.left_out[0].starts_with("M10:")) << placement.left_out[0];
  EXPECT_TRUE(placement.left_out[1].starts_with("M11:")) << placement.left_out[1];
  const auto named = [&](const std::string& label) {
    return std::any_of(placement.suspects.begin(), placement.suspects.end(),
                       [&](const std::string& text) { return text.find(label) != std::string::npos; });
  };
  EXPECT_TRUE(named("M8") || named("M26"));
  EXPECT_EQ(placement.labels.size(), 34u);
}

TEST(MarkerMap, AWrongAnchorIsReported) {
  const Session session;
  auto anchors = session.anchors(kSpread);
  anchors["M14"] = session.places[33];
  const auto placement = place_markers(session.labels, session.on_rig, anchors, session.actor);
  ASSERT_FALSE(placement.suspects.empty());
  EXPECT_TRUE(placement.suspects.front().starts_with("M14:")) << placement.suspects.front();
}

TEST(MarkerMap, TooFewAnchorsAreAnError) {
  const Session session;
  EXPECT_THROW(place_markers(session.labels, session.on_rig, session.anchors({0, 5}), session.actor), InputError);
  EXPECT_NO_THROW(place_markers(session.labels, session.on_rig, session.anchors({0, 5, 14}), session.actor));
}

class AnchorFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const auto file = std::filesystem::temp_directory_path() /
                      (std::string("vultus_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".json");
    std::ofstream(file) << text;
    return file;
  }
  rig::Actor actor_ = SmallFace::actor();
};

TEST_F(AnchorFile, NamesIbugIndicesAndPlaces) {
  actor_.ibug68.emplace().fill(-1);
  (*actor_.ibug68)[36] = 40;
  const auto file = write(R"({"anchors": {"A": "nose", "B": "ibug:36",
                              "C": {"triangle": 7, "barycentric": [0.2, 0.3, 0.5]}}})");
  const auto places = resolve(read_anchors(file, *actor_.topology), actor_);
  const auto vertex_of = [&](const std::string& label) {
    const auto p = position_of(places.at(label), *actor_.topology, actor_.neutral());
    Eigen::Index vertex;
    (actor_.neutral().rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&vertex);
    return static_cast<int>(vertex);
  };
  EXPECT_EQ(vertex_of("A"), actor_.topology->landmarks().at("nose"));
  EXPECT_EQ(vertex_of("B"), 40);
  EXPECT_EQ(places.at("C").triangle, 7);
}

TEST_F(AnchorFile, UnknownLandmarksComeWithTheNearestName) {
  const auto anchors = read_anchors(write(R"({"anchors": {"A": "nsoe"}})"), *actor_.topology);
  try {
    resolve(anchors, actor_);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nose"), std::string::npos) << error.what();
  }
  EXPECT_THROW(resolve(read_anchors(write(R"({"anchors": {"A": "ibug:68"}})"), *actor_.topology), actor_), InputError);
}

TEST_F(AnchorFile, WrongShapesAreRefused) {
  for (const char* text : {"[]", "{}", R"({"anchors": {}})", R"({"anchors": {"A": 5}})", R"({"anchors": ["A"]})",
                           R"({"anchors": {"A": {"triangle": 99999, "barycentric": [1,0,0]}}})"}) {
    EXPECT_THROW(read_anchors(write(text), *actor_.topology), InputError) << text;
  }
}

}  // namespace
}  // namespace vultus::retarget
