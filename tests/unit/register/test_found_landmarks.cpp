#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/error.h"
#include "register/found_landmarks.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::registration {
namespace {

// Our head lying on its back, as an OBJ alone would tell it.
struct Lying {
  Template known = template_head(), nameless = known;
  Eigen::Matrix3d file_from_face;
  DetectedLandmarks seen;  // of the true points, 1 mm above the refined surface
  Lying() {
    file_from_face << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    nameless.ibug68.reset();
    nameless.landmarks.clear();
    nameless.neutral = known.neutral * file_from_face.transpose();
    const Points refined = LoopSubdivision(known.topology, known.subdivisions)(nameless.neutral);
    for (int i = 0; i < 68; ++i)
      seen.points.push_back(
          {ibug_name(i), Eigen::Vector3d(refined.row((*known.ibug68)[i])) + file_from_face.col(2), 0.7});
    // The finder's axes are some degrees off.
    seen.scan_from_face = file_from_face * Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 1, 0).normalized());
  }
};

TEST(FoundLandmarks, AreTheVerticesWhereTheyWereSeen) {
  const Lying head;
  const Template found = with_seen_landmarks(head.nameless, head.seen);
  ASSERT_TRUE(found.ibug68);
  for (int i = 0; i < 68; ++i) EXPECT_EQ((*found.ibug68)[i], i < 17 ? -1 : (*head.known.ibug68)[i]) << i;
}

TEST(FoundLandmarks, TheShapeIsTurnedUprightByQuarters) {
  const Lying head;
  const Template found = with_seen_landmarks(head.nameless, head.seen);
  EXPECT_LT((found.neutral - head.known.neutral).cwiseAbs().maxCoeff(), 1e-12);
  DetectedLandmarks upright = head.seen;
  upright.scan_from_face = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_EQ(with_seen_landmarks(head.nameless, upright).neutral, head.nameless.neutral);
}

TEST(FoundLandmarks, AVertexIsGivenOnce) {
  Lying head;
  head.seen.points[66].position = head.seen.points[62].position;  // lips seen as one point
  const Template found = with_seen_landmarks(head.nameless, head.seen);
  EXPECT_EQ((*found.ibug68)[62], (*head.known.ibug68)[62]);
  EXPECT_EQ((*found.ibug68)[66], -1);
}

TEST(FoundLandmarks, TooFewAreRefusedWithWhatWouldHelp) {
  Lying head;
  head.seen.points.resize(17 + 11);
  try {
    with_seen_landmarks(head.nameless, head.seen);
    FAIL() << "11 points are no face";
  } catch (const InputError& problem) {
    EXPECT_NE(std::string(problem.what()).find("template.json"), std::string::npos);
  }
}

}  // namespace
}  // namespace vultus::registration
