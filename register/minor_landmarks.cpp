#include "register/minor_landmarks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "register/align.h"

namespace vultus::registration {
namespace {

constexpr int neighbours = 6;
constexpr double near = 12.0;         // mm: known points nearer than this count alike
constexpr double slack = 20.0;        // mm: spread of neighbours below which the common similarity has the say
constexpr double surrounded = 45.0;   // mm to the third nearest known point; farther out the map is a guess
constexpr double depth_limit = 30.0;  // mm along the view
constexpr double placed_confidence = 0.3, guessed_confidence = 0.05;

struct Known {
  Points on_template, on_scan;
  Similarity scan_from_template;
};

// The affine map of the nearest known points, as a correction of the common similarity.
struct Carried {
  Eigen::Vector3d place;
  double third_nearest;  // mm on the template
};

Carried carried(const Known& known, const Eigen::Vector3d& point) {
  const Eigen::VectorXd distance = (known.on_template.rowwise() - point.transpose()).rowwise().norm();
  std::vector<int> order(distance.size());
  for (int i = 0; i < static_cast<int>(order.size()); ++i) order[i] = i;
  const int count = std::min<int>(neighbours, static_cast<int>(order.size()));
  std::partial_sort(order.begin(), order.begin() + count, order.end(),
                    [&](int a, int b) { return distance[a] != distance[b] ? distance[a] < distance[b] : a < b; });
  double total = 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), shift = Eigen::Vector3d::Zero();
  std::vector<double> weights;
  std::vector<Eigen::Vector3d> places, errors;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d x = known.on_template.row(order[k]), y = known.on_scan.row(order[k]);
    weights.push_back(1.0 / (distance[order[k]] * distance[order[k]] + near * near));
    places.push_back(x);
    errors.push_back(y - known.scan_from_template * x);
    total += weights.back();
    middle += weights.back() * x;
    shift += weights.back() * errors.back();
  }
  middle /= total;
  shift /= total;
  Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d right = total * slack * slack * Eigen::Matrix3d::Identity();
  for (int k = 0; k < count; ++k) {
    left += weights[k] * (errors[k] - shift) * (places[k] - middle).transpose();
    right += weights[k] * (places[k] - middle) * (places[k] - middle).transpose();
  }
  const Eigen::Matrix3d linear = left * right.inverse();
  return {known.scan_from_template * point + shift + linear * (point - middle), distance[order[2]]};
}

// The view whose pictures show a place best: front or back, either side, top.
Eigen::Vector3d view_of(const Eigen::Vector3d& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return (normal[axis] < 0.0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis);
}

}  // namespace

bool are_major_landmarks(const Template& head, const ScanLandmarks& given) {
  int majors = 0, matched = 0;
  for (const Landmark& landmark : head.landmarks) {
    if (!landmark.major) continue;
    ++majors;
    matched += std::any_of(given.begin(), given.end(), [&](const auto& g) { return g.name == landmark.name; });
  }
  return majors >= 6 && 2 * matched > majors;
}

ScanLandmarks place_minor_landmarks(const Template& head, const ScanLandmarks& given, const ScanSurface& scan) {
  const LandmarkPairs pairs = pair_landmarks(head, given, true);
  if (pairs.size() < 6 || (pairs.confidence.array() > 0.05).count() < 6) return {};
  Known known{head.neutral(pairs.vertices, Eigen::all), pairs.scan, {}};
  known.scan_from_template =
      align_landmarks(known.on_template, known.on_scan, pairs.confidence, Scaling::free).scan_from_template;
  const Points normals = vertex_normals(*head.topology, head.neutral);
  std::set<int> taken(pairs.vertices.begin(), pairs.vertices.end());
  ScanLandmarks minor;
  for (const Landmark& landmark : head.landmarks) {
    if (landmark.vertex < 0 || !taken.insert(landmark.vertex).second) continue;
    const Eigen::Vector3d normal = normals.row(landmark.vertex);
    const auto [place, third_nearest] = carried(known, head.neutral.row(landmark.vertex).transpose());
    const Eigen::Matrix3d& turn = known.scan_from_template.rotation;
    const auto hit = scan.along(place, turn * view_of(normal), turn * normal, depth_limit, 0.2);
    minor.push_back({landmark.name, hit ? hit->position : place,
                     hit && third_nearest < surrounded ? placed_confidence : guessed_confidence, false});
  }
  return minor;
}

}  // namespace vultus::registration
