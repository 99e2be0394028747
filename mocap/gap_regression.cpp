#include "mocap/gap_regression.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/statistics.h"

namespace vultus::mocap {

namespace {

constexpr std::size_t kInputs = 40, kFewestInputs = 4, kFewestFrames = 12;
constexpr double kDenseSeconds = 0.2, kNearSeconds = 0.5, kNearStep = 1.0 / 15.0;

double matern52(double r) {
  const double s = std::sqrt(5.0) * r;
  return (1.0 + s + s * s / 3.0) * std::exp(-s);
}

/// Poses of the input markers, one frame a row, scaled as the kernel says.
Eigen::MatrixXd poses(const Take& guess, const std::vector<int>& frames, const std::vector<int>& inputs,
                      const Points& centres, const Eigen::VectorXd& weights) {
  Eigen::MatrixXd z(static_cast<Eigen::Index>(frames.size()), 3 * static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const Eigen::RowVector3d offset = guess.at(frames[f], inputs[i]).transpose() - centres.row(inputs[i]);
      z.block<1, 3>(static_cast<Eigen::Index>(f), 3 * static_cast<Eigen::Index>(i)) =
          weights(static_cast<Eigen::Index>(i)) * offset;
    }
  }
  return z;
}

/// Covariances of frames `a` with frames `b`; of a square matrix of frames with themselves, the lower triangle only.
enum class Part { all, lower };
Eigen::MatrixXd covariances(const PreparedKernel& prepared, Part part, const Eigen::MatrixXd& za,
                            const std::vector<int>& a, const Eigen::MatrixXd& zb, const std::vector<int>& b) {
  const RegressionKernel& kernel = prepared.kernel;
  Eigen::MatrixXd k(za.rows(), zb.rows());
  if (part == Part::lower) {
    k.setZero();
    k.selfadjointView<Eigen::Lower>().rankUpdate(za);
  } else {
    k.noalias() = za * zb.transpose();
  }
  const Eigen::VectorXd na = za.rowwise().squaredNorm(), nb = zb.rowwise().squaredNorm();
  const double linear = kernel.linear * kernel.linear;
  const double shape = 0.5 / (kernel.similar_length * kernel.similar_length);
  for (Eigen::Index j = 0; j < k.cols(); ++j) {
    for (Eigen::Index i = part == Part::lower ? j : 0; i < k.rows(); ++i) {
      const auto frames =
          static_cast<std::size_t>(std::abs(a[static_cast<std::size_t>(i)] - b[static_cast<std::size_t>(j)]));
      const double apart = std::max(0.0, na(i) + nb(j) - 2.0 * k(i, j));
      k(i, j) =
          linear * k(i, j) + prepared.similar_in_time[frames] / (1.0 + shape * apart) + prepared.smooth_in_time[frames];
    }
  }
  return k;
}

double prior_variance(const RegressionKernel& kernel, double length_squared) {
  return kernel.linear * kernel.linear * length_squared + kernel.similar * kernel.similar +
         kernel.smooth * kernel.smooth;
}

/// Deviation of a coordinate's white noise, from its fourth differences, in which motion all but vanishes (of noise
/// alone they have 70 times its variance).
double jitter(const Take& take, int marker, int step) {
  constexpr double least = 5e-4;  // mm; keeps matrices regular for takes that were smoothed or synthesized
  std::vector<double> differences;
  for (int f = 2; f + 2 < take.frames(); f += step) {
    bool seen = true;
    for (int k = -2; k <= 2; ++k) seen = seen && take.has(f + k, marker);
    if (!seen) continue;
    const Eigen::Vector3d d = take.at(f - 2, marker) - 4.0 * take.at(f - 1, marker) + 6.0 * take.at(f, marker) -
                              4.0 * take.at(f + 1, marker) + take.at(f + 2, marker);
    for (int c = 0; c < 3; ++c) differences.push_back(std::abs(d(c)));
  }
  if (differences.empty()) return least;
  return std::max(least, median(std::move(differences)) / (0.6745 * std::sqrt(70.0)));
}

/// Kernels that suit short, middling and long gaps, and one for lively faces; `fitted` starts from one of them.
std::array<RegressionKernel, 4> starting_kernels() {
  RegressionKernel gentle, close, lively;
  gentle.similar_length = 1.5;
  gentle.similar_seconds = 2.0;
  gentle.smooth_seconds = 0.2;
  close.similar = 3.0;
  close.similar_length = 0.5;
  close.similar_seconds = 5.0;
  lively = close;
  lively.liveliness = 0.2;
  lively.smooth = 1.5;
  return {gentle, RegressionKernel{}, close, lively};
}

}  // namespace

