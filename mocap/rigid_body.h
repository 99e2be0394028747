#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/transform.h"
#include "mocap/take.h"

namespace vultus::mocap {

/// How far a marker is taken to stray from its body before that is measured, mm.
constexpr double start_deviation = 0.3;

/// Markers that move together with the head.
struct RigidBody {
  std::vector<std::string> labels;
  Points positions;            ///< markers×3, mm, head coordinates
  Eigen::VectorXd deviations;  ///< mm, how far each strays from the body (its noise and its own motion), > 0
};

/// The head in one frame.
struct HeadPose {
  enum class Kind { measured, interpolated, none } kind = Kind::none;
  Similarity world_from_head;
  double rms = 0.0;        ///< of the markers in use, mm
  int markers = 0;         ///< in use
  double deviation = 0.0;  ///< mm RMS at the body's markers that the deviations of those in use let expect
};

/// Rigid motion world ← head from the rows of `observed` (body markers×3, NaN where missing): least squares weighted by
/// 1/deviation², iteratively re-weighted with Tukey's biweight on residuals in units of the deviations; where one
/// marker stands out of few, the start is the triple with the least median residual (Rousseeuw 1984). Nothing when
/// fewer than three markers are seen or they are collinear.
std::optional<HeadPose> fit_body(const RigidBody& body, const Points& observed);

/// Column of each label in the take, -1 where it has none.
std::vector<int> columns_of(const Take& take, const std::vector<std::string>& labels);

/// Rows of `frame` at `columns`; NaN for missing samples.
Points observed_rows(const Take& take, int frame, const std::vector<int>& columns);

/// Rows of `markers` that are not far from where most are: a marker that is lost may be written as (0, 0, 0).
std::vector<Eigen::Index> rows_together(const Points& markers);

/// `fit_body` in every frame of the take.
std::vector<HeadPose> body_poses(const Take& take, const RigidBody& body);

/// The body's shape and deviations from many frames of the take: per-frame fits and component-wise medians in turn,
/// starting from `body`, anchored so that the markers seen in `reference_frame` keep their place there on average.
RigidBody refine_body(const Take& take, const RigidBody& body, int reference_frame, const std::vector<int>& frames);

}  // namespace vultus::mocap
