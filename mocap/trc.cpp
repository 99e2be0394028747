#include "mocap/trc.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>

#include "core/error.h"
#include "core/files.h"
#include "mocap/axes.h"
#include "mocap/frame_times.h"
#include "mocap/marker_names.h"
#include "mocap/text_lines.h"
#include "mocap/text_table.h"

namespace vultus::mocap {

namespace {

using namespace std::string_view_literals;

constexpr std::size_t kPiece = 1 << 20;  // bytes written at once

std::string at_line(std::size_t line) { return "line " + std::to_string(line + 1); }

/// Lines two to four of the file.
struct Header {
  double rate_hz = 0.0;
  std::size_t frames = 0, markers = 0;
  std::string unit;
  std::vector<std::string> names;
};

double stated(const std::filesystem::path& file, const std::vector<std::string>& keys,
              const std::vector<std::string>& values, const char* key) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const std::string& k) { return same_word(k, key); });
  const auto column = static_cast<std::size_t>(found - keys.begin());
  if (found == keys.end()) throw InputError(file, at_line(1), std::string("the key ") + key + " is missing");
  const Cell cell = column < values.size() ? cell_value(values[column]) : Cell{};
  if (cell.kind != Cell::number || cell.value < 0.0 || cell.value > 1e9) {
    throw InputError(file, at_line(2), std::string(key) + " is not a usable number");
  }
  return cell.value;
}

Header header_of(const std::filesystem::path& file, TextLines& lines) {
  std::array<std::string, 4> text;
  for (std::size_t l = 0; l < text.size(); ++l) {
    std::string_view line;
    const bool here = lines.next(line);
    if (here) text[l] = line;
    if (!here || (l == 0 && !line.starts_with("PathFileType"))) {
      throw InputError(file, at_line(std::max<std::size_t>(lines.number(), 1) - 1),
                       "a TRC file starts with PathFileType, a line of keys, one of values and one of marker names");
    }
  }
  const std::vector<std::string> keys = cells_of(text[1], '\t'), values = cells_of(text[2], '\t');
  Header header;
  header.rate_hz = stated(file, keys, values, "DataRate");
  header.frames = static_cast<std::size_t>(stated(file, keys, values, "NumFrames"));
  header.markers = static_cast<std::size_t>(stated(file, keys, values, "NumMarkers"));
  if (header.rate_hz <= 0.0) throw InputError(file, at_line(2), "DataRate must be positive");
  const auto unit = std::find_if(keys.begin(), keys.end(), [](const std::string& k) { return same_word(k, "Units"); });
  const auto unit_column = static_cast<std::size_t>(unit - keys.begin());
  if (unit_column < values.size()) header.unit = values[unit_column];
  const std::vector<std::string> cells = cells_of(text[3], '\t');
  for (std::size_t c = 2; c < cells.size(); c += 3) header.names.push_back(cells[c]);
  while (header.names.size() > header.markers && header.names.back().empty()) header.names.pop_back();
  if (header.markers == 0) throw InputError(file, at_line(2), "the file holds no markers");
  // Even a missing marker needs its three tabs in the line of names.
  if (header.markers > text[3].size()) {
    throw InputError(file, at_line(2),
                     std::to_string(header.markers) + " markers are stated, but line 4 names " +
                         std::to_string(header.names.size()));
  }
  return header;
}

void read_row(const std::filesystem::path& file, std::size_t line_number, std::string_view line, std::size_t markers,
              Take& take) {
  take.positions.insert(take.positions.end(), 3 * markers, 0.0F);
  take.present.insert(take.present.end(), markers, 1);
  float* row = take.positions.data() + take.positions.size() - 3 * markers;
  std::uint8_t* here = take.present.data() + take.present.size() - markers;
  std::size_t start = 0;
  for (std::size_t column = 0; column < 3 * markers + 2; ++column) {
    const std::size_t end = start > line.size() ? start : std::min(line.find('\t', start), line.size());
    const std::string_view text = start > line.size() ? std::string_view() : line.substr(start, end - start);
    start = end + 1;
    if (column < 2) continue;
    const Cell cell = cell_value(text);
    if (cell.kind == Cell::malformed) {
      throw InputError(
          file, at_line(line_number),
          "column " + std::to_string(column + 1) + ": '" + trimmed(text.substr(0, 40)) + "' is not a number");
    }
    if (cell.kind == Cell::missing) here[(column - 2) / 3] = 0;
    row[column - 2] = static_cast<float>(cell.value);
  }
}

