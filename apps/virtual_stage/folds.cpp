#include "apps/virtual_stage/folds.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

namespace vultus::virtual_stage {
namespace {

// A step of a fold's line: a landmark (left or midline) and the way from it, mm, +x outward.
struct Knot {
  const char* landmark;
  double x, y;
};

struct Line {
  std::vector<Knot> knots;
  double depth;  ///< mm at its fullest
  double width;  ///< of the valley, mm from its middle to where it is shallow
  std::vector<std::pair<Muscle, double>> drive;
  double always = 0.0;
};

using enum Muscle;

void add_forehead(std::vector<Line>& lines) {
  const std::initializer_list<std::pair<const char*, double>> rows = {
      {"forehead_low", 6}, {"forehead", 1}, {"forehead", 9}, {"forehead_high", 1}};
  int row = 0;
  for (const auto& [landmark, up] : rows) {
    const double wave = 0.7 * (row++ % 2 ? 1 : -1);
    lines.push_back({{{landmark, -6, up}, {landmark, 9, up + wave}, {landmark, 20, up + 1.0}, {landmark, 32, up}},
                     0.8,
                     1.7,
                     {{frontalis_inner, 1.0}},
                     0.05});
    lines.push_back({{{landmark, 10, up + wave}, {landmark, 22, up + 1.0}, {landmark, 34, up}, {landmark, 48, up - 4}},
                     0.8,
                     1.7,
                     {{frontalis_outer, 0.9}},
                     0.04});
  }
}

void add_brow(std::vector<Line>& lines) {
  lines.push_back({{{"4.1", -7.0, -8}, {"4.1", -7.5, 0}, {"4.1", -5.5, 9}},
                   1.0,
                   1.6,
                   {{corrugator, 1.0}, {brow_lowerer, 0.2}},
                   0.06});
  lines.push_back({{{"4.1", -1.5, 2}, {"4.1", -1.0, 9}}, 0.6, 1.3, {{corrugator, 0.8}}});
  lines.push_back(
      {{{"sellion", -1, 2.5}, {"sellion", 7, 3.5}}, 0.7, 1.6, {{brow_lowerer, 0.6}, {nose_wrinkler, 0.7}}, 0.05});
  lines.push_back(
      {{{"sellion", -1, -1.5}, {"sellion", 6.5, -0.5}}, 0.6, 1.2, {{brow_lowerer, 0.4}, {nose_wrinkler, 0.8}}});
  for (int i = 0; i < 3; ++i)
    lines.push_back({{{"9.7", -2.0 + 0.5 * i, -4.0 - 4.5 * i}, {"9.7", 4.5 + i, -9.0 - 4.5 * i}},
                     0.6,
                     1.1,
                     {{nose_wrinkler, 1.0}}});
}

void add_eye(std::vector<Line>& lines) {
  lines.push_back({{{"3.7", 5, 3}, {"3.7", 11, 6}, {"3.7", 17, 10}},
                   0.7,
                   1.1,
                   {{cheek_raiser, 0.9}, {zygomaticus, 0.15}, {lid_tightener, 0.2}},
                   0.05});
  lines.push_back({{{"3.7", 5.5, 0}, {"3.7", 12, 0}, {"3.7", 19, 1}},
                   0.8,
                   1.1,
                   {{cheek_raiser, 0.9}, {zygomaticus, 0.15}, {lid_tightener, 0.2}},
                   0.05});
  lines.push_back({{{"3.7", 5, -3}, {"3.7", 11, -6.5}, {"3.7", 17, -9.5}},
                   0.7,
                   1.1,
                   {{cheek_raiser, 1.0}, {zygomaticus, 0.15}},
                   0.05});
  lines.push_back({{{"orbit_lower_left", -14, 6},
                    {"orbit_lower_left", -7, 2.5},
                    {"orbit_lower_left", 3, 1.0},
                    {"orbit_lower_left", 12, 4}},
                   0.8,
                   1.5,
                   {{cheek_raiser, 0.8}, {lid_tightener, 0.4}},
                   0.12});
  lines.push_back({{{"3.9", -9, -3.5}, {"3.9", 0, -4.5}, {"3.9", 9, -3.0}},
                   0.5,
                   1.0,
                   {{lid_tightener, 0.8}, {cheek_raiser, 0.4}},
                   0.1});
}

void add_cheek(std::vector<Line>& lines) {
  lines.push_back(
      {{{"nose_crease_left", 1.5, 3},
        {"nose_crease_left", 4.5, -6},
        {"nasolabial_high_left", 5, -4},
        {"nasolabial_left", 3, -1},
        {"nasolabial_low_left", 4, 0},
        {"nasolabial_low_left", 3, -8}},
       1.0,
       2.8,
       {{zygomaticus, 0.8}, {upper_lip_raiser, 0.8}, {nose_wrinkler, 0.7}, {risorius, 0.4}, {cheek_raiser, 0.15}},
       0.10});
  lines.push_back({{{"nasolabial_left", 11, -1}, {"nasolabial_low_left", 10, 0}, {"nasolabial_low_left", 6, -9}},
                   0.8,
                   2.6,
                   {{zygomaticus, 0.6}, {risorius, 0.9}, {dimpler, 0.8}}});
  lines.push_back({{{"8.3", 3, -1}, {"8.3", 5, -9}, {"mouth_chin_left", 3, 0}, {"mouth_chin_left", 2, -8}},
                   0.75,
                   2.2,
                   {{anguli_depressor, 1.0}, {chin_raiser, 0.25}},
                   0.06});
}

void add_mouth(std::vector<Line>& lines) {
  lines.push_back({{{"labiomental", -12, 0}, {"labiomental", 0, 1}, {"labiomental", 10, 0}, {"labiomental", 22, -5}},
                   0.55,
                   2.4,
                   {{chin_raiser, 1.0}, {anguli_depressor, 0.3}},
                   0.05});
  const double at[] = {4.0, 9.0, 14.0, 19.0, 24.0};
  for (const double x : at) {
    const double lean = 0.25 * x, length = 6.0 + 2.0 * std::sin(1.7 * x);
    lines.push_back({{{"8.1", 0.75 * x, 1.0 - 0.12 * x}, {"8.1", 0.75 * x + 0.35 * lean, 1.0 + length - 0.1 * x}},
                     0.24,
                     1.2,
                     {{pucker, 1.0}, {lip_press, 0.25}}});
    lines.push_back({{{"8.2", 0.72 * x, -1.0 + 0.1 * x}, {"8.2", 0.72 * x + 0.35 * lean, -1.0 - 0.8 * length}},
                     0.18,
                     1.2,
                     {{pucker, 1.0}}});
  }
}

// Distance in mm from a point to a line of steps, and how far along it (0 … 1).
struct Nearness {
  double distance = 1e30, along = 0.0;
};

// Depth counts for less, since knots float in front of or behind the skin by some millimetres.
Nearness nearness(const Eigen::Vector3d& p, const std::vector<Eigen::Vector3d>& line) {
  Nearness best;
  const Eigen::Vector3d squash(1, 1, 0.35);
  const double steps = static_cast<double>(line.size() - 1);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Eigen::Vector3d a = line[i].cwiseProduct(squash), ab = (line[i + 1] - line[i]).cwiseProduct(squash);
    const double t = std::clamp((p.cwiseProduct(squash) - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    const double distance = (p.cwiseProduct(squash) - a - t * ab).norm();
    if (distance < best.distance) best = {distance, (static_cast<double>(i) + t) / steps};
  }
  return best;
}

// Catmull–Rom through the knots, four steps each, so that the fold has no corners.
std::vector<Eigen::Vector3d> curve(const std::vector<Eigen::Vector3d>& k) {
  std::vector<Eigen::Vector3d> points;
  const int n = static_cast<int>(k.size());
  for (int i = 0; i + 1 < n; ++i) {
    const Eigen::Vector3d a = k[std::max(i - 1, 0)], b = k[i], c = k[i + 1], d = k[std::min(i + 2, n - 1)];
    for (int s = 0; s < 4; ++s) {
      const double t = s / 4.0;
      points.push_back(
          0.5 * ((2 * b) + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t * t * t));
    }
  }
  points.push_back(k.back());
  return points;
}

// A valley with a soft bank on both sides: what goes in comes out beside it.
double profile(double distance, double width) {
  const double u = distance / width;
  return -std::exp(-u * u) + 0.26 * std::exp(-std::pow((u - 2.1) / 1.1, 2));
}

Fold fold_of(const Line& line, Side side, const FaceFeatures& face, const Points& fine, const Eigen::VectorXd& skin) {
  const double lateral = side == Side::left ? 1.0 : -1.0, s = face.scale;
  std::vector<Eigen::Vector3d> knots;
  for (const Knot& knot : line.knots)
    knots.push_back(face.at(knot.landmark, side) + s * Eigen::Vector3d(lateral * knot.x, knot.y, 0));
  const std::vector<Eigen::Vector3d> path = curve(knots);
  Eigen::Vector3d low = path[0], high = path[0];
  for (const Eigen::Vector3d& p : path) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Eigen::Vector3d margin = s * Eigen::Vector3d(5 * line.width, 5 * line.width, 14);
  low -= margin, high += margin;

  Fold fold;
  fold.drive = line.drive, fold.always = line.always, fold.side = side;
  std::vector<double> depth;
  for (Eigen::Index v = 0; v < fine.rows(); ++v) {
    const Eigen::Vector3d p = fine.row(v);
    if (skin[v] <= 0 || (p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
    const Nearness near = nearness(p, path);
    if (near.distance > 4.5 * line.width * s) continue;
    const double ends = smooth_step(0.0, 0.4, near.along) * smooth_step(0.0, 0.4, 1.0 - near.along);
    const double d = skin[v] * line.depth * s * ends * profile(near.distance / s, line.width);
    if (std::abs(d) < 1e-4) continue;
    fold.vertices.push_back(static_cast<int>(v));
    depth.push_back(d);
  }
  fold.depth = Eigen::Map<Eigen::VectorXd>(depth.data(), static_cast<Eigen::Index>(depth.size()));
  return fold;
}

}  // namespace

double Fold::strength(const Activations& activations) const {
  double sum = 0.0;
  for (const auto& [muscle, share] : drive) sum += share * std::max(0.0, activations[channel(muscle, side)]);
  // Skin bunches up only once it is pushed together somewhat.
  return always + (1.0 - always) * std::min(1.0, sum) * smooth_step(0.0, 0.5, sum);
}

std::vector<Fold> folds(const FaceFeatures& face, const Points& fine, const Eigen::VectorXd& skin) {
  std::vector<Line> lines;
  add_forehead(lines);
  add_brow(lines);
  add_eye(lines);
  add_cheek(lines);
  add_mouth(lines);
  std::vector<Fold> all;
  for (const Line& line : lines)
    for (const Side side : {Side::left, Side::right}) all.push_back(fold_of(line, side, face, fine, skin));
  return all;
}

}  // namespace vultus::virtual_stage
