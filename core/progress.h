#pragma once

#include <cstddef>
#include <string_view>

namespace vultus {

/// Where long work says how far it is and asks whether it should stop. Thread-safe in every implementation.
/// Libraries take a `Progress&`, never print; the command line draws it.
class Progress {
 public:
  virtual ~Progress() = default;

  /// Starts a stage of `total` steps (0: unknown). A stage ends when the next begins or the object dies.
  virtual void begin(std::string_view stage, std::size_t total) = 0;
  /// Reports `steps` more steps done.
  virtual void advance(std::size_t steps = 1) = 0;
  /// One line for the log, such as a decision taken about the input ("units: centimetres, from eye distance").
  virtual void note(std::string_view line) = 0;
  /// True once the user asked to stop.
  virtual bool cancelled() const = 0;

  /// Throws `Cancelled` once the user asked to stop.
  void check() const;

  /// A sink that shows nothing and never cancels.
  static Progress& none();
};

}  // namespace vultus
