#include <gtest/gtest.h>

#include "apps/virtual_stage/volume_faults.h"

namespace vultus::virtual_stage {
namespace {

/// Twelve markers at rest on a line, the last three on the jig.
RecordedTake line(int frames) {
  RecordedTake recorded;
  std::vector<std::string> labels;
  for (int m = 0; m < 12; ++m) labels.push_back("m" + std::to_string(m));
  recorded.take = mocap::Take::empty("line", 120.0, labels, frames);
  for (int f = 0; f < frames; ++f)
    for (int m = 0; m < 12; ++m) recorded.take.set(f, m, {10.0 * m, 0.001 * f, 0});
  recorded.clean = recorded.take;
  recorded.volume_from_face.resize(static_cast<std::size_t>(frames));
  return recorded;
}

TEST(VolumeFaults, TheTruthSaysWhoIsWho) {
  const RecordedTake recorded = line(3000);
  FaultOptions options;
  options.slip_mm = 2.0;
  const FaultyTake faulty = with_faults(recorded, 3, options);
  EXPECT_EQ(faulty.faults.size(), 13U);  // 22, 12 and 8 places in 10,000 frames: 7 + 4 + 2
  EXPECT_GE(faulty.slipped_marker, 9);
  for (int f = 0; f < 3000; ++f) {
    for (int c = 0; c < faulty.take.markers(); ++c) {
      const int owner = faulty.owners[faulty.take.index(f, c)];
      EXPECT_EQ(faulty.take.has(f, c), owner != FaultyTake::nobody);
      if (owner < 0 || owner == faulty.slipped_marker) continue;
      EXPECT_EQ(faulty.take.at(f, c), recorded.take.at(f, owner));
    }
  }
  EXPECT_EQ(score_labels(faulty, faulty.take).swaps_left, 7);
  EXPECT_EQ(score_labels(faulty, faulty.take).right_in_swaps, 0U);
}

TEST(VolumeFaults, APerfectRepairScoresFull) {
  const FaultyTake faulty = with_faults(line(3000), 3, {});
  mocap::Take repaired = mocap::Take::empty("line", 120.0, line(1).take.labels, 3000);
  for (int f = 0; f < 3000; ++f)
    for (int c = 0; c < faulty.take.markers(); ++c)
      if (const int owner = faulty.owners[faulty.take.index(f, c)]; owner >= 0)
        repaired.set(f, owner, faulty.take.at(f, c));
  const LabelScore score = score_labels(faulty, repaired);
  EXPECT_EQ(score.right, score.samples);
  EXPECT_EQ(score.swaps_left, 0);
  EXPECT_GT(score.samples_in_swaps, 0U);
}

}  // namespace
}  // namespace vultus::virtual_stage
