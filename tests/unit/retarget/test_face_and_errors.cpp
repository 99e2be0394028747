#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "core/error.h"
#include "retarget/errors.h"
#include "retarget/face.h"
#include "small_face.h"

namespace vultus::retarget {
namespace {

using testing::SmallFace;

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::temp_directory_path() /
         (std::string("vultus_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + name);
}

Weights one_pose(const rig::Actor& actor, std::size_t pose) {
  std::vector<std::string> regions;
  for (const rig::Region& region : actor.regions) regions.push_back(region.name);
  Weights weights = Weights::zeros(60.0, regions, actor.pose_names(), 1);
  for (std::size_t k = 0; k < regions.size(); ++k) weights.at(0, static_cast<int>(k))[pose] = 1.0f;
  return weights;
}

TEST(Face, AFullPoseInEveryRegionIsThatPose) {
  const rig::Actor actor = SmallFace::actor(2, 2, 15.0);
  for (std::size_t pose = 0; pose < actor.poses.size(); ++pose) {
    const Weights weights = one_pose(actor, pose);
    const Points positions = Face(actor, weights.poses, weights.regions).at(weights, 0);
    EXPECT_LE((positions - actor.poses[pose].positions).cwiseAbs().maxCoeff(), 1e-5);  // float32 masks
  }
}

TEST(Face, NeutralWeightsAreTheNeutralExactly) {
  const rig::Actor actor = SmallFace::actor(2, 2, 15.0);
  const Weights weights = one_pose(actor, 0);
  EXPECT_EQ(Face(actor, weights.poses, weights.regions).at(weights, 0), actor.neutral());
}

TEST(Face, RegionsMoveOnTheirOwn) {
  const rig::Actor actor = SmallFace::actor(2, 1, 0.0);
  Weights weights = one_pose(actor, 0);
  weights.at(0, 1)[0] = 0.25f;
  weights.at(0, 1)[1] = 0.75f;
  const Points positions = Face(actor, weights.poses, weights.regions).at(weights, 0);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const double share = actor.neutral()(v, 0) >= 0.0 ? 0.75 : 0.0;
    const Eigen::RowVector3d expected =
        (1.0 - share) * actor.neutral().row(v) + share * actor.poses[1].positions.row(v);
    ASSERT_LE((positions.row(v) - expected).norm(), 1e-6);
  }
}

TEST(Face, PosesAreFoundByName) {
  const rig::Actor actor = SmallFace::actor(2, 1, 15.0);
  Weights weights = Weights::zeros(60.0, {"whole"}, {"neutral", "jaw_open"}, 1);
  weights.at(0, 0)[1] = 1.0f;
  const Points positions = Face(actor, weights.poses, weights.regions).at(weights, 0);
  EXPECT_LE((positions - actor.poses[5].positions).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_THROW(Face(actor, {"neutral", "jaw_opne"}, {"whole"}), InputError);
  EXPECT_THROW(Face(actor, {"neutral"}, {"R0"}), InputError);
}

TEST(MarkerErrors, ByHand) {
  // Two markers, two regions; marker 0 belongs to region 0, marker 1 half to each.
  MarkerBasis basis;
  basis.labels = {"a", "b"};
  basis.poses = {"neutral", "up"};
  basis.usable = {true, true};
  basis.columns = Eigen::MatrixXd::Zero(6, 2);
  basis.columns(1, 1) = 10.0;
  basis.columns(4, 1) = 10.0;
  MarkerWeights counts{{"a", "b"}, {"r0", "r1"}, Eigen::MatrixXd(2, 2), {}};
  counts.values << 1.0, 0.0, 0.5, 0.5;
  Weights weights = Weights::zeros(60.0, {"r0", "r1"}, basis.poses, 2);
  weights.values = {1, 0, 0, 1, 0.5, 0.5, 0.5, 0.5};
  mocap::Take take = mocap::Take::empty("t", 60.0, {"b", "a"}, 2);
  take.set(0, 1, {0, 3, 4});
  take.set(0, 0, {0, 5, 0});
  take.set(1, 0, {0, 5, 12});
  const MarkerErrors errors = marker_errors(take, basis, counts, weights);
  EXPECT_FLOAT_EQ(errors.at(0, 0), 5.0f);   // a stays at 0
  EXPECT_FLOAT_EQ(errors.at(0, 1), 0.0f);   // b at ½·0 + ½·10
  EXPECT_TRUE(std::isnan(errors.at(1, 0)));
  EXPECT_FLOAT_EQ(errors.at(1, 1), 12.0f);
  const ErrorSummary summary = summarize(errors, "two", 2);
  EXPECT_DOUBLE_EQ(summary.max, 6.0);
  EXPECT_DOUBLE_EQ(summary.min, 5.0);
  EXPECT_DOUBLE_EQ(summary.mean, 5.5);
  EXPECT_EQ(mean_by_frame(errors), (std::vector<double>{2.5, 12.0}));
}

TEST(MarkerErrors, FileComesBack) {
  MarkerErrors errors{120.0, {"a", "b"}, {0.5f, 1.25f, std::nanf(""), 3.0f, 0.0f, 2.0f}};
  const auto file = temporary("errors.csv");
  write_errors(file, errors);
  const MarkerErrors back = read_errors(file);
  EXPECT_EQ(back.labels, errors.labels);
  ASSERT_EQ(back.frames(), 3);
  EXPECT_NEAR(back.rate_hz, 120.0, 0.01);
  for (int f = 0; f < 3; ++f) {
    for (int q = 0; q < 2; ++q) {
      if (std::isnan(errors.at(f, q))) {
        EXPECT_TRUE(std::isnan(back.at(f, q)));
      } else {
        EXPECT_NEAR(back.at(f, q), errors.at(f, q), 1e-4);
      }
    }
  }
}

TEST(MarkerErrors, BadFilesAreRefusedWithTheLine) {
  const auto file = temporary("bad.csv");
  for (const char* text : {"", "time,frame,a\n", "frame,time_s,a\n0,0\n", "frame,time_s,a\n0,0,x\n"}) {
    std::ofstream(file) << text;
    EXPECT_THROW(read_errors(file), InputError) << text;
  }
  std::ofstream(file) << "frame,time_s,a\n0,0,1\n1,0.1,oops\n";
  try {
    read_errors(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("line 3"), std::string::npos) << error.what();
  }
}

TEST(Weights, FilesComeBack) {
  const rig::Actor actor = SmallFace::actor(2, 2, 15.0);
  const Weights weights = SmallFace::asymmetric(actor, 7, 1);
  const auto file = temporary("weights.npy");
  write_weights(file, weights);
  const Weights back = read_weights(file);
  EXPECT_EQ(back.values, weights.values);
  EXPECT_EQ(back.regions, weights.regions);
  EXPECT_EQ(back.poses, weights.poses);
  EXPECT_EQ(back.rate_hz, weights.rate_hz);
}

TEST(Weights, FilesThatDisagreeAreRefused) {
  const auto file = temporary("weights.npy");
  Weights weights = Weights::zeros(60.0, {"r"}, {"neutral", "a"}, 2);
  for (int f = 0; f < 2; ++f) weights.at(f, 0)[0] = 1.0f;
  write_weights(file, weights);
  auto json = file;
  json.replace_extension(".json");
  for (const char* text : {"[]", R"({"rate_hz": 60, "regions": ["r"], "poses": ["neutral"]})",
                           R"({"rate_hz": 0, "regions": ["r"], "poses": ["neutral", "a"]})",
                           R"({"rate_hz": 60, "regions": "r", "poses": ["neutral", "a"]})"}) {
    std::ofstream(json) << text;
    EXPECT_THROW(read_weights(file), InputError) << text;
  }
  weights.at(1, 0)[1] = 0.5f;
  write_weights(file, weights);
  EXPECT_THROW(read_weights(file), InputError);
}

}  // namespace
}  // namespace vultus::retarget
