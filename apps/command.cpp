#include "apps/command.h"

#include <oneapi/tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <new>
#include <thread>

#include "apps/report.h"
#include "core/files.h"
#include "core/manifest.h"
#include "core/number_text.h"

namespace vultus::apps {
namespace {

std::string csv_field(const nlohmann::json& value) {
  if (value.is_null()) return "";
  if (value.is_number_float()) return number(value.get<double>(), "%.6g");
  if (!value.is_string()) return value.dump();
  std::string text = value.get<std::string>();
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return "\"" + text + "\"";
}

struct SharedFlags {
  int threads = 0;
  std::uint64_t seed = 1;
  bool quiet = false, force = false;
  std::filesystem::path json;
};

struct Command {
  std::string words;
  CLI::App* app = nullptr;
  Action action;
  SharedFlags flags;
};

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string near = nearest_name(word, names);
  return near.empty() ? "" : "; did you mean \"" + near + "\"?";
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// CLI11 complains of a missing argument before it looks at words it does not know, which are the likelier mistake.
void refuse_unknown_option(const CLI::App& app) {
  for (const std::string& word : app.remaining()) {
    if (word.size() > 1 && word[0] == '-') {
      const std::string name = word.substr(0, word.find('='));
      throw UsageError("unknown option \"" + name + "\"" + did_you_mean(name, option_names(app)));
    }
  }
}

const CLI::App& deepest_parsed(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : deepest_parsed(*chosen.front());
}

void refuse_unknown_command(const CLI::App& root, int argc, const char* const* argv) {
  const CLI::App* app = &root;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const auto names = subcommand_names(*app);
    if (names.empty() || word.starts_with('-')) return;
    if (std::find(names.begin(), names.end(), word) == names.end()) {
      throw UsageError("unknown command \"" + word + "\"" + did_you_mean(word, names));
    }
    app = app->get_subcommand(word);
  }
}

int exit_code_of(const std::exception_ptr& problem, std::string& message) {
  const auto code = [](ExitCode value) { return static_cast<int>(value); };
  try {
    std::rethrow_exception(problem);
  } catch (const Cancelled& error) {
    message = error.what();
    return 128 + stop_signal();
  } catch (const UsageError& error) {
    message = error.what();
    return code(ExitCode::usage);
  } catch (const ToolError& error) {
    message = error.what();
    return code(ExitCode::missing_tool);
  } catch (const OutputError& error) {
    message = error.what();
    return code(ExitCode::cannot_write);
  } catch (const Error& error) {
    message = error.what();
    return code(ExitCode::bad_input);
  } catch (const std::filesystem::filesystem_error& error) {
    message = error.path1().string() + ": " + error.code().message();
    return code(ExitCode::bad_input);
  } catch (const std::bad_alloc&) {
    message = "not enough memory";
    return code(ExitCode::missing_tool);
  } catch (const std::exception& error) {
    message = std::string("internal error: ") + error.what();
    return 70;
  }
}

}  // namespace

struct CommandTable::Impl {
  CLI::App root{"Vultus: facial capture, registration, rigs, performance and rendering.", "vultus"};
  std::vector<std::unique_ptr<Command>> commands;

  const Command* chosen() const {
    const CLI::App* app = &deepest_parsed(root);
    for (const auto& command : commands) {
      if (command->app == app) return command.get();
    }
    return nullptr;
  }
  int execute(const Command& command);
};

CommandTable::CommandTable() : impl_(std::make_unique<Impl>()) {
  impl_->root.set_version_flag("--version", "vultus " + version(), "Print the version and exit");
  impl_->root.require_subcommand(1);
  impl_->root.footer(
      "\"vultus COMMAND --help\" explains a command. Exit codes: 0 ok, 1 usage, 2 bad input,\n"
      "3 missing tool or feature, 4 cannot write, 5 finished but below the asked quality.");
}

CommandTable::~CommandTable() = default;

