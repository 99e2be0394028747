#include "register/gaping_jaw.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/neighbours.h"
#include "core/statistics.h"
#include "register/face_axes.h"

namespace vultus::registration {
namespace {

constexpr double limit = 6.0;        // mm: what finds no scan counts with it
constexpr double rim_weight = 0.3;   // of the rim against all of the front's data
constexpr double turn_weight = 0.3;  // of turns that a jaw hardly makes, at an arm of …
constexpr double arm = 20.0;         // … so many mm
constexpr double hinge_weight = 0.02;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// The skin between the lower lip's rim and just under the chin, wider downwards, without the corners of the mouth:
// what edges reach within that strip, so that the upper lip stays out of it even where lips touch.
std::vector<int> jaw_front(const Ibug68& ibug, const Topology& topology, const Points& rest,
                           const std::vector<bool>& fitted) {
  constexpr double half_at_lip = 0.3, half_at_chin = 0.6;  // of the mouth's width
  constexpr double under = 4.0;                            // mm that the chin reaches below its point
  auto point = [&](int i) -> Eigen::Vector3d { return rest.row(ibug[i]).transpose(); };
  const FaceAxes axes = face_axes(point(16) - point(0), point(27) - point(8));
  const Eigen::Vector3d lip = point(57);
  const double length = axes.up.dot(lip - point(8)), width = (point(54) - point(48)).norm();
  std::vector<bool> inside(rest.rows(), false);
  for (int v = 0; v < rest.rows(); ++v) {
    if (!fitted[v]) continue;
    const Eigen::Vector3d from_lip = rest.row(v).transpose() - lip;
    const double down = -axes.up.dot(from_lip);
    const double half = half_at_lip + (half_at_chin - half_at_lip) * std::clamp(down / length, 0.0, 1.0);
    inside[v] = down < length + under && std::abs(axes.across.dot(from_lip)) < half * width;
  }
  const Adjacency neighbours = adjacency(topology);
  std::vector<int> front = {ibug[57]};
  inside[ibug[57]] = false;
  for (std::size_t next = 0; next < front.size(); ++next)
    for (int w : neighbours.of(front[next]))
      if (inside[w]) {
        inside[w] = false;
        front.push_back(w);
      }
  std::sort(front.begin(), front.end());
  return front;
}

// Normal equations of a small turn about `centre` and a shift.
struct Equations {
  Eigen::Vector3d centre;
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();

  void to_plane(const Eigen::Vector3d& at, const Eigen::Vector3d& normal, double distance, double weight) {
    Vector6 row;
    row << (at - centre).cross(normal), normal;
    matrix += weight * row * row.transpose();
    right += weight * distance * row;
  }
  void to_point(const Eigen::Vector3d& at, const Eigen::Vector3d& target, double weight) {
    for (int k = 0; k < 3; ++k) to_plane(at, Eigen::Vector3d::Unit(k), (target - at)[k], weight);
  }
  // Turns so far, and those to come, cost by what they are along each axis.
  void hold_turn(const Eigen::Vector3d& turned, const Eigen::Matrix3d& weights) {
    matrix.topLeftCorner<3, 3>() += weights;
    right.head<3>() -= weights * turned;
  }
  Similarity solution() const {
    const Vector6 x = (matrix + 1e-9 * (1.0 + matrix.trace()) * Matrix6::Identity()).ldlt().solve(right);
    Similarity small;
    const Eigen::Vector3d turn = x.head<3>();
    if (turn.norm() > 1e-12)
      small.rotation = Eigen::AngleAxisd(std::min(0.2, turn.norm()), turn.normalized()).toRotationMatrix();
    small.translation = centre + x.tail<3>() - small.rotation * centre;
    return small;
  }
};

struct Rim {
  Eigen::Vector3d from, to;
};

class FrontOnScan {
 public:
  FrontOnScan(const Topology& topology, const Points& rest, const std::vector<int>& front, const std::vector<Rim>& rims,
              const Eigen::Vector3d& hinge, const ScanSurface& scan)
      : rims_(rims), hinge_(hinge), scan_(scan) {
    const Points normals = vertex_normals(topology, rest);
    const std::size_t stride = std::max<std::size_t>(1, front.size() / 800);
    for (std::size_t i = 0; i < front.size(); i += stride) {
      points_.emplace_back(rest.row(front[i]));
      normals_.emplace_back(normals.row(front[i]));
    }
  }