GapRegression::GapRegression(const Take& measured, const Take& guess, int spread)
    : measured_(measured),
      guess_(guess),
      spread_(spread),
      centres_(Points::Zero(measured.markers(), 3)),
      deviations_(Eigen::VectorXd::Zero(measured.markers())),
      jitters_(Eigen::VectorXd::Zero(measured.markers())) {
  const int step = std::max(1, measured.frames() / 2000);
  tbb::parallel_for(0, measured.markers(), [&](int m) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    double squares = 0.0;
    int n = 0;
    for (int f = 0; f < measured.frames(); f += step) {
      if (!measured.has(f, m)) continue;
      sum += measured.at(f, m).transpose();
      ++n;
    }
    if (n == 0) return;
    centres_.row(m) = sum / n;
    for (int f = 0; f < measured.frames(); f += step) {
      if (measured.has(f, m)) squares += (measured.at(f, m).transpose() - centres_.row(m)).squaredNorm();
    }
    deviations_(m) = std::sqrt(squares / n);
    jitters_(m) = jitter(measured, m, step);
  });
}

std::vector<int> GapRegression::inputs_for(const TakeView& view, const Gap& gap) const {
  std::vector<int> inputs;
  for (int m = 0; m < measured_.markers(); ++m) {
    if (m == gap.marker || deviations_(m) == 0.0) continue;
    int measured = 0, known = 0;
    for (int f = gap.first; f <= gap.last; ++f) {
      measured += view.has(f, m);
      known += guess_.has(f, m);
    }
    // A marker that was itself mostly guessed tells little of its own.
    if (known == gap.frames() && 10 * measured >= 9 * gap.frames()) inputs.push_back(m);
  }
  const auto distance = [&](int m) { return (centres_.row(m) - centres_.row(gap.marker)).squaredNorm(); };
  std::stable_sort(inputs.begin(), inputs.end(), [&](int a, int b) { return distance(a) < distance(b); });
  if (inputs.size() > kInputs) inputs.resize(kInputs);
  return inputs;
}

