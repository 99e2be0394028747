#include "register/lip_opening.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace vultus::registration {
namespace {

constexpr double step = 0.25;       // mm between rays
constexpr double reach = 3.0;       // mm beyond the outer lip points that a line goes on
constexpr double deep = 2.2;        // mm behind the lips' crests where the opening begins
constexpr double seam_width = 3.0;  // mm of what lies deep in a closed mouth's seam at most …
constexpr double seam_depth = 5.5;  // … and mm of its bottom behind the crests; beyond, the mouth is open
constexpr double sure = 0.7;        // confidence of a point on an edge or a seam

struct Column {
  int upper_outer, upper_inner, lower_inner, lower_outer;
};
constexpr std::array<Column, 3> columns = {{{50, 61, 67, 58}, {51, 62, 66, 57}, {52, 63, 65, 56}}};

std::optional<int> row_of(const Anchors& anchors, int ibug) {
  const auto place = std::find(anchors.names.begin(), anchors.names.end(), ibug_name(ibug));
  if (place == anchors.names.end()) return {};
  return static_cast<int>(place - anchors.names.begin());
}

std::optional<Eigen::Vector3d> mean_of(const Anchors& anchors, std::initializer_list<int> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i : points) {
    const auto row = row_of(anchors, i);
    if (!row) return {};
    sum += anchors.targets.row(*row).transpose();
  }
  return Eigen::Vector3d(sum / static_cast<double>(points.size()));
}

// Straight out of the mouth: across the line between its corners and the line from them to the nose's root.
std::optional<Eigen::Vector3d> front_of(const Anchors& anchors) {
  const auto right = mean_of(anchors, {48}), left = mean_of(anchors, {54});
  const auto eyes = mean_of(anchors, {27});
  if (!right || !left || !eyes) return {};
  const Eigen::Vector3d across = (*left - *right).normalized();
  Eigen::Vector3d up = *eyes - 0.5 * (*right + *left);
  up = (up - across * across.dot(up)).normalized();
  return across.cross(up);
}

// The surface along a line over the lips, seen from the front.
struct Profile {
  std::vector<std::optional<Eigen::Vector3d>> places;
  std::vector<double> heights;  // along the front, mm; far behind where nothing is seen
};

Profile profile_along(const RayScene& rays, const Eigen::Vector3d& front, const Eigen::Vector3d& top,
                      const Eigen::Vector3d& down, double length) {
  const Eigen::Vector3d start = top - reach * down;
  const int count = 1 + static_cast<int>((length + 2.0 * reach) / step);
  Profile profile;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d eye = start + i * step * down + 80.0 * front;
    const auto hit = rays.hit(eye, -front, 0.0, 200.0);
    profile.places.push_back(hit ? std::optional<Eigen::Vector3d>(eye - hit->distance * front) : std::nullopt);
    profile.heights.push_back(hit ? front.dot(*profile.places.back() - top) : -1e3);
  }
  return profile;
}

// What lies between the lips along one line: the edges of what is deep, and the bottom.
struct Furrow {
  Eigen::Vector3d upper, lower, bottom;
  bool seam;
};

// `middle` is a sample between the lips' crests.
std::optional<Furrow> furrow_in(const Profile& profile, int middle) {
  const auto& z = profile.heights;
  const int count = static_cast<int>(z.size());
  if (middle < 2 || middle > count - 3) return {};
  const int above = static_cast<int>(std::max_element(z.begin(), z.begin() + middle) - z.begin());
  const int below = static_cast<int>(std::max_element(z.begin() + middle, z.end()) - z.begin());
  const double crest = std::min(z[above], z[below]);
  const int lowest = static_cast<int>(std::min_element(z.begin() + above, z.begin() + below + 1) - z.begin());
  if (crest < -500.0 || crest - z[lowest] < 0.4) return {};  // no furrow between crests
  int first = lowest, last = lowest;
  while (first > above && z[first - 1] < crest - deep) --first;
  while (last < below && z[last + 1] < crest - deep) ++last;
  if (first <= above || last >= below || !profile.places[first - 1] || !profile.places[last + 1]) return {};
  const bool seam = (last - first) * step <= seam_width && crest - z[lowest] < seam_depth;
  return Furrow{*profile.places[first - 1], *profile.places[last + 1],
                profile.places[lowest].value_or(*profile.places[first - 1]), seam};
}

std::optional<Furrow> furrow_of(const Column& column, const Anchors& anchors, const RayScene& rays,
                                const Eigen::Vector3d& front) {
  const auto top = mean_of(anchors, {column.upper_outer}), bottom = mean_of(anchors, {column.lower_outer});
  if (!top || !bottom) return {};
  Eigen::Vector3d down = *bottom - *top;
  down -= front * front.dot(down);
  const double length = down.norm();
  if (length < 4.0) return {};
  down /= length;
  const auto inner = mean_of(anchors, {column.upper_inner, column.lower_inner});
  const double along = inner ? down.dot(*inner - *top) : 0.5 * length;
  const Profile profile = profile_along(rays, front, *top, down, length);
  return furrow_in(profile, static_cast<int>(std::lround((along + reach) / step)));
}

void set(const Template& head, int ibug, const Eigen::Vector3d& position, Anchors& anchors) {
  auto row = row_of(anchors, ibug);
  if (!row) {
    const auto vertex = landmark_vertex(head, ibug_name(ibug));
    if (!vertex || std::find(anchors.vertices.begin(), anchors.vertices.end(), *vertex) != anchors.vertices.end())
      return;
    row = anchors.size();
    anchors.add(ibug_name(ibug), *vertex, position, 0.0);
  }
  if (anchors.confidence[*row] >= 1.0) return;
  anchors.targets.row(*row) = position;
  anchors.confidence[*row] = std::max(anchors.confidence[*row], sure);
}

// Lips that touch: the pair as far apart as at rest, about its own middle, or about the seam where it had none.
void close(const Template& head, const Column& column, const Points& rest, const Eigen::Vector3d& seam,
           Anchors& anchors) {
  const int upper = (*head.ibug68)[column.upper_inner], lower = (*head.ibug68)[column.lower_inner];
  if (upper < 0 || lower < 0) return;
  const Eigen::Vector3d middle = mean_of(anchors, {column.upper_inner, column.lower_inner}).value_or(seam);
  const Eigen::Vector3d half = 0.5 * (rest.row(upper) - rest.row(lower)).transpose();
  set(head, column.upper_inner, middle + half, anchors);
  set(head, column.lower_inner, middle - half, anchors);
}

}  // namespace

Anchors with_inner_lips(const Template& head, Anchors anchors, const Points& rest, const RayScene& rays) {
  const auto front = front_of(anchors);
  if (!front || !head.ibug68) return anchors;
  std::array<std::optional<Furrow>, columns.size()> furrows;
  int seams = 0, openings = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    furrows[i] = furrow_of(columns[i], anchors, rays, *front);
    if (furrows[i]) ++(furrows[i]->seam ? seams : openings);
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!furrows[i]) continue;
    if (seams > openings) {
      close(head, columns[i], rest, furrows[i]->bottom, anchors);
      continue;
    }
    set(head, columns[i].upper_inner, furrows[i]->upper, anchors);
    set(head, columns[i].lower_inner, furrows[i]->lower, anchors);
  }
  return anchors;
}

}  // namespace vultus::registration
