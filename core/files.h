#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace vultus {

/// Whole file as bytes; throws `InputError` (missing, a folder, no permission, larger than `limit`).
std::string read_file(const std::filesystem::path& file, std::size_t limit = std::size_t{8} << 30);

/// Writes through a temporary file in the same folder and renames it over `file`, so that a reader sees the old or
/// the new content, never a part. Makes missing parent folders. Devices and pipes are written straight. Throws
/// `OutputError`; nothing half-written stays.
void write_file(const std::filesystem::path& file, std::string_view content);
/// The same for writers that need a path: `write` gets a temporary path with `file`'s extension.
void write_file_with(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& write);

/// Parses JSON; errors name file and line.
nlohmann::json read_json(const std::filesystem::path& file);
void write_json(const std::filesystem::path& file, const nlohmann::json& json);

void make_folder(const std::filesystem::path& folder);  ///< with parents; throws `OutputError`

/// The entry of `names` nearest to `word` by edit distance, or empty; for "did you mean".
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

}  // namespace vultus
