#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "rig/database.h"
#include "rig/markers.h"

namespace vultus::rig {
namespace {

namespace fs = std::filesystem;

class Database : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("vultus_database_" + std::to_string(::getpid())) / "anna";
    fs::remove_all(folder_.parent_path());
  }
  void TearDown() override { fs::remove_all(folder_.parent_path()); }

  /// A unit square of two triangles and a quad beside it, with UVs, a set and landmarks.
  static Mesh patch() {
    TopologyData data;
    data.vertex_count = 6;
    data.face_offsets = {0, 3, 6, 10};
    data.corner_vertex = {0, 1, 2, 0, 2, 3, 1, 4, 5, 2};
    data.corner_uv = data.corner_vertex;
    data.uvs = Uvs(6, 2);
    data.uvs << 0, 0, 0.5, 0, 0.5, 1, 0, 1, 1, 0, 1, 1;
    data.sets = {{"lips", {1, 2}}, {"face", {0, 1, 2, 3}}};
    data.landmarks = {{"8.1", 2}, {"nose_tip", 5}};
    Points positions(6, 3);
    positions << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0.125, 2, 1, 0.25;
    return {Topology::make(std::move(data)), positions, {}, {}};
  }

  static Actor actor() {
    const Mesh mesh = patch();
    Actor actor;
    actor.name = "anna";
    actor.template_name = "patch";
    actor.topology = mesh.topology;
    actor.rest = mesh.positions;
    actor.ibug68.emplace().fill(-1);
    (*actor.ibug68)[30] = 5;
    actor.poses.push_back({"neutral", {}, mesh.positions.array() + 1.0});
    actor.poses.push_back({"jawOpen", {"AU26", "jawOpen"}, mesh.positions.array() - 0.5});
    actor.regions.push_back({"mouth", Eigen::VectorXf::Constant(6, 0.25F)});
    actor.regions.push_back({"brow_left", Eigen::VectorXf::Constant(6, 0.75F)});
    actor.region_masks = Image(4, 2, {"mouth", "brow_left"});
    for (int i = 0; i < 8; ++i) {
      actor.region_masks.at(i % 4, i / 4)[0] = 0.25F;
      actor.region_masks.at(i % 4, i / 4)[1] = 0.75F;
    }
    actor.markers["CHIN"] = {1, {0.25, 0.25, 0.5}};
    actor.albedo = Image::rgb(2, 2);
    actor.albedo.set_rgb(1, 0, {0.5F, 0.25F, 0.125F});
    return actor;
  }

  static Provenance made_by(const std::string& input) {
    return {"onboard", {{"method", "default"}}, {{"scan", input}}};
  }
  static void damage(const fs::path& file) { std::ofstream(file, std::ios::app) << "x"; }

  fs::path folder_;
};

TEST_F(Database, RoundTripKeepsEverything) {
  const Actor written = actor();
  save_actor(folder_, written, made_by("a"));
  const Actor read = load_actor(folder_);
  EXPECT_EQ(read.name, "anna");
  EXPECT_EQ(read.template_name, "patch");
  EXPECT_EQ(read.topology->data().corner_vertex, written.topology->data().corner_vertex);
  EXPECT_EQ(read.topology->data().face_offsets, written.topology->data().face_offsets);
  EXPECT_EQ(read.topology->sets(), written.topology->sets());
  EXPECT_EQ(read.topology->landmarks(), written.topology->landmarks());
  EXPECT_EQ(read.ibug68, written.ibug68);
  ASSERT_EQ(read.pose_names(), written.pose_names());
  EXPECT_EQ(read.poses[1].tags, written.poses[1].tags);
  // PLY keeps float32; every coordinate here is a float32 exactly.
  for (std::size_t p = 0; p < 2; ++p) EXPECT_EQ(read.poses[p].positions, written.poses[p].positions);
  EXPECT_EQ(read.rest, written.rest);
  ASSERT_EQ(read.regions.size(), 2U);
  EXPECT_EQ(read.regions[1].name, "brow_left");
  EXPECT_EQ(read.regions[1].vertex_mask, written.regions[1].vertex_mask);
  EXPECT_EQ(read.region_masks.pixels(), written.region_masks.pixels());
  EXPECT_EQ(read.markers.at("CHIN").triangle, 1);
  EXPECT_EQ(read.markers.at("CHIN").barycentric, written.markers.at("CHIN").barycentric);
  EXPECT_EQ(read.albedo.rgb_at(1, 0), written.albedo.rgb_at(1, 0));
  EXPECT_TRUE(damaged_artefacts(folder_).empty());
}

