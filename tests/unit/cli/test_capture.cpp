#include <Eigen/LU>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "apps/capture.h"
#include "apps/frame_range.h"
#include "core/error.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;

struct CaptureTest : testing::Test {
  fs::path folder;
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "vultus-capture-XXXXXX").string();
    folder = ::mkdtemp(pattern.data());
    fs::create_directories(folder / "scans");
  }
  void TearDown() override { fs::remove_all(folder); }
  void put(const std::string& name, const std::string& content = "") const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << content;
  }
  std::string problem() const {
    try {
      read_capture(folder);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
};

TEST_F(CaptureTest, ScansAloneAreEnoughAndTheNeutralComesFirst) {
  for (const char* name : {"scans/angry.PLY", "scans/neutral.obj", "scans/smile.stl", "scans/notes.txt"}) put(name);
  put("landmarks/smile.json");
  const Capture capture = read_capture(folder);
  ASSERT_EQ(capture.poses.size(), 3u);
  EXPECT_EQ(capture.poses[0].name, "neutral");
  EXPECT_EQ(capture.poses[1].name, "angry");
  EXPECT_EQ(capture.poses[2].landmarks, folder / "landmarks/smile.json");
  EXPECT_TRUE(capture.upright.isIdentity());
  EXPECT_EQ(capture.mm_per_unit, 0.0);
}

TEST_F(CaptureTest, TheDescriptionAddsUnitsAxesTagsAndScansElsewhere) {
  put("scans/neutral.ply");
  put("raw/a.obj");
  put("capture.json", R"({"units": "cm", "up": "z", "poses": {"smile": {"scan": "raw/a.obj", "tags": ["AU12"]}}})");
  const Capture capture = read_capture(folder);
  ASSERT_EQ(capture.poses.size(), 2u);
  EXPECT_EQ(capture.poses[1].scan, folder / "raw/a.obj");
  EXPECT_EQ(capture.poses[1].tags, std::vector<std::string>{"AU12"});
  EXPECT_EQ(capture.mm_per_unit, 10.0);
  EXPECT_EQ(Eigen::Vector3d(capture.upright * Eigen::Vector3d::UnitZ()), Eigen::Vector3d(0, 1, 0));
}

TEST_F(CaptureTest, EveryUpAxisGivesARotation) {
  put("scans/neutral.ply");
  for (const char* axis : {"x", "y", "z", "-x", "-y", "-z"}) {
    put("capture.json", std::string("{\"up\": \"") + axis + "\"}");
    const Eigen::Matrix3d upright = read_capture(folder).upright;
    EXPECT_EQ(Eigen::Matrix3d(upright * upright.transpose()), Eigen::Matrix3d(Eigen::Matrix3d::Identity())) << axis;
    EXPECT_EQ(upright.determinant(), 1.0) << axis;
  }
}

TEST_F(CaptureTest, RefusesWhatItCannotUse) {
  EXPECT_NE(problem().find("holds no scans"), std::string::npos);
  put("scans/neutrall.obj");
  EXPECT_NE(problem().find("\"neutrall\""), std::string::npos);
  put("scans/neutral.obj");
  EXPECT_EQ(problem(), "");
  put("scans/neutral.ply");
  EXPECT_NE(problem().find("neutral.obj and neutral.ply"), std::string::npos);
  fs::remove(folder / "scans/neutral.ply");
  for (const char* hostile :
       {"", "[]x", "{\"units\": \"furlongs\"}", "{\"units\": 3}", "{\"up\": \"w\"}", "{\"pose\": {}}",
        "{\"poses\": {\"smile\": {}}}", "{\"poses\": {\"smile\": {\"scan\": \"none.ply\"}}}",
        "{\"poses\": {\"neutral\": {\"tags\": 3}}}"}) {
    put("capture.json", hostile);
    EXPECT_NE(problem(), "") << hostile;
  }
}

TEST(FrameRange, ReadsBothEndsAndLeavesEitherOut) {
  EXPECT_EQ(frame_range("", 10), std::pair(0, 10));
  EXPECT_EQ(frame_range("2:5", 10), std::pair(2, 5));
  EXPECT_EQ(frame_range(":5", 10), std::pair(0, 5));
  EXPECT_EQ(frame_range("5:", 10), std::pair(5, 10));
  EXPECT_EQ(frame_range("9", 10), std::pair(9, 10));
  for (const char* wrong : {"5:2", "0:11", "10", "a:b", "-1:3", "3:3", "1:2:3", "1.5:2", ":x"}) {
    EXPECT_THROW(frame_range(wrong, 10), UsageError) << wrong;
  }
}

TEST(PictureSize, ReadsWidthAndHeight) {
  EXPECT_EQ(picture_size("640x480"), std::pair(640, 480));
  for (const char* wrong : {"640", "640x", "x480", "0x1", "640X480", "-1x5", "1x99999999999"}) {
    EXPECT_THROW(picture_size(wrong), UsageError) << wrong;
  }
}

}  // namespace
}  // namespace vultus::apps
