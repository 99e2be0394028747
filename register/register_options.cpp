#include "register/register_options.h"

#include "core/error.h"
#include "core/files.h"

namespace vultus::registration {

std::vector<std::string> method_names() { return {"default", "zhu", "sanchez"}; }

Method method_named(const std::string& name) {
  if (name == "default") return Method::standard;
  if (name == "zhu") return Method::zhu;
  if (name == "sanchez") return Method::sanchez;
  throw UsageError("unknown registration method \"" + name + "\"; did you mean \"" +
                   nearest_name(name, method_names()) + "\"?");
}

std::string name_of(Method method) {
  switch (method) {
    case Method::zhu:
      return "zhu";
    case Method::sanchez:
      return "sanchez";
    case Method::standard:
      break;
  }
  return "default";
}

std::vector<std::string> landmark_finder_names() { return {"automatic", "dlib", "geometry"}; }

LandmarkFinder landmark_finder_named(const std::string& name) {
  if (name == "automatic") return LandmarkFinder::automatic;
  if (name == "dlib") return LandmarkFinder::pictures;
  if (name == "geometry") return LandmarkFinder::shape;
  throw UsageError("unknown landmark finder \"" + name + "\"; did you mean \"" +
                   nearest_name(name, landmark_finder_names()) + "\"?");
}

RegisterOptions register_options(const std::string& method, const std::string& energy_solver) {
  RegisterOptions options;
  options.method = method_named(method);
  const EnergySolver solver = energy_solver_named(energy_solver);
  if (solver != options.energy_solver && options.method != Method::sanchez)
    throw UsageError("the energy solver \"" + energy_solver + "\" is for the method \"sanchez\", not \"" + method +
                     "\"");
  options.energy_solver = solver;
  return options;
}

std::string method_in_words(const RegisterOptions& options) {
  const bool by_simplex = options.method == Method::sanchez && options.energy_solver == EnergySolver::simplex;
  std::string words = name_of(options.method) + (by_simplex ? ", simplex" : "");
  if (options.landmarks_by == LandmarkFinder::pictures) words += ", landmarks by dlib";
  if (options.landmarks_by == LandmarkFinder::shape) words += ", landmarks by geometry";
  return words;
}

void RegisterOptions::validate() const {
  if (!(displacement_limit > 0.0)) throw InputError("registration: the displacement limit must be positive");
  if (!(least_confidence >= 0.0 && least_confidence <= 1.0))
    throw InputError("registration: the least confidence must lie between 0 and 1");
}

}  // namespace vultus::registration
