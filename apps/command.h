#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/console.h"
#include "core/error.h"

namespace CLI {
class App;
}

namespace vultus::apps {

/// What a running command works with: progress, the shared flags that concern results, and the report of `--json`.
class Run {
 public:
  Run(Console& console, std::uint64_t seed, bool force) : console_(console), seed_(seed), force_(force) {}

  Progress& progress() { return console_; }
  std::uint64_t seed() const { return seed_; }
  bool force() const { return force_; }

  void warn(const std::string& line) { console_.warn(line); }
  void print(const std::string& line);  ///< data, to stdout
  /// A line of CSV: text is quoted where it must be, null is an empty field.
  void print_row(const std::vector<nlohmann::json>& fields);
  void input(const std::filesystem::path& file);  ///< its hash goes into the report
  nlohmann::json& numbers() { return numbers_; }  ///< what was measured, for the report
  const nlohmann::json& numbers() const { return numbers_; }
  nlohmann::json& report() { return report_; }  ///< members of the report's top level, beside the shared ones
  const nlohmann::json& report() const { return report_; }
  const nlohmann::json& inputs() const { return inputs_; }

 private:
  Console& console_;
  std::uint64_t seed_;
  bool force_;
  nlohmann::json numbers_ = nlohmann::json::object(), inputs_ = nlohmann::json::object(),
                 report_ = nlohmann::json::object();
};

using Action = std::function<ExitCode(Run&)>;

/// Shared flags that not every command has a use for.
struct Flags {
  bool seed = false, force = false;
};

/// The commands of the one binary, and what they have in common: `--threads --quiet --json`, and `--seed --force` where
/// they matter; errors turned into exit codes; names mistyped met with the nearest one.
class CommandTable {
 public:
  CommandTable();
  ~CommandTable();

  /// Adds a command; `words` is its name, or group and name ("scan clean"). The caller adds its options to the result.
  CLI::App& add(const std::string& words, const std::string& summary, const std::string& example, Flags flags,
                Action action);

  /// Parses, runs, reports. Returns the process's exit code: `ExitCode`, 128 + signal after Ctrl-C, 70 for an error of
  /// our own making.
  int run(int argc, const char* const* argv);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Adds an option that takes one of a few names; another is refused with the nearest.
void add_choice(CLI::App& app, const std::string& option, std::string& value, const std::string& summary,
                const std::vector<std::string>& names);

/// The same; `chosen` is given the number of the name, and only called when the option is used.
void add_choice(CLI::App& app, const std::string& option, const std::string& standard, const std::string& summary,
                const std::vector<std::string>& names, const std::function<void(std::size_t)>& chosen);

/// The same for values that have names; `value` holds the standard one and must outlive the parsing.
template <class Value>
void add_choice(CLI::App& app, const std::string& option, Value& value, const std::string& summary,
                const std::vector<std::pair<std::string, Value>>& choices) {
  std::vector<std::string> names;
  std::string standard;
  for (const auto& [name, choice] : choices) {
    names.push_back(name);
    if (choice == value) standard = name;
  }
  add_choice(app, option, standard, summary, names,
             [&value, choices](std::size_t number) { value = choices[number].second; });
}

/// Throws `UsageError` naming the nearest of `names` unless `name` is one of them.
void check_name(const std::string& what, const std::string& name, const std::vector<std::string>& names);

}  // namespace vultus::apps
