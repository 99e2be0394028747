#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "retarget/marker_map.h"

namespace vultus::retarget {
namespace {

/// The placed markers' samples, each moved by `move(row, position)`.
template <typename Move>
mocap::Take moved_take(const mocap::Take& take, const MarkerPlacement& placement, const Move& move) {
  mocap::Take moved = mocap::Take::empty(take.name, take.rate_hz, placement.labels, take.frames());
  moved.first_frame = take.first_frame;
  std::vector<int> source;
  for (const std::string& label : placement.labels) source.push_back(take.find(label));
  tbb::parallel_for(0, take.frames(), [&](int frame) {
    for (std::size_t row = 0; row < source.size(); ++row) {
      const int marker = static_cast<int>(row);
      if (source[row] >= 0 && take.has(frame, source[row])) {
        moved.set(frame, marker, move(marker, take.at(frame, source[row])));
      }
    }
  });
  return moved;
}

/// A pair of markers far apart along one axis.
struct Pair {
  int first = -1, second = -1;
  double extent = 0.0;
};

Pair widest(const Points& points, const std::vector<int>& rows, int axis) {
  Pair best;
  for (int a : rows) {
    for (int b : rows) {
      const double extent = points(b, axis) - points(a, axis);
      if (extent > best.extent) best = {a, b, extent};
    }
  }
  return best;
}

std::vector<int> rows_beyond(const Points& points, int axis, double middle, bool above) {
  std::vector<int> rows;
  for (int i = 0; i < points.rows(); ++i) {
    if ((points(i, axis) > middle) == above) rows.push_back(i);
  }
  return rows;
}

double median_of(const Points& points, int axis) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < points.rows(); ++i) values.push_back(points(i, axis));
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace

mocap::Take to_rig(const mocap::Take& take, const MarkerPlacement& placement, const RbfMap& map) {
  return moved_take(take, placement, [&](int, const Eigen::Vector3d& position) { return map(position); });
}

mocap::Take to_rig_by_scale(const mocap::Take& take, const MarkerPlacement& placement, double scale) {
  if (!(scale > 0.0)) throw InputError("marker motion: the scale must be positive");
  const Eigen::Matrix3d turn = scale * placement.rig_from_mocap.rotation;
  return moved_take(take, placement, [&](int row, const Eigen::Vector3d& position) -> Eigen::Vector3d {
    const Eigen::Vector3d motion = position - placement.neutral.row(row).transpose();
    return placement.on_rig.row(row).transpose() + turn * motion;
  });
}

ZhuScale zhu_scale(const MarkerPlacement& placement) {
  if (placement.labels.size() < 4) throw InputError("marker scale: at least 4 placed markers are needed");
  constexpr int kAcross = 0, kUp = 1;
  const Points& rig = placement.on_rig;
  const double middle_x = median_of(rig, kAcross), middle_y = median_of(rig, kUp);
  const std::array<Pair, 4> pairs = {widest(rig, rows_beyond(rig, kUp, middle_y, true), kAcross),
                                     widest(rig, rows_beyond(rig, kUp, middle_y, false), kAcross),
                                     widest(rig, rows_beyond(rig, kAcross, middle_x, false), kUp),
                                     widest(rig, rows_beyond(rig, kAcross, middle_x, true), kUp)};
  ZhuScale scale{0.0, {}};
  for (const Pair& pair : pairs) {
    if (pair.first < 0) throw InputError("marker scale: markers are needed above and below, left and right");
    const double on_rig = (rig.row(pair.second) - rig.row(pair.first)).norm();
    const double in_mocap = (placement.neutral.row(pair.second) - placement.neutral.row(pair.first)).norm();
    if (!(in_mocap > 0.0)) throw InputError("marker scale: two markers share one neutral position");
    scale.factor += 0.25 * on_rig / in_mocap;
    scale.pairs.push_back(fmt::format("{}–{}: {:.3f}", placement.labels[pair.first], placement.labels[pair.second],
                                      on_rig / in_mocap));
  }
  return scale;
}

}  // namespace vultus::retarget
