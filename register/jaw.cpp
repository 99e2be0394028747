#include "register/jaw.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace vultus::registration {
namespace {

struct Hinge {
  Eigen::Vector3d point, axis;  // axis from the subject's right to left
  Eigen::Vector3d turned(const Eigen::Vector3d& p, double angle) const {
    return point + Eigen::AngleAxisd(angle, axis) * (p - point);
  }
};

struct LipPull {
  Eigen::Vector3d from, to;
  double weight;
};

std::vector<int> chin_vertices(const Points& rest, const std::vector<bool>& fitted, const Eigen::Vector3d& chin,
                               double radius) {
  std::vector<int> vertices;
  for (int v = 0; v < rest.rows(); ++v)
    if (fitted[v] && (rest.row(v).transpose() - chin).norm() < radius) vertices.push_back(v);
  return vertices;
}

// Mean distance of the turned chin from the scan plus that of the turned lower lip from its landmarks, mm. The lip may
// well move on its own, hence counts less and never more than a few millimetres.
double mismatch(const Hinge& hinge, double angle, const Points& rest, const Points& normals,
                const std::vector<int>& chin, const std::vector<LipPull>& lip, const ScanSurface& scan) {
  const double limit = 8.0;
  double distance = 0.0;
  for (int v : chin) {
    const Eigen::Vector3d normal = Eigen::AngleAxisd(angle, hinge.axis) * Eigen::Vector3d(normals.row(v));
    const auto place = scan.nearest(hinge.turned(rest.row(v), angle), normal, limit, 0.5);
    distance += place ? place->distance : limit;
  }
  distance /= static_cast<double>(chin.size());
  double pull = 0.0, total = 0.0;
  for (const LipPull& point : lip) {
    pull += point.weight * std::min(20.0, (hinge.turned(point.from, angle) - point.to).norm());
    total += point.weight;
  }
  return distance + (total > 0.0 ? 0.3 * pull / total : 0.0);
}

}  // namespace

JawOpening find_jaw_opening(const Template& head, const Topology& topology, const Points& rest,
                            const std::vector<bool>& fitted, const Anchors& anchors, const ScanSurface& scan) {
  JawOpening opening;
  if (!head.ibug68) return opening;
  const Ibug68& ibug = *head.ibug68;
  for (int needed : {0, 1, 8, 15, 16})
    if (ibug[needed] < 0) return opening;
  auto point = [&](int i) -> Eigen::Vector3d { return rest.row(ibug[i]).transpose(); };
  const Eigen::Vector3d right = 0.5 * (point(0) + point(1)), left = 0.5 * (point(15) + point(16));
  const Hinge hinge{0.5 * (right + left), (left - right).normalized()};
  std::vector<LipPull> lip;
  for (int i = 0; i < anchors.size(); ++i)
    for (int outer : {56, 57, 58})
      if (anchors.names[i] == ibug_name(outer))
        lip.push_back(
            {rest.row(anchors.vertices[i]).transpose(), anchors.targets.row(i).transpose(), anchors.confidence[i]});
  const std::vector<int> chin = chin_vertices(rest, fitted, point(8), 28.0);
  if (chin.size() < 20) return opening;
  std::vector<int> sample;
  for (std::size_t i = 0; i < chin.size(); i += std::max<std::size_t>(1, chin.size() / 250)) sample.push_back(chin[i]);

  const Points normals = vertex_normals(topology, rest);
  const double step = M_PI / 180.0;
  double best = mismatch(hinge, 0.0, rest, normals, sample, lip, scan);
  for (int k = 1; k <= 40; ++k) {
    // A closed jaw is the usual case: the turn has to earn its place.
    const double cost = mismatch(hinge, k * step, rest, normals, sample, lip, scan) + 0.2;
    if (cost >= best) continue;
    best = cost;
    opening.angle = k * step;
  }
  if (opening.angle < 3.0 * step) return JawOpening{};
  const std::vector<int> core = chin_vertices(rest, fitted, point(8), 20.0);
  for (std::size_t i = 0; i < core.size(); i += std::max<std::size_t>(1, core.size() / 25))
    opening.terms.push_back({core[i], hinge.turned(rest.row(core[i]), opening.angle), 0.3});
  return opening;
}

}  // namespace vultus::registration
