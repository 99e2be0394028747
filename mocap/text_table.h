#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vultus::mocap {

/// Lines of a text without their ends (LF, CRLF or CR LF mixed); a byte-order mark is passed over.
std::vector<std::string_view> lines_of(std::string_view text);

/// Cells of one line; double quotes protect separators and are removed, blanks around a cell too.
std::vector<std::string> cells_of(std::string_view line, char separator);

/// One cell of numbers.
struct Cell {
  enum Kind { number, missing, malformed } kind = malformed;
  double value = 0.0;
};
/// Empty, "NA", "NaN", "null", "-" and infinities are missing; `decimal_comma` accepts "1,5".
Cell cell_value(std::string_view cell, bool decimal_comma = false);

std::string trimmed(std::string_view text);
bool same_word(std::string_view a, std::string_view b);  ///< without regard to case

}  // namespace vultus::mocap
