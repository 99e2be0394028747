#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mocap/take.h"

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

/// A column of times as it is read.
struct TextTimes {
  std::vector<double> seconds;  ///< NaN for cells that are no number
  int digits = 0;               ///< most digits after the point

  void add(std::string_view cell, bool decimal_comma = false);
  double step() const;  ///< of the last digit, seconds
  std::vector<double> finite() const;
};

/// More samples than this no text of so many bytes is taken to hold: rows may end before their last missing cells, but
/// a file of such stumps must not make a take far larger than itself.
constexpr std::size_t samples_within(std::size_t bytes) { return bytes; }

/// Samples at exactly (0, 0, 0), where programs put what they did not see, become missing, and `take.decisions` says
/// so; positions of missing samples become zero.
void drop_origin(Take& take);

std::string trimmed(std::string_view text);
bool same_word(std::string_view a, std::string_view b);  ///< without regard to case

}  // namespace vultus::mocap
