#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/virtual_stage/actor.h"
#include "apps/virtual_stage/fault_truth.h"
#include "apps/virtual_stage/label_score.h"
#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"
#include "mocap/labels.h"
#include "register/template_head.h"

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

TEST(VolumeFaults, SpikesDropoutsAndHeldFramesAreWhereTheTruthSays) {
  const RecordedTake recorded = line(3000);
  FaultOptions options;
  options.swaps = options.phantoms = options.fragments = 0;
  options.spikes = options.dropouts = options.held = 40;
  const FaultyTake faulty = with_faults(recorded, 3, options);
  ASSERT_EQ(faulty.faults.size(), 36U);
  std::vector<std::uint8_t> touched(recorded.take.present.size(), 0);
  for (const Fault& fault : faulty.faults) {
    for (int f = fault.first; f <= fault.last; ++f) {
      for (const int m : fault.markers) {
        touched[recorded.take.index(f, m)] = 1;
        const Eigen::Vector3d at = faulty.take.at(f, m), was = recorded.take.at(f, m);
        if (fault.kind == Fault::Kind::spike) {
          EXPECT_NEAR((at - was).norm(), fault.size, 1e-4);  // float positions
        } else if (fault.kind == Fault::Kind::dropout) {
          EXPECT_EQ(at, Eigen::Vector3d::Zero());
        } else {
          EXPECT_EQ(at, recorded.take.at(fault.first - 1, m));
        }
      }
    }
  }
  for (std::size_t i = 0; i < touched.size(); ++i) {
    const int f = static_cast<int>(i / 12), m = static_cast<int>(i % 12);
    if (!touched[i]) {
      ASSERT_EQ(faulty.take.at(f, m), recorded.take.at(f, m));
    }
  }
}

TEST(VolumeFaults, NonsenseIsRefused) {
  EXPECT_NO_THROW(usual_faults(1, 20.0).validate());
  EXPECT_THROW((FaultOptions{.spikes = -1}.validate()), UsageError);
  EXPECT_THROW((FaultOptions{.swaps = 1001}.validate()), UsageError);
  EXPECT_THROW((FaultOptions{.slip_mm = 51}.validate()), UsageError);
  EXPECT_THROW((FaultOptions{.slip_at = 1.1}.validate()), UsageError);
  EXPECT_THROW(with_faults(line(10), 3, {.held = -1}), UsageError);
}

/// A synthetic face in the volume, with the faults that a tracker leaves `times` as often as usual.
class Volume {
 public:
  Volume(double seconds, double missing) {
    const registration::Template head = registration::template_head();
    const FaceModel actor(head, identity(head, 11));
    const MarkerLayout layout = marker_layout(actor, 3);
    jig_ = static_cast<int>(layout.jig.rows());
    recorded_ = record(actor, layout, perform("emotions", seconds, 120.0, 5), {.missing = missing});
  }
  const RecordedTake& recorded() const { return recorded_; }
  FaultyTake faulty(std::uint64_t seed, double times) const {
    return with_faults(recorded_, jig_, usual_faults(seed, times));
  }

 private:
  RecordedTake recorded_;
  int jig_ = 0;
};

// In four seconds a swap that lasts a third of the take is as usual as what is right.
TEST(ShortTakes, AreWarnedOfWhereASwapIsLeft) {
  const Volume volume(4.0, 0.08);
  int left = 0;
  for (const std::uint64_t seed : {8, 9, 11}) {
    const FaultyTake faulty = volume.faulty(seed, 1.0);
    const mocap::Relabelled repaired = mocap::repair_labels(faulty.take);
    const bool fails = score_labels(faulty, repaired.take).swaps_left > 0;
    EXPECT_EQ(fails, !repaired.warnings.empty()) << seed;
    left += fails;
  }
  EXPECT_GT(left, 0);
}

/// Eight seconds of a face, with three times the faults that a tracker leaves, as files.
class FaultFiles : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("vultus_faults_" + std::to_string(::getpid()));
    const Volume volume(8.0, 0.02);
    const FaultyTake faulty = volume.faulty(7, 3.0);
    mocap::write_take(folder_ / "emotions.c3d", faulty.take);
    write_fault_truth(folder_, volume.recorded(), faulty);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  /// As a reader of the files alone has it.
  static FaultyTake read() {
    FaultyTake faulty;
    faulty.take = mocap::read_take(folder_ / "emotions.c3d");
    const Array owners = read_npy(folder_ / "owners.npy");
    for (const float owner : owners.values) faulty.owners.push_back(static_cast<int>(owner));
    const nlohmann::json truth = read_json(folder_ / "faults.json");
    for (const auto& entry : truth["faults"]) {
      if (entry["kind"] != "swap") continue;
      Fault swap{Fault::Kind::swap, entry["first"], entry["last"], {}};
      for (const std::string label : entry["markers"]) swap.markers.push_back(faulty.take.find(label));
      faulty.faults.push_back(swap);
    }
    return faulty;
  }
  static std::filesystem::path folder_;
};
std::filesystem::path FaultFiles::folder_;

TEST_F(FaultFiles, SayWhatWasDone) {
  const nlohmann::json truth = read_json(folder_ / "faults.json");
  for (const char* kind : {"swap", "stray phantom", "fragment", "spike", "dropout", "held"}) {
    const auto of_kind = [&](const auto& entry) { return entry["kind"] == kind; };
    EXPECT_GT(std::ranges::count_if(truth["faults"], of_kind), 0) << kind;
  }
  EXPECT_EQ(truth["slip"]["marker"].get<std::string>().rfind("JIG", 0), 0U);
  EXPECT_EQ(mocap::read_take(folder_ / "recorded.c3d").markers(), 102);
}

TEST_F(FaultFiles, LabelsAreRepairedFromTheFilesAlone) {
  const FaultyTake faulty = read();
  ASSERT_EQ(faulty.owners.size(), faulty.take.present.size());
  const LabelScore before = score_labels(faulty, faulty.take);
  const mocap::Relabelled repaired = mocap::repair_labels(faulty.take);
  EXPECT_TRUE(repaired.warnings.empty());
  const LabelScore after = score_labels(faulty, repaired.take);
  EXPECT_LT(static_cast<double>(before.right), 0.992 * static_cast<double>(before.samples));
  // Above what is asked of a repair at a third of these faults.
  EXPECT_GT(static_cast<double>(after.right), 0.999 * static_cast<double>(after.samples));
  EXPECT_GT(static_cast<double>(after.right_in_swaps), 0.98 * static_cast<double>(after.samples_in_swaps));
}

}  // namespace
}  // namespace vultus::virtual_stage
