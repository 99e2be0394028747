#pragma once

#include <string>

#include "core/progress.h"
#include "register/energy_solver.h"
#include "register/registration_energy.h"

namespace vultus::registration {

struct EnergyRegistrationOptions {
  EnergySolver solver = EnergySolver::ceres;
  int rounds = 4;             ///< ≥ 1: times the vertices with data are found anew
  double first_limit = 15;    ///< mm, > 0: farthest data in the first round …
  double last_limit = 5;      ///< … and in the last
  int most_steps = 12;        ///< ≥ 1 a round: steps of Ceres, sweeps over all control points of the simplex
  double tolerance = 1e-3;    ///< > 0: a round ends when a step or sweep lowers the energy by less than this share
  double simplex_size = 2.0;  ///< mm, > 0: of the start simplex; halved from sweep to sweep
  /// One simplex over the displacements of all control points at once, as published, rather than over one point after
  /// another. A simplex does not find its way in hundreds of dimensions; for small control surfaces only.
  bool whole_simplex = false;
  void validate() const;  ///< throws `InputError`
};

struct EnergyRegistration {
  Points control;              ///< control_count×3, mm
  EnergyTerms initial, final;  ///< at the start and at the end, over the vertices with data in the last round
  int with_data = 0;           ///< of the vertices sampled
  int steps = 0;               ///< of Ceres, or sweeps
  int evaluations = 0;         ///< of the energy (a local one counts too)
  std::string stopped;         ///< why, in words
};

/// Sánchez et al. 2003, §6: moves the control points from `start` so that the energy becomes least. Never ends at a
/// higher energy than it began with in any round. Same answer whatever the number of threads.
EnergyRegistration minimize_energy(RegistrationEnergy& energy, const Points& start,
                                   const EnergyRegistrationOptions& options = {},
                                   Progress& progress = Progress::none());

}  // namespace vultus::registration
