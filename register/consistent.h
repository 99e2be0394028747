#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/transform.h"
#include "register/landmarks.h"
#include "register/nonrigid.h"
#include "register/quality.h"
#include "register/template.h"

namespace vultus::registration {

class FaceFinder;

/// `standard` ("default"): RBF start, then non-rigid refinement. `zhu`: RBF, subdivision and cylindrical projection as
/// published (Zhu §4.3–4.5).
enum class Method { standard, zhu };
/// "default" or "zhu"; throws `UsageError` with the nearest name.
Method method_named(const std::string& name);
std::string name_of(Method method);

struct RegisterOptions {
  Method method = Method::standard;
  double displacement_limit = 10.0;          ///< mm, > 0: Zhu's threshold against large displacements (§4.5.2)
  double least_confidence = 0.1;             ///< landmarks found below this do not take part
  std::shared_ptr<const FaceFinder> finder;  ///< loaded on first need when absent
  QualityLimits limits;
  void validate() const;  ///< throws `InputError`
};

/// A landmark that took part.
struct UsedLandmark {
  std::string name;
  Eigen::Vector3d on_scan, on_mesh;  ///< face frame, mm
  double confidence = 0.0;           ///< [0, 1]
  double residual = 0.0;             ///< mm between both
};

/// A scan in the template's topology.
struct Registered {
  Mesh mesh;                  ///< refined topology, face frame, mm
  Similarity face_from_scan;  ///< of the cleaned scan; scale is 1 unless the scan's unit proved wrong
  std::vector<UsedLandmark> landmarks;
  ScanLandmarks detected;  ///< every landmark found or given, face frame
  bool coloured = false;   ///< landmarks were found with the help of colour
  Quality quality;
  std::vector<std::string> decisions;  ///< what was decided about the input, in words
};

/// Brings scans to one template's topology (DESIGN §3.2). Keeps what scans share: the refined topology and the
/// template's own landmarks as the finder sees them. Methods are const and may run for several scans at once.
class Registration {
 public:
  explicit Registration(Template head, RegisterOptions options = {});
  ~Registration();

  const Template& head() const;
  const std::shared_ptr<const Topology>& refined() const;  ///< topology of every result
  const Points& refined_neutral() const;                   ///< the template's shape on it, mm

  /// A scan of the neutral face. Without `landmarks` they are found (needs dlib's model).
  /// Throws `InputError` when no face or too few landmarks are found, `ToolError` without the model.
  Registered neutral(const Mesh& clean_scan, const std::optional<ScanLandmarks>& landmarks = {},
                     Progress& progress = Progress::none()) const;
  /// Another pose of the same person, from the registered neutral.
  Registered expression(const Registered& neutral, const Mesh& clean_scan,
                        const std::optional<ScanLandmarks>& landmarks = {},
                        Progress& progress = Progress::none()) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One scan alone; `Registration` is cheaper for several.
Registered register_neutral(const Template& head, const Mesh& clean_scan, const std::optional<ScanLandmarks>& landmarks,
                            const RegisterOptions& options, Progress& progress);
Registered register_expression(const Template& head, const Registered& neutral, const Mesh& clean_scan,
                               const std::optional<ScanLandmarks>& landmarks, const RegisterOptions& options,
                               Progress& progress);

}  // namespace vultus::registration
