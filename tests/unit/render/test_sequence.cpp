#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.h"
#include "core/files.h"
#include "render/sequence.h"

namespace vultus::render {
namespace {

/// A tetrahedron whose second pose is lifted by 20 mm.
rig::Actor tetrahedron() {
  TopologyData data;
  data.vertex_count = 4;
  data.face_offsets = {0, 3, 6, 9, 12};
  data.corner_vertex = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
  rig::Actor actor;
  actor.name = "tetrahedron";
  actor.topology = Topology::make(std::move(data));
  Points neutral(4, 3);
  neutral << -30, -30, 0, 30, -30, 0, 0, 30, 0, 0, 0, -40;
  Points lifted = neutral;
  lifted.col(1).array() += 20;
  actor.poses = {{"neutral", {}, neutral}, {"lifted", {}, lifted}};
  return actor;
}

class Sequence : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("vultus_sequence_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    weights_ = retarget::Weights::zeros(30, {"whole"}, {"neutral", "lifted"}, 4);
    for (int f = 0; f < 4; ++f) {
      weights_.at(f, 0)[0] = f < 2 ? 1.0f : 0.0f;
      weights_.at(f, 0)[1] = f < 2 ? 0.0f : 1.0f;
    }
    options_.portrait.width = options_.portrait.height = 24;
    options_.portrait.margin = 2.0;
    options_.tracer.samples = 4;
    source_ = {"render", {{"take", "test"}}, {{"actor", "a"}, {"weights", "w"}}};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  SequenceResult render() { return render_sequence(actor_, weights_, folder_, source_, options_); }

  rig::Actor actor_ = tetrahedron();
  retarget::Weights weights_;
  SequenceOptions options_;
  Provenance source_;
  std::filesystem::path folder_;
};

/// Row of the mean of what is covered.
double height_of(const Image& layers) {
  double total = 0, weight = 0;
  for (int y = 0; y < layers.height(); ++y)
    for (int x = 0; x < layers.width(); ++x) {
      total += layers.at(x, y)[3] * y;
      weight += layers.at(x, y)[3];
    }
  return total / weight;
}

TEST_F(Sequence, FramesShowTheTake) {
  const SequenceResult result = render();
  ASSERT_EQ(result.frames.size(), 4u);
  EXPECT_EQ(result.rendered, 4);
  EXPECT_EQ(result.frames[2].filename(), "000002.exr");
  for (const auto& frame : result.frames) {
    std::filesystem::path png = frame;
    EXPECT_TRUE(std::filesystem::exists(png.replace_extension(".png")));
  }
  // The face is 60 mm of a 120 mm picture of 24 rows: 20 mm up are 4 rows, the camera standing still.
  const double before = height_of(read_image(result.frames[1])), after = height_of(read_image(result.frames[2]));
  EXPECT_NEAR(before - after, 4.0, 0.4);
  EXPECT_EQ(read_image(result.frames[0]).pixels(), read_image(result.frames[1]).pixels());
}

TEST_F(Sequence, SecondRunDoesOnlyWhatChanged) {
  render();
  EXPECT_EQ(render().rendered, 0);
  options_.first = 1;
  options_.last = 3;
  EXPECT_EQ(render().frames.size(), 2u);
  write_file(folder_ / "000001.png", "damaged");
  EXPECT_EQ(render().rendered, 1);
  options_.tracer.seed = 2;
  EXPECT_EQ(render().rendered, 2);
  source_.inputs["weights"] = "changed";
  EXPECT_EQ(render().rendered, 2);
  options_.force = true;
  EXPECT_EQ(render().rendered, 2);
}

TEST_F(Sequence, PartsMakeTheSameFramesAsTheWhole) {
  const Image whole = read_image(render().frames[2]);
  std::filesystem::remove_all(folder_);
  options_.first = 2;
  options_.last = 3;
  EXPECT_EQ(read_image(render().frames.at(0)).pixels(), whole.pixels());
}

TEST_F(Sequence, RefusesRangesOutsideTheTake) {
  for (const auto& [first, last] : {std::pair{-1, 2}, {0, 5}, {2, 2}, {3, 1}, {9, -1}}) {
    options_.first = first;
    options_.last = last;
    EXPECT_THROW(render(), UsageError) << first << ":" << last;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(Sequence, EnvironmentFromAFileChangesThePicture) {
  const Image studio = read_image(render().frames[0]);
  Image sky = Image::rgb(16, 8);
  for (float& value : sky.pixels()) value = 0.5f;
  std::filesystem::create_directories(folder_);
  write_image(folder_ / "sky.exr", sky);
  options_.environment = folder_ / "sky.exr";
  options_.show_environment = true;
  const SequenceResult result = render();
  EXPECT_EQ(result.rendered, 4);
  EXPECT_NEAR(read_image(result.frames[0]).rgb_at(0, 0)[1], 0.5f, 1e-3f);
  EXPECT_NE(read_image(result.frames[0]).pixels(), studio.pixels());
}

class Cancelling final : public Progress {
 public:
  void begin(std::string_view, std::size_t) override {}
  void advance(std::size_t) override { ++done_; }
  void note(std::string_view) override {}
  bool cancelled() const override { return done_ >= 2; }

 private:
  int done_ = 0;
};

TEST_F(Sequence, CancellingKeepsFinishedFrames) {
  Cancelling progress;
  EXPECT_THROW(render_sequence(actor_, weights_, folder_, source_, options_, progress), Cancelled);
  EXPECT_EQ(render().rendered, 2);
}

}  // namespace
}  // namespace vultus::render
