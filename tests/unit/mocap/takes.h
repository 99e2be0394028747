#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/random.h"
#include "mocap/take.h"

namespace vultus::mocap {

/// A folder of its own for each test, removed afterwards.
class InFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    // Thousands of small files are written: in memory where the system offers it.
    std::error_code problem;
    const bool in_memory = std::filesystem::is_directory("/dev/shm", problem) && ::access("/dev/shm", W_OK) == 0;
    folder = (in_memory ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path()) /
             ("vultus_" + std::to_string(::getpid()) + "_" + info->test_suite_name() + "_" + info->name());
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder / name, std::ios::binary) << content;
    return folder / name;
  }
  std::filesystem::path folder;
};

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Folder of the real data, or empty where there is none.
inline std::filesystem::path real_data() {
  const char* folder = std::getenv("VULTUS_DATA");
  return folder == nullptr ? std::filesystem::path() : std::filesystem::path(folder);
}

/// Markers on an 80 mm cap (an egg's front), spread evenly by the golden angle.
inline Points face_markers(int n) {
  Points points(n, 3);
  for (int i = 0; i < n; ++i) {
    const double t = 0.15 + 0.75 * (i + 0.5) / n, angle = 2.399963 * i, r = 80.0 * std::sqrt(1.0 - (1 - t) * (1 - t));
    points.row(i) << r * std::cos(angle), 1.2 * r * std::sin(angle), 90.0 * (1 - t);
  }
  return points;
}

inline std::vector<std::string> numbered(const std::string& stem, int n) {
  std::vector<std::string> labels;
  for (int i = 0; i < n; ++i) labels.push_back(stem + std::to_string(i + 1));
  return labels;
}

/// Noise of standard deviation `size` on each coordinate, mm.
inline Eigen::Vector3d jitter(Random& random, double size) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return size * Eigen::Vector3d(x, y, z);
}

/// A random take with a tenth of the samples missing.
inline Take random_take(int frames, int markers, std::uint64_t seed) {
  Take take = Take::empty("random", 120.0, numbered("m", markers), frames);
  Random random(seed);
  for (int f = 0; f < frames; ++f) {
    for (int m = 0; m < markers; ++m) {
      if (random.uniform() < 0.1) continue;
      take.set(f, m, {random.uniform(-900, 900), random.uniform(-900, 900), random.uniform(-900, 900)});
    }
  }
  return take;
}

}  // namespace vultus::mocap
