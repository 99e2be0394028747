#include "mocap/text_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>

namespace vultus::mocap {

namespace {

bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\0'; }

std::string_view stripped(std::string_view text) {
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back().push_back(c);
    }
  }
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

Cell cell_value(std::string_view cell, bool decimal_comma) {
  cell = stripped(cell);
  if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') cell = stripped(cell.substr(1, cell.size() - 2));
  if (cell.empty() || cell == "-" || same_word(cell, "na") || same_word(cell, "null")) return {Cell::missing, 0.0};
  std::string copy;
  if (decimal_comma && cell.find(',') != std::string_view::npos) {
    copy = std::string(cell);
    std::replace(copy.begin(), copy.end(), ',', '.');
    cell = copy;
  }
  if (cell.front() == '+') cell.remove_prefix(1);
  Cell result;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), result.value);
  if (error != std::errc() || end != cell.data() + cell.size()) return {Cell::malformed, 0.0};
  result.kind = std::isfinite(result.value) && std::abs(result.value) < 1e30 ? Cell::number : Cell::missing;
  return result;
}

void TextTimes::add(std::string_view cell, bool decimal_comma) {
  const Cell time = cell_value(cell, decimal_comma);
  seconds.push_back(time.kind == Cell::number ? time.value : std::numeric_limits<double>::quiet_NaN());
  const std::string_view text = stripped(cell);
  const std::size_t point = text.find_first_of(decimal_comma ? ".," : "."), end = text.find_first_of("eE");
  if (end != text.npos) {
    digits = 12;
  } else if (point != text.npos) {
    digits = std::max(digits, static_cast<int>(std::min<std::size_t>(text.size() - point - 1, 12)));
  }
}

double TextTimes::step() const { return std::pow(10.0, -digits); }

std::vector<double> TextTimes::finite() const {
  std::vector<double> result;
  std::copy_if(seconds.begin(), seconds.end(), std::back_inserter(result), [](double t) { return std::isfinite(t); });
  return result;
}

void drop_origin(Take& take) {
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < take.present.size(); ++i) {
    float* p = take.positions.data() + 3 * i;
    if (take.present[i] != 0 && p[0] == 0.0F && p[1] == 0.0F && p[2] == 0.0F) {
      take.present[i] = 0;
      ++dropped;
    }
    if (take.present[i] == 0) std::fill(p, p + 3, 0.0F);
  }
  if (dropped > 0)
    take.decisions.push_back("samples: " + std::to_string(dropped) + " at exactly (0, 0, 0) taken as missing");
}

std::string trimmed(std::string_view text) { return std::string(stripped(text)); }

bool same_word(std::string_view a, std::string_view b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](unsigned char x, unsigned char y) {
           return std::tolower(x) == std::tolower(y);
         });
}

}  // namespace vultus::mocap
