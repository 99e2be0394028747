#pragma once

#include <string>
#include <vector>

namespace vultus::registration {

/// What minimizes the registration energy (register/energy_registration.h). `simplex`: downhill simplex as published;
/// `ceres`: Levenberg-Marquardt on the same energy, far faster.
enum class EnergySolver { simplex, ceres };
/// "simplex" or "ceres"; throws `UsageError` with the nearest name.
EnergySolver energy_solver_named(const std::string& name);
std::string name_of(EnergySolver solver);
std::vector<std::string> energy_solver_names();

}  // namespace vultus::registration
