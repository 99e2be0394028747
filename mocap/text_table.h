#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vultus::mocap {

/// Cells of one line; double quotes protect separators and are removed, blanks around a cell too.
std::vector<std::string> cells_of(std::string_view line, char separator);

/// One cell of numbers.
struct Cell {
  enum Kind { number, missing, malformed } kind = malformed;
  double value = 0.0;
};
/// Empty, "NA", "NaN", "null", "-" and infinities are missing; `decimal_comma` accepts "1,5".
Cell cell_value(std::string_view cell, bool decimal_comma = false);

/// More samples than this no text of so many bytes is taken to hold: rows may end before their last missing cells, but
/// a file of such stumps must not make a take far larger than itself.
constexpr std::size_t samples_within(std::size_t bytes) { return bytes; }

std::string trimmed(std::string_view text);
bool same_word(std::string_view a, std::string_view b);  ///< without regard to case

}  // namespace vultus::mocap
