#include "register/anchors.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "register/align.h"

namespace vultus::registration {
namespace {

std::map<std::string, Eigen::Vector3d> pictured_by_name(const ScanLandmarks& landmarks) {
  std::map<std::string, Eigen::Vector3d> map;
  for (const ScanLandmark& landmark : landmarks)
    if (landmark.pictured) map[landmark.name] = landmark.position;
  return map;
}

// Each target becomes its vertex, moved as the sightings of it moved from template to scan.
void cancel_bias(const Points& vertices, const ScanLandmarks& seen_template, const std::vector<bool>& pictured,
                 Anchors& anchors) {
  const auto seen = pictured_by_name(seen_template);
  std::vector<int> shared;
  for (int i = 0; i < anchors.size(); ++i)
    if (pictured[i] && seen.contains(anchors.names[i])) shared.push_back(i);
  if (shared.size() < 8) return;
  Points sightings(shared.size(), 3);
  for (std::size_t k = 0; k < shared.size(); ++k) sightings.row(k) = seen.at(anchors.names[shared[k]]);
  const Alignment alignment =
      align_landmarks(sightings, anchors.targets(shared, Eigen::all), anchors.confidence(shared), Scaling::free);
  const Similarity& turn = alignment.scan_from_template;
  for (std::size_t k = 0; k < shared.size(); ++k) {
    const int i = shared[k];
    const Eigen::Vector3d bias = (vertices.row(anchors.vertices[i]) - sightings.row(k)).transpose();
    // A mouth seen open is another picture than a closed one: what has moved far has a bias of its own.
    const double moved = (turn * Eigen::Vector3d(sightings.row(k)) - anchors.targets.row(i).transpose()).norm();
    const double alike = std::exp(-std::pow(moved / 12.0, 2));
    anchors.targets.row(i) += alike * (turn.scale * (turn.rotation * bias)).transpose();
  }
}

// How far skin at a landmark can move against the skull, mm. A finder that takes brows for closed eyes is off by more.
double farthest_motion(int ibug) {
  if (ibug < 27) return ibug < 17 ? 45.0 : 15.0;                                            // jaw; brows
  if (ibug < 36) return ibug < 31 ? 4.0 : 8.0;                                              // nose ridge; nostrils
  if (ibug < 48) return ibug == 36 || ibug == 39 || ibug == 42 || ibug == 45 ? 5.0 : 12.0;  // eye corners; lids
  if (ibug >= 50 && ibug <= 52) return 13.0;                                                // middle of the upper lip
  return 45.0;
}

// Features whose points a picture gets wrong together: an eye, the mouth; −1 for any other point.
int feature_of(int ibug) { return ibug < 36 ? -1 : ibug < 42 ? 0 : ibug < 48 ? 1 : 2; }

// One wrong corner tells of a brow taken for an eye, two wrong points of the upper lip of nostrils taken for a mouth.
int telling(int ibug) {
  const bool corner = ibug == 36 || ibug == 39 || ibug == 42 || ibug == 45;
  return corner ? 2 : ibug >= 50 && ibug <= 52 ? 1 : 0;
}

}  // namespace

Anchors Anchors::at(const std::vector<int>& rows) const {
  Anchors some{{}, {}, targets(rows, Eigen::all), confidence(rows)};
  for (int i : rows) {
    some.names.push_back(names[i]);
    some.vertices.push_back(vertices[i]);
  }
  return some;
}

void Anchors::add(const std::string& name, int vertex, const Eigen::Vector3d& target, double sureness) {
  const int row = size();
  names.push_back(name);
  vertices.push_back(vertex);
  targets.conservativeResize(row + 1, 3);
  confidence.conservativeResize(row + 1);
  targets.row(row) = target;
  confidence[row] = sureness;
}

double unit_correction(double outer_eye_distance) {
  const double least = 65.0, most = 125.0;
  if (!(outer_eye_distance > 0.0)) return 1.0;
  for (double factor : {1.0, 10.0, 0.1, 1000.0, 0.001, 25.4, 1.0 / 25.4, 100.0, 0.01, 2.54, 1.0 / 2.54})
    if (factor * outer_eye_distance >= least && factor * outer_eye_distance <= most) return factor;
  return 1.0;
}

Anchors make_anchors(const Template& head, const Points& vertices, const ScanLandmarks& scan,
                     const ScanLandmarks* seen_template, double least_confidence, bool chin) {
  ScanLandmarks trusted;
  for (const ScanLandmark& landmark : scan)
    if (landmark.confidence >= least_confidence) trusted.push_back(landmark);
  LandmarkPairs pairs = pair_landmarks(head, trusted, chin);
  Anchors anchors{std::move(pairs.names), std::move(pairs.vertices), std::move(pairs.scan),
                  std::move(pairs.confidence)};
  if (seen_template) cancel_bias(vertices, *seen_template, pairs.pictured, anchors);
  return anchors;
}

Anchors plausible_anchors(const Anchors& anchors, const Points& rest) {
  int doubts[3] = {0, 0, 0};
  std::vector<bool> keep(anchors.size(), true);
  for (int i = 0; i < anchors.size(); ++i) {
    const auto ibug = ibug_index(anchors.names[i]);
    if (!ibug || anchors.confidence[i] >= 1.0) continue;
    keep[i] = (rest.row(anchors.vertices[i]) - anchors.targets.row(i)).norm() <= farthest_motion(*ibug);
    if (!keep[i] && feature_of(*ibug) >= 0) doubts[feature_of(*ibug)] += telling(*ibug);
  }
  std::vector<int> rows;
  for (int i = 0; i < anchors.size(); ++i) {
    const auto ibug = ibug_index(anchors.names[i]);
    const int feature = ibug ? feature_of(*ibug) : -1;
    const bool given = anchors.confidence[i] >= 1.0;
    if (given || (keep[i] && (feature < 0 || doubts[feature] < 2))) rows.push_back(i);
  }
  return anchors.at(rows);
}

ScanLandmarks overridden(ScanLandmarks found, const ScanLandmarks& given) {
  for (const ScanLandmark& point : given) {
    const auto same = [&](const ScanLandmark& other) { return other.name == point.name; };
    const auto place = std::find_if(found.begin(), found.end(), same);
    if (place == found.end())
      found.push_back(point);
    else
      *place = point;
  }
  return found;
}

}  // namespace vultus::registration
