#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "core/error.h"
#include "core/files.h"
#include "core/texture_space.h"
#include "register/template_file.h"
#include "rig/databank.h"
#include "rig/databank_parts.h"
#include "rig/database.h"

namespace vultus::rig {
namespace {

namespace fs = std::filesystem;

TEST(DatabankTags, NameArkitShapesAndFacsUnits) {
  EXPECT_EQ(ict_pose_tags("browDown_L"), (std::vector<std::string>{"browDownLeft", "AU4L"}));
  EXPECT_EQ(ict_pose_tags("browInnerUp_R"), (std::vector<std::string>{"browInnerUp", "AU1R"}));
  EXPECT_EQ(ict_pose_tags("jawOpen"), (std::vector<std::string>{"jawOpen", "AU27"}));
  EXPECT_EQ(ict_pose_tags("unheardOf"), std::vector<std::string>{"unheardOf"});
}

class IctFaceKit : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("VULTUS_DATA");
    if (data == nullptr || !fs::exists(fs::path(data) / "ict-facekit"))
      GTEST_SKIP() << "VULTUS_DATA has no ict-facekit";
    source_ = fs::path(data) / "ict-facekit";
    copy_ = fs::path(testing::TempDir()) / ("vultus_databank_" + std::to_string(::getpid()));
    fs::remove_all(copy_);
    fs::create_directories(copy_ / "model");
  }
  void TearDown() override {
    if (!copy_.empty()) fs::remove_all(copy_);
  }
  /// A folder with only the named files of the model, so that the test reads a few and not sixty.
  fs::path with(const std::vector<std::string>& names) const {
    fs::copy_file(source_ / "vertex_indices.json", copy_ / "model/vertex_indices.json");
    for (const std::string& name : names)
      fs::create_symlink(source_ / (name + ".obj"), copy_ / "model" / (name + ".obj"));
    return copy_ / "model";
  }
  fs::path source_, copy_;
};

TEST_F(IctFaceKit, BecomesAnActorAndATemplateInMillimetres) {
  const fs::path model = with({"generic_neutral_mesh", "jawOpen", "mouthClose", "eyeBlink_L", "identity003"});
  const std::vector<std::string> decisions = import_ict_facekit(model, copy_ / "bank");
  ASSERT_FALSE(decisions.empty());
  EXPECT_TRUE(decisions[0].starts_with("units: cm")) << decisions[0];
  EXPECT_TRUE(std::any_of(decisions.begin(), decisions.end(), [](const std::string& line) {
    return line.starts_with("listed but absent") && line.find("browDown_L") != std::string::npos;
  }));

  const Actor actor = load_actor(copy_ / "bank");
  EXPECT_EQ(actor.pose_names(), (std::vector<std::string>{"neutral", "eyeBlink_L", "jawOpen", "mouthClose"}));
  EXPECT_EQ(actor.topology->face_count(), 26384);
  const registration::Ibug68 points = actor.ibug68.value();
  // The frame of DESIGN §1: the origin midway between the outer eye corners, the subject's left at +x.
  EXPECT_LT((actor.neutral().row(points[36]) + actor.neutral().row(points[45])).norm(), 1e-3);
  EXPECT_NEAR((actor.neutral().row(points[45]) - actor.neutral().row(points[36])).norm(), 89.2, 0.1);
  const auto gap = [&](const std::string& pose) {
    const Points& shape = actor.poses[actor.pose_index(pose)].positions;
    return (shape.row(points[62]) - shape.row(points[66])).norm();
  };
  EXPECT_GT(gap("jawOpen"), 20.0);
  // The lips meet, but slide over each other by some millimetres where these two landmarks lie.
  EXPECT_LT(gap("mouthClose"), 0.25 * gap("jawOpen")) << "an open jaw with closed lips";
  const double chin_drop =
      actor.neutral()(points[8], 1) - actor.poses[actor.pose_index("mouthClose")].positions(points[8], 1);
  EXPECT_GT(chin_drop, 20.0);

  const std::vector<Pose> identities = load_identities(copy_ / "bank");
  ASSERT_EQ(identities.size(), 1U);
  EXPECT_EQ(identities[0].name, "identity003");
  const registration::Template head = registration::read_template(copy_ / "bank");
  EXPECT_EQ(head.ibug68, actor.ibug68);
  EXPECT_EQ(head.topology->sets(), actor.topology->sets());
}

TEST_F(IctFaceKit, SetsAreWhatTheirNamesSay) {
  const Databank bank = read_ict_facekit(with({"generic_neutral_mesh"}));
  const Topology& topology = *bank.actor.topology;
  const registration::Ibug68 points = bank.actor.ibug68.value();
  const auto contains = [&](const std::string& set, int landmark) {
    const std::vector<int>& vertices = topology.set(set);
    return std::binary_search(vertices.begin(), vertices.end(), points[landmark]);
  };
  for (int i = 48; i < 68; ++i) EXPECT_TRUE(contains("lips", i)) << i;
  EXPECT_TRUE(contains("upper_lip", 51));
  EXPECT_FALSE(contains("upper_lip", 57));
  EXPECT_TRUE(contains("lower_lip", 57));
  EXPECT_TRUE(contains("lids_right", 37));
  EXPECT_TRUE(contains("lids_left", 44));
  EXPECT_FALSE(contains("lips", 33));
  EXPECT_FALSE(contains("lids_left", 37));
  EXPECT_EQ(topology.set("skin").size(), 11248U);
  for (int v : topology.set("eyeball_left")) EXPECT_GT(bank.actor.neutral()(v, 0), 0.0);
  // The model's tiles overlap in the unit square; ours may share at most texels on a border.
  const TextureSpace texels(bank.actor.topology, 256, 256);
  EXPECT_LT(texels.overlapping_texels(), 256 * 256 / 200);
}

TEST_F(IctFaceKit, ASecondImportDoesNothingAndADamagedOneIsRepaired) {
  const fs::path model = with({"generic_neutral_mesh", "jawOpen"}), out = copy_ / "bank";
  import_ict_facekit(model, out);
  EXPECT_EQ(import_ict_facekit(model, out), std::vector<std::string>{"everything is current"});
  std::ofstream(out / "poses/jawOpen.ply", std::ios::app) << "x";
  EXPECT_GT(import_ict_facekit(model, out).size(), 1U);
  EXPECT_TRUE(damaged_artefacts(out).empty());
}

TEST_F(IctFaceKit, WhatIsNotTheModelIsRefused) {
  EXPECT_THROW(read_ict_facekit(copy_ / "nowhere"), InputError);
  EXPECT_THROW(read_ict_facekit(copy_ / "model"), InputError) << "no index";
  const fs::path model = with({"generic_neutral_mesh"});
  write_file(model / "jawOpen.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THROW(read_ict_facekit(model), InputError) << "another topology";
}

}  // namespace
}  // namespace vultus::rig
