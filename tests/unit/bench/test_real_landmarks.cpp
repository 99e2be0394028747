#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/bench_registration/real_landmarks.h"
#include "core/error.h"
#include "core/files.h"

namespace vultus::apps::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct RealLandmarks : testing::Test {
  fs::path file;
  void SetUp() override { file = fs::temp_directory_path() / ("vultus-landmarks-" + std::to_string(::getpid())); }
  void TearDown() override { fs::remove(file); }
};

// Groups in a file of menpo's stand in another order than the scheme's; point k has x = k.
json menpo() {
  json labels = json::array(), points = json::array();
  int next = 0;
  for (const auto& [name, count] : std::vector<std::pair<std::string, int>>{
           {"chin", 17}, {"leye", 6}, {"reye", 6}, {"leyebrow", 5}, {"nose", 9}, {"reyebrow", 5}, {"mouth", 20}}) {
    json mask = json::array();
    for (int i = 0; i < count; ++i) mask.push_back(next++);
    labels.push_back({{"label", name}, {"mask", mask}});
  }
  for (int k = 0; k < 68; ++k) points.push_back({1.0 * k, 0.0, 0.0});
  return {{"groups", {{"LJSON", {{"labels", labels}, {"landmarks", {{"points", points}}}}}}}, {"version", 2}};
}

TEST_F(RealLandmarks, MenposGroupsAreBroughtIntoTheSchemesOrder) {
  json content = menpo();
  content["groups"]["LJSON"]["landmarks"]["points"][34] = {nullptr, nullptr, nullptr};  // the nose's first
  write_json(file, content);
  const PlacedLandmarks placed = read_ljson(file);
  EXPECT_FALSE(placed.contains(0));   // the jaw's outline
  EXPECT_FALSE(placed.contains(27));  // null
  EXPECT_EQ(placed.at(17).x(), 29);   // first of leyebrow
  EXPECT_EQ(placed.at(22).x(), 43);   // first of reyebrow
  EXPECT_EQ(placed.at(28).x(), 35);   // second of nose
  EXPECT_EQ(placed.at(36).x(), 17);   // first of leye
  EXPECT_EQ(placed.at(67).x(), 67);
  EXPECT_EQ(placed.size(), 50U);
}

TEST_F(RealLandmarks, AnotherFormIsRefused) {
  json content = menpo();
  content["groups"]["LJSON"]["labels"].erase(2);
  write_json(file, content);
  EXPECT_THROW(read_ljson(file), InputError);
  write_json(file, json::array());
  EXPECT_THROW(read_ljson(file), InputError);
  write_file(file, "1,2,3\n4,5\n");
  EXPECT_THROW(read_five_points(file), InputError);
}

TEST_F(RealLandmarks, FivePointsHaveTheirNamesInTheScheme) {
  write_file(file, "-5,60,77\n35,57,72\n15,29,119\n-10,-13,92\n45,-16,89\n");
  const PlacedLandmarks placed = read_five_points(file);
  EXPECT_EQ(placed.size(), 5U);
  EXPECT_EQ(placed.at(39), Eigen::Vector3d(-5, 60, 77));
  EXPECT_EQ(placed.at(30), Eigen::Vector3d(15, 29, 119));
  EXPECT_EQ(placed.at(54), Eigen::Vector3d(45, -16, 89));
}

}  // namespace
}  // namespace vultus::apps::bench
