#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/virtual_stage/expressions.h"
#include "apps/virtual_stage/stage.h"
#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"
#include "core/manifest.h"
#include "core/mesh_io.h"
#include "core/rays.h"
#include "core/transform.h"
#include "mocap/take.h"
#include "register/template_head.h"

namespace vultus::virtual_stage {
namespace {

namespace fs = std::filesystem;

StageOptions small() {
  StageOptions options;
  options.poses = {"jaw_open"};
  options.scan_triangles = 20'000;
  options.performances = {"asymmetry"};
  options.performance_seconds = 1.0;
  options.hold_seconds = 0.2;
  options.landmarks = true;
  options.clutter = false;
  return options;
}

Similarity pose_of(const nlohmann::json& rows) {
  Similarity pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.rotation(r, c) = rows[r][c];
    pose.translation[r] = rows[r][3];
  }
  return pose;
}

class Stage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("vultus_stage_" + std::to_string(::getpid()));
    simulate(folder_, small(), Progress::none());
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }
  static fs::path folder_;
};
fs::path Stage::folder_;

TEST_F(Stage, CaptureHoldsWhatAStudioBrings) {
  const nlohmann::json capture = read_json(folder_ / "capture" / "capture.json");
  EXPECT_EQ(capture["units"], "mm");
  ASSERT_EQ(capture["poses"].size(), 2u);
  for (const auto& [name, pose] : capture["poses"].items()) {
    EXPECT_TRUE(fs::exists(folder_ / "capture" / pose["scan"].get<std::string>())) << name;
    EXPECT_EQ(pose["tags"], expression(name).tags);
  }
  for (const char* take : {"training", "asymmetry"})
    EXPECT_EQ(mocap::read_take(folder_ / "capture" / "mocap" / (std::string(take) + ".c3d")).markers(), 102);
  const nlohmann::json training = read_json(folder_ / "capture" / "mocap" / "training.json");
  EXPECT_EQ(training["poses"].size(), 2u);
  const nlohmann::json anchors = read_json(folder_ / "capture" / "mocap" / "markers.json")["anchors"];
  const registration::Template head = registration::template_head();
  for (const auto& [label, landmark] : anchors.items())
    EXPECT_TRUE(head.topology->landmarks().contains(landmark.get<std::string>())) << label;
}

TEST_F(Stage, TruthIsTheScansTruth) {
  const nlohmann::json truth = read_json(folder_ / "truth" / "truth.json");
  for (const char* name : {"neutral", "jaw_open"}) {
    const Mesh in_face = read_mesh(folder_ / "truth" / "poses" / (std::string(name) + ".ply")),
               in_scan = read_mesh(folder_ / "truth" / "scans" / (std::string(name) + ".ply")),
               scan = read_mesh(folder_ / "capture" / "scans" / (std::string(name) + ".ply"));
    const Similarity pose = pose_of(truth["scans"][name]["scan_from_face"]);
    EXPECT_LT((transformed(pose, in_face.positions) - in_scan.positions).rowwise().norm().maxCoeff(),
              1e-3);  // float files
    // Every tenth scan vertex lies on the true surface, within noise, hair's noise and what 1.5 mm facets leave out.
    const RayScene surface(*in_scan.topology, in_scan.positions);
    int near = 0, all = 0;
    for (Eigen::Index v = 0; v < scan.positions.rows(); v += 10) {
      const auto closest = surface.closest(scan.positions.row(v));
      near += closest && closest->distance < 0.6;
      ++all;
    }
    EXPECT_GT(near, 0.9 * all) << name;
  }
}

TEST_F(Stage, ClickedLandmarksAreMillimetresOff) {
  const registration::Template head = registration::template_head();
  const Mesh truth = read_mesh(folder_ / "truth" / "scans" / "neutral.ply");
  const nlohmann::json points = read_json(folder_ / "capture" / "landmarks" / "neutral.json")["points"];
  ASSERT_GT(points.size(), 20u);
  double worst = 0;
  for (const auto& [name, p] : points.items()) {
    const Eigen::Vector3d at(p[0], p[1], p[2]), on = truth.positions.row(head.topology->landmarks().at(name));
    worst = std::max(worst, (at - on).norm());
  }
  EXPECT_GT(worst, 0.5);
  EXPECT_LT(worst, 5.0);
}

TEST_F(Stage, MocapTruthHasTheTakesLength) {
  const mocap::Take take = mocap::read_take(folder_ / "capture" / "mocap" / "asymmetry.c3d");
  const Array activations = read_npy(folder_ / "truth" / "mocap" / "asymmetry" / "activations.npy");
  const Array poses = read_npy(folder_ / "truth" / "mocap" / "asymmetry" / "head_poses.npy");
  ASSERT_EQ(take.frames(), 120);
  EXPECT_EQ(take.rate_hz, 120.0);
  EXPECT_EQ(activations.shape, (std::vector<std::size_t>{120, static_cast<std::size_t>(channel_count)}));
  EXPECT_EQ(poses.shape, (std::vector<std::size_t>{120, 3, 4}));
}

TEST_F(Stage, AgainGivesTheSameBytes) {
  const fs::path again = folder_.string() + "_again";
  StageOptions options = small();
  options.mocap = false;
  options.poses = {"neutral"};
  simulate(again, options, Progress::none());
  for (const char* file : {"capture/scans/neutral.ply", "truth/poses/neutral.ply"})
    EXPECT_EQ(sha256_of_file(folder_ / file), sha256_of_file(again / file)) << file;
  fs::remove_all(again);
}

TEST(StageOptionsTest, RefusesNonsense) {
  StageOptions options;
  options.poses = {"jaw_opne"};
  EXPECT_THROW(options.validate(), InputError);
  options = {};
  options.performances = {"singing"};
  EXPECT_THROW(options.validate(), InputError);
  options = {};
  options.performance_seconds = 0;
  EXPECT_THROW(options.validate(), UsageError);
  options = {};
  options.scan_triangles = 1;
  EXPECT_THROW(options.validate(), UsageError);
}

}  // namespace
}  // namespace vultus::virtual_stage
