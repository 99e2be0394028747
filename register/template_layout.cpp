#include "register/template_layout.h"

#include <algorithm>
#include <cmath>

#include "register/template_curves.h"
#include "register/template_orient.h"
#include "register/template_shape.h"

namespace vultus::registration::layout {
namespace {

using shape::Curve;

class Weaver {
 public:
  Weave weave;

  int add(const Eigen::Vector3d& p, double hold, double set_back = 1.0) {
    weave.position.push_back(p);
    weave.hold.push_back(hold);
    weave.set_back.push_back(set_back);
    return static_cast<int>(weave.position.size()) - 1;
  }
  Ring add(const Curve& curve, double hold, double set_back = 1.0) {
    Ring ring;
    for (const auto& p : curve) ring.push_back(add(p, hold, set_back));
    return ring;
  }
  void triangle(int a, int b, int c) {
    if (a == b || b == c || c == a) return;
    weave.triangles.push_back({a, b, c});
    weave.patch.push_back(patch_);
  }
  void patch(Patch p) { patch_ = p; }

  /// Joins two rows of any lengths; the longer one's extra vertices are spread evenly.
  void strip(const Ring& a, const Ring& b) {
    const int n = static_cast<int>(a.size()) - 1, m = static_cast<int>(b.size()) - 1;
    for (int i = 0, j = 0; i < n || j < m;) {
      const bool step_a = j == m || (i < n && (2 * i + 1) * m <= (2 * j + 1) * n);
      triangle(a[i], b[j], step_a ? a[i + 1] : b[j + 1]);
      ++(step_a ? i : j);
    }
  }
  void closed_strip(Ring a, Ring b) {
    a.push_back(a.front());
    b.push_back(b.front());
    strip(a, b);
  }
  void fan(const Ring& ring, int centre) {
    for (std::size_t i = 0; i < ring.size(); ++i) triangle(ring[i], ring[(i + 1) % ring.size()], centre);
  }

