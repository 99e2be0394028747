#include "retarget/regional.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

#include "core/error.h"
#include "retarget/simplex_qp.h"

namespace vultus::retarget {
namespace {

constexpr int kFramesPerTask = 64;
constexpr double kSeen = 1e-3;  // a region that sees less than this share of one marker knows nothing in that frame

/// One region's share of the problem: the markers that count there and M_k S about the neutral.
struct RegionProblem {
  std::vector<int> markers;    // of the basis
  std::vector<int> sources;    // of the take; -1 where the take lacks the marker
  Eigen::VectorXd counts;      // m_k of each marker, at least the floor
  Eigen::VectorXd own;         // m_k without the floor
  Eigen::MatrixXd design;      // 3·markers × usable poses
};

std::vector<int> usable_poses(const MarkerBasis& basis) {
  std::vector<int> poses;
  for (std::size_t i = 0; i < basis.poses.size(); ++i) {
    if (basis.usable[i]) poses.push_back(static_cast<int>(i));
  }
  if (poses.empty() || poses.front() != 0) throw InputError("retargeting: the basis has no neutral pose");
  return poses;
}

int row_of(const std::vector<std::string>& labels, const std::string& label) {
  const auto found = std::find(labels.begin(), labels.end(), label);
  return found == labels.end() ? -1 : static_cast<int>(found - labels.begin());
}

RegionProblem region_problem(const mocap::Take& take, const MarkerBasis& basis, const MarkerWeights& weights,
                             int region, const std::vector<int>& poses, double floor) {
  RegionProblem problem;
  std::vector<double> counts, own;
  for (int q = 0; q < basis.markers(); ++q) {
    const int row = row_of(weights.labels, basis.labels[q]);
    if (row < 0) throw InputError("retargeting: marker " + basis.labels[q] + " has no region weights");
    const double count = std::max(weights.values(row, region), floor);
    if (count <= 0.0) continue;
    problem.markers.push_back(q);
    problem.sources.push_back(take.find(basis.labels[q]));
    counts.push_back(count);
    own.push_back(weights.values(row, region));
  }
  const auto rows = static_cast<Eigen::Index>(counts.size());
  problem.counts = Eigen::Map<Eigen::VectorXd>(counts.data(), rows);
  problem.own = Eigen::Map<Eigen::VectorXd>(own.data(), rows);
  problem.design.resize(3 * rows, static_cast<Eigen::Index>(poses.size()));
  for (Eigen::Index r = 0; r < rows; ++r) {
    const int q = problem.markers[r];
    for (std::size_t i = 0; i < poses.size(); ++i) {
      problem.design.block<3, 1>(3 * r, static_cast<Eigen::Index>(i)) =
          problem.counts[r] * (basis.at(q, poses[i]) - basis.at(q, 0));
    }
  }
  return problem;
}

/// Solves consecutive frames of one region; the Gram matrix is kept while the same markers are seen.
class RegionSolver {
 public:
  RegionSolver(const mocap::Take& take, const MarkerBasis& basis, const RegionProblem& problem, double rest_cost)
      : take_(take),
        basis_(basis),
        problem_(problem),
        rows_(problem.design),
        target_(problem.design.rows()),
        cost_(Eigen::VectorXd::Constant(problem.design.cols(), 0.5 * rest_cost)) {
    cost_[0] = 0.0;
  }

  /// The usable poses' weights; nothing when no marker of the region is seen.
  std::optional<SimplexQpResult> solve(int frame) {
    std::vector<bool> seen(problem_.markers.size());
    double evidence = 0.0;
    for (std::size_t r = 0; r < seen.size(); ++r) {
      seen[r] = problem_.sources[r] >= 0 && take_.has(frame, problem_.sources[r]);
      if (seen[r]) evidence += problem_.own[static_cast<Eigen::Index>(r)];
    }
    if (evidence < kSeen) return {};
    if (!programme_ || seen != seen_) rebuild(seen);
    for (std::size_t r = 0; r < seen.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      target_.segment<3>(3 * row).setZero();
      if (!seen[r]) continue;
      target_.segment<3>(3 * row) = problem_.counts[row] * (take_.at(frame, problem_.sources[r]) -
                                                            basis_.at(problem_.markers[r], 0));
    }
    return programme_->solve(cost_ - rows_.transpose() * target_);
  }

 private:
  void rebuild(const std::vector<bool>& seen) {
    seen_ = seen;
    rows_ = problem_.design;
    for (std::size_t r = 0; r < seen.size(); ++r) {
      if (!seen[r]) rows_.middleRows<3>(3 * static_cast<Eigen::Index>(r)).setZero();
    }
    programme_.emplace(rows_.transpose() * rows_);
  }

  const mocap::Take& take_;
  const MarkerBasis& basis_;
  const RegionProblem& problem_;
  Eigen::MatrixXd rows_;
  Eigen::VectorXd target_;
  Eigen::VectorXd cost_;  // ½ rest_cost for every pose but the neutral
  std::vector<bool> seen_;
  std::optional<SimplexQp> programme_;
};

/// What one task found out, gathered in frame order afterwards.
struct TaskReport {
  double worst_kkt_residual = 0.0;
  long iterations = 0;
};

void store(const Eigen::VectorXd& solution, const std::vector<int>& poses, std::span<float> row) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    row[poses[i]] = static_cast<float>(solution[static_cast<Eigen::Index>(i)]);
  }
}

