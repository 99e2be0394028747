#pragma once

#include <filesystem>
#include <string>

#include "apps/command.h"
#include "mocap/take.h"

namespace vultus::apps {

/// What every step on one take has in common.
struct TakeArguments {
  std::filesystem::path take, out;
  mocap::ReadOptions reading;
};

/// Adds TAKE, --out and how the file is to be understood (--unit, --up, --rate).
void add_take_options(CLI::App& app, TakeArguments& arguments);

/// Reads the take; what reading decided goes to the log.
mocap::Take read_step(const TakeArguments& arguments, Run& run);
/// Writes it, prints the file's name, and begins `run.numbers()` with frames, markers and the share missing.
void write_step(const TakeArguments& arguments, const mocap::Take& take, Run& run);

}  // namespace vultus::apps
