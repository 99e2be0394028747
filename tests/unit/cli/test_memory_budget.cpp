#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "apps/memory_budget.h"

namespace vultus::apps {
namespace {

TEST(RunWithin, NeverExceedsTheBudgetAndDoesEverything) {
  const std::vector<std::uint64_t> costs{4, 3, 3, 2, 6, 1, 1, 5};
  std::mutex mutex;
  std::uint64_t used = 0, peak = 0;
  std::vector<int> done(costs.size(), 0);
  run_within(7, costs, 4, [&](std::size_t i) {
    {
      const std::scoped_lock lock(mutex);
      used += costs[i];
      peak = std::max(peak, used);
      ++done[i];
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    const std::scoped_lock lock(mutex);
    used -= costs[i];
  });
  EXPECT_EQ(done, std::vector<int>(costs.size(), 1));
  EXPECT_LE(peak, 7u);
}

TEST(RunWithin, RunsTwoAtOnceWhereTheyFit) {
  // Each waits for the other: one after the other would never end (the test's time limit would).
  std::atomic<int> there = 0;
  run_within(10, {5, 5}, 2, [&](std::size_t) {
    ++there;
    while (there < 2) std::this_thread::yield();
  });
  EXPECT_EQ(there, 2);
}

TEST(RunWithin, WhatIsDearerThanTheBudgetRunsAlone) {
  std::atomic<int> running = 0;
  bool alone = false;
  run_within(4, {1, 100, 1}, 3, [&](std::size_t i) {
    ++running;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (i == 1) alone = running == 1;
    --running;
  });
  EXPECT_TRUE(alone);
}

TEST(RunWithin, TheFirstErrorComesThroughAndEndsIt) {
  std::atomic<int> started = 0;
  const auto run = [&] {
    run_within(1, std::vector<std::uint64_t>(50, 1), 4, [&](std::size_t i) {
      ++started;
      if (i == 3) throw std::runtime_error("third");
    });
  };
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_EQ(started, 4);  // one at a time
}

TEST(MostAtOnce, CountsTheDearestFirst) {
  EXPECT_EQ(most_at_once({1, 5, 1, 5}, 10, 8), 2u);
  EXPECT_EQ(most_at_once({1, 1, 1, 1}, 10, 2), 2u);
  EXPECT_EQ(most_at_once({50}, 10, 8), 1u);
}

TEST(MemoryForScan, FollowsTheTriangles) {
  const auto folder = std::filesystem::temp_directory_path() / ("vultus-memory-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "scan.PLY")
      << "ply\nformat binary_little_endian 1.0\nelement vertex 9\nelement face 10000000\n"
         "property list uchar int vertex_indices\nend_header\n";
  std::ofstream(folder / "scan.obj") << std::string(70'000'000, '#');
  EXPECT_GT(memory_for_scan(folder / "scan.PLY"), 4'000'000'000u);   // what ten million triangles took when measured
  EXPECT_LT(memory_for_scan(folder / "scan.PLY"), 12'000'000'000u);  // what they may take
  EXPECT_GT(memory_for_scan(folder / "scan.obj"), 1'000'000'000u);
  EXPECT_GT(memory_for_scan(folder / "none.ply"), 0u);
  EXPECT_GT(available_memory(), 0u);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace vultus::apps
