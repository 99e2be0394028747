#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "core/files.h"
#include "mocap/c3d.h"
#include "mocap/c3d_parameters.h"

namespace vultus::mocap {

namespace {

constexpr int kPointGroup = 1, kTrialGroup = 2, kEventGroup = 3, kAnalogGroup = 4, kManufacturerGroup = 5;
constexpr int kLargestWord = 65535;

/// Length of one residual step: the take's own, else a hundredth of a millimetre, longer where residuals ask for it.
float residual_step(const Take& take) {
  float largest = 0.0F;
  for (std::size_t i = 0; i < take.residuals.size(); ++i) {
    if (take.present[i] != 0) largest = std::max(largest, take.residuals[i]);
  }
  const float step = take.residual_step > 0.0F ? take.residual_step : 0.01F;
  return largest > 255.5F * step ? largest / 255.0F : step;
}

/// Names in LABELS, LABELS2, …; minutes and seconds in TIMES, TIMES2, …, 255 each.
void put_events(const std::vector<Event>& events, C3dParameterWriter& writer) {
  std::vector<std::string> labels;
  for (const Event& event : events) labels.push_back(event.label);
  writer.group(kEventGroup, "EVENT");
  writer.integers(kEventGroup, "USED", {static_cast<int>(labels.size())});
  writer.texts(kEventGroup, "LABELS", labels);
  for (std::size_t first = 0; first < events.size(); first += 255) {
    std::vector<float> times;
    for (std::size_t i = first; i < std::min(first + 255, events.size()); ++i) {
      const double minutes = std::floor(events[i].time_s / 60.0);
      times.insert(times.end(), {static_cast<float>(minutes), static_cast<float>(events[i].time_s - 60.0 * minutes)});
    }
    const int n = static_cast<int>(times.size() / 2);
    writer.reals(kEventGroup, first == 0 ? "TIMES" : "TIMES" + std::to_string(first / 255 + 1), times, {2, n});
  }
}

std::vector<std::uint8_t> parameter_section(const Take& take, float step, int data_block) {
  const int frames = take.frames(), last = take.first_frame + frames - 1;
  C3dParameterWriter writer;
  writer.group(kPointGroup, "POINT");
  writer.integers(kPointGroup, "USED", {take.markers()});
  writer.reals(kPointGroup, "SCALE", {-step});
  writer.reals(kPointGroup, "RATE", {static_cast<float>(take.rate_hz)});
  writer.integers(kPointGroup, "DATA_START", {data_block});
  writer.integers(kPointGroup, "FRAMES", {std::min(frames, kLargestWord)});
  if (frames > kLargestWord) writer.reals(kPointGroup, "LONG_FRAMES", {static_cast<float>(frames)});
  writer.text(kPointGroup, "UNITS", "mm");
  writer.text(kPointGroup, "X_SCREEN", "+X");
  writer.text(kPointGroup, "Y_SCREEN", "+Y");
  writer.texts(kPointGroup, "LABELS", take.labels);
  writer.texts(kPointGroup, "DESCRIPTIONS", std::vector<std::string>(take.labels.size()));
  writer.group(kTrialGroup, "TRIAL");
  writer.integers(kTrialGroup, "ACTUAL_START_FIELD", {take.first_frame & 0xffff, take.first_frame >> 16});
  writer.integers(kTrialGroup, "ACTUAL_END_FIELD", {last & 0xffff, last >> 16});
  writer.reals(kTrialGroup, "CAMERA_RATE", {static_cast<float>(take.rate_hz)});
  writer.group(kAnalogGroup, "ANALOG");
  writer.integers(kAnalogGroup, "USED", {0});
  if (!take.events.empty()) put_events(take.events, writer);
  writer.group(kManufacturerGroup, "MANUFACTURER");
  writer.text(kManufacturerGroup, "SOFTWARE", "Vultus");
  return writer.finish();
}

void put_word(std::vector<std::uint8_t>& bytes, std::size_t at, int value) {
  bytes[at] = static_cast<std::uint8_t>(value & 0xff);
  bytes[at + 1] = static_cast<std::uint8_t>((value >> 8) & 0xff);
}

void put_real(std::vector<std::uint8_t>& bytes, std::size_t at, float value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::vector<std::uint8_t> header(const Take& take, float step, int data_block) {
  std::vector<std::uint8_t> bytes(512, 0);
  const int last = take.first_frame + take.frames() - 1;
  bytes[0] = 2;
  bytes[1] = 80;
  put_word(bytes, 2, take.markers());
  put_word(bytes, 6, std::min(take.first_frame, kLargestWord));
  put_word(bytes, 8, std::min(last, kLargestWord));
  put_real(bytes, 12, -step);
  put_word(bytes, 16, data_block);
  put_real(bytes, 20, static_cast<float>(take.rate_hz));
  return bytes;
}

void put_frame(const Take& take, float step, int frame, std::vector<float>& values) {
  for (int m = 0; m < take.markers(); ++m) {
    const std::size_t i = take.index(frame, m);
    float* value = values.data() + 4 * static_cast<std::size_t>(m);
    std::fill(value, value + 4, 0.0F);
    value[3] = -1.0F;
    if (take.present[i] == 0) continue;
    std::copy_n(take.positions.data() + 3 * i, 3, value);
    const int residual = take.residuals.empty() ? 0 : static_cast<int>(std::lround(take.residuals[i] / step));
    const int cameras = take.cameras.empty() ? 0 : take.cameras[i] & 0x7f;
    value[3] = static_cast<float>(cameras << 8 | std::clamp(residual, 0, 255));
  }
}

void check(const std::filesystem::path& file, const Take& take) {
  if (take.markers() == 0 || take.frames() == 0)
    throw OutputError(file, "C3D cannot hold a take without markers or frames");
  if (take.markers() > kLargestWord) throw OutputError(file, "C3D holds 65535 markers at most");
}

}  // namespace

void write_c3d(const std::filesystem::path& file, const Take& take) {
  check(file, take);
  const float step = residual_step(take);
  std::vector<std::uint8_t> section;
  try {
    section = parameter_section(take, step, 0);
    section = parameter_section(take, step, 2 + static_cast<int>(section.size() / 512));
  } catch (const OutputError&) {
    throw;
  } catch (const Error& problem) {
    throw OutputError(file, problem.what());
  }
  const std::vector<std::uint8_t> head = header(take, step, 2 + static_cast<int>(section.size() / 512));
  write_file_with(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    const auto put = [&](const void* bytes, std::size_t n) {
      stream.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(n));
    };
    put(head.data(), head.size());
    put(section.data(), section.size());
    std::vector<float> values(4 * static_cast<std::size_t>(take.markers()));
    for (int f = 0; f < take.frames(); ++f) {
      put_frame(take, step, f, values);
      put(values.data(), 4 * values.size());
    }
    const std::size_t tail = 4 * values.size() * static_cast<std::size_t>(take.frames()) % 512;
    const std::vector<char> padding(tail == 0 ? 0 : 512 - tail, 0);
    put(padding.data(), padding.size());
    stream.flush();
    if (!stream) throw OutputError(file, "cannot be written (is the disk full?)");
  });
}

}  // namespace vultus::mocap
