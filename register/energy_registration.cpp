#include "register/energy_registration.h"

#include <cmath>

#include "core/error.h"
#include "core/files.h"
#include "register/energy_solvers.h"

namespace vultus::registration {

std::vector<std::string> energy_solver_names() { return {"ceres", "simplex"}; }

EnergySolver energy_solver_named(const std::string& name) {
  if (name == "ceres") return EnergySolver::ceres;
  if (name == "simplex") return EnergySolver::simplex;
  throw UsageError("unknown energy solver \"" + name + "\"; did you mean \"" +
                   nearest_name(name, energy_solver_names()) + "\"?");
}

std::string name_of(EnergySolver solver) { return solver == EnergySolver::ceres ? "ceres" : "simplex"; }

void EnergyRegistrationOptions::validate() const {
  if (rounds < 1 || most_steps < 1) throw InputError("energy registration needs at least one round of one step");
  if (!(first_limit > 0.0 && last_limit > 0.0 && tolerance > 0.0 && simplex_size > 0.0))
    throw InputError("energy registration: limits, tolerance and simplex size must be positive");
}

EnergyRegistration minimize_energy(RegistrationEnergy& energy, const Points& start,
                                   const EnergyRegistrationOptions& options, Progress& progress) {
  options.validate();
  EnergyRegistration result;
  result.control = start;
  progress.begin("energy", static_cast<std::size_t>(options.rounds));
  bool converged = false;
  for (int round = 0; round < options.rounds; ++round) {
    progress.check();
    const double t = options.rounds > 1 ? static_cast<double>(round) / (options.rounds - 1) : 1.0;
    result.with_data =
        energy.find_data(result.control, options.first_limit * std::pow(options.last_limit / options.first_limit, t));
    const SolvedEnergy solved = options.solver == EnergySolver::ceres
                                    ? solve_by_ceres(energy, result.control, options, progress)
                                    : solve_by_simplex(energy, result.control, options, progress);
    result.control = solved.control;
    result.steps += solved.steps;
    result.evaluations += solved.evaluations;
    converged = solved.converged;
    progress.advance();
  }
  result.initial = energy(start);
  result.final = energy(result.control);
  result.stopped = result.with_data == 0 ? "no vertex has data within reach"
                   : converged           ? "the last step lowered the energy by less than the tolerance"
                                         : "the last round ran out of steps";
  return result;
}

}  // namespace vultus::registration
