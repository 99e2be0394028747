#include <algorithm>
#include <cmath>

#include "register/downhill_simplex.h"
#include "register/energy_solvers.h"

namespace vultus::registration {
namespace {

/// The energy as one control point changes it: only the terms over vertices that this point moves.
class LocalEnergy {
 public:
  LocalEnergy(const RegistrationEnergy& energy, const Points& control)
      : energy_(energy), control_(control), slots_(energy.bones()(control, energy.vertices())), near_(control.rows()) {
    for (std::size_t s = 0; s < energy.vertices().size(); ++s)
      for (int c : energy.bones().controls_of(energy.vertices()[s])) {
        near_[c].slots.push_back(static_cast<int>(s));
        near_[c].vertices.push_back(energy.vertices()[s]);
      }
    std::vector<bool> has_data(energy.vertices().size(), false);
    for (int s : energy.with_data()) has_data[s] = true;
    for (Neighbourhood& near : near_) {
      std::vector<bool> moves(energy.vertices().size(), false);
      for (int s : near.slots) moves[s] = true;
      for (int s : near.slots)
        if (has_data[s]) near.with_data.push_back(s);
      for (const RegistrationEnergy::Edge& edge : energy.edges()) {
        const bool bends = edge.d >= 0 && (moves[edge.c] || moves[edge.d]);
        if (moves[edge.a] || moves[edge.b] || bends) near.edges.push_back(&edge);
      }
    }
  }

  const Points& control() const { return control_; }
  bool moves_any(int number) const { return !near_[number].edges.empty() || !near_[number].with_data.empty(); }

  /// Puts control point `number` to `place` and returns the energy of all terms it changes.
  double at(int number, const Eigen::Vector3d& place) {
    const Neighbourhood& near = near_[number];
    control_.row(number) = place;
    const Points moved = energy_.bones()(control_, near.vertices);
    for (std::size_t i = 0; i < near.slots.size(); ++i) slots_.row(near.slots[i]) = moved.row(i);
    double distance = 0.0, strain = 0.0, bending = 0.0;
    for (int s : near.with_data)
      distance += soft_absolute(energy_.distance_of(slots_.row(s)).value, energy_.softness());
    for (const RegistrationEnergy::Edge* edge : near.edges) {
      strain += soft_absolute(energy_.strain_of(*edge, slots_).value, energy_.softness());
      bending += soft_absolute(energy_.bending_of(*edge, slots_).value, energy_.bending_softness());
    }
    return energy_.distance_share() * distance + energy_.strain_share() * strain + energy_.bending_share() * bending;
  }

 private:
  struct Neighbourhood {
    std::vector<int> slots, vertices, with_data;
    std::vector<const RegistrationEnergy::Edge*> edges;
  };
  const RegistrationEnergy& energy_;
  Points control_;
  Points slots_;
  std::vector<Neighbourhood> near_;
};

SolvedEnergy solve_whole(const RegistrationEnergy& energy, const Points& start,
                         const EnergyRegistrationOptions& options) {
  const Eigen::VectorXd from = Eigen::Map<const Eigen::VectorXd>(start.data(), start.size());
  auto points = [&](const Eigen::VectorXd& place) -> Points {
    return Eigen::Map<const Points>(place.data(), start.rows(), 3);
  };
  SimplexOptions simplex;
  simplex.first_size = options.simplex_size;
  simplex.spread = 1e-3 * options.tolerance;
  simplex.least_size = 1e-3 * options.simplex_size;
  simplex.most_evaluations = 100 * options.most_steps * static_cast<int>(start.size());
  simplex.restarts = options.most_steps;
  const SimplexResult found =
      downhill_simplex([&](const Eigen::VectorXd& place) { return energy(points(place)).total; }, from, simplex);
  return {points(found.place), 1, found.evaluations, found.converged};
}

}  // namespace

SolvedEnergy solve_by_simplex(const RegistrationEnergy& energy, const Points& start,
                              const EnergyRegistrationOptions& options, Progress& progress) {
  if (options.whole_simplex) return solve_whole(energy, start, options);
  SolvedEnergy solved{start};
  LocalEnergy local(energy, start);
  const double initial = energy(start).total;
  SimplexOptions simplex;
  simplex.first_size = options.simplex_size;
  simplex.most_evaluations = 60;  // a point is visited again in the next sweep, when its neighbours have moved too
  simplex.restarts = 0;
  for (int sweep = 0; sweep < options.most_steps && !solved.converged; ++sweep) {
    double gained = 0.0;
    simplex.least_size = 0.02 * simplex.first_size;
    for (int c = 0; c < start.rows(); ++c) {
      progress.check();
      if (!local.moves_any(c)) continue;
      const SimplexResult found = downhill_simplex([&](const Eigen::VectorXd& place) { return local.at(c, place); },
                                                   local.control().row(c).transpose(), simplex);
      local.at(c, found.place);
      gained += found.initial_value - found.value;
      solved.evaluations += found.evaluations;
    }
    ++solved.steps;
    // A coarse simplex that gains nothing says little; the next is finer.
    solved.converged = gained < options.tolerance * initial && simplex.first_size < 0.1;
    simplex.first_size = std::max(0.05, 0.5 * simplex.first_size);
  }
  solved.control = local.control();
  return solved;
}

}  // namespace vultus::registration
