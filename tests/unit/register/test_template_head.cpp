#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "core/texture_space.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::registration {
namespace {

using Edge = std::pair<int, int>;

const Template& head() {
  static const Template made = template_head();
  return made;
}

const LoopSubdivision& smooth() {
  static const LoopSubdivision loop(head().topology, head().subdivisions);
  return loop;
}

const Points& smooth_neutral() {
  static const Points positions = smooth()(head().neutral);
  return positions;
}

Eigen::Vector3d at(const std::string& landmark) {
  return head().neutral.row(head().topology->landmarks().at(landmark));
}

std::set<Edge> directed_edges() {
  std::set<Edge> edges;
  const Triangles& t = head().topology->triangles();
  for (int f = 0; f < t.rows(); ++f)
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(edges.emplace(t(f, k), t(f, (k + 1) % 3)).second) << "triangle " << f;
  return edges;
}

// Zhu's generic head has 1,000–3,000 triangles.
TEST(TemplateHead, IsAControlMeshOfTrianglesForTwoSubdivisions) {
  const int triangles = static_cast<int>(head().topology->triangles().rows());
  EXPECT_GE(triangles, 1000);
  EXPECT_LE(triangles, 3000);
  EXPECT_EQ(triangles, head().topology->face_count());
  EXPECT_EQ(head().neutral.rows(), head().topology->vertex_count());
  EXPECT_EQ(head().subdivisions, 2);
  std::set<int> used;
  for (const int v : head().topology->data().corner_vertex) used.insert(v);
  EXPECT_EQ(static_cast<int>(used.size()), head().topology->vertex_count());
}

// Every edge is run through at most once each way, and the open ones form one closed loop for the neck, one behind each
// eye's lids and one around each row of teeth.
TEST(TemplateHead, IsManifoldAndOpenOnlyWhereItShouldBe) {
  const auto edges = directed_edges();
  std::map<int, int> next;
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) {
      EXPECT_TRUE(next.emplace(a, b).second) << "two boundaries meet at vertex " << a;
    }
  std::vector<int> lengths;
  while (!next.empty()) {
    int length = 0;
    for (int v = next.begin()->first; next.contains(v); ++length) {
      const int to = next.at(v);
      next.erase(v);
      v = to;
    }
    lengths.push_back(length);
  }
  std::sort(lengths.begin(), lengths.end());
  EXPECT_EQ(lengths, (std::vector<int>{16, 16, 28, 30, 30}));
}

TEST(TemplateHead, IsMirrorSymmetricToTheLastBit) {
  const auto mirror = template_mirror();
  for (int v = 0; v < head().neutral.rows(); ++v) {
    EXPECT_EQ(mirror[mirror[v]], v);
    EXPECT_EQ(head().neutral.row(mirror[v]),
              Eigen::RowVector3d(-head().neutral(v, 0), head().neutral(v, 1), head().neutral(v, 2)));
  }
  const auto edges = directed_edges();
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({mirror[b], mirror[a]}));
}

// Volume about a point inside: each closed part must have its own sign right, so they are checked one by one.
TEST(TemplateHead, FacesOutward) {
  const auto volume = [](const std::string& set) {
    std::vector<bool> member(head().neutral.rows(), false);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int v : head().topology->set(set)) {
      member[v] = true;
      middle += head().neutral.row(v).transpose() / static_cast<double>(head().topology->set(set).size());
    }
    double sum = 0.0;
    for (const auto& t : head().topology->triangles().rowwise()) {
      if (!member[t[0]] || !member[t[1]] || !member[t[2]]) continue;
      const Eigen::Vector3d a = head().neutral.row(t[0]).transpose() - middle,
                            b = head().neutral.row(t[1]).transpose() - middle,
                            c = head().neutral.row(t[2]).transpose() - middle;
      sum += a.dot(b.cross(c)) / 6.0;
    }
    return sum;
  };
  EXPECT_GT(volume("skin"), 3e6);  // a head holds 4–5 litres
  const double radius = eye_sphere_left().radius, ball = 4.0 / 3.0 * M_PI * radius * radius * radius;
  EXPECT_NEAR(volume("eyeball_left"), ball, 0.35 * ball);
  EXPECT_NEAR(volume("eyeball_right"), ball, 0.35 * ball);
}

