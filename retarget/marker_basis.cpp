#include "retarget/marker_basis.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/rbf.h"

namespace vultus::retarget {
namespace {

void check_shapes(const std::vector<std::string>& labels, const std::vector<std::string>& poses,
                  const std::vector<Points>& captured) {
  if (poses.empty() || captured.size() != poses.size()) {
    throw InputError("marker basis: one captured frame a pose is needed");
  }
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    const auto rows = captured[pose].rows();
    if (rows != 0 && rows != static_cast<Eigen::Index>(labels.size())) {
      throw InputError(fmt::format("marker basis, pose {}: {} markers where {} are labelled", poses[pose], rows,
                                   labels.size()));
    }
  }
  if (captured.front().rows() == 0) {
    throw InputError("marker basis: the training take has no frame for the neutral pose \"" + poses.front() + "\"");
  }
}

std::vector<int> present_rows(const Points& points, const std::vector<int>& among) {
  std::vector<int> rows;
  for (int row : among) {
    if (points.row(row).allFinite()) rows.push_back(row);
  }
  return rows;
}

Points rows_of(const Points& points, const std::vector<int>& rows) {
  Points result(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) result.row(static_cast<Eigen::Index>(i)) = points.row(rows[i]);
  return result;
}

/// The pose's positions of the markers `kept`, missing ones carried along by the present ones around them.
Points filled_pose(const Points& neutral, const Points& pose, const std::vector<int>& kept,
                   const std::vector<int>& present) {
  Points result = rows_of(pose, kept);
  if (present.size() == kept.size()) return result;
  const RbfMap pose_from_neutral(rows_of(neutral, present), rows_of(pose, present),
                                 {RbfKernel::inverse_multiquadric, true, 0.0});
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (!result.row(row).allFinite()) {
      result.row(row) = pose_from_neutral(Eigen::Vector3d(neutral.row(kept[i]))).transpose();
    }
  }
  return result;
}

void store_pose(MarkerBasis& basis, int pose, const Points& positions) {
  basis.columns.col(pose) = Eigen::Map<const Eigen::VectorXd>(positions.data(), positions.size());
}

}  // namespace

MarkerBasis basis_from_training(const std::vector<std::string>& labels, const std::vector<std::string>& poses,
                                const std::vector<Points>& captured) {
  check_shapes(labels, poses, captured);
  const Points& neutral = captured.front();
  MarkerBasis basis;
  basis.poses = poses;
  std::vector<int> kept;
  for (int row = 0; row < neutral.rows(); ++row) {
    if (neutral.row(row).allFinite()) {
      kept.push_back(row);
      basis.labels.push_back(labels[row]);
    } else {
      basis.notes.push_back("marker " + labels[row] + " is missing in the neutral pose and is left out");
    }
  }
  if (kept.size() < 4) throw InputError("marker basis: fewer than 4 markers are present in the neutral pose");
  basis.columns = Eigen::MatrixXd::Zero(3 * basis.markers(), static_cast<Eigen::Index>(poses.size()));
  basis.usable.assign(poses.size(), false);
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    const std::vector<int> present = captured[pose].rows() == 0 ? std::vector<int>{} : present_rows(captured[pose], kept);
    if (present.size() < 4 || 2 * present.size() < kept.size()) {
      basis.notes.push_back(fmt::format("pose {} was not captured ({} of {} markers): its weight stays zero",
                                        poses[pose], present.size(), kept.size()));
      continue;
    }
    if (present.size() < kept.size()) {
      basis.notes.push_back(fmt::format("pose {}: {} missing markers filled from those around them", poses[pose],
                                        kept.size() - present.size()));
    }
    store_pose(basis, static_cast<int>(pose), filled_pose(neutral, captured[pose], kept, present));
    basis.usable[pose] = true;
  }
  return basis;
}

MarkerBasis basis_from_surface(const rig::Actor& actor, const std::vector<std::string>& labels,
                               const std::vector<SurfacePoint>& places) {
  if (labels.size() != places.size()) throw InputError("marker basis: one place a label is needed");
  MarkerBasis basis;
  basis.labels = labels;
  basis.poses = actor.pose_names();
  basis.usable.assign(basis.poses.size(), true);
  basis.columns.resize(3 * basis.markers(), static_cast<Eigen::Index>(basis.poses.size()));
  for (std::size_t pose = 0; pose < actor.poses.size(); ++pose) {
    Points positions(static_cast<Eigen::Index>(places.size()), 3);
    for (std::size_t i = 0; i < places.size(); ++i) {
      positions.row(static_cast<Eigen::Index>(i)) =
          position_of(places[i], *actor.topology, actor.poses[pose].positions).transpose();
    }
    store_pose(basis, static_cast<int>(pose), positions);
  }
  return basis;
}

}  // namespace vultus::retarget
