#pragma once

#include <memory>
#include <optional>

#include "core/progress.h"
#include "register/landmarks.h"
#include "register/register_options.h"
#include "register/registered.h"
#include "register/template.h"
#include "scan/clean.h"

namespace vultus::registration {

/// Brings scans to one template's topology (DESIGN §3.2). Keeps what scans share: the refined topology and the
/// template's own landmarks as the finder sees them. Methods are const and may run for several scans at once.
class Registration {
 public:
  /// A template that names no landmarks gets those found on its own shape (register/found_landmarks.h; throws
  /// `InputError` where there are none, `ToolError` without dlib's model).
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
  /// The same for what cleaning made (mm): triangles that it invented never count as data, and what it had to repair
  /// is a reason for a warning in the verdict.
  Registered neutral(const scan::CleanScan& scan, const std::optional<ScanLandmarks>& landmarks = {},
                     Progress& progress = Progress::none()) const;
  Registered expression(const Registered& neutral, const scan::CleanScan& scan,
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