  double mismatch(const Similarity& motion) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto place = scan_.nearest(motion * points_[i], motion.rotation * normals_[i], limit, 0.7);
      sum += place ? place->distance : limit;
    }
    return sum / static_cast<double>(points_.size());
  }

  // The turn given, shifted so that the rim comes to its place, then drawn to the scan.
  std::optional<Similarity> from_turn(double angle) const {
    Similarity motion;
    motion.rotation = Eigen::AngleAxisd(angle, hinge_).toRotationMatrix();
    for (const Rim& rim : rims_)
      motion.translation += (rim.to - motion.rotation * rim.from) / static_cast<double>(rims_.size());
    constexpr int steps = 25;
    for (int i = 0; i < steps; ++i)
      if (!step(8.0 * std::pow(3.0 / 8.0, static_cast<double>(i) / (steps - 1)), motion)) return {};
    return motion;
  }

 private:
  bool step(double reach, Similarity& motion) const {
    struct Pair {
      Eigen::Vector3d at, normal;
      double distance;
    };
    std::vector<Pair> pairs;
    std::vector<double> residuals;
    Equations equations{Eigen::Vector3d::Zero()};
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d at = motion * points_[i];
      equations.centre += at / static_cast<double>(points_.size());
      const auto place = scan_.nearest(at, motion.rotation * normals_[i], reach, 0.6);
      if (!place) continue;
      pairs.push_back({at, place->normal, place->normal.dot(place->position - at)});
      residuals.push_back(std::abs(pairs.back().distance));
    }
    if (pairs.size() < 20) return false;
    const double spread = 4.685 * std::max(0.2, 1.4826 * median(residuals));
    for (const Pair& pair : pairs) {
      const double x = pair.distance / spread;
      if (std::abs(x) < 1.0) equations.to_plane(pair.at, pair.normal, pair.distance, std::pow(1.0 - x * x, 2));
    }
    const double data = static_cast<double>(pairs.size());
    for (const Rim& rim : rims_)
      equations.to_point(motion * rim.from, rim.to, rim_weight * data / static_cast<double>(rims_.size()));
    const Eigen::AngleAxisd turn(motion.rotation);
    const Eigen::Matrix3d about_hinge = hinge_ * hinge_.transpose();
    equations.hold_turn(
        turn.angle() * turn.axis(),
        data * arm * arm * (hinge_weight * about_hinge + turn_weight * (Eigen::Matrix3d::Identity() - about_hinge)));
    motion = equations.solution() * motion;
    return true;
  }

  std::vector<Eigen::Vector3d> points_, normals_;
  std::vector<Rim> rims_;
  Eigen::Vector3d hinge_;
  const ScanSurface& scan_;
};

}  // namespace

GapingJaw find_gaping_jaw(const Template& head, const Topology& topology, const Points& rest,
                          const std::vector<bool>& fitted, const MouthGape& gape, const ScanSurface& scan) {
  if (!head.ibug68) return {};
  const Ibug68& ibug = *head.ibug68;
  for (int needed : {0, 8, 16, 27, 48, 54, 57, 65, 66, 67})
    if (ibug[needed] < 0) return {};
  std::vector<int> front = jaw_front(ibug, topology, rest, fitted);
  if (front.size() < 40) return {};
  std::vector<Rim> rims;
  for (int i = 0; i < 3; ++i) rims.push_back({rest.row(ibug[67 - i]).transpose(), gape.lower[i]});
  const Eigen::Vector3d hinge = (rest.row(ibug[16]) - rest.row(ibug[0])).transpose().normalized();
  const FrontOnScan on_scan(topology, rest, front, rims, hinge, scan);
  const double unmoved = on_scan.mismatch({});
  GapingJaw best;
  for (double degrees : {0.0, 10.0, 20.0, 30.0}) {
    const auto motion = on_scan.from_turn(degrees * M_PI / 180.0);
    if (!motion) continue;
    const double mismatch = on_scan.mismatch(*motion);
    if (!best.front.empty() && mismatch >= best.mismatch) continue;
    best = {*motion, front, mismatch, unmoved};
  }
  return best;
}

}  // namespace vultus::registration
