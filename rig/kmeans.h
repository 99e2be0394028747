#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace vultus::rig {

struct KMeansResult {
  std::vector<int> labels;  ///< a cluster for each row; clusters are numbered by their first row
  Eigen::MatrixXd centres;  ///< clusters × dimensions
  double inertia = 0.0;     ///< Σ weight · squared distance to the own centre
  int iterations = 0;
  bool converged = false;  ///< no row changed its cluster
};

/// Lloyd's k-means from k-means++ seeds (Arthur and Vassilvitskii 2007); `weights` ≥ 0, one a row. `clusters` is
/// lowered to the number of different rows. The same seed gives the same clusters on any number of threads.
KMeansResult k_means(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, int clusters, std::uint64_t seed,
                     int max_iterations = 100);

}  // namespace vultus::rig
