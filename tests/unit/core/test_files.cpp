#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/manifest.h"
#include "temporary_folder.h"

namespace vultus {
namespace {

using test::message_of;
using test::TemporaryFolder;

TEST(Files, WritesWholeFilesAndMakesTheirFolders) {
  const TemporaryFolder folder;
  const std::string content("a\0b\n", 4);
  write_file(folder / "x/y/z.bin", content);
  EXPECT_EQ(read_file(folder / "x/y/z.bin"), content);
  write_file(folder / "x/y/z.bin", "new");
  EXPECT_EQ(folder.get("x/y/z.bin"), "new");
}

TEST(Files, AFailedWriterLeavesTheOldContentAndNothingElse) {
  const TemporaryFolder folder;
  folder.put("a.png", "old");
  std::filesystem::path temporary;
  const auto fail = [&](const std::filesystem::path& path) {
    temporary = path;
    folder.put(path.filename().string(), "half");
    throw OutputError(path, "broken");
  };
  EXPECT_THROW(write_file_with(folder / "a.png", fail), OutputError);
  EXPECT_EQ(temporary.extension(), ".png");
  EXPECT_EQ(folder.get("a.png"), "old");
  EXPECT_EQ(folder.entries(), 1);
}

// A file-size limit makes write() fail midway, as a full disk does, without needing root.
TEST(Files, AFullDiskIsAnOutputErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tiny{4096, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tiny);
  const std::string message = message_of<OutputError>([&] { write_file(folder / "a.bin", std::string(100000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_NE(message.find("a.bin"), std::string::npos);
  EXPECT_EQ(folder.entries(), 0);
}

TEST(Files, OutputThatCannotBeIsAnOutputError) {
  const TemporaryFolder folder;
  folder.put("file", "");
  EXPECT_THROW(write_file(folder / "file/inside.txt", "x"), OutputError);
  EXPECT_THROW(make_folder(folder / "file"), OutputError);
  EXPECT_THROW(write_file(folder.path(), "x"), OutputError);
}

TEST(Files, DevicesAreWrittenStraightAndStayDevices) {
  EXPECT_NO_THROW(write_file("/dev/null", "x"));
  EXPECT_THROW(write_file("/dev/full", "x"), OutputError);
  EXPECT_THROW(write_file_with("/dev/null", [](const std::filesystem::path&) {}), OutputError);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(Files, ReadRefusesFilesAboveTheLimit) {
  const TemporaryFolder folder;
  folder.put("a", "12345");
  EXPECT_EQ(read_file(folder / "a", 5), "12345");
  EXPECT_THROW(read_file(folder / "a", 4), InputError);
}

TEST(Files, JsonErrorsNameFileAndLine) {
  const TemporaryFolder folder;
  const auto file = folder.put("a.json", "{\n \"a\": 1,\n \"b\" 2\n}\n");
  const std::string message = message_of<InputError>([&] { read_json(file); });
  EXPECT_NE(message.find(file.string() + ": line 3"), std::string::npos) << message;
  EXPECT_THROW(read_json(folder.put("empty.json", "")), InputError);
  write_json(folder / "b.json", {{"x", {1, 2}}});
  EXPECT_EQ(read_json(folder / "b.json").at("x").size(), 2u);
}

TEST(Files, NearestNameIgnoresCaseAndCountsEdits) {
  EXPECT_EQ(nearest_name("smlie", {"neutral", "smile", "frown"}), "smile");
  EXPECT_EQ(nearest_name("JAWOPEN", {"jawLeft", "jawOpen"}), "jawOpen");
  EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(Hash, MatchesPublishedVectors) {
  // FIPS 180-2, appendix B.1 and the empty message.
  EXPECT_EQ(sha256_of_bytes("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of_bytes(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  const TemporaryFolder folder;
  EXPECT_EQ(sha256_of_file(folder.put("a", "abc")), sha256_of_bytes("abc"));
  EXPECT_THROW(sha256_of_file(folder / "none"), InputError);
  EXPECT_THROW(sha256_of_file(folder.path()), InputError);
}

struct ManifestTest : testing::Test {
  TemporaryFolder folder;
  Provenance provenance{"onboard", {{"method", "default"}}, {{"scan", "12ab"}}};

  void SetUp() override {
    folder.put("a.ply", "content");
    Manifest manifest = Manifest::open(folder / "actor.json", "actor");
    manifest.facts()["name"] = "Ada";
    manifest.record("a.ply", provenance);
    manifest.save();
  }
  Manifest reopened() const { return Manifest::open(folder / "actor.json", "actor"); }
};

TEST_F(ManifestTest, RemembersFactsAndArtefacts) {
  const Manifest manifest = reopened();
  EXPECT_EQ(manifest.facts().at("name"), "Ada");
  EXPECT_EQ(manifest.artefacts(), std::vector<std::string>{"a.ply"});
  EXPECT_EQ(manifest.hash("a.ply"), sha256_of_bytes("content"));
  EXPECT_TRUE(manifest.is_current("a.ply", provenance));
  EXPECT_NO_THROW(manifest.verify("a.ply"));
  EXPECT_TRUE(manifest.damaged().empty());
}

TEST_F(ManifestTest, AnyChangeOfOptionsOrInputsMakesAnArtefactStale) {
  Provenance other = provenance;
  other.options["method"] = "zhu";
  EXPECT_FALSE(reopened().is_current("a.ply", other));
  other = provenance;
  other.inputs["scan"] = "34cd";
  EXPECT_FALSE(reopened().is_current("a.ply", other));
  EXPECT_FALSE(reopened().is_current("b.ply", provenance));
}

TEST_F(ManifestTest, NamesDamagedAndMissingArtefacts) {
  folder.put("a.ply", "contenT");
  EXPECT_FALSE(reopened().is_current("a.ply", provenance));
  EXPECT_NE(message_of<InputError>([&] { reopened().verify("a.ply"); }).find("a.ply"), std::string::npos);
  EXPECT_EQ(reopened().damaged(), std::vector<std::string>{"a.ply"});
  std::filesystem::remove(folder / "a.ply");
  EXPECT_FALSE(reopened().is_current("a.ply", provenance));
  EXPECT_NE(message_of<InputError>([&] { reopened().verify("a.ply"); }).find("missing"), std::string::npos);
}

TEST_F(ManifestTest, RefusesAnotherKindAndDamage) {
  EXPECT_NE(message_of<InputError>([&] { Manifest::open(folder / "actor.json", "session"); }).find("\"actor\""),
            std::string::npos);
  EXPECT_THROW(reopened().hash("b.ply"), InputError);
  const std::string whole = folder.get("actor.json");
  folder.put("actor.json", whole.substr(0, whole.size() / 2));
  EXPECT_THROW(reopened(), InputError);
  for (const char* hostile :
       {"[]", "{}", "{\"kind\": 3}", "{\"kind\": \"actor\", \"facts\": {}, \"artefacts\": {\"a\": 1}}"}) {
    folder.put("actor.json", hostile);
    EXPECT_THROW(reopened(), InputError) << hostile;
  }
}

TEST_F(ManifestTest, AHandEditedManifestIsNoticed) {
  std::string text = folder.get("actor.json");
  text.replace(text.find("Ada"), 3, "Eve");
  folder.put("actor.json", text);
  EXPECT_THROW(reopened(), InputError);
}

}  // namespace
}  // namespace vultus
