#pragma once

#include <memory>
#include <string>
#include <vector>

#include "register/energy_solver.h"
#include "register/quality.h"

namespace vultus::registration {

class FaceFinder;

/// `standard` ("default"): RBF start, then non-rigid refinement. `zhu`: RBF, subdivision and cylindrical projection as
/// published (Zhu §4.3–4.5). `sanchez`: distance, strain and bending over a control surface of planar bones (Sánchez §6).
enum class Method { standard, zhu, sanchez };
/// "default", "zhu" or "sanchez"; throws `UsageError` with the nearest name.
Method method_named(const std::string& name);
std::string name_of(Method method);
std::vector<std::string> method_names();

struct RegisterOptions {
  Method method = Method::standard;
  EnergySolver energy_solver = EnergySolver::ceres;  ///< of the method `sanchez`
  double displacement_limit = 10.0;          ///< mm, > 0: Zhu's threshold against large displacements (§4.5.2)
  double least_confidence = 0.1;             ///< landmarks found below this do not take part
  std::shared_ptr<const FaceFinder> finder;  ///< loaded on first need when absent
  QualityLimits limits;
  void validate() const;  ///< throws `InputError`
};

}  // namespace vultus::registration
