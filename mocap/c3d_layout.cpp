#include "mocap/c3d_layout.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"

namespace vultus::mocap {

namespace {

constexpr std::uint64_t kBlock = 512;
constexpr std::uint64_t kLargestSection = 1 << 20;  // four times what any known program writes

std::string at_byte(std::uint64_t byte) { return "byte " + std::to_string(byte); }

std::optional<double> unsigned_number(const C3dParameters& parameters, const char* group, const char* name,
                                      std::size_t index = 0) {
  auto value = parameters.number(group, name, index);
  if (value && *value < 0.0) *value += 65536.0;  // counts are stored in 16 bits and signed only by tradition
  return value && std::isfinite(*value) && *value < 4e9 ? value : std::nullopt;
}

Decoder decoder_of(FileBytes& file, std::uint64_t section, std::vector<std::string>& decisions) {
  std::uint8_t head[4];
  file.read(section, head, "the parameter section");
  if (head[3] >= 84 && head[3] <= 86) return {static_cast<Processor>(head[3])};
  if (head[3] >= 1 && head[3] <= 3) return {static_cast<Processor>(head[3] + 83)};
  if (head[2] != 0) {
    throw InputError(file.path(), at_byte(section + 3),
                     "processor type " + std::to_string(head[3]) + " is none of 84 (Intel), 85 (DEC), 86 (SGI/MIPS)");
  }
  decisions.push_back("processor type: Intel, as the file has no parameter section");
  return {};
}

C3dHeader header_of(FileBytes& file, Decoder decoder) {
  std::uint8_t bytes[24];
  file.read(0, bytes, "the header");
  C3dHeader header;
  header.parameter_block = bytes[0];
  header.points = decoder.word(bytes + 2);
  header.analog_per_frame = decoder.word(bytes + 4);
  header.first_frame = decoder.word(bytes + 6);
  header.last_frame = decoder.word(bytes + 8);
  header.scale = decoder.real(bytes + 12);
  header.data_block = decoder.word(bytes + 16);
  header.rate_hz = decoder.real(bytes + 20);
  return header;
}

C3dParameters parameters_of(FileBytes& file, std::uint64_t section, const C3dHeader& header, Decoder decoder,
                            std::vector<std::string>& decisions) {
  std::uint8_t head[4];
  file.read(section, head, "the parameter section");
  const std::uint64_t stated = section + kBlock * head[2];
  const std::uint64_t data = header.data_block > 0 ? kBlock * static_cast<std::uint64_t>(header.data_block - 1) : 0;
  std::uint64_t end = std::max(stated, data);  // some programs state too few blocks
  if (stated > file.size()) {
    throw InputError(file.path(), at_byte(section + 2),
                     "the parameter section of " + std::to_string(head[2]) + " blocks is longer than the file");
  }
  end = std::clamp(std::min(end, section + kLargestSection), section + 4, std::max(file.size(), section + 4));
  std::vector<std::uint8_t> bytes(end - section - 4);
  file.read(section + 4, bytes, "the parameter section");
  return C3dParameters::parse(bytes, section + 4, decoder, decisions);
}

/// Candidate values in order of trust, without repetition.
template <class T>
void add(std::vector<T>& candidates, std::optional<T> value) {
  if (value && std::find(candidates.begin(), candidates.end(), *value) == candidates.end())
    candidates.push_back(*value);
}

std::optional<std::uint64_t> count_of(std::optional<double> value) {
  return value && *value >= 0.0 ? std::optional<std::uint64_t>(static_cast<std::uint64_t>(*value)) : std::nullopt;
}

/// The 32-bit frame number in two 16-bit words (or one real) of TRIAL.
std::optional<double> trial_field(const C3dParameters& parameters, const char* name) {
  const auto low = unsigned_number(parameters, "TRIAL", name, 0);
  const C3dParameter* stored = parameters.find("TRIAL", name);
  if (!low || stored->type == 4) return low;
  return *low + 65536.0 * unsigned_number(parameters, "TRIAL", name, 1).value_or(0.0);
}

struct Candidates {
  std::vector<std::uint64_t> points, frames, analog, offsets;
  std::vector<double> scales;
};

Candidates candidates_of(const C3dHeader& header, const C3dParameters& parameters) {
  Candidates result;
  add(result.points, count_of(unsigned_number(parameters, "POINT", "USED")));
  add(result.points, count_of(header.points));
  const auto first = trial_field(parameters, "ACTUAL_START_FIELD"), last = trial_field(parameters, "ACTUAL_END_FIELD");
  if (first && last && *last >= *first) add(result.frames, count_of(*last - *first + 1.0));
  add(result.frames, count_of(unsigned_number(parameters, "POINT", "LONG_FRAMES")));
  add(result.frames, count_of(unsigned_number(parameters, "POINT", "FRAMES")));
  if (header.last_frame >= header.first_frame) {
    add(result.frames, count_of(header.last_frame - header.first_frame + 1.0));
  }
  add(result.analog, count_of(header.analog_per_frame));
  const auto channels = unsigned_number(parameters, "ANALOG", "USED");
  const auto analog_rate = parameters.number("ANALOG", "RATE"), rate = parameters.number("POINT", "RATE");
  if (channels && analog_rate && rate && *rate > 0.0 && *analog_rate >= 0.0 && *analog_rate / *rate < 1e5) {
    add(result.analog, count_of(*channels * std::round(*analog_rate / *rate)));
  }
  const auto offset = [](double block) {
    return std::optional<std::uint64_t>(kBlock * static_cast<std::uint64_t>(block - 1.0));
  };
  const auto stated = unsigned_number(parameters, "POINT", "DATA_START");
  if (stated && *stated >= 2.0) add(result.offsets, offset(*stated));
  if (header.data_block >= 2) add(result.offsets, offset(header.data_block));
  // The header first: where the two differ (older Motion Analysis files) it is the one that fits a person.
  for (const double scale : {header.scale, parameters.number("POINT", "SCALE").value_or(header.scale)}) {
    if (std::isfinite(scale) && scale != 0.0) add(result.scales, std::optional<double>(scale));
  }
  return result;
}

/// Bytes of the file left after the samples; nothing when they do not fit.
std::optional<std::uint64_t> slack(const C3dLayout& layout, std::uint64_t size) {
  const std::uint64_t stride = layout.stride();
  if (layout.data_offset > size || stride == 0 || layout.frames > (size - layout.data_offset) / stride) return {};
  return size - layout.data_offset - layout.frames * stride;
}

std::vector<C3dLayout> combinations(const Candidates& c) {
  std::vector<C3dLayout> all;
  for (const std::uint64_t offset : c.offsets) {
    for (const double scale : c.scales) {
      for (const std::uint64_t analog : c.analog) {
        for (const std::uint64_t points : c.points) {
          for (const std::uint64_t frames : c.frames) {
            if (points == 0 || frames == 0 || points > 65535 || analog > 10'000'000) continue;
            C3dLayout layout;
            layout.points = static_cast<int>(points);
            layout.frames = frames;
            layout.analog_per_frame = static_cast<int>(analog);
            layout.real = scale < 0.0;
            layout.scale = std::abs(scale);
            layout.data_offset = offset;
            all.push_back(layout);
          }
        }
      }
    }
  }
  return all;
}

std::string described(const C3dLayout& layout) {
  return std::to_string(layout.frames) + " frames of " + std::to_string(layout.points) + " points and " +
         std::to_string(layout.analog_per_frame) + " analog values, " + (layout.real ? "real" : "integer") +
         ", from byte " + std::to_string(layout.data_offset);
}

C3dLayout settle(FileBytes& file, const C3dHeader& header, const C3dParameters& parameters,
                 std::vector<std::string>& decisions) {
  const Candidates candidates = candidates_of(header, parameters);
  if (candidates.offsets.empty())
    throw InputError(file.path(), at_byte(16), "no place is given where the samples start");
  if (candidates.scales.empty()) throw InputError(file.path(), at_byte(12), "the scale factor is zero or not a number");
  const std::vector<C3dLayout> all = combinations(candidates);
  if (all.empty())
    throw InputError(file.path(), at_byte(2), "the file holds no marker positions (no points or no frames)");
  for (const C3dLayout& layout : all) {
    const auto left = slack(layout, file.size());
    if (!left || *left >= kBlock) continue;
    if (&layout != &all.front()) {
      decisions.push_back("layout: " + described(layout) +
                          ", as the size of the file asks (stated: " + described(all.front()) + ")");
    }
    return layout;
  }
  if (slack(all.front(), file.size())) return all.front();
  throw InputError(file.path(), at_byte(file.size()),
                   "the file ends before its samples do: it states " + described(all.front()) + ", that is " +
                       std::to_string(all.front().stride()) + " bytes a frame");
}

}  // namespace

C3dHead read_c3d_head(FileBytes& file, std::vector<std::string>& decisions) {
  std::uint8_t start[2];
  file.read(0, start, "the header");
  if (start[1] != 80) throw InputError(file.path(), at_byte(1), "not a C3D file (the key byte 0x50 is missing)");
  if (start[0] < 2) throw InputError(file.path(), at_byte(0), "the parameter section cannot start inside the header");
  const std::uint64_t section = kBlock * (start[0] - 1U);
  C3dHead head;
  head.decoder = decoder_of(file, section, decisions);
  head.header = header_of(file, head.decoder);
  head.parameters = parameters_of(file, section, head.header, head.decoder, decisions);
  head.layout = settle(file, head.header, head.parameters, decisions);
  const double first = trial_field(head.parameters, "ACTUAL_START_FIELD").value_or(0.0);
  if (first > 65535.0 && first < 2e9) head.header.first_frame = static_cast<int>(first);
  const double scale = head.parameters.number("POINT", "SCALE").value_or(head.header.scale);
  if (std::abs(std::abs(scale) - head.layout.scale) > 1e-6 * head.layout.scale) {
    decisions.push_back("scale: " + std::to_string(head.layout.scale) + " of the header, not the " +
                        std::to_string(std::abs(scale)) + " of POINT:SCALE");
  }
  return head;
}

}  // namespace vultus::mocap
