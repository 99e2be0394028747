#include "mocap/csv.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "core/error.h"
#include "mocap/axes.h"
#include "mocap/frame_times.h"
#include "mocap/marker_names.h"
#include "mocap/text_lines.h"
#include "mocap/text_table.h"

namespace vultus::mocap {

namespace {

using Lines = std::vector<std::string>;

constexpr std::size_t kStartLines = 20;  // more than any known form has above its samples
constexpr std::size_t kSectionHead = 5;  // lines of a Trajectories section above its samples
constexpr std::size_t kNone = ~std::size_t{0};

/// What a first pass over the file keeps of it.
struct Survey {
  Lines start;                  ///< the first lines
  Lines trajectories;           ///< Vicon's section from its name to its units
  std::size_t section = kNone;  ///< line of its name
  std::size_t end = 0;          ///< line after the section's samples, else after the file's lines
  std::uint64_t bytes = 0;
};

std::string at_line(std::size_t line) { return "line " + std::to_string(line + 1); }

/// Where a table keeps its markers.
struct Table {
  char separator = ',';
  std::size_t first_row = 0, end_row = 0;  ///< lines of the samples
  std::vector<std::string> names;
  std::vector<std::array<std::size_t, 3>> columns;  ///< x, y, z of each marker
  std::optional<std::size_t> time_column;           ///< seconds
  double rate_hz = 0.0;                             ///< 0: from the time column
  FileConvention convention;
};

char separator_of(std::string_view line) {
  char best = ',';
  for (const char c : {',', ';', '\t'}) {
    if (std::count(line.begin(), line.end(), c) > std::count(line.begin(), line.end(), best)) best = c;
  }
  return best;
}

/// "brow_x", "brow.X", "brow:x" or "brow x" → "brow" and 0; nothing for other columns.
std::optional<std::pair<std::string, std::size_t>> marker_column(const std::string& cell) {
  if (cell.size() < 3) return {};
  const char axis = static_cast<char>(std::tolower(static_cast<unsigned char>(cell.back())));
  const char mark = cell[cell.size() - 2];
  if (axis < 'x' || axis > 'z' || std::string("_.: -").find(mark) == std::string::npos) return {};
  return std::pair(trimmed(cell.substr(0, cell.size() - 2)), static_cast<std::size_t>(axis - 'x'));
}

void add_marker(Table& table, const std::string& name, std::array<std::size_t, 3> columns) {
  table.names.push_back(name);
  table.columns.push_back(columns);
}

Table plain_table(const std::filesystem::path& file, const Lines& lines) {
  Table table;
  table.separator = separator_of(lines[0]);
  const std::vector<std::string> cells = cells_of(lines[0], table.separator);
  std::map<std::string, std::array<std::size_t, 3>> found;
  std::vector<std::string> order;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (same_word(cells[c], "time") || same_word(cells[c], "time (seconds)")) table.time_column = c;
    const auto column = marker_column(cells[c]);
    if (!column) continue;
    const auto [place, added] = found.try_emplace(column->first, std::array{kNone, kNone, kNone});
    if (added) order.push_back(column->first);
    if (place->second[column->second] != kNone) {
      throw InputError(file, at_line(0), "the column '" + cells[c] + "' stands there twice");
    }
    place->second[column->second] = c;
  }
  for (const std::string& name : order) {
    const auto& columns = found[name];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (columns[axis] == kNone) {
        throw InputError(file, at_line(0), "marker '" + name + "' has no column for " + "xyz"[axis]);
      }
    }
    add_marker(table, name, columns);
  }
  table.first_row = 1;
  return table;
}

std::string after(const std::vector<std::string>& cells, const char* key) {
  for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
    if (same_word(cells[i], key)) return cells[i + 1];
  }
  return {};
}

/// "subject:marker" → "marker" when every name has the same prefix.
void drop_common_prefix(std::vector<std::string>& names) {
  if (names.empty()) return;
  const std::size_t colon = names[0].find(':');
  if (colon == std::string::npos) return;
  const std::string prefix = names[0].substr(0, colon + 1);
  if (!std::all_of(names.begin(), names.end(), [&](const std::string& n) { return n.starts_with(prefix); })) return;
  for (std::string& name : names) name.erase(0, prefix.size());
}

bool has_cell(const std::vector<std::string>& cells, const char* word) {
  return std::any_of(cells.begin(), cells.end(), [&](const std::string& c) { return same_word(c, word); });
}