// Published adult means (Farkas 1994): a few mm of latitude, since the template stands for everybody.
TEST(TemplateHead, HasAdultProportions) {
  EXPECT_NEAR((at("3.5") - at("3.6")).norm(), 63.0, 2.0);
  EXPECT_NEAR((at("3.7") - at("3.12")).norm(), 90.0, 4.0);
  EXPECT_NEAR(at("sellion").y() - at("2.1").y(), 115.0, 6.0);
  EXPECT_NEAR((at("8.3") - at("8.4")).norm(), 51.0, 5.0);
  EXPECT_NEAR((at("9.1") - at("9.2")).norm(), 35.0, 4.0);
  const Box box = bounds(smooth_neutral());
  EXPECT_NEAR(box.max.z() - box.min.z(), 205.0, 10.0);  // nose tip to occiput
  EXPECT_NEAR(0.5 * (at("3.7") + at("3.12")).y(), 0.0, 1.0);
}

TEST(TemplateHead, LipsAreSealedWithoutCrossingBeforeAndAfterSubdivision) {
  ASSERT_EQ(lip_seal().size(), 11u);
  for (const auto& [upper, lower] : lip_seal()) {
    for (const Points* p : {&head().neutral, &smooth_neutral()}) {
      const double gap = (*p)(upper, 1) - (*p)(lower, 1);
      EXPECT_GT(gap, -0.05) << upper;
      EXPECT_LT(gap, 0.6) << upper;
      EXPECT_LT((p->row(upper) - p->row(lower)).norm(), 0.8) << upper;
    }
  }
}

// The subdivided lid margins must lie on the eyeball's sphere or just outside, and leave the pupil free.
TEST(TemplateHead, LidsLieOnTheEyeballs) {
  for (const auto& pairs : {lid_seal_left(), lid_seal_right()}) {
    ASSERT_EQ(pairs.size(), 7u);
    const EyeSphere eye = smooth_neutral()(pairs[0].first, 0) > 0 ? eye_sphere_left() : eye_sphere_right();
    for (const auto& [upper, lower] : pairs) {
      EXPECT_GT(smooth_neutral()(upper, 1), smooth_neutral()(lower, 1));
      for (const int v : {upper, lower}) {
        const double clearance = (smooth_neutral().row(v).transpose() - eye.centre).norm() - eye.radius;
        EXPECT_GT(clearance, 0.2);
        EXPECT_LT(clearance, 3.5);
      }
    }
    EXPECT_GT(smooth_neutral()(pairs[3].first, 1), 2.5);
    EXPECT_LT(smooth_neutral()(pairs[3].second, 1), -2.5);
  }
  for (const int v : head().topology->set("eyeball_left"))
    EXPECT_NEAR((smooth_neutral().row(v).transpose() - eye_sphere_left().centre).norm(), eye_sphere_left().radius, 0.6);
}