 private:
  Patch patch_ = Patch::skin;
};

Ring slice(const Ring& ring, int first, int last) { return Ring(ring.begin() + first, ring.begin() + last + 1); }
Ring joined(Ring a, const Ring& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
Ring reversed(Ring ring) {
  std::reverse(ring.begin(), ring.end());
  return ring;
}

void weave_eye(Weaver& w) {
  static const double hold[] = {50, 50, 50, 20, 20, 2, 2};
  for (int r = 0; r < 7; ++r) w.weave.eye[r] = w.add(shape::eye_ring(r), hold[r]);
  for (int i = 9; i <= 14; ++i) w.weave.hold[w.weave.eye[6][i]] = 0.2;  // no bag where the cheek's rows end
  for (int r = 0; r < 6; ++r) w.closed_strip(w.weave.eye[r], w.weave.eye[r + 1]);
}

void weave_mouth(Weaver& w) {
  static const double hold[] = {20, 50, 50, 50, 20, 20, 8, 3, 4};
  static const double set_back[] = {0, 0, 0.2, 0, 1, 1, 1, 1, 1};  // no crossing of lips in the control mesh
  auto& mouth = w.weave.mouth;
  for (int r = 0; r < 9; ++r) mouth[r] = w.add(shape::mouth_ring(r), hold[r], set_back[r]);
  Curve back = shape::mouth_ring(0);
  for (auto& p : back) p = Eigen::Vector3d(0.75 * p.x(), -66.5 + 0.8 * (p.y() + 66.5), 0.25 * p.z() - 14.0);
  w.weave.mouth_back = w.add(back, 20, 0);
  for (int r = 1; r < 8; ++r) w.strip(mouth[r], mouth[r + 1]);
  w.patch(Patch::mouth_cavity);
  w.strip(mouth[0], mouth[1]);
  w.strip(w.weave.mouth_back, mouth[0]);
  w.strip(slice(w.weave.mouth_back, 0, 6), reversed(slice(w.weave.mouth_back, 6, 12)));
  w.patch(Patch::skin);
}

void weave_nose_ridge(Weaver& w) {
  auto& nose = w.weave.nose;
  const Ring& brow = w.weave.eye[6];
  for (int r = 0; r < 9; ++r) nose[r] = w.add(shape::nose_row(r), r < 5 ? 5 : 20);
  w.strip(joined(nose[1], {brow[2]}), joined(nose[2], {brow[1]}));
  w.strip(joined(nose[2], {brow[1]}), joined(nose[3], {brow[0]}));
  w.strip(joined(nose[3], {brow[0]}), joined(nose[4], {brow[15]}));
  w.strip(joined(nose[4], {brow[15]}), joined(nose[5], {brow[14]}));
  w.strip(joined(nose[5], {brow[14]}), nose[6]);
  w.strip(nose[6], nose[7]);
  w.strip(nose[7], nose[8]);
}

void weave_nose_base(Weaver& w) {
  auto& nose = w.weave.nose;
  const Ring& lip = w.weave.mouth[8];
  const Curve rim = shape::nostril();
  w.weave.nostril = w.add(rim, 20);
  w.weave.columella = w.add(shape::columella(), 20);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& p : rim) middle += p / static_cast<double>(rim.size());
  Curve inner;
  for (const auto& p : rim) inner.push_back(middle + 0.72 * (p - middle) + Eigen::Vector3d(0.3, 4.5, -1.0));
  w.weave.nostril_inner = w.add(inner, 20);
  w.weave.nostril_centre = w.add(middle + Eigen::Vector3d(0.4, 8.0, -2.0), 20);
  const Ring& n = w.weave.nostril;
  w.triangle(nose[8][0], nose[8][1], n[0]);
  w.strip({nose[8][0], w.weave.columella, lip[0]}, {n[0], n[1], n[2]});
  w.strip({lip[0], lip[1], lip[2], lip[3]}, {n[2], n[3], n[4]});
  w.strip({nose[8][1], nose[8][2], nose[8][3], lip[3]}, {n[0], n[6], n[5], n[4]});
  w.closed_strip(n, w.weave.nostril_inner);
  w.fan(w.weave.nostril_inner, w.weave.nostril_centre);
  w.triangle(nose[8][3], nose[8][4], lip[3]);
  w.triangle(nose[8][4], lip[4], lip[3]);
}

/// Ring 0 of the face joins brow, cheek and chin; the outline and the ring half way are placed by hand.
void weave_face(Weaver& w) {
  auto& face = w.weave.face;
  const Ring &brow = w.weave.eye[6], &lip = w.weave.mouth[8];
  const auto& nose = w.weave.nose;
  const Ring cheek = joined({brow[13]}, w.add(shape::cheek_strip(), 3));
  w.strip(joined({brow[14], nose[6][4], nose[7][4], nose[8][4]}, slice(lip, 4, 12)), cheek);
  face[0] = joined(joined(nose[0], slice(brow, 3, 12)), cheek);
  face[0].insert(face[0].begin() + 2, w.add(Eigen::Vector3d(13.5, 18.0, 30.0), 2));
  w.strip(slice(face[0], 0, 3), joined(nose[1], {brow[2]}));
  const Curve middle = shape::face_ring(1), outline = shape::face_ring(2);
  Curve between;
  for (int i = 0; i < shape::face_count; ++i)
    between.push_back(shape::through({{0, w.weave.position[face[0][i]]}, {2, middle[i]}, {4, outline[i]}}, 5)[3]);
  face[1] = w.add(shape::face_ring(0), 3);
  for (int i = 10; i <= 19; ++i) w.weave.hold[face[1][i]] = 0.6;
  face[2] = w.add(middle, 0.4);
  face[3] = w.add(between, 0.05);
  face[4] = w.add(outline, 2);
  for (int r = 0; r < 4; ++r) w.strip(face[r], face[r + 1]);
}

void weave_neck_and_skull(Weaver& w) {
  auto& throat = w.weave.throat;
  auto& side = w.weave.side;
  const Ring jaw = slice(w.weave.face[4], shape::throat_first, shape::face_count - 1);
  for (int r = 0; r < 5; ++r) throat[r] = w.add(shape::throat_row(r), r == 4 ? 5 : 1.5);
  w.strip(jaw, throat[0]);
  for (int r = 0; r < 4; ++r) w.strip(throat[r], throat[r + 1]);
  side[0] = slice(w.weave.face[4], 0, shape::throat_first);
  for (const Ring& row : throat) side[0].push_back(row.front());
  for (int c = 1; c < 9; ++c) {
    const Curve column = shape::side_column(c);
    for (int r = 0; r < static_cast<int>(column.size()); ++r) {
      const bool in_ear = c == 1 && r > 10 && r < 14, at_end = r == 0 || r + 1 == static_cast<int>(column.size());
      side[c].push_back(in_ear ? -1 : w.add(column[r], at_end ? 5 : c == 8 ? 2 : 0.5));
    }
  }
  for (int c = 0; c < 2; ++c) {
    w.strip(slice(side[c], 0, 10), slice(side[c + 1], 0, 10));
    w.strip(slice(side[c], 14, 24), slice(side[c + 1], 14, 24));
  }
  w.strip(slice(side[2], 0, 10), slice(side[3], 0, 6));
  w.strip(slice(side[2], 10, 15), slice(side[3], 6, 9));
  w.strip(slice(side[2], 15, 24), slice(side[3], 9, 14));
  for (int c = 3; c < 8; ++c) w.strip(side[c], side[c + 1]);
}

void weave_ear(Weaver& w) {
  auto& ear = w.weave.ear;
  auto& side = w.weave.side;
  ear[0] = joined(slice(side[0], 10, 14), joined({side[1][14]}, reversed(slice(side[2], 10, 14))));
  ear[0].push_back(side[1][10]);
  for (int r = 1; r < 8; ++r) ear[r] = w.add(shape::ear_ring(r), 10);
  for (int r = 0; r < 6; ++r) w.closed_strip(ear[r], ear[r + 1]);
  w.fan(ear[6], ear[7][0]);
}

void weave_eyeball(Weaver& w) {
  static const double angles[] = {0, 13, 28, 50, 80, 115, 180};
  const shape::Eyeball eye;
  auto& ball = w.weave.eyeball;
  for (int r = 0; r < 7; ++r) {
    const double polar = angles[r] * M_PI / 180.0;
    for (int i = 0; i < (r == 0 || r == 6 ? 1 : 12); ++i) {
      const double a = 2.0 * M_PI * i / 12.0;
      const Eigen::Vector3d d(std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar));
      ball[r].push_back(w.add(eye.centre + eye.radius * d, 1e3));
    }
  }
  w.patch(Patch::eyeball_front);
  w.fan(ball[1], ball[0][0]);
  for (int r = 1; r < 4; ++r) w.closed_strip(ball[r], ball[r + 1]);
  w.patch(Patch::eyeball_back);
  w.closed_strip(ball[4], ball[5]);
  w.fan(ball[5], ball[6][0]);
}

void weave_teeth(Weaver& w) {
  for (const bool upper : {true, false}) {
    auto& rows = upper ? w.weave.teeth_upper : w.weave.teeth_lower;
    w.patch(upper ? Patch::teeth_upper : Patch::teeth_lower);
    for (int r = 0; r < 4; ++r) rows[r] = w.add(shape::tooth_row(upper, r), 1e3, 0);
    for (int r = 0; r < 3; ++r) w.strip(rows[r], rows[r + 1]);
  }
}

}  // namespace

