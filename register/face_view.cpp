#include "register/face_view.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "register/landmarks.h"

namespace vultus::registration {
namespace {

Camera camera_for(const Shot& shot, int pixels) {
  const double field = 0.35;  // radians: near enough to parallel that features do not hide one another
  const double distance = shot.target.radius / std::tan(0.5 * field);
  const Eigen::Vector3d eye = shot.target.centre + distance * shot.frame.col(2);
  return Camera::look_at(eye, shot.target.centre, shot.frame.col(1), field, pixels, pixels);
}

// Between open lips a ray goes on into the mouth: inner lip points that lie deep behind the outer lips are none.
void drop_mouth_cavity(FaceView& view, const Camera& camera) {
  std::vector<double> depths;
  for (int i = 48; i < 60; ++i)
    if (view.points[i]) depths.push_back(camera.project(*view.points[i]).z());
  if (depths.empty()) return;
  const double farthest = *std::max_element(depths.begin(), depths.end());
  const double span = farthest - *std::min_element(depths.begin(), depths.end());
  for (int i = 60; i < 68; ++i)
    if (view.points[i] && camera.project(*view.points[i]).z() > farthest + 0.3 * span) view.points[i].reset();
}

bool from_one_place(const Shot& a, const Shot& b) {
  return a.frame == b.frame && a.target.centre == b.target.centre && a.target.radius == b.target.radius;
}

struct Sight {
  Eigen::Vector3d position;
  double facing;
};

std::optional<Sight> seen_at(const ScanPictures& pictures, const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector3d eye = camera.centre(), direction = camera.direction(pixel.x(), pixel.y()).normalized();
  const auto hit = pictures.rays().hit(eye, direction);
  if (!hit) return {};
  const double facing = -pictures.normal(hit->place).dot(direction);
  if (facing < 0.15) return {};
  return Sight{eye + hit->distance * direction, facing};
}

// A scan has cracks just where points lie, along lids and lips: what stands beside the crack is seen instead.
std::optional<Sight> seen_near(const ScanPictures& pictures, const Camera& camera, const Eigen::Vector2d& pixel,
                               double reach) {
  if (const auto sight = seen_at(pictures, camera, pixel)) return sight;
  for (double radius : {0.5 * reach, reach}) {
    Sight sum{Eigen::Vector3d::Zero(), 0.0};
    int count = 0;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector2d beside = pixel + radius * Eigen::Vector2d(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4));
      if (const auto sight = seen_at(pictures, camera, beside)) {
        sum.position += sight->position;
        sum.facing += sight->facing;
        ++count;
      }
    }
    if (count >= 3) return Sight{sum.position / count, sum.facing / count};
  }
  return {};
}

FaceView cast_back(const ScanPictures& pictures, const FoundFace& face, const Camera& camera) {
  FaceView view{face, {}, {}};
  const double reach = 0.04 * (face.points[16] - face.points[0]).norm();  // some 5 mm on a head
  for (int i = 0; i < 68; ++i) {
    const auto sight =
        is_contour(i) ? seen_at(pictures, camera, face.points[i]) : seen_near(pictures, camera, face.points[i], reach);
    if (!sight) continue;
    view.points[i] = sight->position;
    view.facing[i] = sight->facing;
  }
  drop_mouth_cavity(view, camera);
  return view;
}

std::optional<Eigen::Vector3d> mean_of(const FaceView& view, std::initializer_list<int> points) {
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

}  // namespace

const Eigen::Vector3d light_from_above(0.0, -0.6, -1.0);
const Eigen::Vector3d light_from_front(0.25, -0.25, -1.0);

FaceFrame turned(const FaceFrame& frame, double yaw, double pitch, double roll) {
  const auto degrees = [](double d) { return d * M_PI / 180.0; };
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(degrees(yaw), Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(degrees(pitch), Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(degrees(roll), Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  return frame * turn;
}

std::vector<std::vector<FaceView>> look(const ScanPictures& pictures, const FaceFinder& finder,
                                        const std::vector<Shot>& shots, int pixels, double least_score, int most) {
  std::vector<std::size_t> firsts;  // of the shots in a row that differ by their light alone
  for (std::size_t i = 0; i < shots.size(); ++i)
    if (i == 0 || !from_one_place(shots[i - 1], shots[i])) firsts.push_back(i);
  firsts.push_back(shots.size());
  std::vector<std::vector<FaceView>> views(shots.size());
  tbb::parallel_for(std::size_t{0}, firsts.size() - 1, [&](std::size_t group) {
    const std::size_t first = firsts[group], count = firsts[group + 1] - first;
    const Camera camera = camera_for(shots[first], pixels);
    std::vector<Eigen::Vector3d> lights;
    for (std::size_t i = 0; i < count; ++i) lights.push_back(shots[first + i].light);
    const std::vector<GreyImage> taken = pictures.shade(camera, lights);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      for (const FoundFace& face : finder.find_all(taken[i], least_score, most))
        views[first + i].push_back(cast_back(pictures, face, camera));
    });
  });
  return views;
}

// The line from mouth to eyes leans back from the face's upright axis by about the angle below, so that the frame
// agrees with heads that look straight along z.
std::optional<FacePlace> place_of(const FaceView& view) {
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
  place.eye_distance = (*left - *right).norm();
  place.target = {0.6 * eyes + 0.4 * *mouth, 2.1 * place.eye_distance};
  return place;
}

}  // namespace vultus::registration