TEST_F(Database, EveryDamagedArtefactIsNamed) {
  save_actor(folder_, actor(), made_by("a"));
  damage(folder_ / "poses/jawOpen.ply");
  fs::remove(folder_ / "regions/masks.exr");
  EXPECT_EQ(damaged_artefacts(folder_), (std::vector<std::string>{"poses/jawOpen.ply", "regions/masks.exr"}));
  try {
    load_actor(folder_);
    FAIL() << "a damaged actor was loaded";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("poses/jawOpen.ply, regions/masks.exr"), std::string::npos);
  }
}

TEST_F(Database, SecondRunSkipsWhatIsCurrent) {
  const Actor one = actor();
  save_actor(folder_, one, made_by("a"));
  ActorWriter writer(folder_);
  EXPECT_TRUE(writer.topology_is_current(made_by("a")));
  EXPECT_TRUE(writer.pose_is_current("jawOpen", made_by("a")));
  EXPECT_TRUE(writer.regions_are_current(made_by("a")));
  EXPECT_TRUE(writer.markers_are_current(made_by("a")));
  EXPECT_TRUE(writer.map_is_current("neutral", "albedo", made_by("a")));
  EXPECT_FALSE(writer.pose_is_current("jawOpen", made_by("b"))) << "another scan must be registered again";
  EXPECT_FALSE(writer.pose_is_current("smile", made_by("a")));
  damage(folder_ / "poses/jawOpen.ply");
  EXPECT_FALSE(writer.pose_is_current("jawOpen", made_by("a"))) << "an edited pose must be made again";
}

TEST_F(Database, PosesCanBeAddedOneAtATime) {
  const Actor one = actor();
  ActorWriter writer(folder_, "anna");
  EXPECT_THROW(writer.write_pose(one.poses[0], made_by("a")), InputError) << "there is no topology yet";
  writer.write_topology({one.topology, one.rest, {}, {}}, "patch", one.ibug68, made_by("a"));
  writer.write_pose(one.poses[1], made_by("a"));
  EXPECT_THROW(load_actor(folder_), InputError) << "an actor without a neutral is not finished";
  ActorWriter second(folder_);
  second.write_pose(one.poses[0], made_by("a"));
  EXPECT_EQ(load_actor(folder_).pose_names(), one.pose_names()) << "the neutral is listed first";
  Pose smile{"smile", {"AU12"}, one.poses[0].positions};
  second.write_pose(smile, made_by("a"));
  second.keep_poses({"neutral", "smile"});
  EXPECT_EQ(load_actor(folder_).pose_names(), (std::vector<std::string>{"neutral", "smile"}));
  EXPECT_FALSE(fs::exists(folder_ / "poses/jawOpen.ply"));
  EXPECT_THROW(second.keep_poses({"neutral", "smlie"}), InputError);
}

TEST_F(Database, AnotherTopologyDropsWhatNoLongerFits) {
  const Actor one = actor();
  save_actor(folder_, one, made_by("a"));
  ActorWriter writer(folder_);
  writer.write_topology({one.topology, one.rest, {}, {}}, "patch", one.ibug68, made_by("b"));
  EXPECT_EQ(writer.pose_names().size(), 2U) << "the same shape made another way keeps the poses";
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  const Points corners = one.rest.topRows(3);
  writer.write_topology({Topology::from_triangles(3, triangle), corners, {}, {}}, "other", std::nullopt, made_by("c"));
  EXPECT_TRUE(writer.pose_names().empty());
  EXPECT_FALSE(fs::exists(folder_ / "poses/neutral.ply"));
  EXPECT_FALSE(fs::exists(folder_ / "regions/masks.exr"));
  EXPECT_TRUE(damaged_artefacts(folder_).empty());
}

