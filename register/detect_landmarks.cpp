#include "register/detect_landmarks.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "register/shaded_view.h"

namespace vultus::registration {
namespace {

using Frame = Eigen::Matrix3d;  // columns: face's right-to-left (x), up (y), front (z) axes in the scan

constexpr int search_pixels = 320;
constexpr int close_pixels = 400;
const Eigen::Vector3d light_from_above(0.0, -0.6, -1.0);
const Eigen::Vector3d light_from_front(0.25, -0.25, -1.0);

struct Target {
  Eigen::Vector3d centre;
  double radius;  // of what should fill the picture
};

Camera camera_for(const Frame& frame, const Target& target, int pixels) {
  const double field = 0.35;  // radians: near enough to parallel that features do not hide one another
  const double distance = target.radius / std::tan(0.5 * field);
  const Eigen::Vector3d eye = target.centre + distance * frame.col(2);
  return Camera::look_at(eye, target.centre, frame.col(1), field, pixels, pixels);
}

Frame turned(const Frame& frame, double yaw, double pitch, double roll) {
  const auto degrees = [](double d) { return d * M_PI / 180.0; };
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(degrees(yaw), Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(degrees(pitch), Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(degrees(roll), Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  return frame * turn;
}

std::vector<Frame> around(const Frame& frame, std::initializer_list<double> yaws, std::initializer_list<double> pitches,
                          std::initializer_list<double> rolls) {
  std::vector<Frame> frames;
  for (double roll : rolls)
    for (double pitch : pitches)
      for (double yaw : yaws) frames.push_back(turned(frame, yaw, pitch, roll));
  return frames;
}

// The 24 ways of laying right, up and front along the scan's axes, the usual one (y up, z front) first.
std::vector<Frame> axis_frames() {
  std::vector<Frame> frames;
  for (int up : {1, 2, 0})
    for (double up_sign : {1.0, -1.0})
      for (int front : {2, 1, 0})
        for (double front_sign : {1.0, -1.0}) {
          if (front == up) continue;
          Frame frame;
          frame.col(1) = up_sign * Eigen::Vector3d::Unit(up);
          frame.col(2) = front_sign * Eigen::Vector3d::Unit(front);
          frame.col(0) = frame.col(1).cross(frame.col(2));
          frames.push_back(frame);
        }
  return frames;
}

struct View {
  FoundFace face;
  std::array<std::optional<Eigen::Vector3d>, 68> points;  // scan frame, where the surface faces the camera
  std::array<double, 68> facing{};                        // cosine between surface normal and view
};

// Between open lips a ray goes on into the mouth: inner lip points that lie deep behind the outer lips are none.
void drop_mouth_cavity(View& view, const Camera& camera) {
  std::vector<double> depths;
  for (int i = 48; i < 60; ++i)
    if (view.points[i]) depths.push_back(camera.project(*view.points[i]).z());
  if (depths.empty()) return;
  const double farthest = *std::max_element(depths.begin(), depths.end());
  const double span = farthest - *std::min_element(depths.begin(), depths.end());
  for (int i = 60; i < 68; ++i)
    if (view.points[i] && camera.project(*view.points[i]).z() > farthest + 0.3 * span) view.points[i].reset();
}

std::optional<View> look(const ScanPictures& pictures, const FaceFinder& finder, const Camera& camera,
                         const Eigen::Vector3d& light, double least_score) {
  const auto face = finder.find(pictures.shade(camera, light), least_score);
  if (!face) return {};
  View view{*face, {}, {}};
  const Eigen::Vector3d eye = camera.centre();
  for (int i = 0; i < 68; ++i) {
    const Eigen::Vector3d direction = camera.direction(face->points[i].x(), face->points[i].y());
    const auto hit = pictures.rays().hit(eye, direction);
    if (!hit) continue;
    const double facing = -pictures.normal(hit->place).dot(direction.normalized());
    if (facing < 0.15) continue;
    view.points[i] = eye + hit->distance * direction.normalized();
    view.facing[i] = facing;
  }
  drop_mouth_cavity(view, camera);
  return view;
}

struct Shot {
  Frame frame;
  Eigen::Vector3d light;
};

std::vector<std::optional<View>> look_all(const ScanPictures& pictures, const FaceFinder& finder,
                                          const std::vector<Shot>& shots, const Target& target, int pixels,
                                          double least_score) {
  std::vector<std::optional<View>> views(shots.size());
  tbb::parallel_for(std::size_t{0}, shots.size(), [&](std::size_t i) {
    views[i] = look(pictures, finder, camera_for(shots[i].frame, target, pixels), shots[i].light, least_score);
  });
  return views;
}

std::optional<Eigen::Vector3d> mean_of(const View& view, std::initializer_list<int> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (int i : points)
    if (view.points[i]) {
      sum += *view.points[i];
      ++count;
    }
  if (2 * count < static_cast<int>(points.size())) return {};
  return Eigen::Vector3d(sum / count);
}

struct FacePlace {
  Frame frame;
  Target target;
};

// Face axes from the eyes and the mouth. The line from mouth to eyes leans back from the face's upright axis by about
// the angle below, so that the frame agrees with heads that look straight along z.
std::optional<FacePlace> place_of(const View& view) {
  const auto right = mean_of(view, {36, 37, 38, 39, 40, 41}), left = mean_of(view, {42, 43, 44, 45, 46, 47});
  const auto mouth = mean_of(view, {48, 54, 51, 57});
  if (!right || !left || !mouth) return {};
  const Eigen::Vector3d eyes = 0.5 * (*right + *left);
  FacePlace place;
  const Eigen::Vector3d x = (*left - *right).normalized();
  Eigen::Vector3d up = eyes - *mouth;
  up = (up - x * x.dot(up)).normalized();
  place.frame << x, up, x.cross(up);
  place.frame = turned(place.frame, 0.0, 8.0, 0.0);
  const double eye_distance = (*left - *right).norm();
  place.target = {0.6 * eyes + 0.4 * *mouth, 2.1 * eye_distance};
  return place;
}

struct Search {
  FacePlace place;
  double score;
  std::string how;
};

std::optional<Search> best_of(const ScanPictures& pictures, const FaceFinder& finder, const std::vector<Frame>& frames,
                              const Target& target, double least_score, const std::string& how) {
  std::vector<Shot> shots;
  for (const Frame& frame : frames) shots.push_back({frame, light_from_above});
  const auto views = look_all(pictures, finder, shots, target, search_pixels, least_score);
  std::optional<Search> best;
  for (const auto& view : views) {
    if (!view || (best && view->face.score <= best->score)) continue;
    const auto place = place_of(*view);
    // A face seen in hair or on the inside of a shell has eyes and mouth of absurd size.
    if (place && place->target.radius > 0.1 * target.radius) best = Search{*place, view->face.score, how};
  }
  return best;
}

Search search_face(const ScanPictures& pictures, const FaceFinder& finder) {
  const Box box = bounds(pictures.scan().positions);
  const Target whole{box.centre(), 0.5 * box.diagonal()}, near{box.centre(), 0.32 * box.diagonal()};
  const Frame usual = Frame::Identity();
  const double sure = 0.5;
  const auto upright = around(usual, {0, -25, 25}, {0, -20, 20}, {0});
  std::optional<Search> found;
  auto consider = [&](std::optional<Search> next) {
    if (next && (!found || next->score > found->score)) found = next;
    return found && found->score > sure;
  };
  if (consider(best_of(pictures, finder, upright, whole, 0.0, "upright, looking along +z"))) return *found;
  if (consider(best_of(pictures, finder, upright, near, 0.0, "upright, looking along +z"))) return *found;
  const auto axes = axis_frames();
  if (consider(best_of(pictures, finder, axes, whole, 0.0, "along the scan's axes"))) return *found;
  std::vector<Frame> every;
  for (const Frame& frame : axes)
    for (const Frame& turn : around(frame, {-40, 0, 40}, {-30, 0, 30}, {-30, 0, 30})) every.push_back(turn);
  if (consider(best_of(pictures, finder, every, whole, 0.0, "turned freely"))) return *found;
  if (found) return *found;
  throw InputError(
      "no face found in the scan from any side; place landmarks by hand (landmarks/<pose>.json) or check that the scan "
      "shows a face");
}

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

double median(std::vector<double> values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What a point is worth however well the views agree: brows and contour are colour and outline rather than shape.
double worth(int point, bool coloured) {
  if (is_contour(point)) return point >= 7 && point <= 9 ? 0.4 : 0.1;
  if (point < 27) return coloured ? 0.6 : 0.25;
  return coloured ? 0.9 : 0.8;
}

void agree(const std::vector<std::optional<View>>& views, double eye_distance, DetectedLandmarks& result) {
  const double tolerance = 0.05 * eye_distance;  // some 3 mm on a head
  std::vector<double> spreads;
  for (int i = 0; i < 68; ++i) {
    std::vector<Eigen::Vector3d> points;
    std::vector<double> weights;
    for (const auto& view : views)
      if (view && view->points[i]) {
        points.push_back(*view->points[i]);
        weights.push_back(view->facing[i] * view->facing[i]);
      }
    if (static_cast<int>(points.size()) < std::max(1, result.views / 4)) continue;
    const Eigen::Vector3d centre = robust_mean(points, weights, tolerance);
    std::vector<double> distances;
    for (const auto& point : points) distances.push_back((point - centre).norm());
    const double spread = median(distances);
    const double seen = static_cast<double>(points.size()) / result.views;
    const double confidence = worth(i, result.coloured) * std::sqrt(seen) / (1.0 + std::pow(spread / tolerance, 2));
    result.points.push_back({ibug_name(i), centre, confidence});
    spreads.push_back(spread);
  }
  result.spread = Eigen::Map<Eigen::VectorXd>(spreads.data(), static_cast<Eigen::Index>(spreads.size()));
}

// Two views more or less straight on settle face axes and size before the fan is laid around them.
FacePlace settle(const ScanPictures& pictures, const FaceFinder& finder, FacePlace place) {
  for (int round = 0; round < 2; ++round) {
    const auto views = look_all(pictures, finder, {{place.frame, light_from_above}, {place.frame, light_from_front}},
                                place.target, close_pixels, -0.3);
    for (const auto& view : views) {
      if (!view) continue;
      const auto better = place_of(*view);
      if (better) place = *better;
      break;
    }
  }
  return place;
}

std::string describe(const Eigen::Vector3d& axis) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", axis.x(), axis.y(), axis.z());
  return text;
}

double point_distance(const ScanLandmarks& points, int a, int b) {
  const Eigen::Vector3d* ends[2] = {nullptr, nullptr};
  for (const ScanLandmark& point : points) {
    if (point.name == ibug_name(a)) ends[0] = &point.position;
    if (point.name == ibug_name(b)) ends[1] = &point.position;
  }
  return ends[0] && ends[1] ? (*ends[0] - *ends[1]).norm() : 0.0;
}

}  // namespace

DetectedLandmarks detect_landmarks(const Mesh& scan, const FaceFinder& finder) {
  const ScanPictures pictures(scan);
  const Search found = search_face(pictures, finder);
  const FacePlace place = settle(pictures, finder, found.place);

  std::vector<Shot> shots;
  for (const Frame& frame : around(place.frame, {-20, -10, 0, 10, 20}, {-10, 0, 10}, {0}))
    for (const Eigen::Vector3d& light : {light_from_above, light_from_front}) shots.push_back({frame, light});
  const auto views = look_all(pictures, finder, shots, place.target, close_pixels, -0.2);

  DetectedLandmarks result;
  result.scan_from_face = place.frame;
  result.coloured = pictures.coloured();
  for (const auto& view : views)
    if (view) {
      ++result.views;
      result.score += view->face.score;
    }
  if (result.views == 0)
    throw InputError("a face was seen in the scan but could not be followed around; place landmarks by hand");
  result.score /= result.views;
  agree(views, place.target.radius / 2.1, result);
  result.outer_eye_distance = point_distance(result.points, 36, 45);
  result.decisions.push_back("face found " + found.how + ": front " + describe(place.frame.col(2)) + ", up " +
                             describe(place.frame.col(1)) + ", " + std::to_string(result.views) + " of " +
                             std::to_string(shots.size()) + " views agree");
  return result;
}

}  // namespace vultus::registration
