#pragma once

#include <charconv>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh_io.h"

/// What the readers and writers of the three mesh formats share; not part of the library's interface.
namespace vultus::mesh_files {

Mesh read_obj(const std::filesystem::path& file, std::string_view content, NonFinite non_finite);
Mesh read_ply(const std::filesystem::path& file, std::string_view content, NonFinite non_finite);
Mesh read_stl(const std::filesystem::path& file, std::string_view content, NonFinite non_finite);

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Walks over a text file line by line and word by word, without copies.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : rest_(text) {}

  /// Takes the next line (without its end); false at the end of the file.
  bool next_line() {
    if (rest_.empty()) return false;
    const auto end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++number_;
    return true;
  }
  /// Takes the next word of the line; empty when there is none left.
  std::string_view word() {
    while (!line_.empty() && is_blank(line_.front())) line_.remove_prefix(1);
    std::size_t size = 0;
    while (size < line_.size() && !is_blank(line_[size])) ++size;
    const std::string_view taken = line_.substr(0, size);
    line_.remove_prefix(size);
    return taken;
  }
  /// What is left of the line, without blanks at its ends.
  std::string_view rest_of_line() {
    while (!line_.empty() && is_blank(line_.front())) line_.remove_prefix(1);
    while (!line_.empty() && is_blank(line_.back())) line_.remove_suffix(1);
    return line_;
  }
  std::string_view rest_of_file() const { return rest_; }
  std::size_t line_number() const { return number_; }
  std::string place() const { return "line " + std::to_string(number_); }

 private:
  std::string_view rest_, line_;
  std::size_t number_ = 0;
};

/// The whole of `word` as a number ("nan" and "inf" included); false when it is none.
template <class Number>
bool parse(std::string_view word, Number& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

/// Faces as they are read, with the checks that need the file's own numbering.
struct Faces {
  std::vector<int> offsets{0}, corner_vertex, corner_uv;
  void close() { offsets.push_back(static_cast<int>(corner_vertex.size())); }
};

/// Path of the image that a mesh file calls `name`: beside the file, whatever folders its author's machine had.
std::string texture_path(const std::filesystem::path& file, std::string name);

/// n×3 from a flat list.
Points points_from(const std::vector<double>& flat);

/// `Topology::make` with the file's name in the error.
std::shared_ptr<const Topology> make_topology(const std::filesystem::path& file, TopologyData data);

/// Throws `InputError` naming the first vertex with a coordinate that is not finite, unless they are kept.
void check_finite(const std::filesystem::path& file, const Points& positions, NonFinite non_finite);

}  // namespace vultus::mesh_files
