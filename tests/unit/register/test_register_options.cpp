#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "register/consistent.h"
#include "scanned_head.h"

namespace vultus::registration {
namespace {

TEST(RegisterOptions, NamesComeBack) {
  for (const std::string& name : method_names()) EXPECT_EQ(name_of(method_named(name)), name);
  EXPECT_EQ(landmark_finder_named("automatic"), LandmarkFinder::automatic);
  EXPECT_EQ(landmark_finder_named("dlib"), LandmarkFinder::pictures);
  EXPECT_EQ(landmark_finder_named("geometry"), LandmarkFinder::shape);
  EXPECT_EQ(landmark_finder_names().size(), 3u);
  const RegisterOptions options = register_options("sanchez", "simplex");
  EXPECT_EQ(options.method, Method::sanchez);
  EXPECT_EQ(options.energy_solver, EnergySolver::simplex);
  EXPECT_EQ(register_options("default", "ceres").method, Method::standard);
}

std::string refusal(const std::string& method, const std::string& solver) {
  try {
    register_options(method, solver);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(RegisterOptions, UnknownNamesAreRefusedWithTheNearest) {
  EXPECT_NE(refusal("zuh", "ceres").find("\"zhu\""), std::string::npos);
  EXPECT_NE(refusal("sanchez", "simplx").find("\"simplex\""), std::string::npos);
  EXPECT_THROW(landmark_finder_named("dilb"), UsageError);
  // A solver for a method that solves nothing is a mistake, not something to pass over.
  EXPECT_NE(refusal("zhu", "simplex").find("sanchez"), std::string::npos);
}

TEST(RegisterOptions, WhatGivesAnotherResultIsCalledSo) {
  RegisterOptions options = register_options("sanchez", "simplex");
  EXPECT_EQ(method_in_words(options), "sanchez, simplex");
  options.landmarks_by = LandmarkFinder::shape;
  EXPECT_EQ(method_in_words(options), "sanchez, simplex, landmarks by geometry");
  EXPECT_EQ(method_in_words({}), "default");
}

TEST(RegisterOptions, ValuesOutOfRangeAreRefused) {
  for (const double limit : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    RegisterOptions options;
    options.displacement_limit = limit;
    EXPECT_THROW(options.validate(), InputError) << limit;
    EXPECT_THROW(Registration(template_head(), options), InputError) << limit;
  }
  for (const double confidence : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    RegisterOptions options;
    options.least_confidence = confidence;
    EXPECT_THROW(options.validate(), InputError) << confidence;
  }
}

// What becomes of a person's scan by Zhu's chain on the template as it is, the quickest there is.
class RegisterOptionsAtWork : public testing::Test {
 protected:
  static const test::ScannedHead& person() {
    static const test::ScannedHead one = test::scanned_head(1.05, 0.97, 3);
    return one;
  }
  static Registered with(const RegisterOptions& options, const ScanLandmarks& landmarks = person().landmarks) {
    Template head = person().head;
    head.subdivisions = 0;
    return Registration(head, options).neutral(person().scan, landmarks);
  }
  static RegisterOptions zhu() { return register_options("zhu", "ceres"); }
};

TEST_F(RegisterOptionsAtWork, TheDisplacementLimitHoldsTheProjectionBack) {
  RegisterOptions tight = zhu();
  tight.displacement_limit = 0.05;
  const auto distance = [](const Registered& found) { return found.quality.sets.at("face").mesh_to_scan_mean; };
  EXPECT_GT(distance(with(tight)), 1.5 * distance(with(zhu())));
}

TEST_F(RegisterOptionsAtWork, LandmarksBelowTheLeastConfidenceTakeNoPart) {
  ScanLandmarks landmarks = person().landmarks;
  for (std::size_t i = 0; i < landmarks.size(); i += 2) landmarks[i].confidence = 0.5;
  RegisterOptions strict = zhu();
  strict.least_confidence = 0.6;
  EXPECT_EQ(with(strict, landmarks).landmarks.size(), landmarks.size() / 2);
  EXPECT_GT(with(zhu(), landmarks).landmarks.size(), landmarks.size() / 2);
  for (std::size_t i = 5; i < landmarks.size(); ++i) landmarks[i].confidence = 0.5;
  EXPECT_THROW(with(strict, landmarks), InputError);
}

TEST_F(RegisterOptionsAtWork, LimitsDecideTheVerdict) {
  RegisterOptions severe = zhu();
  severe.limits.pass_mean = severe.limits.fail_mean = 1e-6;
  EXPECT_EQ(with(severe).quality.verdict, Verdict::fail);
}

TEST_F(RegisterOptionsAtWork, PicturesNeedNamesThatTheTemplateHas) {
  RegisterOptions options = zhu();
  options.landmarks_by = LandmarkFinder::pictures;
  Template head = person().head;
  head.subdivisions = 0;
  head.ibug68.reset();
  try {
    Registration(head, options).neutral(person().scan);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("68-point"), std::string::npos);
  }
}

}  // namespace
}  // namespace vultus::registration