CLI::App& CommandTable::add(const std::string& words, const std::string& summary, const std::string& example,
                            Flags flags, Action action) {
  const auto space = words.find(' ');
  CLI::App* parent = &impl_->root;
  if (space != std::string::npos) {
    const std::string group = words.substr(0, space);
    const auto known = subcommand_names(*parent);
    const bool is_new = std::find(known.begin(), known.end(), group) == known.end();
    const std::string group_summary =
        group == "bench" ? "Figures measured against truth" : "The " + group + " stage alone";
    parent =
        is_new ? parent->add_subcommand(group, group_summary)->require_subcommand(1) : parent->get_subcommand(group);
  }
  auto command = std::make_unique<Command>();
  command->words = words;
  command->action = std::move(action);
  CLI::App* app = parent->add_subcommand(words.substr(space == std::string::npos ? 0 : space + 1), summary);
  command->app = app;
  app->footer("\nExample:\n  " + example);
  SharedFlags& shared = command->flags;
  const std::string group = "Shared options";
  app->add_option("--threads", shared.threads, "Threads to use at most (0: all cores); results do not depend on it")
      ->check(CLI::Range(0, 4096))
      ->group(group);
  if (flags.seed)
    app->add_option("--seed", shared.seed, "Seed of everything random")->capture_default_str()->group(group);
  if (flags.force) app->add_flag("--force", shared.force, "Redo work that is already done")->group(group);
  app->add_flag("--quiet", shared.quiet, "Only errors on stderr")->group(group);
  app->add_option("--json", shared.json, "Write a report (options, hashes, timings, numbers) to FILE")
      ->type_name("FILE")
      ->group(group);
  impl_->commands.push_back(std::move(command));
  return *app;
}

int CommandTable::Impl::execute(const Command& command) {
  const SharedFlags& flags = command.flags;
  const int most = flags.threads > 0 ? flags.threads : static_cast<int>(std::thread::hardware_concurrency());
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(std::max(1, most)));
  Console console(flags.quiet);
  Run run(console, flags.seed, flags.force);
  const auto start = std::chrono::steady_clock::now();
  std::string message;
  int code = 0;
  try {
    code = static_cast<int>(command.action(run));
    if (!std::cout.flush()) throw OutputError("stdout", "the output is not taken");
  } catch (...) {
    code = exit_code_of(std::current_exception(), message);
  }
  console.finish();
  if (!message.empty()) std::cerr << "vultus: " << message << "\n";
  if (flags.json.empty()) return code;
  try {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    write_json(flags.json,
               report_json({command.words, options_json(*command.app), code, message, seconds}, run, console));
  } catch (const Error& error) {
    std::cerr << "vultus: " << error.what() << "\n";
    return static_cast<int>(ExitCode::cannot_write);
  }
  return code;
}

int CommandTable::run(int argc, const char* const* argv) {
  CLI::App& root = impl_->root;
  try {
    refuse_unknown_command(root, argc, argv);
    try {
      root.parse(argc, argv);
    } catch (const CLI::Success& help_or_version) {
      return root.exit(help_or_version, std::cout, std::cerr);
    } catch (const CLI::ParseError& error) {
      const CLI::App& app = deepest_parsed(root);
      refuse_unknown_option(app);
      throw UsageError(std::string(error.what()) + "\nRun with --help for more information.");
    }
  } catch (const UsageError& error) {
    std::cerr << "vultus: " << error.what() << "\n";
    return static_cast<int>(ExitCode::usage);
  }
  return impl_->execute(*impl_->chosen());
}

void Run::print_row(const std::vector<nlohmann::json>& fields) {
  std::string line;
  for (const nlohmann::json& field : fields) line += (&field == &fields.front() ? "" : ",") + csv_field(field);
  print(line);
}

void Run::print(const std::string& line) { std::cout << line << "\n"; }

void Run::input(const std::filesystem::path& file) { inputs_[file.string()] = sha256_of_file(file); }

void check_name(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  throw UsageError("unknown " + what + " \"" + name + "\"" + did_you_mean(name, names));
}

namespace {

/// What is shown of a choice, and what refuses other words.
void limit_to(const std::vector<std::string>& names, CLI::Option& option) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : "|") + name;
  option.type_name(list)->check([names](const std::string& word) {
    if (std::find(names.begin(), names.end(), word) != names.end()) return std::string();
    return "unknown value \"" + word + "\"" + did_you_mean(word, names);
  });
}

}  // namespace

void add_choice(CLI::App& app, const std::string& option, std::string& value, const std::string& summary,
                const std::vector<std::string>& names) {
  limit_to(names, *app.add_option(option, value, summary)->capture_default_str());
}

void add_choice(CLI::App& app, const std::string& option, const std::string& standard, const std::string& summary,
                const std::vector<std::string>& names, const std::function<void(std::size_t)>& chosen) {
  const auto set = [names, chosen](const std::string& word) {
    chosen(static_cast<std::size_t>(std::find(names.begin(), names.end(), word) - names.begin()));
  };
  limit_to(names, *app.add_option_function<std::string>(option, set, summary)->default_str(standard));
}

}  // namespace vultus::apps
