#include "mocap/local_frames.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "core/files.h"
#include "core/statistics.h"
#include "mocap/take_parts.h"

namespace vultus::mocap {

namespace {

constexpr int kNeighbours = 4;

std::vector<int> nearest_markers(const Take& take, int frame, int marker, int except) {
  std::vector<int> order;
  for (int m = 0; m < take.markers(); ++m) {
    if (m != marker && m != except && take.has(frame, m)) order.push_back(m);
  }
  const Eigen::Vector3d centre = take.at(frame, marker);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return (take.at(frame, a) - centre).squaredNorm() < (take.at(frame, b) - centre).squaredNorm();
  });
  order.resize(std::min<std::size_t>(order.size(), kNeighbours));
  return order;
}

/// Surface coordinates at `sibling`; nothing when it or two of the neighbours are missing, or all lie on a line.
/// `previous_normal` settles the normal's sign.
std::optional<Eigen::Isometry3d> surface_frame(const Take& take, int frame, int sibling, const std::vector<int>& near,
                                               const Eigen::Vector3d& previous_normal) {
  if (!take.has(frame, sibling)) return {};
  const Eigen::Vector3d origin = take.at(frame, sibling);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();
  for (const int m : near) {
    // Every neighbour must be there: another set of them would mean another frame.
    if (!take.has(frame, m)) return {};
    const Eigen::Vector3d arm = take.at(frame, m) - origin;
    scatter += arm * arm.transpose();
    if (towards.isZero()) towards = arm;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  if (near.size() < 2 || solver.eigenvalues()(1) < 1e-6 * solver.eigenvalues()(2)) return {};
  Eigen::Vector3d z = solver.eigenvectors().col(0);
  if (z.dot(previous_normal) < 0.0) z = -z;
  const Eigen::Vector3d x = (towards - z * z.dot(towards)).normalized();
  Eigen::Isometry3d result;
  result.linear() << x, z.cross(x), z;
  result.translation() = origin;
  return result;
}

/// Places of a marker with the given place in the reference frame; no rows' worth where it cannot be carried.
struct Carried {
  std::vector<std::uint8_t> present;
  Points places;
};

Carried carried(const Take& take, int reference, int sibling, const Eigen::Vector3d& place, int except) {
  Carried result{std::vector<std::uint8_t>(static_cast<std::size_t>(take.frames()), 0), Points::Zero(take.frames(), 3)};
  const std::vector<int> near = nearest_markers(take, reference, sibling, except);
  const auto rest = surface_frame(take, reference, sibling, near, Eigen::Vector3d::UnitZ());
  if (!rest) return result;
  const Eigen::Vector3d offset = rest->inverse() * place, normal = rest->linear().col(2);
  for (int f = 0; f < take.frames(); ++f) {
    const auto frame = surface_frame(take, f, sibling, near, normal);
    if (!frame) continue;
    result.present[static_cast<std::size_t>(f)] = 1;
    result.places.row(f) = (*frame * offset).transpose();
  }
  return result;
}

/// 70 % quantile of the construction's error, each captured marker in turn carried by its nearest one.
double leave_out_error(const Take& take, int reference) {
  std::vector<std::vector<double>> errors(take.labels.size());
  tbb::parallel_for(0, take.markers(), [&](int m) {
    if (!take.has(reference, m)) return;
    const std::vector<int> near = nearest_markers(take, reference, m, -1);
    if (near.empty()) return;
    const Carried guess = carried(take, reference, near[0], take.at(reference, m), m);
    const int step = std::max(1, take.frames() / 500);
    for (int f = 0; f < take.frames(); f += step) {
      if (guess.present[static_cast<std::size_t>(f)] == 0 || !take.has(f, m)) continue;
      errors[static_cast<std::size_t>(m)].push_back((Eigen::Vector3d(guess.places.row(f)) - take.at(f, m)).norm());
    }
  });
  std::vector<double> all;
  for (const auto& of_marker : errors) all.insert(all.end(), of_marker.begin(), of_marker.end());
  return all.empty() ? 0.0 : quantile(std::move(all), 0.7);
}

int sibling_of(const Take& take, int reference, const VirtualMarker& marker) {
  if (take.find(marker.label) >= 0)
    throw InputError("take '" + take.name + "' already has a marker '" + marker.label + "'");
  if (!marker.sibling.empty()) {
    const int sibling = take.find(marker.sibling);
    if (sibling < 0) {
      throw InputError("take '" + take.name + "' has no marker '" + marker.sibling + "'; the nearest is '" +
                       nearest_name(marker.sibling, take.labels) + "'");
    }
    if (!take.has(reference, sibling)) {
      throw InputError("take '" + take.name + "': marker '" + marker.sibling + "' is not seen in the reference frame");
    }
    return sibling;
  }
  int best = -1;
  for (int m = 0; m < take.markers(); ++m) {
    if (!take.has(reference, m)) continue;
    const double distance = (take.at(reference, m) - marker.neutral).norm();
    if (best < 0 || distance < (take.at(reference, best) - marker.neutral).norm()) best = m;
  }
  if (best < 0) throw InputError("take '" + take.name + "': no marker is seen in the reference frame");
  return best;
}

/// Adds columns for the markers, without samples.
void widen(Filled& filled, const std::vector<VirtualMarker>& markers) {
  const Take old = std::move(filled.take);
  const std::vector<Origin> origins = std::move(filled.origins);
  const std::vector<float> errors = std::move(filled.expected_errors);
  std::vector<std::string> labels = old.labels;
  for (const VirtualMarker& marker : markers) labels.push_back(marker.label);
  Take wide = emptied(old, std::move(labels));
  filled.origins.assign(wide.present.size(), Origin::missing);
  filled.expected_errors.assign(wide.present.size(), 0.0F);
  for (int f = 0; f < old.frames(); ++f) {
    for (int m = 0; m < old.markers(); ++m) {
      const std::size_t from = old.index(f, m), to = wide.index(f, m);
      copy_sample(old, from, wide, to);
      filled.origins[to] = origins[from];
      filled.expected_errors[to] = errors[from];
    }
  }
  filled.take = std::move(wide);
}

}  // namespace

void add_virtual_markers(Filled& filled, int reference_frame, const std::vector<VirtualMarker>& markers) {
  if (markers.empty()) return;
  const Take captured = filled.take;
  std::vector<int> siblings;
  for (const VirtualMarker& marker : markers) siblings.push_back(sibling_of(captured, reference_frame, marker));
  const double error = leave_out_error(captured, reference_frame);
  widen(filled, markers);
  for (std::size_t v = 0; v < markers.size(); ++v) {
    const int column = captured.markers() + static_cast<int>(v);
    const Carried places = carried(captured, reference_frame, siblings[v], markers[v].neutral, -1);
    for (int f = 0; f < captured.frames(); ++f) {
      if (places.present[static_cast<std::size_t>(f)] == 0) continue;
      const std::size_t i = filled.take.index(f, column);
      filled.take.set(f, column, places.places.row(f).transpose());
      filled.origins[i] = Origin::local_frame;
      filled.expected_errors[i] = static_cast<float>(error);
    }
  }
  filled.decisions.push_back("gaps: " + std::to_string(markers.size()) +
                             " never-captured markers carried by local frames");
}

}  // namespace vultus::mocap
