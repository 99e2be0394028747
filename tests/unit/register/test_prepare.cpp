#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/error.h"
#include "register/prepare.h"
#include "register/template_head.h"
#include "shipped_head.h"

namespace vultus::registration {
namespace {

using test::model;
using test::shape_of;

// dlib's model out of reach while it lives.
class NoModel {
 public:
  NoModel() {
    if (const char* set = std::getenv("VULTUS_DLIB_MODEL")) before_ = set;
    setenv("VULTUS_DLIB_MODEL", "/nowhere/model.dat", 1);
  }
  ~NoModel() {
    if (before_.empty())
      unsetenv("VULTUS_DLIB_MODEL");
    else
      setenv("VULTUS_DLIB_MODEL", before_.c_str(), 1);
  }

 private:
  std::string before_;
};

TEST(Preparation, MajorPointsByHandBringTheMinorOnesForZhu) {
  ScanLandmarks majors;
  for (const Landmark& landmark : model().head.landmarks)
    if (landmark.major) majors.push_back({landmark.name, model().neutral.row(landmark.vertex).transpose()});
  const Mesh scan = shape_of(model().neutral);
  RegisterOptions options;
  EXPECT_EQ(Preparation(model(), options)(scan, majors).landmarks.size(), 28u);
  options.method = Method::zhu;
  const Prepared prepared = Preparation(model(), options)(scan, majors);
  ASSERT_EQ(prepared.landmarks.size(), 172u);
  EXPECT_EQ(prepared.landmarks[3].confidence, 1.0);
  EXPECT_LT(prepared.landmarks[100].confidence, 1.0);
}

TEST(Preparation, WithoutTheModelShapeIsAsked) {
  const NoModel gone;
  Mesh ball = shape_of(model().neutral);
  for (int v = 0; v < ball.positions.rows(); ++v)
    ball.positions.row(v) *= 110.0 / std::max(1.0, ball.positions.row(v).norm());
  RegisterOptions options;
  EXPECT_THROW(Preparation(model(), options)(ball, {}), InputError);  // shape finds no face, and says so
  options.landmarks_by = LandmarkFinder::pictures;
  EXPECT_THROW(Preparation(model(), options)(ball, {}), ToolError);
  EXPECT_EQ(Preparation(model(), options).template_sighting(), nullptr);
}

TEST(LandmarkFinderNames, AreReadAndWrongOnesCorrected) {
  EXPECT_EQ(landmark_finder_named("geometry"), LandmarkFinder::shape);
  EXPECT_EQ(landmark_finder_named("dlib"), LandmarkFinder::pictures);
  EXPECT_EQ(landmark_finder_named("automatic"), LandmarkFinder::automatic);
  try {
    landmark_finder_named("geometri");
    FAIL();
  } catch (const UsageError& problem) {
    EXPECT_NE(std::string(problem.what()).find("geometry"), std::string::npos);
  }
}

}  // namespace
}  // namespace vultus::registration
