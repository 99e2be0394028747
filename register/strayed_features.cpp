#include "register/strayed_features.h"

#include "register/landmarks.h"

namespace vultus::registration {
namespace {

struct Feature {
  int first, last;  // of the 68-point scheme
  bool painted;     // told by colour alone
};
constexpr Feature features[] = {{17, 21, true}, {22, 26, true}, {36, 41, false}, {42, 47, false}};

std::vector<int> found_points(const Anchors& anchors, const Feature& feature) {
  std::vector<int> rows;
  for (int i = 0; i < anchors.size(); ++i) {
    const auto ibug = ibug_index(anchors.names[i]);
    if (ibug && *ibug >= feature.first && *ibug <= feature.last && anchors.confidence[i] < 1.0) rows.push_back(i);
  }
  return rows;
}

}  // namespace

std::vector<PointTerm> strayed_features(const Anchors& anchors, const Points& positions, bool coloured) {
  const double margin = coloured ? 1.0 : 2.5;  // mm: what the mean of a finder's points is off
  std::vector<PointTerm> terms;
  for (const Feature& feature : features) {
    if (feature.painted && !coloured) continue;
    const std::vector<int> rows = found_points(anchors, feature);
    if (rows.size() < 3) continue;
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    for (int i : rows)
      way +=
          (anchors.targets.row(i) - positions.row(anchors.vertices[i])).transpose() / static_cast<double>(rows.size());
    if (way.norm() <= margin) continue;
    way *= 1.0 - margin / way.norm();
    for (int i : rows)
      terms.push_back({anchors.vertices[i], positions.row(anchors.vertices[i]).transpose() + way, 1.0});
  }
  return terms;
}

}  // namespace vultus::registration
