#include "register/template_fair.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <map>
#include <set>

namespace vultus::registration::layout {
namespace {

struct Star {
  std::set<int> neighbours;
  std::vector<int> boundary;  ///< the two neighbours along an open edge
};

std::vector<Star> stars(const Weave& whole) {
  std::vector<Star> of(whole.position.size());
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : whole.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      ++uses[{a, b}];
    }
  for (const auto& [edge, count] : uses) {
    of[edge.first].neighbours.insert(edge.second);
    of[edge.second].neighbours.insert(edge.first);
    if (count > 1) continue;
    of[edge.first].boundary.push_back(edge.second);
    of[edge.second].boundary.push_back(edge.first);
  }
  return of;
}

void symmetrize(const Weave& whole, Points& p) {
  for (int v = 0; v < p.rows(); ++v) {
    const int m = whole.mirror[v];
    if (m == v) p(v, 0) = 0.0;
    if (m > v) p.row(m) = Eigen::RowVector3d(-p(v, 0), p(v, 1), p(v, 2));
  }
}

}  // namespace

Points faired(const Weave& whole) {
  const int n = static_cast<int>(whole.position.size());
  const auto star = stars(whole);
  std::vector<Eigen::Triplet<double>> entries, keep;
  Points placed(n, 3);
  for (int v = 0; v < n; ++v) {
    placed.row(v) = whole.position[v];
    keep.emplace_back(v, v, whole.hold[v]);
    if (!star[v].boundary.empty()) continue;
    entries.emplace_back(v, v, -1.0);
    for (const int w : star[v].neighbours)
      entries.emplace_back(v, w, 1.0 / static_cast<double>(star[v].neighbours.size()));
  }
  Eigen::SparseMatrix<double> umbrella(n, n), hold(n, n);
  umbrella.setFromTriplets(entries.begin(), entries.end());
  hold.setFromTriplets(keep.begin(), keep.end());
  const Eigen::SparseMatrix<double> system = umbrella.transpose() * umbrella + hold;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
  Points p = solver.solve(Eigen::MatrixXd(hold * placed));
  symmetrize(whole, p);
  return p;
}

Points loop_limit(const Weave& whole, const Points& control) {
  const auto star = stars(whole);
  Points limit = control;
  for (int v = 0; v < control.rows(); ++v) {
    if (star[v].boundary.size() == 2) {
      limit.row(v) = (4.0 * control.row(v) + control.row(star[v].boundary[0]) + control.row(star[v].boundary[1])) / 6.0;
      continue;
    }
    const double valence = static_cast<double>(star[v].neighbours.size());
    const double c = 0.375 + 0.25 * std::cos(2.0 * M_PI / valence);
    const double beta = (0.625 - c * c) / valence, weight = 1.0 / (0.375 / beta + valence);
    limit.row(v) *= 1.0 - valence * weight;
    for (const int w : star[v].neighbours) limit.row(v) += weight * control.row(w);
  }
  return limit;
}

Points loop_controls(const Weave& whole, const Points& target, int rounds) {
  Points control = target;
  for (int i = 0; i < rounds; ++i) {
    const Points step = target - loop_limit(whole, control);
    for (int v = 0; v < control.rows(); ++v) control.row(v) += whole.set_back[v] * step.row(v);
  }
  symmetrize(whole, control);
  return control;
}

}  // namespace vultus::registration::layout
