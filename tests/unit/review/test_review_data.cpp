#include <algorithm>
#include <cstring>
#include <fstream>

#include "apps/review_cleaning.h"
#include "apps/review_data.h"
#include "apps/review_encoding.h"
#include "apps/review_findings.h"
#include "apps/review_head.h"
#include "apps/review_pictures.h"
#include "apps/review_takes.h"
#include "core/error.h"
#include "review_session.h"

namespace vultus::apps {
namespace {

using testing::ReviewFolder;

template <typename T>
std::vector<T> decoded(const nlohmann::json& json) {
  const std::string text = json.get<std::string>();
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (char c : text) {
    if (c == '=') break;
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    group = group << 6 | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes += static_cast<char>(group >> bits & 255U);
    }
  }
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

bool has(const std::vector<Finding>& findings, Severity severity, const std::string& text) {
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
    return finding.severity == severity && finding.text.find(text) != std::string::npos;
  });
}

TEST(ReviewData, ReadsAWholeSession) {
  const ReviewFolder folder;
  const ReviewSession session = read_review_session(folder.session());
  EXPECT_EQ(session.actor.name, "Ada");
  ASSERT_EQ(session.takes.size(), 1u);
  EXPECT_EQ(session.takes[0].frames(), 24);
  EXPECT_TRUE(session.takes[0].errors && session.takes[0].global_errors && session.takes[0].samples);
  EXPECT_EQ(session.markers.size(), 36u);
  EXPECT_TRUE(session.missing.empty());
}

TEST(ReviewData, MissingFilesAreNamedNotFatal) {
  const ReviewFolder folder;
  for (const char* file : {"errors.csv", "errors_global.csv", "samples.json", "report.json", "weights.npy"}) {
    fs::remove(folder.take() / file);
  }
  fs::remove_all(folder.actor() / "report");
  const ReviewSession session = read_review_session(folder.session());
  EXPECT_EQ(session.missing.size(), 5u);
  const auto findings = find_what_stands_out(session);
  EXPECT_TRUE(has(findings, Severity::note, "weights.npy"));
  EXPECT_EQ(take_json(session.takes[0])["frames"], 0);
}

TEST(ReviewData, WhatIsNoSessionIsRefused) {
  const ReviewFolder folder;
  EXPECT_THROW(read_review_session(folder.actor()), InputError);
  std::ofstream(folder.take() / "errors.csv") << "frame,time_s,M0\n0,0,1\n";
  EXPECT_THROW(read_review_session(folder.session()), InputError);
}

TEST(ReviewFindings, ProblemsComeFirst) {
  const ReviewFolder folder;
  const auto findings = find_what_stands_out(read_review_session(folder.session()));
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings.front().severity, Severity::problem);
  EXPECT_EQ(findings.front().pose, "smile");
  for (std::size_t i = 1; i < findings.size(); ++i) EXPECT_LE(findings[i - 1].severity, findings[i].severity);
  EXPECT_TRUE(has(findings, Severity::look, "coverage 71 %"));
  EXPECT_TRUE(has(findings, Severity::look, "M7 for 11 frames from 10, expected error 1.8 mm"));
  EXPECT_TRUE(has(findings, Severity::look, "1 gap stays unfilled, the first at frame 3"));
  EXPECT_TRUE(has(findings, Severity::look, "off by 2.5 mm at frame 9"));
  EXPECT_TRUE(has(findings, Severity::look, "M3: 9.0 mm from the face"));
  EXPECT_TRUE(has(findings, Severity::look, "Jig marker jig2 slips by 2.5 mm at frame 14"));
  EXPECT_TRUE(has(findings, Severity::note, "2 repairs of labels; the least certain: swap of M5 at frame 8"));
  EXPECT_TRUE(has(findings, Severity::note, "Largest mean error"));
  EXPECT_FALSE(has(findings, Severity::problem, "worse than the global"));
}