/// A process that dies between announcing new files and moving them must end in the new state, before that in the old.
TEST_F(Database, AWriteCutShortIsFinishedByTheNextReader) {
  const Actor one = actor();
  save_actor(folder_, one, made_by("a"));
  const fs::path pose = folder_ / "poses/jawOpen.ply";
  const std::string old_bytes = read_file(pose), old_manifest = read_file(folder_ / "actor.json");
  Pose changed = one.poses[1];
  changed.positions.array() += 8.0;
  {
    ActorWriter writer(folder_);
    writer.write_pose(changed, made_by("b"));
  }
  const std::string new_bytes = read_file(pose);

  write_file(folder_ / "actor.json", old_manifest);
  write_file(pose, old_bytes);
  write_file(folder_ / ".pending/poses/jawOpen.ply", new_bytes);
  Manifest announced = Manifest::open(folder_ / "actor.json", "actor");
  announced.facts()["pending"] = {
      {"provenance", {{"command", "onboard"}, {"options", {{"method", "default"}}}, {"inputs", {{"scan", "b"}}}}},
      {"files", {{"poses/jawOpen.ply", sha256_of_bytes(new_bytes)}}}};
  announced.save();

  EXPECT_EQ(load_actor(folder_).poses[1].positions, changed.positions);
  EXPECT_EQ(read_file(pose), old_bytes) << "reading writes nothing";
  ActorWriter writer(folder_);
  EXPECT_EQ(read_file(pose), new_bytes);
  EXPECT_TRUE(writer.pose_is_current("jawOpen", made_by("b")));
  EXPECT_FALSE(fs::exists(folder_ / ".pending"));
  EXPECT_TRUE(damaged_artefacts(folder_).empty());
}

TEST_F(Database, ALeftoverBeforeTheAnnouncementIsIgnored) {
  const Actor one = actor();
  save_actor(folder_, one, made_by("a"));
  write_file(folder_ / ".pending/poses/jawOpen.ply", "half a fi");
  EXPECT_EQ(load_actor(folder_).poses[1].positions, one.poses[1].positions);
}

TEST_F(Database, RefusesWhatWouldNotBeFoundAgain) {
  const Actor one = actor();
  ActorWriter writer(folder_, "anna");
  writer.write_topology({one.topology, one.rest, {}, {}}, "patch", one.ibug68, made_by("a"));
  Pose pose = one.poses[0];
  for (const char* name : {"", "..", "../neutral", "a/b", ".hidden", "with space"}) {
    pose.name = name;
    EXPECT_THROW(writer.write_pose(pose, made_by("a")), InputError) << name;
  }
  pose = one.poses[0];
  pose.positions(3, 1) = std::nan("");
  EXPECT_THROW(writer.write_pose(pose, made_by("a")), InputError);
  EXPECT_THROW(writer.write_pose({"short", {}, Points::Zero(5, 3)}, made_by("a")), InputError);
  EXPECT_THROW(load_actor(folder_.parent_path()), InputError);
}

TEST_F(Database, UnknownPosesAndMapsAreNamedWithTheNearest) {
  const Actor one = actor();
  try {
    (void)one.pose_index("jawopen");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("jawOpen"), std::string::npos);
  }
  save_actor(folder_, one, made_by("a"));
  EXPECT_EQ(map_names(folder_, "neutral"), std::vector<std::string>{"albedo"});
  EXPECT_EQ(load_map(folder_, "neutral", "albedo").width(), 2);
  EXPECT_THROW(load_map(folder_, "neutral", "specular"), InputError);
}

class Markers : public Database {
 protected:
  MarkerPlaces read(const std::string& json) {
    write_file(folder_ / "markers.json", json);
    return read_markers(folder_ / "markers.json", *patch().topology);
  }
};

TEST_F(Markers, PlacesComeFromTrianglesLandmarksAndVertices) {
  const MarkerPlaces places = read(R"({"markers": {"A": {"triangle": 3, "barycentric": [0.5, 0.25, 0.25]},
      "B": {"landmark": "nose_tip"}, "C": {"vertex": 3}}})");
  const Mesh mesh = patch();
  EXPECT_EQ(places.at("A").triangle, 3);
  EXPECT_EQ(position_of(places.at("B"), *mesh.topology, mesh.positions), mesh.positions.row(5).transpose());
  EXPECT_EQ(position_of(places.at("C"), *mesh.topology, mesh.positions), mesh.positions.row(3).transpose());
}

TEST_F(Markers, BadPlacesNameTheMarker) {
  for (const char* entry :
       {R"({"triangle": 4, "barycentric": [1, 0, 0]})", R"({"triangle": -1, "barycentric": [1, 0, 0]})",
        R"({"triangle": 0, "barycentric": [1, 1, 0]})", R"({"triangle": 0, "barycentric": [2, -1, 0]})",
        R"({"triangle": 0, "barycentric": [1, 0]})", R"({"triangle": 0})", R"({"landmark": "nose_tpi"})",
        R"({"vertex": 6})", R"({"vertex": 1e30})", R"({})", "3"}) {
    try {
      read(std::string(R"({"markers": {"LIP": )") + entry + "}}");
      ADD_FAILURE() << entry << " was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("LIP"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(read(R"({"labels": {}})"), InputError);
}

}  // namespace
}  // namespace vultus::rig
