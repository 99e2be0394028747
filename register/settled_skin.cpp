#include "register/settled_skin.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/neighbours.h"

namespace vultus::registration {
namespace {

enum class Place { on_scan, off_scan, without_data };

Place place_of(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, const ScanSurface& scan) {
  constexpr double noise = 0.25;        // mm: of scan and neutral together
  constexpr double least_cosine = 0.9;  // between normals
  const auto nearest = scan.rays().closest(point, 5.0);
  if (!nearest) return Place::off_scan;
  if (scan.on_border(nearest->place) || !scan.is_data(nearest->place)) return Place::without_data;
  const bool level = scan.normal_at(nearest->place).dot(normal) >= least_cosine;
  return level && std::abs((nearest->position - point).dot(normal)) <= noise ? Place::on_scan : Place::off_scan;
}

// How sure it is that skin at `point` has stayed, by the landmarks around it: 0 near one that has clearly moved.
double by_landmarks(const Eigen::Vector3d& point, const Points& rest, const Anchors& anchors) {
  constexpr double reach = 25.0;  // mm
  double sure = 1.0;
  for (int i = 0; i < anchors.size(); ++i) {
    const Eigen::Vector3d at = rest.row(anchors.vertices[i]);
    const double way = (anchors.targets.row(i).transpose() - at).norm() * std::sqrt(anchors.confidence[i]);
    const double moved = std::clamp((way - 1.5) / 2.0, 0.0, 1.0);  // a finder is 1 to 2 mm off
    sure = std::min(sure, 1.0 - moved * std::clamp(2.0 - (point - at).norm() / reach, 0.0, 1.0));
  }
  return sure;
}

}  // namespace

std::vector<PointTerm> settled_skin(const RefinedTemplate& model, const Points& rest, const Anchors& anchors,
                                    const ScanSurface& scan) {
  constexpr double reach = 15.0;  // mm from skin that has left the scan until skin is trusted in full
  const Points normals = vertex_normals(model.topology(), rest);
  std::vector<Place> places(rest.rows(), Place::without_data);
  std::vector<int> off;
  for (int v = 0; v < rest.rows(); ++v) {
    if (!model.fitted[v]) continue;
    places[v] = place_of(rest.row(v), normals.row(v), scan);
    if (places[v] == Place::off_scan) off.push_back(v);
  }
  std::optional<PointTree> left;
  if (!off.empty()) left.emplace(rest(off, Eigen::all));
  std::vector<PointTerm> terms;
  // Lips and chin slide along themselves with the jaw: lying on the scan tells nothing of them.
  for (int v : model.above_lips()) {
    if (places[v] != Place::on_scan) continue;
    const double distance = left ? left->nearest(rest.row(v), 1).front().distance : reach;
    const double sure =
        std::min(std::clamp((distance - 1.0) / reach, 0.0, 1.0), by_landmarks(rest.row(v), rest, anchors));
    if (sure > 0.0) terms.push_back({v, rest.row(v).transpose(), sure * sure});
  }
  return terms;
}

}  // namespace vultus::registration
