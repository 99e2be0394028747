#include "apps/report.h"

#include <sys/resource.h>

#include <CLI/CLI.hpp>

#include "core/manifest.h"

namespace vultus::apps {
namespace {

std::string name_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name() : option.get_lnames().front();
}

nlohmann::json value_of(const CLI::Option& option) {
  if (option.count() == 0)
    return option.get_default_str().empty() ? nlohmann::json() : nlohmann::json(option.get_default_str());
  if (option.results().size() == 1) return option.results().front();
  return option.results();
}

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

nlohmann::json options_json(const CLI::App& app) {
  nlohmann::json options = nlohmann::json::object();
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = name_of(*option);
    if (name != "help" && name != "json" && name != "quiet") options[name] = value_of(*option);
  }
  return options;
}

nlohmann::json report_json(const Outcome& outcome, const Run& run, const Console& console) {
  nlohmann::json timings = nlohmann::json::array();
  for (const Console::Timing& timing : console.timings()) {
    timings.push_back({{"stage", timing.stage}, {"seconds", timing.seconds}});
  }
  nlohmann::json report = run.report();
  report.update({{"command", outcome.command},
                 {"version", version()},
                 {"options", outcome.options},
                 {"inputs", run.inputs()},
                 {"timings", timings},
                 {"seconds", outcome.seconds},
                 {"peak_memory_bytes", peak_memory_bytes()},
                 {"numbers", run.numbers()},
                 {"notes", console.notes()},
                 {"warnings", console.warnings()},
                 {"exit_code", outcome.exit_code},
                 {"error", outcome.error}});
  return report;
}

}  // namespace vultus::apps