TEST(TemplateHead, NoTexelIsCoveredTwiceAndNoChartIsFlipped) {
  const Topology& topology = *head().topology;
  EXPECT_GE(topology.uvs().minCoeff(), 0.0);
  EXPECT_LE(topology.uvs().maxCoeff(), 1.0);
  for (int f = 0; f < topology.face_count(); ++f) {
    const auto uv = topology.face_uv(f);
    const Eigen::Vector2d a = topology.uvs().row(uv[0]), b = topology.uvs().row(uv[1]), c = topology.uvs().row(uv[2]);
    EXPECT_GT((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(), 0.0) << "triangle " << f;
  }
  EXPECT_EQ(TextureSpace(head().topology, 2048, 2048).overlapping_texels(), 0);
  EXPECT_EQ(TextureSpace(smooth().refined(), 2048, 2048).overlapping_texels(), 0);
}

TEST(TemplateHead, NamesItsLandmarks) {
  EXPECT_EQ(head().landmarks.size(), 172u);
  std::set<std::string> names;
  std::set<int> vertices;
  int major = 0;
  for (const Landmark& l : head().landmarks) {
    EXPECT_TRUE(names.insert(l.name).second) << l.name;
    EXPECT_TRUE(vertices.insert(l.vertex).second) << l.name;
    EXPECT_EQ(head().topology->landmarks().at(l.name), l.vertex);
    major += l.major ? 1 : 0;
  }
  EXPECT_EQ(major, 28);
  // A feature point in MPEG-4's numbering for each part of the face, left of its twin.
  const std::pair<const char*, const char*> twins[] = {
      {"2.4", "2.5"}, {"3.5", "3.6"},  {"3.7", "3.12"}, {"3.11", "3.8"}, {"4.1", "4.2"},   {"5.1", "5.2"},
      {"8.3", "8.4"}, {"8.10", "8.9"}, {"9.1", "9.2"},  {"9.5", "9.4"},  {"10.1", "10.2"}, {"11.3", "11.2"}};
  for (const auto& [left, right] : twins) {
    EXPECT_GT(at(left).x(), 0.0) << left;
    EXPECT_EQ(template_mirror()[head().topology->landmarks().at(left)], head().topology->landmarks().at(right)) << left;
  }
  EXPECT_GT(at("3.7").x(), at("3.11").x());
  EXPECT_GT(at("8.1").y(), at("2.2").y());
  EXPECT_LT(at("8.2").y(), at("2.3").y());
  EXPECT_GT(at("11.4").y(), at("11.1").y());
  EXPECT_LT(at("11.6").z(), at("10.3").z());
}

TEST(TemplateHead, MapsThe68PointScheme) {
  ASSERT_TRUE(head().ibug68.has_value());
  const Ibug68& points = *head().ibug68;
  EXPECT_EQ(std::set<int>(points.begin(), points.end()).size(), 68u);
  const auto p = [&](int i) -> Eigen::Vector3d { return head().neutral.row(points[i]); };
  const auto mirror = template_mirror();
  const std::pair<int, int> twins[] = {{0, 16},  {4, 12},  {17, 26}, {21, 22}, {31, 35}, {36, 45}, {39, 42}, {37, 44},
                                       {41, 46}, {48, 54}, {50, 52}, {59, 55}, {60, 64}, {61, 63}, {67, 65}};
  for (const auto& [right, left] : twins) {
    EXPECT_LT(p(right).x(), 0.0) << right;
    EXPECT_EQ(mirror[points[right]], points[left]) << right;
  }
  for (int i = 0; i < 16; ++i) EXPECT_LT(p(i).x(), p(i + 1).x()) << i;
  for (int i = 27; i < 30; ++i) EXPECT_GT(p(i).y(), p(i + 1).y()) << i;
  for (int i = 22; i < 26; ++i) EXPECT_LT(p(i).x(), p(i + 1).x()) << i;
  EXPECT_GT(p(44).y(), p(46).y());
  EXPECT_GT(p(51).y(), p(62).y());
  EXPECT_GE(p(62).y(), p(66).y());
  EXPECT_GT(p(66).y(), p(57).y());
  EXPECT_GT(p(57).y(), p(8).y());
  // iBUG spaces the bridge's points evenly; the mesh has a vertex within 5 mm. Those below the nostrils lie inside the
  // middle between wing and midline.
  for (int i : {28, 29}) EXPECT_NEAR(p(i).y(), p(27).y() + (i - 27) / 3.0 * (p(30).y() - p(27).y()), 5.0) << i;
  EXPECT_LT(p(34).x(), 0.5 * p(35).x());
}

TEST(TemplateHead, NamesItsParts) {
  const Topology& topology = *head().topology;
  for (const char* name : {"face",
                           "back_of_head",
                           "rigid",
                           "neck",
                           "ears",
                           "ear_left",
                           "ear_right",
                           "lips",
                           "upper_lip",
                           "lower_lip",
                           "lids",
                           "upper_lid_left",
                           "upper_lid_right",
                           "lower_lid_left",
                           "lower_lid_right",
                           "eyeball_left",
                           "eyeball_right",
                           "inner_mouth",
                           "teeth",
                           "skin"})
    EXPECT_FALSE(topology.set(name).empty()) << name;
  std::set<int> face(topology.set("face").begin(), topology.set("face").end());
  for (const char* other : {"ears", "neck", "eyeballs", "inner_mouth", "back_of_head"})
    for (const int v : topology.set(other)) EXPECT_FALSE(face.contains(v)) << other << " " << v;
  for (const int v : topology.set("ear_left")) EXPECT_GT(head().neutral(v, 0), 0.0);
}

}  // namespace
}  // namespace vultus::registration
