#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/transform.h"
#include "register/minor_landmarks.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::registration {
namespace {

// A person of other proportions: wider, with a longer chin, a higher brow and a longer nose, in a turned scan.
Points someone_else(const Points& neutral) {
  Points other = neutral;
  for (int v = 0; v < other.rows(); ++v) {
    const Eigen::Vector3d p = neutral.row(v);
    const double chin = 1.0 / (1.0 + std::exp((p.y() + 60.0) / 12.0));
    const double nose = std::exp(-(p - Eigen::Vector3d(0, -40, 95)).squaredNorm() / 700.0);
    other.row(v) << 1.05 * p.x(), 1.02 * p.y() - 5.0 * chin, p.z() + 4.0 * nose;
  }
  Similarity pose;
  pose.rotation = Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.2, 1.0, 0.4).normalized()).toRotationMatrix();
  pose.translation = {10.0, -30.0, 55.0};
  return transformed(pose, other);
}

struct Placed {
  std::vector<double> errors;
  int majors = 0, minors = 0;
};

Placed placed_on(const Template& head, const Points& truth_control, const Mesh& surface) {
  const ScanSurface scan(surface);
  ScanLandmarks majors;
  for (const Landmark& landmark : head.landmarks)
    if (landmark.major) majors.push_back({landmark.name, truth_control.row(landmark.vertex).transpose(), 1.0});
  EXPECT_TRUE(are_major_landmarks(head, majors));
  Placed placed;
  placed.majors = static_cast<int>(majors.size());
  for (const ScanLandmark& minor : place_minor_landmarks(head, majors, scan)) {
    placed.errors.push_back(
        (minor.position.transpose() - truth_control.row(*landmark_vertex(head, minor.name))).norm());
    EXPECT_LT(minor.confidence, 1.0);
    ++placed.minors;
  }
  std::sort(placed.errors.begin(), placed.errors.end());
  return placed;
}

TEST(MinorLandmarks, AreExactOnTheTemplateItself) {
  const Template head = template_head();
  Mesh surface;
  surface.topology = head.topology;
  surface.positions = head.neutral;
  const Placed placed = placed_on(head, head.neutral, surface);
  EXPECT_EQ(placed.majors, 28);
  EXPECT_EQ(placed.minors, 144);
  // Maps and rays return the vertices themselves; some inner ones (lips' seam, nostrils) are hidden from every view.
  EXPECT_LT(placed.errors[placed.errors.size() * 9 / 10], 0.1);
}

TEST(MinorLandmarks, FollowTheMajorOnesOfAnotherPerson) {
  const Template head = template_head();
  Mesh surface;
  surface.topology = head.topology;
  surface.positions = someone_else(head.neutral);
  const Placed placed = placed_on(head, surface.positions, surface);
  ASSERT_EQ(placed.minors, 144);
  // Proportions differ by up to 8 mm; what 28 points leave open between them is a few millimetres along the skin.
  EXPECT_LT(placed.errors[72], 2.0);
  EXPECT_LT(placed.errors[130], 6.0);
}

TEST(MinorLandmarks, NeedEnoughKnownPoints) {
  const Template head = template_head();
  Mesh surface;
  surface.topology = head.topology;
  surface.positions = head.neutral;
  const ScanSurface scan(surface);
  ScanLandmarks few = {{"9.3", head.neutral.row(*landmark_vertex(head, "9.3")).transpose(), 1.0}};
  EXPECT_TRUE(place_minor_landmarks(head, few, scan).empty());
  EXPECT_FALSE(are_major_landmarks(head, few));
}

}  // namespace
}  // namespace vultus::registration
