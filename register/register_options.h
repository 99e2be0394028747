#pragma once

#include <memory>
#include <string>
#include <vector>

#include "register/energy_solver.h"
#include "register/quality.h"

namespace vultus::registration {

class FaceFinder;

/// `standard` ("default"): RBF start, then non-rigid refinement. `zhu`: RBF, subdivision and cylindrical projection as
/// published (Zhu §4.3–4.5). `sanchez`: distance, strain and bending over a control surface of planar bones (Sánchez
/// §6).
enum class Method { standard, zhu, sanchez };
/// "default", "zhu" or "sanchez"; throws `UsageError` with the nearest name.
Method method_named(const std::string& name);
std::string name_of(Method method);
std::vector<std::string> method_names();

/// Who finds landmarks: `pictures` ("dlib") needs dlib's model and a face it can see; `shape` ("geometry") needs
/// neither colour nor model; `automatic` takes pictures where they show a face, else shape.
enum class LandmarkFinder { automatic, pictures, shape };
/// "automatic", "dlib" or "geometry"; throws `UsageError` with the nearest name.
LandmarkFinder landmark_finder_named(const std::string& name);
std::vector<std::string> landmark_finder_names();

struct RegisterOptions {
  Method method = Method::standard;
  EnergySolver energy_solver = EnergySolver::ceres;  ///< of the method `sanchez`
  LandmarkFinder landmarks_by = LandmarkFinder::automatic;
  double displacement_limit = 10.0;          ///< mm, > 0: Zhu's threshold against large displacements (§4.5.2)
  double least_confidence = 0.1;             ///< landmarks found below this do not take part
  std::shared_ptr<const FaceFinder> finder;  ///< loaded on first need when absent
  QualityLimits limits;
  void validate() const;  ///< throws `InputError`
};

/// The defaults with method and energy solver by name. Throws `UsageError` for unknown names and for another solver
/// than the default with a method that minimizes no energy.
RegisterOptions register_options(const std::string& method, const std::string& energy_solver);
/// The method in words that tell apart what gives different results: "default", "zhu", "sanchez", "sanchez, simplex",
/// "default, landmarks by geometry".
std::string method_in_words(const RegisterOptions& options);

}  // namespace vultus::registration