std::vector<int> GapRegression::frames_for(const TakeView& view, const Gap& gap, const std::vector<int>& inputs) const {
  const double rate = measured_.rate_hz;
  const int dense = std::max(4, static_cast<int>(kDenseSeconds * rate)), near = static_cast<int>(kNearSeconds * rate);
  const int step = std::max(1, static_cast<int>(kNearStep * rate)), frames = measured_.frames();
  std::vector<int> wanted;
  for (int i = 0; i < spread_; ++i) {
    wanted.push_back(
        static_cast<int>((2 * static_cast<std::int64_t>(i) + 1) * frames / (2 * static_cast<std::int64_t>(spread_))));
  }
  for (int d = 1; d <= near; ++d) {
    if (d > dense && d % step != 0) continue;
    wanted.push_back(gap.first - d);
    wanted.push_back(gap.last + d);
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::erase_if(wanted, [&](int f) {
    return !view.has(f, gap.marker) ||
           !std::all_of(inputs.begin(), inputs.end(), [&](int m) { return guess_.has(f, m); });
  });
  return wanted;
}

PreparedKernel GapRegression::prepared(const RegressionKernel& kernel) const {
  PreparedKernel result{kernel, {}, {}};
  for (int f = 0; f < measured_.frames(); ++f) {
    const double seconds = f / measured_.rate_hz;
    result.similar_in_time.push_back(kernel.similar * kernel.similar * matern52(seconds / kernel.similar_seconds));
    result.smooth_in_time.push_back(kernel.smooth * kernel.smooth * matern52(seconds / kernel.smooth_seconds));
  }
  return result;
}

std::optional<Guess> GapRegression::fill(const TakeView& view, const Gap& gap, const PreparedKernel& prepared) const {
  const RegressionKernel& kernel = prepared.kernel;
  const std::vector<int> inputs = inputs_for(view, gap);
  if (inputs.size() < kFewestInputs) return {};
  const std::vector<int> known = frames_for(view, gap, inputs);
  if (known.size() < kFewestFrames) return {};
  std::vector<int> unknown(static_cast<std::size_t>(gap.frames()));
  std::iota(unknown.begin(), unknown.end(), gap.first);

  Eigen::VectorXd weights(static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double distance = (centres_.row(inputs[i]) - centres_.row(gap.marker)).norm();
    weights(static_cast<Eigen::Index>(i)) =
        (std::exp(-distance / kernel.reach) + 0.1) / std::pow(deviations_(inputs[i]) + 0.1, kernel.liveliness);
  }
  Eigen::MatrixXd z = poses(guess_, known, inputs, centres_, weights);
  Eigen::MatrixXd z_gap = poses(guess_, unknown, inputs, centres_, weights);
  const double length = std::sqrt(z.rowwise().squaredNorm().mean());
  if (!(length > 0.0)) return {};
  z /= length;
  z_gap /= length;

  Points y(static_cast<Eigen::Index>(known.size()), 3);
  for (std::size_t i = 0; i < known.size(); ++i)
    y.row(static_cast<Eigen::Index>(i)) = view.at(known[i], gap.marker).transpose();
  const Eigen::RowVector3d mean = y.colwise().mean();
  y.rowwise() -= mean;
  const double deviation = std::max(0.05, std::sqrt(y.rowwise().squaredNorm().mean() / 3.0));
  const double noise = kernel.noise * jitters_(gap.marker) / deviation;

  Eigen::MatrixXd k = covariances(prepared, Part::lower, z, known, z, known);
  k.diagonal().array() += noise * noise + 1e-9;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(k);
  if (cholesky.info() != Eigen::Success) return {};
  const Eigen::MatrixXd k_gap = covariances(prepared, Part::all, z, known, z_gap, unknown);
  Guess guess;
  guess.places = k_gap.transpose() * cholesky.solve(Eigen::MatrixXd(y));
  guess.places.rowwise() += mean;
  const Eigen::MatrixXd explained = cholesky.matrixL().solve(k_gap);
  guess.scale.resize(gap.frames());
  for (Eigen::Index i = 0; i < guess.scale.size(); ++i) {
    const double variance = prior_variance(kernel, z_gap.row(i).squaredNorm()) - explained.col(i).squaredNorm();
    guess.scale(i) = deviation * std::sqrt(std::max(variance, 0.0) + noise * noise);
  }
  return guess;
}

/// Mean error over the trials' samples, summed over trials that could be filled, mm.
double GapRegression::error_on(const std::vector<GapTrial>& trials, const RegressionKernel& kernel) const {
  const PreparedKernel tabulated = prepared(kernel);
  std::vector<double> errors(trials.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, trials.size(), [&](std::size_t i) {
    const Gap& gap = trials[i].gap;
    const auto guess = fill({measured_, trials[i].hidden}, gap, tabulated);
    if (!guess) return;
    for (int f = gap.first; f <= gap.last; ++f) {
      const Eigen::Vector3d place = guess->places.row(f - gap.first).transpose();
      errors[i] += (place - measured_.at(f, gap.marker)).norm() / gap.frames();
    }
  });
  return std::accumulate(errors.begin(), errors.end(), 0.0);
}

RegressionKernel GapRegression::fitted(const RigidGroups& groups, int length, std::uint64_t seed) const {
  constexpr int trial_count = 24;
  const std::array<RegressionKernel, 4> starts = starting_kernels();
  const std::vector<GapTrial> trials = cut_trials(measured_, groups, length, false, trial_count, seed);
  RegressionKernel best = starts[1];
  if (length < 0.25 * measured_.rate_hz) best = starts[0];
  if (length >= measured_.rate_hz) best = starts[2];
  if (trials.empty()) return best;
  double least = error_on(trials, best);
  const auto consider = [&](const RegressionKernel& candidate) {
    const double error = error_on(trials, candidate);
    // A small gain on a few trials is chance.
    if (error < 0.985 * least) {
      least = error;
      best = candidate;
    }
  };
  for (const RegressionKernel& candidate : starts) consider(candidate);
  const RegressionKernel chosen = best;
  const auto vary = [&](double RegressionKernel::*member, double factor) {
    RegressionKernel candidate = best;
    candidate.*member = factor * chosen.*member;
    consider(candidate);
  };
  vary(&RegressionKernel::noise, 0.1);
  vary(&RegressionKernel::noise, 4.0);
  vary(&RegressionKernel::linear, 0.4);
  vary(&RegressionKernel::linear, 2.0);
  return best;
}

}  // namespace vultus::mocap