TEST(ReviewFindings, ARegionalSolveWorseThanTheGlobalOneIsAProblem) {
  const ReviewFolder folder;
  const auto regional = retarget::read_errors(folder.take() / "errors.csv");
  retarget::write_errors(folder.take() / "errors_global.csv", regional);
  auto worse = regional;
  for (float& value : worse.values) value += 1.0F;
  retarget::write_errors(folder.take() / "errors.csv", worse);
  EXPECT_TRUE(
      has(find_what_stands_out(read_review_session(folder.session())), Severity::problem, "worse than the global"));
}

TEST(ReviewHead, PosesComeBackFromTheirBytes) {
  const ReviewFolder folder;
  const ReviewSession session = read_review_session(folder.session());
  const nlohmann::json head = head_json(session);
  const Points& neutral = session.actor.neutral();
  ASSERT_EQ(head["vertices"].get<int>(), neutral.rows());
  EXPECT_EQ(decoded<std::uint16_t>(head["triangles"]["data"]).size(), 3u * session.actor.topology->triangles().rows());
  const auto packed = decoded<std::int16_t>(head["neutral"]["data"]);
  for (Eigen::Index i = 0; i < neutral.size(); ++i) {
    const double value =
        packed[i] * head["neutral"]["step"].get<double>() + head["neutral"]["centre"][i % 3].get<double>();
    ASSERT_NEAR(value, neutral.data()[i], 0.005);
  }
  for (std::size_t pose = 0; pose < session.actor.poses.size(); ++pose) {
    const nlohmann::json& json = head["poses"][pose];
    Points positions = neutral;
    const auto vertices = decoded<std::uint32_t>(json["vertices"]);
    const auto motion = decoded<std::int16_t>(json["motion"]);
    for (std::size_t n = 0; n < vertices.size(); ++n) {
      for (int axis = 0; axis < 3; ++axis)
        positions(vertices[n], axis) += json["step"].get<double>() * motion[3 * n + axis];
    }
    // Motion below a hundredth of a millimetre is not stored; steps are finer.
    EXPECT_LE((positions - session.actor.poses[pose].positions).rowwise().norm().maxCoeff(), 0.011) << json["name"];
  }
}

TEST(ReviewHead, DistancesMasksAndMarkersBelongToTheirVertices) {
  const ReviewFolder folder;
  const ReviewSession session = read_review_session(folder.session());
  const nlohmann::json head = head_json(session);
  const auto distances = decoded<std::uint16_t>(head["distances"]["neutral"]);
  EXPECT_EQ(distances[3], 1250);
  EXPECT_EQ(distances[4], 65535);
  EXPECT_EQ(distances[5], 0);
  EXPECT_FALSE(head["distances"].contains("smile"));
  const auto masks = decoded<std::uint8_t>(head["masks"]);
  for (int v : {0, 500, 1088}) {
    for (int k = 0; k < 2; ++k) EXPECT_NEAR(masks[2 * v + k], 255.0F * session.actor.regions[k].vertex_mask[v], 0.51F);
  }
  EXPECT_EQ(head["markers"].size(), 36u);
}

TEST(ReviewTakes, LongTakesAreThinnedAndSayso) {
  ReviewTake take;
  take.name = "long";
  take.weights =
      retarget::Weights::zeros(120.0, std::vector<std::string>(12, "r"), std::vector<std::string>(60, "p"), 9000);
  const nlohmann::json json = take_json(take);
  EXPECT_EQ(json["frames"], 9000);
  EXPECT_EQ(json["weights"]["stride"], 3);  // 6.48 M values, 2.5 M at most
  EXPECT_EQ(decoded<std::uint16_t>(json["weights"]["data"]).size(), 3000u * 720u);
}

TEST(ReviewTakes, FiguresOfMarkersAndTheTable) {
  const ReviewFolder folder;
  const ReviewSession session = read_review_session(folder.session());
  const nlohmann::json json = take_json(session.takes[0]);
  ASSERT_EQ(json["table"].size(), 2u);
  EXPECT_LT(json["table"][1]["mean_mm"], json["table"][0]["mean_mm"]);
  EXPECT_EQ(json["markers"].size(), 36u);
  EXPECT_EQ(json["gaps"].size(), 3u);
  EXPECT_EQ(json["gaps"][1]["marker"], "M7");
  EXPECT_EQ(json["stabilization"]["rms_mm"][9], 2.5);
}

