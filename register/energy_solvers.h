#pragma once

#include "register/energy_registration.h"

namespace vultus::registration {

/// How far one solver came with the vertices that have data now.
struct SolvedEnergy {
  Points control;
  int steps = 0, evaluations = 0;
  bool converged = false;
};

/// Ceres, Levenberg-Marquardt with exact derivatives. Throws `InputError` for a softness of 0.
SolvedEnergy solve_by_ceres(const RegistrationEnergy& energy, const Points& start,
                            const EnergyRegistrationOptions& options, Progress& progress);
/// Downhill simplex, over each control point in turn or over all.
SolvedEnergy solve_by_simplex(const RegistrationEnergy& energy, const Points& start,
                              const EnergyRegistrationOptions& options, Progress& progress);

}  // namespace vultus::registration
