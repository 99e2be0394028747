#include "register/mouth_gape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "register/face_axes.h"

namespace vultus::registration {
namespace {

constexpr double step = 0.25;      // mm between rays
constexpr double above = 8.0;      // mm over the upper lip's middle where a line starts
constexpr double below = 90.0;     // mm under it where it ends: a jaw opens by 60 and has a chin
constexpr double deep = 4.0;       // mm behind a lip's crest where the opening begins
constexpr double hollow = 6.0;     // mm that an opening's bottom lies behind both lips at least
constexpr double farthest = 15.0;  // mm that the upper lip's rim moves at most
constexpr double unseen = -1e3;

struct Edges {
  Eigen::Vector3d upper, lower;
  double width;
};

// The surface's height along a line, and where it lies.
struct Line {
  std::vector<double> heights;  // mm towards the front
  std::vector<Eigen::Vector3d> places;
};

Line look_along(const RayScene& rays, const Eigen::Vector3d& lip, const Eigen::Vector3d& up,
                const Eigen::Vector3d& front) {
  Line line;
  for (double down = -above; down <= below; down += step) {
    const Eigen::Vector3d eye = lip - down * up + 80.0 * front;
    const auto hit = rays.hit(eye, -front, 0.0, 200.0);
    line.heights.push_back(hit ? 80.0 - hit->distance : unseen);
    line.places.push_back(eye - (hit ? hit->distance : 0.0) * front);
  }
  return line;
}

// The bottom of the first hollow under the upper lip: what lies behind all that is seen above it and something below.
// Holes in the data farther down are no mouth.
std::optional<int> bottom_of(const std::vector<double>& heights) {
  const int count = static_cast<int>(heights.size());
  std::vector<double> over(heights), under(heights);
  for (int i = 1; i < count; ++i) over[i] = std::max(over[i - 1], heights[i]);
  for (int i = count - 2; i >= 0; --i) under[i] = std::max(under[i + 1], heights[i]);
  std::optional<int> bottom;
  for (int i = 0; i < count; ++i) {
    const bool inside = std::min(over[i], under[i]) - heights[i] > hollow;
    if (bottom && !inside) break;
    if (inside && (!bottom || heights[i] < heights[*bottom])) bottom = i;
  }
  return bottom;
}

std::optional<Edges> edges_on(const Line& line) {
  const std::vector<double>& heights = line.heights;
  const auto bottom = bottom_of(heights);
  if (!bottom) return {};
  const auto crest = std::max_element(heights.begin(), heights.begin() + *bottom);
  int upper = static_cast<int>(crest - heights.begin());
  while (upper + 1 < *bottom && heights[upper + 1] > *crest - deep) ++upper;
  // The lower lip is the first crest that the surface comes back to.
  const int count = static_cast<int>(heights.size());
  int lower = *bottom, lip = *bottom;
  for (int i = *bottom; i < count && heights[i] > heights[lip] - 1.5; ++i)
    if (heights[i] > heights[lip]) lip = i;
  if (heights[lip] <= unseen || heights[lip] - heights[*bottom] < hollow) return {};
  lower = lip;
  while (lower - 1 > upper && heights[lower - 1] > heights[lip] - deep) --lower;
  return Edges{line.places[upper], line.places[lower], (lower - upper) * step};
}

// The middle one of several lines side by side, by where their edges lie.
Eigen::Vector3d middle_of(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Eigen::Vector3d& point : points) values.push_back(point[k]);
    middle[k] = median(values);
  }
  return middle;
}

}  // namespace

std::optional<MouthGape> find_gape(const Template& head, const Points& rest, const RayScene& rays, double least) {
  if (!head.ibug68) return {};
  const Ibug68& ibug = *head.ibug68;
  for (int needed : {0, 8, 16, 27, 61, 62, 63})
    if (ibug[needed] < 0) return {};
  auto point = [&](int i) -> Eigen::Vector3d { return rest.row(ibug[i]).transpose(); };
  const FaceAxes axes = face_axes(point(16) - point(0), point(27) - point(8));

  MouthGape gape;
  for (int column = 0; column < 3; ++column) {
    const Eigen::Vector3d rim = point(61 + column);
    std::vector<Eigen::Vector3d> upper, lower;
    for (double aside : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
      const auto edges = edges_on(look_along(rays, rim + aside * axes.across, axes.up, axes.front));
      if (!edges || edges->width < least || (edges->upper - rim).norm() > farthest) continue;
      upper.push_back(edges->upper);
      lower.push_back(edges->lower);
    }
    if (upper.size() < 3) return {};
    gape.upper[column] = middle_of(upper);
    gape.lower[column] = middle_of(lower);
  }
  // A rim runs on from line to line.
  for (int column = 0; column < 2; ++column)
    if ((gape.lower[column + 1] - gape.lower[column]).norm() > 20.0) return {};
  return gape;
}

}  // namespace vultus::registration
