#include "register/flow_alignment.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>

#include "core/camera.h"

namespace vultus::registration {
namespace {

struct Layers {
  cv::Mat colour, relief;  // 32F
  cv::Mat depth;           // 32F, mm; 0 where nothing is seen
};

Layers blank(int pixels) {
  return {cv::Mat::zeros(pixels, pixels, CV_32F), cv::Mat::zeros(pixels, pixels, CV_32F),
          cv::Mat::zeros(pixels, pixels, CV_32F)};
}

Layers picture_of_scan(const Appearance& scan, const Camera& camera) {
  Layers layers = blank(camera.width);
  const Eigen::Vector3d eye = camera.centre();
  tbb::parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto hit = scan.rays().hit(eye, camera.direction(x + 0.5, y + 0.5));
      if (!hit) continue;
      layers.colour.at<float>(y, x) = scan.coloured() ? scan.colour(hit->place) : 0.0f;
      layers.relief.at<float>(y, x) = scan.relief(hit->place);
      layers.depth.at<float>(y, x) = static_cast<float>(hit->distance);
    }
  });
  return layers;
}

// The fit, with what the neutral's scan shows at the same place of the skin.
Layers picture_of_fit(const Topology& topology, const RayScene& fit, const Look& neutral, const Camera& camera) {
  Layers layers = blank(camera.width);
  const Eigen::Vector3d eye = camera.centre();
  tbb::parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto hit = fit.hit(eye, camera.direction(x + 0.5, y + 0.5));
      if (!hit) continue;
      const auto place = neutral.scan.rays().closest(position_of(hit->place, topology, neutral.positions), 2.0);
      if (!place) continue;
      layers.colour.at<float>(y, x) = neutral.scan.coloured() ? neutral.scan.colour(place->place) : 0.0f;
      layers.relief.at<float>(y, x) = neutral.scan.relief(place->place);
      layers.depth.at<float>(y, x) = static_cast<float>(hit->distance);
    }
  });
  return layers;
}

cv::Mat blurred(const cv::Mat& image, double sigma) {
  cv::Mat result;
  cv::GaussianBlur(image, result, cv::Size(), sigma, sigma, cv::BORDER_REPLICATE);
  return result;
}

// Brightness against the surroundings in units of the local contrast, so that light and tan do not matter; grey where
// the mask is zero.
cv::Mat normalized(const cv::Mat& image, const cv::Mat& mask, double sigma, double floor) {
  const cv::Mat weight = blurred(mask, sigma) + 1e-3f;
  const cv::Mat mean = blurred(image.mul(mask), sigma) / weight;
  const cv::Mat centred = (image - mean).mul(mask);
  cv::Mat contrast;
  cv::sqrt(blurred(centred.mul(centred), sigma) / weight, contrast);
  const cv::Mat ratio = centred / (contrast + floor);
  cv::Mat bytes;
  cv::Mat(128.0 + 55.0 * ratio).convertTo(bytes, CV_8U);
  return bytes;
}

struct Flows {
  cv::Mat there, back;  // 32FC2
  cv::Mat contrast;     // 32F, of the fit's picture
};

Flows flows_between(const cv::Mat& fit, const cv::Mat& scan) {
  const cv::Ptr<cv::DISOpticalFlow> flow = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  flow->setFinestScale(1);
  Flows flows;
  flow->calc(fit, scan, flows.there);
  flow->calc(scan, fit, flows.back);
  cv::Mat dx, dy;
  cv::Sobel(fit, dx, CV_32F, 1, 0, 3, 0.25);
  cv::Sobel(fit, dy, CV_32F, 0, 1, 3, 0.25);
  cv::sqrt(blurred(dx.mul(dx) + dy.mul(dy), 4.0), flows.contrast);
  return flows;
}

cv::Vec2f sample(const cv::Mat& flow, double x, double y) {
  const double fx = std::clamp(x - 0.5, 0.0, flow.cols - 1.001), fy = std::clamp(y - 0.5, 0.0, flow.rows - 1.001);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const float ax = static_cast<float>(fx - ix), ay = static_cast<float>(fy - iy);
  return (1 - ay) * ((1 - ax) * flow.at<cv::Vec2f>(iy, ix) + ax * flow.at<cv::Vec2f>(iy, ix + 1)) +
         ay * ((1 - ax) * flow.at<cv::Vec2f>(iy + 1, ix) + ax * flow.at<cv::Vec2f>(iy + 1, ix + 1));
}

struct Sighting {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();
  double weight = 0.0;
};

