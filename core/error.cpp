#include "core/error.h"

namespace vultus {

InputError::InputError(const std::filesystem::path& file, const std::string& problem)
    : Error(file.string() + ": " + problem) {}

InputError::InputError(const std::filesystem::path& file, const std::string& place, const std::string& problem)
    : Error(file.string() + ": " + place + ": " + problem) {}

OutputError::OutputError(const std::filesystem::path& file, const std::string& problem)
    : Error("cannot write " + file.string() + ": " + problem) {}

}  // namespace vultus
