#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace vultus {

/// Base of every error that a user can act on. `what()` is one line, ready to print.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Bad data: names the file and the place (line, byte, marker, frame, pose) and what would be accepted.
class InputError : public Error {
 public:
  using Error::Error;
  InputError(const std::filesystem::path& file, const std::string& problem);
  InputError(const std::filesystem::path& file, const std::string& place, const std::string& problem);
};

/// A command line that cannot be carried out as given.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// A missing program, driver, model file or feature; says how to get it.
class ToolError : public Error {
 public:
  using Error::Error;
};

/// A file or folder that cannot be written (permission, full disk).
class OutputError : public Error {
 public:
  using Error::Error;
  OutputError(const std::filesystem::path& file, const std::string& problem);
};

/// Work stopped by the user (Ctrl-C); what was finished stays on disk.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled; run the same command again to continue") {}
};

/// Process exit codes of the command line.
enum class ExitCode : int { ok = 0, usage = 1, bad_input = 2, missing_tool = 3, cannot_write = 4, below_quality = 5 };

}  // namespace vultus