Weave left_half() {
  Weaver w;
  weave_eye(w);
  weave_mouth(w);
  weave_nose_ridge(w);
  weave_nose_base(w);
  weave_face(w);
  weave_neck_and_skull(w);
  weave_ear(w);
  weave_eyeball(w);
  weave_teeth(w);
  orient_outward(w.weave);
  return w.weave;
}

Weave mirrored(const Weave& left) {
  Weave whole = left;
  const int half = static_cast<int>(left.position.size());
  whole.mirror.resize(half);
  for (int v = 0; v < half; ++v) {
    if (left.position[v].x() == 0.0) {
      whole.mirror[v] = v;
      continue;
    }
    whole.mirror[v] = static_cast<int>(whole.position.size());
    whole.mirror.push_back(v);
    whole.position.push_back(left.position[v].cwiseProduct(Eigen::Vector3d(-1, 1, 1)));
    whole.hold.push_back(left.hold[v]);
    whole.set_back.push_back(left.set_back[v]);
  }
  for (std::size_t t = 0; t < left.triangles.size(); ++t) {
    const auto& [a, b, c] = left.triangles[t];
    whole.triangles.push_back({whole.mirror[a], whole.mirror[c], whole.mirror[b]});
    whole.patch.push_back(left.patch[t]);
  }
  return whole;
}

}  // namespace vultus::registration::layout
