#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/command.h"

namespace vultus::apps {

/// How a command ended.
struct Outcome {
  std::string command;
  nlohmann::json options;
  int exit_code = 0;
  std::string error;
  double seconds = 0.0;
};

/// The report of `--json`: command, version, options, inputs' hashes, timings of the stages, peak memory, numbers, what
/// was decided and warned of, exit code and error.
nlohmann::json report_json(const Outcome& outcome, const Run& run, const Console& console);

/// Every option of a parsed command with the value in force.
nlohmann::json options_json(const CLI::App& app);

}  // namespace vultus::apps