class View {
 public:
  View(const Topology& topology, const Points& normals, const RayScene& fit, const Look& neutral, const Look& pose,
       const Camera& camera, const FlowOptions& options)
      : pose_(pose), normals_(normals), fit_(fit), camera_(camera), options_(options) {
    const Layers model = picture_of_fit(topology, fit, neutral, camera), seen = picture_of_scan(pose.scan, camera);
    cv::Mat skin = (cv::abs(model.depth - seen.depth) < options.depth_tolerance) & (model.depth > 0) & (seen.depth > 0);
    cv::Mat mask;
    skin.convertTo(mask, CV_32F, 1.0 / 255.0);
    const double sigma = 0.03 * options.pixels;
    cv::Mat a = normalized(model.relief, mask, sigma, 0.1), b = normalized(seen.relief, mask, sigma, 0.1);
    if (neutral.scan.coloured() && pose.scan.coloured()) {
      cv::addWeighted(normalized(model.colour, mask, sigma, 0.01), 0.7, a, 0.3, 0.0, a);
      cv::addWeighted(normalized(seen.colour, mask, sigma, 0.01), 0.7, b, 0.3, 0.0, b);
    }
    flows_ = flows_between(a, b);
    mask_ = mask;
  }

  Sighting of(int vertex) const {
    const Eigen::Vector3d point = pose_.positions.row(vertex), eye = camera_.centre();
    const Eigen::Vector3d towards = point - eye;
    const double facing = -normals_.row(vertex).dot(towards.normalized());
    if (facing < 0.35) return {};
    const auto first = fit_.hit(eye, towards);
    if (!first || first->distance < towards.norm() - 0.5) return {};
    const Eigen::Vector3d pixel = camera_.project(point);
    const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
    if (x < 2 || y < 2 || x >= camera_.width - 2 || y >= camera_.height - 2 || mask_.at<float>(y, x) == 0.0f) return {};
    const cv::Vec2f there = sample(flows_.there, pixel.x(), pixel.y());
    const double to_x = pixel.x() + there[0], to_y = pixel.y() + there[1];
    if (to_x < 1 || to_y < 1 || to_x > camera_.width - 1 || to_y > camera_.height - 1) return {};
    const double disagreement = cv::norm(there + sample(flows_.back, to_x, to_y)) / options_.agreement;
    if (disagreement >= 1.0) return {};
    const auto hit = pose_.scan.rays().hit(eye, camera_.direction(to_x, to_y));
    if (!hit) return {};
    Sighting sighting;
    sighting.target = pose_.scan.position(hit->place);
    const double moved = (sighting.target - point).norm();
    if (moved > options_.farthest || pose_.scan.normal(hit->place).dot(normals_.row(vertex)) < 0.5) return {};
    const double contrast = std::min(1.0, flows_.contrast.at<float>(y, x) / 12.0);
    sighting.weight = contrast * contrast * facing * facing * (1.0 - disagreement * disagreement);
    return sighting;
  }

 private:
  Look pose_;
  const Points& normals_;
  const RayScene& fit_;
  Camera camera_;
  FlowOptions options_;
  Flows flows_;
  cv::Mat mask_;
};

std::vector<Camera> cameras(const Points& positions, const std::vector<int>& vertices, const Similarity& scan_from_face,
                            int pixels) {
  const Eigen::Matrix3d axes = scan_from_face.rotation;
  const Box box = bounds(positions(vertices, Eigen::all));
  const Eigen::Vector3d centre = box.centre();
  const double field = 0.35, distance = 0.42 * box.diagonal() / std::tan(0.5 * field);
  std::vector<Camera> all;
  for (const auto& [yaw, pitch] :
       std::array<std::pair<double, double>, 5>{{{0.0, 0.0}, {-0.75, 0.0}, {0.75, 0.0}, {0.0, 0.6}, {0.0, -0.5}}}) {
    const Eigen::Vector3d front = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ());
    all.push_back(Camera::look_at(centre + distance * (axes * front), centre, axes.col(1), field, pixels, pixels));
  }
  return all;
}

}  // namespace

std::vector<PointTerm> flow_targets(const Topology& topology, const std::vector<int>& vertices, const Look& neutral,
                                    const Look& pose, const Similarity& scan_from_face, const FlowOptions& options) {
  const RayScene fit(topology, pose.positions);
  const Points normals = vertex_normals(topology, pose.positions);
  std::vector<Sighting> sum(vertices.size());
  for (const Camera& camera : cameras(pose.positions, vertices, scan_from_face, options.pixels)) {
    const View view(topology, normals, fit, neutral, pose, camera, options);
    tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t i) {
      const Sighting one = view.of(vertices[i]);
      sum[i].target += one.weight * one.target;
      sum[i].weight += one.weight;
    });
  }
  std::vector<PointTerm> terms;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (sum[i].weight > 0.05)
      terms.push_back({vertices[i], sum[i].target / sum[i].weight, std::min(1.0, sum[i].weight)});
  return terms;
}

}  // namespace vultus::registration
