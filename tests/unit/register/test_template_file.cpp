#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/files.h"
#include "register/landmarks.h"
#include "register/template_file.h"

namespace vultus::registration {
namespace {

namespace fs = std::filesystem;

class TemplateFile : public testing::Test {
 protected:
  fs::path folder = fs::path(testing::TempDir()) / "vultus_template_file";
  void SetUp() override {
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream obj(folder / "template.obj");
    for (int v = 0; v < 80; ++v) obj << "v " << 0.1 * v << " " << (v % 7) << " " << (v % 3) << "\n";
    for (int v = 0; v + 3 < 80; v += 4) obj << "f " << v + 1 << " " << v + 2 << " " << v + 3 << " " << v + 4 << "\n";
  }
  void TearDown() override { fs::remove_all(folder); }
  void describe(const std::string& json) { std::ofstream(folder / "template.json") << json; }
  std::string error_of(const std::string& json) {
    describe(json);
    try {
      read_template(folder);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
};

std::string ibug_list(int last) {
  std::string list = "[";
  for (int i = 0; i < 67; ++i) list += std::to_string(i) + ",";
  return list + std::to_string(last) + "]";
}

TEST_F(TemplateFile, ReadsUnitsLandmarksAndSets) {
  describe(R"({"units": "cm", "name": "test", "landmarks": {"scheme": "ibug-68", "vertices": )" + ibug_list(-1) +
           R"(, "points": {"8.1": 5}, "major": ["8.1"]}, "sets": {"face": [3, 1, 2, 1]}, "subdivisions": 2})");
  const Template head = read_template(folder / "template.json");
  EXPECT_EQ(head.name, "test");
  EXPECT_NEAR(head.neutral(10, 0), 10.0, 1e-9);  // 1.0 cm
  EXPECT_EQ((*head.ibug68)[66], 66);
  EXPECT_EQ((*head.ibug68)[67], -1);
  ASSERT_EQ(head.landmarks.size(), 1u);
  EXPECT_TRUE(head.landmarks[0].major);
  EXPECT_EQ(head.topology->set("face"), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(head.topology->landmarks().at("8.1"), 5);
  EXPECT_EQ(head.subdivisions, 2);
  EXPECT_EQ(head.topology->face_count(), 20);  // quads stay quads
}

TEST_F(TemplateFile, ComesBackAsWritten) {
  describe(R"({"units": "mm", "landmarks": {"points": {"a": 1, "b": 70}}, "sets": {"lips": [4, 5]}})");
  const Template first = read_template(folder);
  write_template(folder / "copy", first);
  const Template second = read_template(folder / "copy");
  EXPECT_LT((first.neutral - second.neutral).cwiseAbs().maxCoeff(), 1e-5);  // OBJ keeps six digits
  EXPECT_EQ(second.landmarks[1].name, "b");
  EXPECT_EQ(second.landmarks[1].vertex, 70);
  EXPECT_EQ(second.topology->set("lips"), first.topology->set("lips"));
}

TEST_F(TemplateFile, AnObjAloneHasItsUnitsGuessed) {
  const Template head = read_template(folder / "template.obj");  // 8 × 6 × 2 units: a head in inches alone
  EXPECT_FALSE(head.ibug68);
  EXPECT_NEAR(head.neutral(10, 0), 25.4, 1e-9);
}

TEST_F(TemplateFile, SaysWhatIsWrongAndWhere) {
  const std::string good = R"("landmarks": {"points": {"a": 1}})";
  EXPECT_NE(error_of("{" + good + "}").find("units"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "km", )" + good + "}").find("km"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": 3, )" + good + "}").find("units"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm"})").find("landmarks"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", "landmark": {}})").find("did you mean \"landmarks\""), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", "landmarks": {"points": {"nose": 80}}})").find("landmarks.points.nose"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", "landmarks": {"points": {"nose": -1}}})").find("-1"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", "landmarks": {"points": {"nose": 1e30}}})").find("nose"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", "landmarks": {"vertices": [1, 2]}})").find("68"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", "landmarks": {"vertices": )" + ibug_list(99) + "}}").find("vertices[67]"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", )" + good + R"(, "sets": {"lips": 4}})").find("sets.lips"), std::string::npos);
  EXPECT_NE(error_of(R"({"units": "mm", )" + good + R"(, "subdivisions": 9})").find("subdivisions"), std::string::npos);
  EXPECT_NE(error_of("[]"), "no error");
  EXPECT_NE(error_of("{\"units\": "), "no error");
  EXPECT_NE(error_of(""), "no error");
}

TEST_F(TemplateFile, MissingFilesAreNamed) {
  try {
    read_template(folder / "nowhere");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere"), std::string::npos);
  }
}

TEST_F(TemplateFile, LandmarkFilesGoAroundAndRefuseNonsense) {
  const ScanLandmarks landmarks = {{"8.1", {1, 2, 3}, 1.0}, {"ibug.30", {4, 5, 6}, 0.5}};
  write_landmarks(folder / "neutral.json", landmarks);
  const ScanLandmarks back = read_landmarks(folder / "neutral.json", 10.0);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[0].name, "8.1");
  EXPECT_EQ(back[0].position, Eigen::Vector3d(10, 20, 30));
  auto refused = [&](const std::string& content) {
    std::ofstream(folder / "bad.json") << content;
    EXPECT_THROW(read_landmarks(folder / "bad.json"), InputError) << content;
  };
  refused("");
  refused("{}");
  refused(R"({"points": 3})");
  refused(R"({"points": {"a": [1, 2]}})");
  refused(R"({"points": {"a": [1, 2, "x"]}})");
  refused(R"({"points": [[1, 2, 3]]})");
  EXPECT_THROW(read_landmarks(folder / "missing.json"), InputError);
}

TEST_F(TemplateFile, PairsSkipContoursAndNameUnknownPoints) {
  describe(R"({"units": "mm", "landmarks": {"vertices": )" + ibug_list(67) + R"(, "points": {"chin": 70}}})");
  const Template head = read_template(folder);
  const LandmarkPairs pairs =
      pair_landmarks(head, {{"ibug.3", {0, 0, 0}, 1.0}, {"ibug.30", {1, 1, 1}, 0.5}, {"chin", {2, 2, 2}, 1.0}});
  EXPECT_EQ(pairs.vertices, (std::vector<int>{30, 70}));
  EXPECT_EQ(pairs.confidence[0], 0.5);
  EXPECT_THROW(pair_landmarks(head, {{"chinn", {0, 0, 0}, 1.0}}), InputError);
}

}  // namespace
}  // namespace vultus::registration