TaskReport solve_frames(const mocap::Take& take, const MarkerBasis& basis, const std::vector<RegionProblem>& problems,
                        const std::vector<int>& poses, double rest_cost, int first, int last, SolveResult& result) {
  TaskReport report;
  for (std::size_t k = 0; k < problems.size(); ++k) {
    const int region = static_cast<int>(k);
    RegionSolver solver(take, basis, problems[k], rest_cost);
    for (int frame = first; frame < last; ++frame) {
      const auto solution = solver.solve(frame);
      if (!solution) {
        result.bridged[frame * problems.size() + k] = 1;
        continue;
      }
      store(solution->weights, poses, result.weights.at(frame, region));
      report.worst_kkt_residual = std::max(report.worst_kkt_residual, solution->kkt_residual);
      report.iterations += solution->iterations;
    }
  }
  return report;
}

/// Fills frames [first, last) of a region on the way from the row of frame `from` to that of `to`.
void blend_rows(Weights& weights, int region, int first, int last, int from, int to) {
  const auto a = std::as_const(weights).at(from, region), b = std::as_const(weights).at(to, region);
  for (int frame = first; frame < last; ++frame) {
    const float along = from == to ? 0.0f : static_cast<float>(frame - from) / static_cast<float>(to - from);
    const auto row = weights.at(frame, region);
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = (1.0f - along) * a[i] + along * b[i];
  }
}

/// Gives the unseen frames of a region the weights of the seen ones before and after them; false when there are none.
bool bridge_region(SolveResult& result, int region) {
  const int frames = result.weights.frames();
  const auto unseen = [&](int frame) {
    return result.bridged[frame * result.weights.regions.size() + static_cast<std::size_t>(region)] != 0;
  };
  int before = -1;
  for (int frame = 0; frame < frames; ++frame) {
    if (!unseen(frame)) {
      before = frame;
      continue;
    }
    int after = frame + 1;
    while (after < frames && unseen(after)) ++after;
    if (before < 0 && after == frames) return false;
    blend_rows(result.weights, region, frame, after, before < 0 ? after : before, after == frames ? before : after);
    frame = after - 1;
  }
  return true;
}

void bridge(SolveResult& result) {
  for (int region = 0; region < static_cast<int>(result.weights.regions.size()); ++region) {
    if (bridge_region(result, region)) continue;
    result.notes.push_back("region " + result.weights.regions[region] + " never sees a marker and stays neutral");
    for (int frame = 0; frame < result.weights.frames(); ++frame) result.weights.at(frame, region)[0] = 1.0f;
  }
}

}  // namespace

void SolveOptions::validate() const {
  if (!(marker_floor >= 0.0) || !(marker_floor <= 1.0)) throw InputError("marker_floor must be in [0, 1]");
  if (!(rest_cost >= 0.0) || !std::isfinite(rest_cost)) throw InputError("rest_cost must be 0 or more");
  if (!(smoothing >= 0.0) || !std::isfinite(smoothing)) throw InputError("smoothing must be 0 s or more");
}

SolveResult solve_take(const mocap::Take& take, const MarkerBasis& basis, const MarkerWeights& weights,
                       const SolveOptions& options, Progress& progress) {
  options.validate();
  const std::vector<int> poses = usable_poses(basis);
  SolveResult result;
  int found = 0;
  for (const std::string& label : basis.labels) {
    if (take.find(label) >= 0) {
      ++found;
    } else {
      result.notes.push_back("marker " + label + " of the basis is not in take " + take.name);
    }
  }
  if (found == 0) throw InputError("retargeting: take " + take.name + " has none of the basis's markers");
  std::vector<RegionProblem> problems;
  for (int k = 0; k < static_cast<int>(weights.regions.size()); ++k) {
    problems.push_back(region_problem(take, basis, weights, k, poses, options.marker_floor));
  }
  result.weights = Weights::zeros(take.rate_hz, weights.regions, basis.poses, take.frames());
  result.bridged.assign(static_cast<std::size_t>(take.frames()) * problems.size(), 0);

  const int tasks = (take.frames() + kFramesPerTask - 1) / kFramesPerTask;
  std::vector<TaskReport> reports(tasks);
  progress.begin("retarget " + take.name, take.frames());
  tbb::parallel_for(0, tasks, [&](int task) {
    progress.check();
    const int first = task * kFramesPerTask, last = std::min(first + kFramesPerTask, take.frames());
    reports[task] = solve_frames(take, basis, problems, poses, options.rest_cost, first, last, result);
    progress.advance(last - first);
  });
  for (const TaskReport& report : reports) {
    result.worst_kkt_residual = std::max(result.worst_kkt_residual, report.worst_kkt_residual);
    result.iterations += report.iterations;
  }
  bridge(result);
  if (options.smoothing > 0.0) smooth(result.weights, options.smoothing);
  return result;
}

void smooth(Weights& weights, double deviation) {
  const double frames_of_deviation = deviation * weights.rate_hz;
  const int reach = static_cast<int>(std::ceil(4.0 * frames_of_deviation));
  if (reach < 1 || weights.frames() < 2) return;
  std::vector<double> kernel(reach + 1);
  for (int d = 0; d <= reach; ++d) kernel[d] = std::exp(-0.5 * (d / frames_of_deviation) * (d / frames_of_deviation));
  const Weights source = weights;
  const std::size_t stride = weights.regions.size() * weights.poses.size();
  tbb::parallel_for(0, weights.frames(), [&](int frame) {
    const int first = std::max(0, frame - reach), last = std::min(weights.frames() - 1, frame + reach);
    std::vector<double> sums(stride, 0.0);
    double total = 0.0;
    for (int f = first; f <= last; ++f) {
      const double factor = kernel[std::abs(f - frame)];
      total += factor;
      for (std::size_t i = 0; i < stride; ++i) sums[i] += factor * source.values[f * stride + i];
    }
    for (std::size_t i = 0; i < stride; ++i) weights.values[frame * stride + i] = static_cast<float>(sums[i] / total);
  });
}

}  // namespace vultus::retarget