/// Motive: rows of types, names, ids (and parents), properties, then "Frame, Time (Seconds), X, Y, Z, …".
Table motive_table(const std::filesystem::path& file, const Lines& lines) {
  Table table;
  const std::vector<std::string> facts = cells_of(lines[0], ',');
  const Cell rate = cell_value(after(facts, "Export Frame Rate"));
  if (rate.kind == Cell::number && rate.value > 0.0) table.rate_hz = rate.value;
  table.convention = {after(facts, "Length Units"), "", "y"};
  std::vector<std::string> types, names, properties, axes;
  std::size_t l = 1;
  for (; l < std::min(lines.size(), kStartLines) && axes.empty(); ++l) {
    const std::vector<std::string> cells = cells_of(lines[l], ',');
    if (cells.size() < 3) continue;
    if (same_word(cells[0], "Frame")) {
      axes = cells;
    } else if (types.empty() && (has_cell(cells, "Marker") || has_cell(cells, "Rigid Body Marker"))) {
      types = cells;
    } else if (!types.empty() && names.empty()) {
      names = cells;
    } else if (has_cell(cells, "Position")) {
      properties = cells;
    }
  }
  if (axes.empty() || types.empty() || properties.empty()) {
    throw InputError(file, at_line(l),
                     "a Motive export has rows with Marker, names, Position and Frame above its data");
  }
  const std::size_t width = std::min({types.size(), names.size(), properties.size(), axes.size()});
  for (const char* type : {"Marker", "Bone Marker", "Rigid Body Marker"}) {
    for (std::size_t c = 2; c + 2 < width; ++c) {
      const bool position = same_word(types[c], type) && same_word(properties[c], "Position") &&
                            same_word(axes[c], "X") && names[c] == names[c + 2];
      const bool known = std::find(table.names.begin(), table.names.end(), names[c]) != table.names.end();
      if (position && !known) add_marker(table, names[c], {c, c + 1, c + 2});
    }
  }
  drop_common_prefix(table.names);
  table.time_column = 1;
  table.first_row = l;
  return table;
}

/// Vicon: "Trajectories", the rate, names over every third column, axes, units; ends at a blank line.
Table vicon_table(const std::filesystem::path& file, const Survey& survey) {
  Table table;
  const Lines& lines = survey.trajectories;
  if (lines.size() < kSectionHead) {
    throw InputError(file, at_line(survey.section + lines.size()), "the Trajectories section is cut short");
  }
  table.separator = separator_of(lines[2]);
  const Cell rate = cell_value(cells_of(lines[1], table.separator)[0]);
  if (rate.kind != Cell::number || rate.value <= 0.0) {
    throw InputError(file, at_line(survey.section + 1), "the frame rate is expected below Trajectories");
  }
  table.rate_hz = rate.value;
  const std::vector<std::string> names = cells_of(lines[2], table.separator);
  const std::vector<std::string> axes = cells_of(lines[3], table.separator);
  const std::vector<std::string> units = cells_of(lines[4], table.separator);
  for (std::size_t c = 2; c + 2 < axes.size(); c += 3) {
    if (same_word(axes[c], "X")) add_marker(table, c < names.size() ? names[c] : "", {c, c + 1, c + 2});
  }
  drop_common_prefix(table.names);
  table.convention = {units.size() > 2 ? units[2] : "", "", "z"};  // Vicon's laboratory axes
  table.first_row = survey.section + kSectionHead;
  return table;
}

Survey survey_of(const std::filesystem::path& file) {
  TextLines lines(file);
  Survey survey;
  survey.bytes = lines.file_bytes();
  bool inside = false;
  for (std::string_view line; lines.next(line);) {
    const std::size_t l = lines.number() - 1;
    if (l < kStartLines) survey.start.emplace_back(line);
    if (survey.section == kNone && line.starts_with("Trajectories")) {
      survey.section = l;
      inside = true;
    }
    if (inside && survey.trajectories.size() < kSectionHead) {
      survey.trajectories.emplace_back(line);
    } else if (inside && trimmed(line).empty()) {
      inside = false;
      survey.end = l;
    }
  }
  if (survey.section == kNone || inside) survey.end = lines.number();
  return survey;
}

