#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/error.h"
#include "register/consistent.h"
#include "register/refined_template.h"
#include "register/scan_facts.h"
#include "scan/clean.h"
#include "scanned_head.h"

namespace vultus::registration {
namespace {

const test::ScannedHead& person() {
  static const test::ScannedHead one = test::scanned_head(1.05, 0.97, 3);
  return one;
}

// Zhu's chain, the quickest: verdicts do not depend on the method.
const Registration& registration() {
  static const Registration made = [] {
    RegisterOptions options;
    options.method = Method::zhu;
    return Registration(template_head(), options);
  }();
  return made;
}

Quality judged(const Mesh& raw, const ScanLandmarks& landmarks) {
  return registration().neutral(scan::clean_scan(raw), landmarks).quality;
}

bool says(const Quality& quality, const std::string& words) {
  for (const std::string& reason : quality.reasons)
    if (reason.find(words) != std::string::npos) return true;
  return false;
}

std::string told(const Quality& quality) {
  std::string text = verdict_name(quality.verdict);
  for (const std::string& reason : quality.reasons) text += "\n  " + reason;
  return text;
}

#define EXPECT_DOUBT(quality, words)                \
  do {                                              \
    const Quality found = (quality);                \
    EXPECT_NE(found.verdict, Verdict::pass);        \
    EXPECT_TRUE(says(found, words)) << told(found); \
  } while (false)

TEST(DamagedScans, TheTruthOnASoundScanPasses) {
  const ScanSurface scan(person().scan);
  const auto& topology = *person().loop.refined();
  const RefinedTemplate model(template_head());
  const Quality quality = judge(person().head, topology, model.fitted, model.neutral, person().truth, scan, {}, {}, {});
  EXPECT_EQ(quality.verdict, Verdict::pass) << told(quality);
  for (const char* region : {"face", "front", "lips", "eyes", "nose", "forehead", "chin", "ears", "left_half"})
    EXPECT_TRUE(quality.sets.contains(region)) << region;
  EXPECT_EQ(quality.crossing_triangles, 0);
}

TEST(DamagedScans, HalfAFace) {
  std::vector<bool> keep(person().scan.positions.rows());
  for (std::size_t v = 0; v < keep.size(); ++v) keep[v] = person().scan.positions(v, 0) > 0.0;
  const Quality quality = judged(sub_mesh(person().scan, keep).mesh, person().landmarks);
  EXPECT_DOUBT(quality, "of the face lies on data");
  EXPECT_LT(quality.sets.at("right_half").coverage, 0.4);  // what is left of it lies within 5 mm of the cut
  EXPECT_GT(quality.sets.at("left_half").coverage, 0.8);
}

// With nothing placed by hand too little of a face is refused, with what to do about it.
TEST(DamagedScans, AThirdOfAFaceWithoutLandmarks) {
  RegisterOptions options;
  options.method = Method::zhu;
  options.landmarks_by = LandmarkFinder::shape;
  Template head = template_head();
  head.subdivisions = 0;
  std::vector<bool> keep(person().scan.positions.rows());
  for (std::size_t v = 0; v < keep.size(); ++v) keep[v] = person().scan.positions(v, 0) > 35.0;
  try {
    Registration(head, options).neutral(scan::clean_scan(sub_mesh(person().scan, keep).mesh));
    FAIL() << "registered";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("by hand (landmarks/<pose>.json)"), std::string::npos) << error.what();
  }
}

TEST(DamagedScans, AnotherPersonsLandmarks) {
  ScanLandmarks landmarks = test::scanned_head(0.85, 1.15, 9).landmarks;
  for (ScanLandmark& landmark : landmarks) landmark.position.z() += 6.0;  // who never sits in quite the same place
  EXPECT_DOUBT(judged(person().scan, landmarks), "off the scan's surface");
}

TEST(DamagedScans, LandmarksUnderOtherNames) {
  ScanLandmarks landmarks = person().landmarks;
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    landmarks[i].position = person().landmarks[(i + 7) % landmarks.size()].position;
  EXPECT_DOUBT(judged(person().scan, landmarks), "do not form a face");
}

TEST(DamagedScans, UpsideDown) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Mesh scan = person().scan;
  scan.positions = (scan.positions * turn.transpose()).eval();
  ScanLandmarks landmarks = person().landmarks;
  for (ScanLandmark& landmark : landmarks) landmark.position = turn * landmark.position;
  EXPECT_DOUBT(judged(scan, landmarks), "upside down");
}

TEST(DamagedScans, InsideOut) {
  Triangles turned = person().scan.topology->triangles();
  turned.col(0).swap(turned.col(1));
  Mesh scan = person().scan;
  scan.topology = Topology::from_triangles(static_cast<int>(scan.positions.rows()), turned);
  const Quality repaired = judged(scan, person().landmarks);
  EXPECT_DOUBT(repaired, "inside out and has been turned");
  EXPECT_GT(repaired.sets.at("face").coverage, 0.9);
  EXPECT_DOUBT(registration().neutral(scan, person().landmarks).quality, "the scan is inside out");  // not cleaned
}

Mesh scaled(double factor) {
  Mesh scan = person().scan;
  scan.positions *= factor;
  return scan;
}

TEST(DamagedScans, OtherUnits) {
  for (const auto& [factor, unit] : {std::pair(1000.0, "micrometres"), std::pair(0.1, "cm"), std::pair(0.001, "m")})
    EXPECT_EQ(facts_of(scan::clean_scan(scaled(factor)).report).unit, unit);
  EXPECT_EQ(facts_of(scan::clean_scan(person().scan).report).unit, "");
  EXPECT_DOUBT(judged(scaled(1000.0), person().landmarks), "taken to be micrometres");
}

TEST(DamagedScans, TwoHeads) {
  const Mesh& one = person().scan;
  const int count = static_cast<int>(one.positions.rows());
  const Triangles& triangles = one.topology->triangles();
  Triangles both(2 * triangles.rows(), 3);
  both << triangles, (triangles.array() + count).matrix();
  Mesh scan;
  scan.topology = Topology::from_triangles(2 * count, both);
  scan.positions.resize(2 * count, 3);
  scan.positions << one.positions, (one.positions.rowwise() + Eigen::RowVector3d(260, 0, 0));
  EXPECT_DOUBT(judged(scan, person().landmarks), "2 heads");
}

TEST(DamagedScans, InventedTrianglesAreNoData) {
  scan::CleanScan clean = scan::clean_scan(person().scan);
  const Triangles& triangles = clean.mesh.topology->triangles();
  for (int t = 0; t < triangles.rows(); ++t) clean.invented[t] = clean.mesh.positions(triangles(t, 0), 0) < 0.0;
  const Quality quality = registration().neutral(clean, person().landmarks).quality;
  EXPECT_DOUBT(quality, "of the face lies on data");
  EXPECT_LT(quality.sets.at("right_half").coverage, 0.4);
}

}  // namespace
}  // namespace vultus::registration
