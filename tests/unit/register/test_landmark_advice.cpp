#include <gtest/gtest.h>

#include "register/anchors.h"
#include "register/landmark_advice.h"

namespace vultus::registration {
namespace {

ScanLandmarks sure_of_all() {
  ScanLandmarks all;
  for (int i = 0; i < 68; ++i) all.push_back({ibug_name(i), Eigen::Vector3d(i, 0, 0), 0.8, true});
  return all;
}

TEST(LandmarkAdvice, SaysNothingWhenNothingIsToDo) { EXPECT_EQ(landmark_advice("smile", sure_of_all()), ""); }

TEST(LandmarkAdvice, NamesPoseFilePointAndPlace) {
  ScanLandmarks found = sure_of_all();
  found[48].confidence = 0.05;
  found[3].confidence = 0.0;  // an outline is never placed by hand
  found.erase(found.begin() + 30);
  const std::string advice = landmark_advice("smile", found);
  EXPECT_NE(advice.find("landmarks/smile.json"), std::string::npos);
  EXPECT_NE(advice.find("ibug.48 (right corner of the mouth)"), std::string::npos);
  EXPECT_NE(advice.find("ibug.30 (tip of the nose)"), std::string::npos);
  EXPECT_EQ(advice.find("ibug.3 "), std::string::npos);
}

TEST(LandmarkAdvice, EveryPointHasAPlaceInWords) {
  for (int i = 0; i < 68; ++i) EXPECT_FALSE(place_in_words(ibug_name(i)).empty()) << i;
  EXPECT_EQ(place_in_words("ibug.36"), "outer corner of the right eye");
  EXPECT_EQ(place_in_words("hairline"), "");
}

TEST(LandmarkAdvice, APointPlacedByHandReplacesTheOneFoundAndEndsTheAdvice) {
  ScanLandmarks found = sure_of_all();
  found[48].confidence = 0.05;
  const ScanLandmarks given = {{ibug_name(48), Eigen::Vector3d(1, 2, 3)}};
  const ScanLandmarks both = overridden(found, given);
  ASSERT_EQ(both.size(), 68u);
  EXPECT_EQ(both[48].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(both[48].confidence, 1.0);
  EXPECT_FALSE(both[48].pictured);
  EXPECT_EQ(both[47].position, found[47].position);
  EXPECT_EQ(landmark_advice("smile", both), "");
}

}  // namespace
}  // namespace vultus::registration