Table table_of(const std::filesystem::path& file, const Survey& survey) {
  const std::string& first = survey.start[0];
  const bool motive = first.starts_with("Format Version") || first.starts_with("\"Format Version");
  Table table = motive                    ? motive_table(file, survey.start)
                : survey.section != kNone ? vicon_table(file, survey)
                                          : plain_table(file, survey.start);
  table.end_row = motive ? kNone : survey.end;
  return table;
}

/// Cells of the row as views, quotes left in place (numbers have none that matter).
void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t end = std::min(line.find(separator, start), line.size());
    cells.push_back(line.substr(start, end - start));
    start = end + 1;
  }
}

/// Mean rate of the times, seconds; 0 where they do not rise.
double rate_of(const std::vector<double>& times) {
  if (times.size() < 2 || !(times.back() > times.front())) return 0.0;
  const double span = times.back() - times.front(), rate = static_cast<double>(times.size() - 1) / span;
  // Times printed to a tenth of a millisecond give 59.98 for 60.
  const double tolerance = rate * std::max(1e-4, 1e-4 / span);
  return std::abs(rate - std::round(rate)) < tolerance && rate > 5.0 ? std::round(rate) : rate;
}

/// One row's markers behind what `take` has.
void read_row(const std::filesystem::path& file, std::size_t l, const std::vector<std::string_view>& cells,
              const Table& table, Take& take) {
  const bool decimal_comma = table.separator != ',';
  for (const auto& columns : table.columns) {
    bool here = true;
    for (const std::size_t column : columns) {
      const Cell cell = column < cells.size() ? cell_value(cells[column], decimal_comma) : Cell{Cell::missing, 0.0};
      if (cell.kind == Cell::malformed) {
        throw InputError(file, at_line(l),
                         "column " + std::to_string(column + 1) + ": '" + trimmed(cells[column].substr(0, 40)) +
                             "' is not a number");
      }
      here = here && cell.kind == Cell::number;
      take.positions.push_back(static_cast<float>(cell.value));
    }
    take.present.push_back(here ? 1 : 0);
    if (!here) std::fill(take.positions.end() - 3, take.positions.end(), 0.0F);
  }
}

void read_rows(const std::filesystem::path& file, const Survey& survey, const Table& table, Take& take,
               TextTimes& times) {
  TextLines lines(file);
  std::vector<std::string_view> cells;
  const std::size_t markers = table.columns.size(), most = samples_within(survey.bytes);
  const std::size_t rows = std::min(survey.end - std::min(survey.end, table.first_row), most / markers);
  take.positions.reserve(3 * rows * markers);
  take.present.reserve(rows * markers);
  for (std::string_view line; lines.next(line);) {
    const std::size_t l = lines.number() - 1;
    if (l >= table.end_row) break;
    if (l < table.first_row || line.find_first_not_of(" \t\r") == line.npos) continue;
    if (take.present.size() + markers > most) {
      throw InputError(file, at_line(l), "the rows are too short for " + std::to_string(markers) + " markers");
    }
    split(line, table.separator, cells);
    read_row(file, l, cells, table, take);
    if (!table.time_column) continue;
    times.add(*table.time_column < cells.size() ? cells[*table.time_column] : "", table.separator != ',');
  }
}

}  // namespace

Take read_csv(const std::filesystem::path& file, const ReadOptions& options) {
  const Survey survey = survey_of(file);
  if (survey.start.empty()) throw InputError(file, "is empty; a table of marker positions is expected");
  const Table table = table_of(file, survey);
  if (table.columns.empty()) {
    throw InputError(file, at_line(0), "no marker columns (such as brow_x, brow_y, brow_z), no Motive or Vicon export");
  }
  Take take;
  take.name = file.stem().string();
  take.labels = unique_names(table.names, table.columns.size(), take.decisions);
  take.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : table.rate_hz;
  TextTimes times;
  read_rows(file, survey, table, take, times);
  if (take.rate_hz == 0.0) take.rate_hz = rate_of(times.finite());
  if (take.frames() == 0) throw InputError(file, at_line(survey.end), "the table holds no frames");
  if (take.rate_hz == 0.0) {
    take.rate_hz = 30.0;
    take.decisions.push_back("rate: 30 Hz, assumed, as the file gives no times");
  }
  drop_origin(take);
  if (options.rate_hz <= 0.0 && table.time_column) to_even_times(take, times.seconds, times.step());
  to_our_frame(take, table.convention, options);
  return take;
}

}  // namespace vultus::mocap