// By frame of the cleaned take, from which two doubled frames were taken out.
TEST(ReviewCleaning, RepairsSayWhatWasDoneAndWhereItShows) {
  const ReviewFolder folder;
  const nlohmann::json json = cleaning_json(read_review_session(folder.session()).takes[0]);
  const nlohmann::json& repairs = json["repairs"];
  ASSERT_EQ(repairs.size(), 5u);
  EXPECT_EQ(repairs[0]["kind"], "phantom");
  EXPECT_EQ(repairs[0]["marks"], nlohmann::json::array({{"M6", 4, 5}}));
  EXPECT_EQ(repairs[0]["what"], "M6 → dropped");
  EXPECT_EQ(repairs[1]["kind"], "doubled");
  EXPECT_TRUE(repairs[1]["markers"].empty());
  EXPECT_EQ(repairs[2]["kind"], "swap");
  EXPECT_EQ(repairs[2]["markers"], (std::vector<std::string>{"M5", "M4"}));
  EXPECT_EQ(repairs[2]["first"], 8);
  EXPECT_EQ(repairs[2]["last"], 10);
  EXPECT_EQ(repairs[2]["what"], "M4 → M5, M5 → M4: 9.0 mm off");
  EXPECT_EQ(repairs[3]["kind"], "slip");
  EXPECT_EQ(repairs[4]["kind"], "refused");
  EXPECT_EQ(repairs[4]["what"], "fragment refused by hand; the samples stay under *12");
  EXPECT_EQ(repairs[4]["first"], 16);
  EXPECT_TRUE(repairs[4]["marks"].empty());
  EXPECT_EQ(json["stabilization"]["slips"][0]["marker"], "jig2");
}

// The take as measured still has the jig, and its own order of columns.
TEST(ReviewCleaning, CurvesAreThoseOfTheMarkersByName) {
  ReviewTake take;
  take.measured = mocap::Take::empty("t", 60.0, {"jig", "b", "a"}, 2);
  take.clean = mocap::Take::empty("t", 60.0, {"a", "b", "never"}, 2);
  take.measured->set(0, 0, {900, 900, 900});
  take.measured->set(0, 2, {-3, 1, 2});
  take.measured->set(1, 1, {5, 6, 7});
  take.clean->set(0, 0, {-2.5, 1, 2});
  take.clean->set(1, 1, {5.5, 6, 7});
  const nlohmann::json curves = cleaning_json(take)["curves"];
  EXPECT_EQ(curves["least"], (std::vector<float>{-3, 1, 2, 5, 6, 7, 0, 0, 0}));
  const std::uint16_t none = 65535, half = 100;  // 0.5 mm in steps of 0.005
  EXPECT_EQ(decoded<std::uint16_t>(curves["measured"]["data"]),
            (std::vector<std::uint16_t>{0, 0, 0, none, none, none, none, none, none,  //
                                        none, none, none, 0, 0, 0, none, none, none}));
  EXPECT_EQ(decoded<std::uint16_t>(curves["clean"]["data"]),
            (std::vector<std::uint16_t>{half, 0, 0, none, none, none, none, none, none,  //
                                        none, none, none, half, 0, 0, none, none, none}));
}

TEST(ReviewPictures, InlinedReducedAndSpread) {
  const ReviewFolder folder;
  const fs::path frames = folder.session() / "render" / "smile";
  PictureOptions options;
  options.width = 32;
  const auto all = pictures_json(frames, folder.session() / "review", options, Progress::none());
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0]["frame"], 4);
  EXPECT_EQ(all[0]["mode"], "reference");
  EXPECT_EQ(all[0]["href"], "../render/smile/reference/000004.png");
  EXPECT_EQ(all[0]["src"].get<std::string>().rfind("data:image/jpeg;base64,", 0), 0u);
  EXPECT_EQ(all[0]["width"], 40);  // of the file, not of the inlined copy
  options.most = 1;
  EXPECT_EQ(pictures_json(frames, folder.session() / "review", options, Progress::none()).size(), 1u);
  EXPECT_TRUE(film_json(frames, folder.session() / "review", options).is_null());
}

}  // namespace
}  // namespace vultus::apps
