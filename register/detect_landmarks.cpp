#include "register/detect_landmarks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/statistics.h"
#include "register/face_search.h"

namespace vultus::registration {
namespace {

// Finer pictures show the scan's noise rather than more of the face: points then scatter more.
constexpr int close_pixels = 320;

// Weiszfeld's geometric median, weighted: one view's mistake cannot pull it far.
Eigen::Vector3d robust_mean(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& weights,
                            double scale) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    centre += weights[i] * points[i];
    total += weights[i];
  }
  centre /= total;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weight = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double w = weights[i] / std::max(0.1 * scale, (points[i] - centre).norm());
      sum += w * points[i];
      weight += w;
    }
    centre = sum / weight;
  }
  return centre;
}

// What a point is worth however well the views agree: brows and contour are colour and outline rather than shape.
double worth(int point, bool coloured) {
  if (is_contour(point)) return point >= 7 && point <= 9 ? 0.4 : 0.1;
  if (point < 27) return coloured ? 0.6 : 0.25;
  return coloured ? 0.9 : 0.8;
}

void agree(const std::vector<std::vector<FaceView>>& views, double eye_distance, DetectedLandmarks& result) {
  const double tolerance = 0.05 * eye_distance;  // some 3 mm on a head
  std::vector<double> spreads;
  for (int i = 0; i < 68; ++i) {
    std::vector<Eigen::Vector3d> points;
    std::vector<double> weights;
    for (const auto& view : views)
      if (!view.empty() && view.front().points[i]) {
        points.push_back(*view.front().points[i]);
        weights.push_back(view.front().facing[i] * view.front().facing[i]);
      }
    if (static_cast<int>(points.size()) < std::max(1, result.views / 4)) continue;
    const Eigen::Vector3d centre = robust_mean(points, weights, tolerance);
    std::vector<double> distances;
    for (const auto& point : points) distances.push_back((point - centre).norm());
    const double spread = median(distances);
    const double seen = static_cast<double>(points.size()) / result.views;
    const double confidence = worth(i, result.coloured) * std::sqrt(seen) / (1.0 + std::pow(spread / tolerance, 2));
    result.points.push_back({ibug_name(i), centre, confidence, true});
    spreads.push_back(spread);
  }
  result.spread = Eigen::Map<Eigen::VectorXd>(spreads.data(), static_cast<Eigen::Index>(spreads.size()));
}

std::string describe(const Eigen::Vector3d& axis) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", axis.x(), axis.y(), axis.z());
  return text;
}

std::vector<Shot> fan(const FacePlace& place) {
  std::vector<Shot> shots;
  for (double pitch : {-10.0, 0.0, 10.0})
    for (double yaw : {-20.0, -10.0, 0.0, 10.0, 20.0})
      for (const Eigen::Vector3d& light : {light_from_above, light_from_front})
        shots.push_back({turned(place.frame, yaw, pitch, 0.0), place.target, light});
  return shots;
}

}  // namespace

DetectedLandmarks detect_landmarks(const Mesh& scan, const FaceFinder& finder) {
  const ScanPictures pictures(scan);
  const FaceSearch found = search_face(pictures, finder);
  const FacePlace& place = found.place;
  const std::vector<Shot> shots = fan(place);
  const auto views = look(pictures, finder, shots, close_pixels, -0.2);

  DetectedLandmarks result;
  result.scan_from_face = place.frame;
  result.coloured = pictures.coloured();
  for (const auto& view : views)
    if (!view.empty()) {
      ++result.views;
      result.score += view.front().face.score;
    }
  if (result.views == 0)
    throw InputError("a face was seen in the scan but could not be followed around; place landmarks by hand");
  result.score /= result.views;
  // Faces reach 1 to 3 from all around; half a face, hair and hollow shells that pass for one stay below.
  if (result.score < 0.5) {
    char text[96];
    std::snprintf(text, sizeof text, "what was taken for the face hardly looks like one (score %.2f)", result.score);
    result.doubts.push_back(text);
  }
  result.agreement = static_cast<double>(result.views) / static_cast<double>(shots.size());
  result.other_faces = static_cast<int>(found.others.size());
  agree(views, place.eye_distance, result);
  result.outer_eye_distance = distance_between(result.points, ibug_name(36), ibug_name(45));
  result.decisions.push_back("face found " + found.how + ": front " + describe(place.frame.col(2)) + ", up " +
                             describe(place.frame.col(1)) + ", " + std::to_string(result.views) + " of " +
                             std::to_string(shots.size()) + " views agree");
  if (result.other_faces > 0)
    result.decisions.push_back(std::to_string(1 + result.other_faces) +
                               " faces in the scan; the one that was seen most clearly is taken, cut the others away");
  return result;
}

}  // namespace vultus::registration