void read_rows(const std::filesystem::path& file, const Header& header, TextLines& lines, Take& take,
               TextTimes& times) {
  const std::size_t most = samples_within(lines.file_bytes());
  const std::size_t expected = std::min(header.frames, most / header.markers) * header.markers;
  take.positions.reserve(3 * expected);
  take.present.reserve(expected);
  for (std::string_view line; lines.next(line);) {
    const std::size_t l = lines.number() - 1;
    const std::string_view text = line.substr(std::min(line.find_first_not_of(" \t\r\0"sv), line.size()));
    const bool column_names = l < 7 && text.starts_with('X');
    if (column_names || text.empty()) continue;
    if (take.present.size() + header.markers > most) {
      throw InputError(file, at_line(l),
                       "the rows are too short for the stated " + std::to_string(header.markers) + " markers");
    }
    read_row(file, l, line, header.markers, take);
    const std::size_t first = std::min(line.find('\t'), line.size() - 1) + 1;
    times.add(line.substr(first, line.find('\t', first) - first));
  }
}

void append(std::string& text, float value) {
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end);
}

void append_row(std::string& text, const Take& take, int frame) {
  text += std::to_string(take.first_frame + frame) + "\t";
  append(text, static_cast<float>(frame / take.rate_hz));
  for (int m = 0; m < take.markers(); ++m) {
    const float* p = take.positions.data() + 3 * take.index(frame, m);
    for (int c = 0; c < 3; ++c) {
      text += "\t";
      if (take.has(frame, m)) append(text, p[c]);
    }
  }
  text += "\n";
}

}  // namespace

Take read_trc(const std::filesystem::path& file, const ReadOptions& options) {
  TextLines lines(file);
  if (lines.file_bytes() == 0) throw InputError(file, "is empty; a TRC file is expected");
  const Header header = header_of(file, lines);
  Take take;
  take.name = file.stem().string();
  take.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : header.rate_hz;
  take.labels = unique_names(header.names, header.markers, take.decisions);
  TextTimes times;
  read_rows(file, header, lines, take, times);
  const auto frames = static_cast<std::size_t>(take.frames());
  if (frames < header.frames || frames == 0) {
    throw InputError(
        file, at_line(lines.number()),
        "the file ends after " + std::to_string(frames) + " of " + std::to_string(header.frames) + " frames");
  }
  if (frames > header.frames) {
    take.decisions.push_back("frames: " + std::to_string(frames) + " rows, not the stated " +
                             std::to_string(header.frames));
  }
  drop_origin(take);
  if (options.rate_hz <= 0.0) to_even_times(take, times.seconds, times.step());
  to_our_frame(take, {header.unit, "", ""}, options);
  return take;
}

void write_trc(const std::filesystem::path& file, const Take& take) {
  std::string text = "PathFileType\t4\t(X/Y/Z)\t" + file.filename().string() + "\n";
  text += "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n";
  std::string rate;
  append(rate, static_cast<float>(take.rate_hz));
  const std::string frames = std::to_string(take.frames());
  text += rate + "\t" + rate + "\t" + frames + "\t" + std::to_string(take.markers()) + "\tmm\t" + rate + "\t" +
          std::to_string(take.first_frame) + "\t" + frames + "\n";
  text += "Frame#\tTime";
  for (const std::string& label : take.labels) text += "\t" + label + "\t\t";
  text += "\n\t";
  for (int m = 1; m <= take.markers(); ++m) {
    for (const char* axis : {"X", "Y", "Z"}) text += "\t" + (axis + std::to_string(m));
  }
  text += "\n\n";
  write_file_with(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    for (int f = 0; f < take.frames(); ++f) {
      append_row(text, take, f);
      if (text.size() < kPiece && f + 1 < take.frames()) continue;
      stream.write(text.data(), static_cast<std::streamsize>(text.size()));
      text.clear();
    }
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.flush();
    if (!stream) throw OutputError(file, "cannot be written (is the disk full?)");
  });
}

}  // namespace vultus::mocap
