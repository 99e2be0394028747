#include "register/template_uv.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "register/convex_map.h"
#include "register/relaxed_map.h"

namespace vultus::registration::layout {
namespace {

using Corner = Eigen::Vector2d;

constexpr int seam_end_column = 4;  ///< the skin's seam runs up the back midline and ends there, on the crown

/// Collects charts into one layout.
class Sheet {
 public:
  explicit Sheet(std::size_t triangles) { layout_.corner.assign(3 * triangles, -1); }

  int add(const Corner& uv) {
    rows_.push_back(uv);
    return static_cast<int>(rows_.size()) - 1;
  }
  void corner(int triangle, int k, int row) { layout_.corner[3 * triangle + k] = row; }
  TextureLayout finished() {
    layout_.uvs.resize(static_cast<int>(rows_.size()), 2);
    for (std::size_t i = 0; i < rows_.size(); ++i) layout_.uvs.row(static_cast<int>(i)) = rows_[i];
    return layout_;
  }

 private:
  TextureLayout layout_;
  std::vector<Corner> rows_;
};

/// Outline of the skin's chart: a rounded rectangle, `turn` in quarter turns from the top, counter-clockwise.
Corner on_outline(double turn) {
  const double angle = (turn + 1.0) * M_PI / 2.0, c = std::cos(angle), s = std::sin(angle);
  const auto rounded = [](double x) { return std::copysign(std::pow(std::abs(x), 0.55), x); };
  return {0.5 + 0.485 * rounded(c), 0.595 + 0.39 * rounded(s)};
}

/// Places vertices first … last of a run along the outline by their distance along it.
void place_run(const Points& p, const Ring& run, double from, double to, std::vector<Corner>& uv) {
  std::vector<double> along = {0.0};
  for (std::size_t i = 1; i < run.size(); ++i)
    along.push_back(along.back() + (p.row(run[i]) - p.row(run[i - 1])).norm());
  for (std::size_t i = 0; i + 1 < run.size(); ++i)
    uv.push_back(on_outline(from + (to - from) * along[i] / along.back()));
}

/// The skin cut open: copies of seam vertices for the right half, and the chart's outline.
struct CutSkin {
  std::map<int, int> right_copy;
  Disc disc;
  std::vector<int> triangle;  ///< of the head, for each of the disc's
};

Ring both_sides(const Weave& w, Ring left_from_midline) {
  Ring whole;
  for (auto i = left_from_midline.rbegin(); i != left_from_midline.rend(); ++i) whole.push_back(w.mirror[*i]);
  whole.insert(whole.end(), left_from_midline.begin() + 1, left_from_midline.end());
  return whole;
}

/// Closed loop of a half mouth ring: over the left upper lip, the left corner, and back by the right.
Ring mouth_loop(const Weave& w, const Ring& half) {
  Ring loop = half;
  for (int i = static_cast<int>(half.size()) - 2; i > 0; --i) loop.push_back(w.mirror[half[i]]);
  return loop;
}

Ring mirrored_ring(const Weave& w, Ring ring) {
  for (int& v : ring) v = w.mirror[v];
  return ring;
}

void set_outline(const Weave& w, CutSkin& skin) {
  Ring crown, back;
  for (int c = seam_end_column; c < 9; ++c) crown.push_back(w.side[c][0]);
  back = w.side[8];
  Ring neck(w.throat[4].rbegin(), w.throat[4].rend());  // from the front midline to the left side
  for (int c = 1; c < 9; ++c) neck.push_back(w.side[c].back());
  const Points& p = skin.disc.positions;
  std::vector<Corner> uv;
  place_run(p, crown, 0.0, 0.5, uv);
  place_run(p, back, 0.5, 1.55, uv);
  Ring neck_back_to_front(neck.rbegin(), neck.rend());
  place_run(p, neck_back_to_front, 1.55, 2.0, uv);
  // Counter-clockwise from the top the outline first follows the right half.
  Ring half = crown;
  half.insert(half.end(), back.begin() + 1, back.end());
  half.insert(half.end(), neck_back_to_front.begin() + 1, neck_back_to_front.end());
  uv.push_back(on_outline(2.0));
  const int n = static_cast<int>(half.size());
  Disc& disc = skin.disc;
  disc.outline_uv.resize(2 * n - 2, 2);
  for (int i = 0; i < n; ++i) {
    const int v = half[i];
    disc.outline.push_back(skin.right_copy.contains(v) ? skin.right_copy.at(v) : w.mirror[v]);
    disc.outline_uv.row(i) = uv[i];
  }
  for (int i = n - 2; i > 0; --i) {
    disc.outline_uv.row(static_cast<int>(disc.outline.size())) = Corner(1.0 - uv[i].x(), uv[i].y());
    disc.outline.push_back(half[i]);
  }
}

/// Wished texture scale: 5 on the front of the face, falling to 1 behind the ears.
double wished_scale(const Eigen::Vector3d& p) {
  const double away = std::clamp((20.0 - p.z()) / 90.0, 0.0, 1.0);
  return 5.0 - 4.0 * away;
}

CutSkin cut_skin(const Weave& w, const Points& positions) {
  CutSkin skin;
  int count = static_cast<int>(positions.rows());
  for (const int v : w.side[8]) skin.right_copy[v] = count++;
  for (int c = seam_end_column + 1; c < 8; ++c) skin.right_copy[w.side[c][0]] = count++;
  skin.disc.positions.resize(count, 3);
  skin.disc.positions.topRows(positions.rows()) = positions;
  for (const auto& [v, copy] : skin.right_copy) skin.disc.positions.row(copy) = positions.row(v);
  const int half = static_cast<int>(w.triangles.size()) / 2;
  for (int t = 0; t < 2 * half; ++t) {
    if (w.patch[t] != Patch::skin) continue;
    std::array<int, 3> corners = w.triangles[t];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int& v : corners) {
      if (t >= half && skin.right_copy.contains(v)) v = skin.right_copy.at(v);
      middle += skin.disc.positions.row(v).transpose() / 3.0;
    }
    skin.disc.triangles.push_back(corners);
    skin.disc.importance.push_back(wished_scale(middle));
    skin.triangle.push_back(t);
  }
  skin.disc.holes = {w.eye[0], mirrored_ring(w, w.eye[0]), mouth_loop(w, w.mouth[1])};
  set_outline(w, skin);
  return skin;
}

/// Renumbers a disc's vertices to those it uses.
std::vector<int> compacted(Disc& disc) {
  std::map<int, int> fresh;
  std::vector<int> old;
  const auto renumber = [&](int& v) {
    const auto [at, inserted] = fresh.emplace(v, static_cast<int>(old.size()));
    if (inserted) old.push_back(v);
    v = at->second;
  };
  for (auto& t : disc.triangles)
    for (int& v : t) renumber(v);
  for (auto& hole : disc.holes)
    for (int& v : hole) renumber(v);
  for (int& v : disc.outline) renumber(v);
  Points used(static_cast<int>(old.size()), 3);
  for (std::size_t i = 0; i < old.size(); ++i) used.row(static_cast<int>(i)) = disc.positions.row(old[i]);
  disc.positions = used;
  return old;
}

void add_disc(Disc disc, const std::vector<int>& triangle_of, Sheet& sheet) {
  compacted(disc);
  const Uvs uv = relaxed_map(disc, convex_map(disc, 4), 400);
  std::vector<int> row;
  for (int v = 0; v < uv.rows(); ++v) row.push_back(sheet.add(uv.row(v)));
  for (std::size_t t = 0; t < disc.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) sheet.corner(triangle_of[t], k, row[disc.triangles[t][k]]);
}

/// A disc-shaped patch of one half (or, for the cavity, of both) inside a circle.
void add_round(const Weave& w, const Points& positions, const std::vector<int>& triangles, const Ring& outline,
               const Corner& centre, double radius, Sheet& sheet) {
  Disc disc;
  disc.positions = positions;
  for (const int t : triangles) disc.triangles.push_back(w.triangles[t]);
  disc.importance.assign(triangles.size(), 1.0);
  disc.outline = outline;
  const int n = static_cast<int>(outline.size());
  disc.outline_uv.resize(n, 2);
  // The first triangle edge along the outline tells which way round it is counter-clockwise.
  bool along = false;
  for (const auto& t : disc.triangles)
    for (int k = 0; k < 3; ++k) along = along || (t[k] == outline[0] && t[(k + 1) % 3] == outline[1]);
  for (int i = 0; i < n; ++i) {
    const double angle = (along ? 2.0 : -2.0) * M_PI * i / n;
    disc.outline_uv.row(i) = centre + radius * Corner(std::cos(angle), std::sin(angle));
  }
  add_disc(disc, triangles, sheet);
}

std::vector<int> triangles_of(const Weave& w, Patch patch, int side) {
  const int half = static_cast<int>(w.triangles.size()) / 2;
  std::vector<int> found;
  for (int t = 0; t < 2 * half; ++t)
    if (w.patch[t] == patch && (side < 0 || side == t / half)) found.push_back(t);
  return found;
}

void add_teeth(const Weave& w, bool upper, const Corner& low, const Corner& high, Sheet& sheet) {
  const auto& rows = upper ? w.teeth_upper : w.teeth_lower;
  std::map<int, int> row_of;
  for (int r = 0; r < 4; ++r) {
    const Ring row = both_sides(w, rows[r]);
    for (int i = 0; i < static_cast<int>(row.size()); ++i) {
      const double across = i / (static_cast<double>(row.size()) - 1.0), up = upper ? 1.0 - r / 3.0 : r / 3.0;
      row_of[row[i]] = sheet.add({low.x() + across * (high.x() - low.x()), low.y() + up * (high.y() - low.y())});
    }
  }
  for (const int t : triangles_of(w, upper ? Patch::teeth_upper : Patch::teeth_lower, -1))
    for (int k = 0; k < 3; ++k) sheet.corner(t, k, row_of.at(w.triangles[t][k]));
}

}  // namespace

TextureLayout texture_layout(const Weave& whole, const Points& positions) {
  Sheet sheet(whole.triangles.size());
  const CutSkin skin = cut_skin(whole, positions);
  add_disc(skin.disc, skin.triangle, sheet);
  for (const int side : {0, 1}) {
    const Ring rim = side == 0 ? whole.eyeball[4] : mirrored_ring(whole, whole.eyeball[4]);
    const double u = side == 0 ? 0.27 : 0.10;
    add_round(whole, positions, triangles_of(whole, Patch::eyeball_front, side), rim, {u, 0.095}, 0.08, sheet);
    add_round(whole, positions, triangles_of(whole, Patch::eyeball_back, side), rim, {0.41, side == 0 ? 0.14 : 0.05},
              0.04, sheet);
  }
  add_round(whole, positions, triangles_of(whole, Patch::mouth_cavity, -1), mouth_loop(whole, whole.mouth[1]),
            {0.55, 0.095}, 0.08, sheet);
  add_teeth(whole, true, {0.66, 0.11}, {0.98, 0.17}, sheet);
  add_teeth(whole, false, {0.66, 0.02}, {0.98, 0.08}, sheet);
  return sheet.finished();
}

}  // namespace vultus::registration::layout
