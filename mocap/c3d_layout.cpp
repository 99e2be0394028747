#include "mocap/c3d_layout.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"

namespace vultus::mocap {

namespace {

constexpr std::uint64_t kBlock = 512;
constexpr int kWord = 65536;
constexpr std::uint64_t kLargestSection = 1 << 20;  // four times what any known program writes

std::string at_byte(std::uint64_t byte) { return "byte " + std::to_string(byte); }

std::optional<double> unsigned_number(const C3dParameters& parameters, const char* group, const char* name,
                                      std::size_t index = 0) {
  auto value = parameters.number(group, name, index);
  if (value && *value < 0.0) *value += 65536.0;  // counts are stored in 16 bits and signed only by tradition
  return value && std::isfinite(*value) && *value < 4e9 ? value : std::nullopt;
}

bool names_processor(FileBytes& file, std::uint64_t section) {
  std::uint8_t head[4];
  if (section + 4 > file.size()) return false;
  file.read(section, head, "the parameter section");
  return (head[3] >= 84 && head[3] <= 86) || (head[3] >= 1 && head[3] <= 3);
}

/// Where the parameter section starts: where the header says, else in the second block, its usual place.
std::uint64_t section_of(FileBytes& file, int block, std::vector<std::string>& decisions) {
  const std::uint64_t stated = kBlock * static_cast<std::uint64_t>(std::max(block, 1) - 1);
  if (block >= 2 && (stated == kBlock || names_processor(file, stated) || !names_processor(file, kBlock)))
    return stated;
  if (!names_processor(file, kBlock)) {
    throw InputError(file.path(), at_byte(0), "the parameter section cannot start inside the header");
  }
  decisions.push_back("parameters: found in block 2, not in the stated block " + std::to_string(block));
  return kBlock;
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
  std::uint64_t stated = section + kBlock * head[2];
  const std::uint64_t data = header.data_block > 0 ? kBlock * static_cast<std::uint64_t>(header.data_block - 1) : 0;
  if (stated > file.size() && data > section + 4 && data < file.size()) {
    decisions.push_back("parameters: " + std::to_string(head[2]) +
                        " blocks are stated, more than the file has; they end where the samples start");
    stated = data;
  }
  const std::uint64_t wanted = std::max(stated, data);  // some programs state too few blocks
  if (stated > file.size()) {
    throw InputError(file.path(), at_byte(section + 2),
                     "the parameter section of " + std::to_string(head[2]) + " blocks is longer than the file");
  }
  const std::uint64_t end =
      std::clamp(std::min(wanted, section + kLargestSection), section + 4, std::max(file.size(), section + 4));
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
  const int counted = header.last_frame - header.first_frame + 1;
  add(result.frames, count_of(counted > 0 ? counted : counted + kWord));  // 16 bits run over
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

/// Frames up to the file's end without those of nothing but zeros in its last block: the padding.
std::uint64_t frames_held(FileBytes& file, const C3dLayout& layout) {
  const std::uint64_t stride = layout.stride();
  std::uint64_t frames = (file.size() - layout.data_offset) / stride;
  std::vector<std::uint8_t> frame(stride);
  const auto in_last_block = [&] { return layout.data_offset + frames * stride + kBlock > file.size() + stride; };
  while (frames > 0 && stride < kBlock && in_last_block()) {
    file.read(layout.data_offset + (frames - 1) * stride, frame, "the samples");
    if (std::any_of(frame.begin(), frame.end(), [](std::uint8_t byte) { return byte != 0; })) break;
    --frames;
  }
  return frames;
}

/// Stated frames where 16 bits ran over or stopped at 65,535: as many more as fill the file.
std::vector<C3dLayout> with_more_frames(FileBytes& file, const std::vector<C3dLayout>& stated) {
  std::vector<C3dLayout> more;
  for (C3dLayout layout : stated) {
    if (layout.frames >= kWord || layout.data_offset > file.size()) continue;
    const std::uint64_t most = (file.size() - layout.data_offset) / layout.stride();
    if (most < kWord - 1 || most <= layout.frames) continue;
    layout.frames = layout.frames == kWord - 1 ? frames_held(file, layout) : most - (most - layout.frames) % kWord;
    if (layout.frames >= kWord - 1) more.push_back(layout);
  }
  return more;
}

/// Real samples under a scale that promises integers, where the first frame reads as such.
std::vector<C3dLayout> taken_as_real(FileBytes& file, const std::vector<C3dLayout>& stated, Decoder decoder) {
  std::vector<C3dLayout> real;
  for (C3dLayout layout : stated) {
    if (layout.real) continue;
    layout.real = true;
    if (!slack(layout, file.size())) continue;
    std::vector<std::uint8_t> frame(16 * static_cast<std::size_t>(layout.points));
    file.read(layout.data_offset, frame, "the samples");
    bool plausible = true;
    for (std::size_t i = 0; i < frame.size(); i += 4) {
      const float value = decoder.real(frame.data() + i);
      const bool word = value == std::floor(value) && value >= -1.0F && value < 32768.0F;
      plausible = plausible && std::isfinite(value) && std::abs(value) < 1e6F && (i % 16 != 12 || word);
    }
    if (plausible) real.push_back(layout);
  }
  return real;
}

/// The one layout of several that fills the file to its last block; nothing when none or more than one does.
std::optional<C3dLayout> only_filling(const std::vector<C3dLayout>& layouts, std::uint64_t size) {
  std::optional<C3dLayout> found;
  for (const C3dLayout& layout : layouts) {
    const auto left = slack(layout, size);
    if (!left || *left >= kBlock) continue;
    if (found && described(*found) != described(layout)) return {};
    if (!found) found = layout;
  }
  return found;
}

C3dLayout settle(FileBytes& file, const C3dHeader& header, const C3dParameters& parameters, Decoder decoder,
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
  for (const auto& repaired : {with_more_frames(file, all), taken_as_real(file, all, decoder)}) {
    const auto layout = only_filling(repaired, file.size());
    if (!layout) continue;
    decisions.push_back("layout: " + described(*layout) +
                        ", the only one that fills the file (stated: " + described(all.front()) + ")");
    return *layout;
  }
  if (const auto left = slack(all.front(), file.size())) {
    decisions.push_back("layout: " + std::to_string(*left) + " bytes after the samples were passed over");
    return all.front();
  }
  throw InputError(file.path(), at_byte(file.size()),
                   "the file ends before its samples do: it states " + described(all.front()) + ", that is " +
                       std::to_string(all.front().stride()) + " bytes a frame");
}

}  // namespace

C3dHead read_c3d_head(FileBytes& file, std::vector<std::string>& decisions) {
  std::uint8_t start[2];
  file.read(0, start, "the header");
  if (start[1] != 80) throw InputError(file.path(), at_byte(1), "not a C3D file (the key byte 0x50 is missing)");
  const std::uint64_t section = section_of(file, start[0], decisions);
  C3dHead head;
  head.decoder = decoder_of(file, section, decisions);
  head.header = header_of(file, head.decoder);
  head.parameters = parameters_of(file, section, head.header, head.decoder, decisions);
  head.layout = settle(file, head.header, head.parameters, head.decoder, decisions);
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
