#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "core/progress.h"

namespace vultus::apps {

/// Progress on stderr: a bar with the time left on a terminal, plain lines elsewhere, only errors when quiet.
/// SIGINT and SIGTERM make `cancelled()` true; a second signal ends the process at once.
class Console final : public Progress {
 public:
  explicit Console(bool quiet);
  ~Console() override;

  void begin(std::string_view stage, std::size_t total) override;
  void advance(std::size_t steps = 1) override;
  void note(std::string_view line) override;
  bool cancelled() const override;

  void warn(std::string_view line);  ///< as `note`, marked
  void finish();                     ///< ends the running stage

  struct Timing {
    std::string stage;
    double seconds = 0.0;
  };
  /// One entry a stage that has ended, in order; stages of one name that follow each other are summed.
  const std::vector<Timing>& timings() const { return timings_; }
  const std::vector<std::string>& notes() const { return notes_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  using Clock = std::chrono::steady_clock;
  void end_stage();
  void say(std::string_view line);
  void draw(Clock::time_point now);

  bool quiet_, terminal_;
  std::mutex mutex_;
  std::string stage_;
  std::atomic<std::size_t> done_{0};
  std::size_t total_ = 0;
  Clock::time_point stage_start_, last_drawn_;
  std::vector<Timing> timings_;
  std::vector<std::string> notes_, warnings_;
};

/// Number of the signal that asked to stop, 0 for none.
int stop_signal();

}  // namespace vultus::apps
