#include "rig/kmeans.h"

#include <tbb/parallel_for.h>

#include <limits>

#include "core/error.h"
#include "core/random.h"

namespace vultus::rig {
namespace {

/// Index drawn with probability proportional to `weights`; -1 when all are zero.
int draw(const Eigen::VectorXd& weights, Random& random) {
  const double total = weights.sum();
  if (!(total > 0.0)) return -1;
  double left = random.uniform() * total;
  int last = -1;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    last = static_cast<int>(i);
    left -= weights[i];
    if (left < 0.0) break;
  }
  return last;
}

std::vector<int> seed_rows(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, int clusters, Random& random) {
  std::vector<int> seeds;
  Eigen::VectorXd nearest = Eigen::VectorXd::Ones(rows.rows());
  while (static_cast<int>(seeds.size()) < clusters) {
    const int chosen = draw(weights.cwiseProduct(nearest), random);
    if (chosen < 0) break;
    const Eigen::VectorXd squared = (rows.rowwise() - rows.row(chosen)).rowwise().squaredNorm();
    nearest = seeds.empty() ? squared : Eigen::VectorXd(nearest.cwiseMin(squared));
    seeds.push_back(chosen);
  }
  return seeds;
}

int nearest_centre(const Eigen::MatrixXd& centres, const Eigen::VectorXd& row, double& squared) {
  int best = 0;
  squared = std::numeric_limits<double>::infinity();
  for (Eigen::Index c = 0; c < centres.cols(); ++c) {
    const double distance = (centres.col(c) - row).squaredNorm();
    if (distance < squared) {
      squared = distance;
      best = static_cast<int>(c);
    }
  }
  return best;
}

void renumber(KMeansResult& result) {
  std::vector<int> number(static_cast<std::size_t>(result.centres.rows()), -1);
  int next = 0;
  for (int& label : result.labels) {
    if (number[label] < 0) number[label] = next++;
    label = number[label];
  }
  Eigen::MatrixXd centres(next, result.centres.cols());
  for (std::size_t c = 0; c < number.size(); ++c)
    if (number[c] >= 0) centres.row(number[c]) = result.centres.row(static_cast<Eigen::Index>(c));
  result.centres = std::move(centres);
}

}  // namespace

KMeansResult k_means(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, int clusters, std::uint64_t seed,
                     int max_iterations) {
  if (clusters < 1) throw InputError("k-means needs at least one cluster");
  if (rows.rows() == 0 || !(weights.sum() > 0.0)) throw InputError("k-means needs rows of positive weight");
  Random random(seed);
  const Eigen::MatrixXd columns = rows.transpose();  // one contiguous column a row of data
  const std::vector<int> seeds = seed_rows(rows, weights, clusters, random);
  Eigen::MatrixXd centres(rows.cols(), static_cast<Eigen::Index>(seeds.size()));
  for (std::size_t c = 0; c < seeds.size(); ++c) centres.col(static_cast<Eigen::Index>(c)) = columns.col(seeds[c]);

  KMeansResult result;
  result.labels.assign(static_cast<std::size_t>(rows.rows()), -1);
  Eigen::VectorXd squared(rows.rows());
  while (!result.converged && result.iterations < max_iterations) {
    ++result.iterations;
    const std::vector<int> old = result.labels;
    tbb::parallel_for(Eigen::Index{0}, rows.rows(), [&](Eigen::Index r) {
      result.labels[static_cast<std::size_t>(r)] = nearest_centre(centres, columns.col(r), squared[r]);
    });
    result.converged = result.labels == old;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centres.rows(), centres.cols());
    Eigen::VectorXd totals = Eigen::VectorXd::Zero(centres.cols());
    for (Eigen::Index r = 0; r < rows.rows(); ++r) {
      const int label = result.labels[static_cast<std::size_t>(r)];
      sums.col(label) += weights[r] * columns.col(r);
      totals[label] += weights[r];
    }
    for (Eigen::Index c = 0; c < centres.cols(); ++c)
      if (totals[c] > 0.0) centres.col(c) = sums.col(c) / totals[c];
  }
  result.inertia = weights.dot(squared);
  result.centres = centres.transpose();
  renumber(result);
  return result;
}

}  // namespace vultus::rig
