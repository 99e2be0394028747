#include "register/template_head.h"

#include <algorithm>
#include <set>

#include "register/template_fair.h"
#include "register/template_landmarks.h"
#include "register/template_layout.h"
#include "register/template_shape.h"
#include "register/template_uv.h"

namespace vultus::registration {
namespace {

using layout::Ring;
using layout::Weave;

const Weave& head() {
  static const Weave whole = layout::mirrored(layout::left_half());
  return whole;
}

/// Builds named sets from rings of the left half.
class SetMaker {
 public:
  VertexSets sets;

  void left(const std::string& name, const Ring& ring) { add(name, ring, false); }
  void right(const std::string& name, const Ring& ring) { add(name, ring, true); }
  void both(const std::string& name, const Ring& ring) {
    left(name, ring);
    right(name, ring);
  }
  void sides(const std::string& name, const Ring& ring) {
    left(name + "_left", ring);
    right(name + "_right", ring);
  }
  void merge(const std::string& name, const std::vector<std::string>& parts) {
    for (const auto& part : parts) sets[name].insert(sets[name].end(), sets.at(part).begin(), sets.at(part).end());
  }
  VertexSets finished() {
    for (auto& [name, vertices] : sets) {
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    }
    return sets;
  }

 private:
  void add(const std::string& name, const Ring& ring, bool mirror) {
    for (const int v : ring)
      if (v >= 0) sets[name].push_back(mirror ? head().mirror[v] : v);
  }
};

Ring part(const Ring& ring, int first, int last) { return Ring(ring.begin() + first, ring.begin() + last + 1); }

void add_lips_and_lids(SetMaker& s, const Weave& w) {
  for (int r = 1; r <= 5; ++r) {
    s.both("upper_lip", part(w.mouth[r], 0, 5));
    s.both("lower_lip", part(w.mouth[r], 7, 12));
    s.both("lips", w.mouth[r]);
  }
  for (int r = 0; r <= 4; ++r) {
    s.sides("upper_lid", part(w.eye[r], 1, 7));
    s.sides("lower_lid", part(w.eye[r], 9, 15));
    s.both("lids", w.eye[r]);
  }
  for (int r = 1; r <= 2; ++r) s.sides("lid_margin", w.eye[r]);
}

void add_face(SetMaker& s, const Weave& w) {
  for (int r = 1; r <= 6; ++r) s.both("face", w.eye[r]);
  for (int r = 3; r <= 8; ++r) s.both("face", w.mouth[r]);
  for (const Ring& row : w.nose) s.both("face", row);
  for (const Ring& ring : w.face) s.both("face", ring);
  s.both("face", w.nostril);
  s.both("face", {w.columella});
}

void add_skull_and_neck(SetMaker& s, const Weave& w) {
  for (const Ring& row : w.throat) s.both("neck", row);
  for (int c = 0; c <= 2; ++c) s.both("neck", part(w.side[c], c == 0 ? 20 : 16, 24));
  for (int c = 3; c <= 8; ++c) s.both("neck", part(w.side[c], 10, 14));
  s.both("neck_boundary", w.throat[4]);
  for (int c = 0; c <= 8; ++c) s.both("neck_boundary", {w.side[c].back()});
  for (int c = 1; c <= 2; ++c) s.both("back_of_head", part(w.side[c], 0, 9));
  for (int c = 3; c <= 8; ++c) s.both("back_of_head", part(w.side[c], 0, 9));
  s.both("rigid", part(w.face[4], 0, 8));
  s.both("rigid", part(w.face[3], 0, 6));
  s.merge("rigid", {"back_of_head"});
  for (int r = 1; r <= 7; ++r) s.sides("ear", w.ear[r]);
}

void add_inside(SetMaker& s, const Weave& w) {
  for (const Ring& ring : w.eyeball) s.sides("eyeball", ring);
  for (int r = 0; r <= 2; ++r) s.sides("iris", w.eyeball[r]);
  s.both("mouth_cavity", w.mouth[0]);
  s.both("mouth_cavity", w.mouth_back);
  s.both("mouth_lining", w.mouth[1]);
  s.merge("mouth_lining", {"mouth_cavity"});
  for (int r = 0; r < 4; ++r) {
    s.both("teeth_upper", w.teeth_upper[r]);
    s.both("teeth_lower", w.teeth_lower[r]);
  }
}

VertexSets vertex_sets(const Weave& w) {
  SetMaker s;
  add_lips_and_lids(s, w);
  add_face(s, w);
  add_skull_and_neck(s, w);
  add_inside(s, w);
  s.merge("ears", {"ear_left", "ear_right"});
  s.merge("eyeballs", {"eyeball_left", "eyeball_right"});
  s.merge("teeth", {"teeth_upper", "teeth_lower"});
  s.merge("inner_mouth", {"mouth_cavity", "teeth"});
  s.merge("skin", {"face", "lids", "lips", "neck", "back_of_head", "ears"});
  s.both("nostrils", w.nostril_inner);
  s.both("nostrils", {w.nostril_centre});
  s.merge("skin", {"nostrils"});
  for (const Ring& column : w.side) s.both("skin", column);
  return s.finished();
}

Template make_template_head() {
  const Weave& w = head();
  Template result;
  result.name = "vultus-head";
  result.neutral = layout::loop_controls(w, layout::faired(w), 2);
  const layout::TextureLayout texture = layout::texture_layout(w, result.neutral);
  TopologyData data;
  data.vertex_count = static_cast<int>(w.position.size());
  for (std::size_t t = 0; t <= w.triangles.size(); ++t) data.face_offsets.push_back(static_cast<int>(3 * t));
  for (const auto& t : w.triangles) data.corner_vertex.insert(data.corner_vertex.end(), t.begin(), t.end());
  data.corner_uv = texture.corner;
  data.uvs = texture.uvs;
  data.sets = vertex_sets(w);
  result.landmarks = layout::landmarks(w);
  for (const Landmark& l : result.landmarks) data.landmarks[l.name] = l.vertex;
  result.ibug68 = layout::ibug68(w);
  result.topology = Topology::make(std::move(data));
  result.subdivisions = 2;
  return result;
}

VertexPairs lid_seal(bool right) {
  const Weave& w = head();
  VertexPairs pairs;
  for (int i = 1; i < 8; ++i) {
    const int upper = w.eye[2][i], lower = w.eye[2][16 - i];
    pairs.emplace_back(right ? w.mirror[upper] : upper, right ? w.mirror[lower] : lower);
  }
  return pairs;
}

}  // namespace

VertexPairs lip_seal() {
  const Weave& w = head();
  VertexPairs pairs;
  for (int i = 0; i < 6; ++i) {
    pairs.emplace_back(w.mouth[2][i], w.mouth[2][12 - i]);
    if (i > 0) pairs.emplace_back(w.mirror[w.mouth[2][i]], w.mirror[w.mouth[2][12 - i]]);
  }
  return pairs;
}

VertexPairs lid_seal_left() { return lid_seal(false); }
VertexPairs lid_seal_right() { return lid_seal(true); }

Template template_head() {
  static const Template made = [] {
    Template result = make_template_head();
    result.rims = {{"lips", lip_seal()}, {"left lids", lid_seal_left()}, {"right lids", lid_seal_right()}};
    return result;
  }();
  return made;
}

std::vector<int> template_mirror() { return head().mirror; }

EyeSphere eye_sphere_left() {
  const shape::Eyeball eye;
  return {eye.centre, eye.radius};
}

EyeSphere eye_sphere_right() {
  const shape::Eyeball eye;
  return {eye.centre.cwiseProduct(Eigen::Vector3d(-1, 1, 1)), eye.radius};
}

}  // namespace vultus::registration
