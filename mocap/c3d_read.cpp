#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "mocap/axes.h"
#include "mocap/c3d.h"
#include "mocap/c3d_layout.h"
#include "mocap/marker_names.h"

namespace vultus::mocap {

namespace {

constexpr std::uint64_t kBuffer = 1 << 20;

/// What decoding met on the way.
struct Repairs {
  std::size_t not_finite = 0, at_origin = 0, fractional_residuals = 0;
};

/// Residual and camera mask of a sample, from its fourth word.
struct Fourth {
  bool valid;
  std::uint8_t residual, cameras;
};

Fourth split(int word) {
  return {word >= 0, static_cast<std::uint8_t>(word & 0xff), static_cast<std::uint8_t>((word >> 8) & 0x7f)};
}

void decode_sample(const Decoder& decoder, const C3dLayout& layout, const std::uint8_t* bytes, std::size_t i,
                   Take& take, Repairs& repairs) {
  float* p = take.positions.data() + 3 * i;
  Fourth fourth{};
  if (layout.real) {
    for (int c = 0; c < 3; ++c) p[c] = decoder.real(bytes + 4 * c);
    const float word = decoder.real(bytes + 12);
    fourth =
        std::isfinite(word) && word >= 0.0F && word < 32768.0F ? split(static_cast<int>(word)) : Fourth{false, 0, 0};
    repairs.fractional_residuals += fourth.valid && word != std::floor(word);
  } else {
    for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(decoder.integer(bytes + 2 * c) * layout.scale);
    fourth = split(decoder.integer(bytes + 6));
  }
  if (fourth.valid && !(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))) {
    fourth.valid = false;
    ++repairs.not_finite;
  } else if (fourth.valid && p[0] == 0.0F && p[1] == 0.0F && p[2] == 0.0F) {
    fourth.valid = false;
    ++repairs.at_origin;
  }
  take.present[i] = fourth.valid ? 1 : 0;
  take.residuals[i] = fourth.valid ? fourth.residual * take.residual_step : 0.0F;
  take.cameras[i] = fourth.valid ? fourth.cameras : std::uint8_t{0};
  if (!fourth.valid) std::fill(p, p + 3, 0.0F);
}

/// Samples whose fourth word is not a whole number hold the residual itself (some exporters' habit), no camera mask.
void reread_fractional(const C3dHead& head, const std::uint8_t* frame, std::size_t first, Take& take) {
  for (std::size_t m = 0; m < take.labels.size(); ++m) {
    if (take.present[first + m] == 0) continue;
    take.residuals[first + m] = head.decoder.real(frame + 16 * m + 12);
    take.cameras[first + m] = 0;
  }
}

void read_samples(FileBytes& file, const C3dHead& head, Take& take) {
  const C3dLayout& layout = head.layout;
  const std::uint64_t stride = layout.stride(), batch = std::max<std::uint64_t>(1, kBuffer / stride);
  std::vector<std::uint8_t> buffer(std::min(batch, layout.frames) * stride);
  const std::size_t markers = take.labels.size(), sample = 4 * layout.value_bytes();
  Repairs repairs;
  const auto pass = [&](const auto& per_frame) {
    for (std::uint64_t first = 0; first < layout.frames; first += batch) {
      const std::uint64_t n = std::min(batch, layout.frames - first);
      file.read(layout.data_offset + first * stride, {buffer.data(), n * stride}, "the samples");
      for (std::uint64_t f = 0; f < n; ++f) per_frame(buffer.data() + f * stride, (first + f) * markers);
    }
  };
  pass([&](const std::uint8_t* frame, std::size_t i) {
    for (std::size_t m = 0; m < markers; ++m)
      decode_sample(head.decoder, layout, frame + m * sample, i + m, take, repairs);
  });
  if (repairs.fractional_residuals > 0) {
    pass([&](const std::uint8_t* frame, std::size_t i) { reread_fractional(head, frame, i, take); });
    take.residual_step = 0.0F;
    take.decisions.push_back("residuals: stored as plain numbers (" + std::to_string(repairs.fractional_residuals) +
                             " are no whole steps), so no camera masks");
  }
  if (repairs.not_finite > 0) {
    take.decisions.push_back("samples: " + std::to_string(repairs.not_finite) +
                             " without finite coordinates taken as missing");
  }
  if (repairs.at_origin > 0) {
    take.decisions.push_back("samples: " + std::to_string(repairs.at_origin) +
                             " at exactly (0, 0, 0) taken as missing");
  }
}

/// Events of the header (4-character names) and of the EVENT group.
void read_events(FileBytes& file, const C3dHead& head, Take& take) {
  std::array<std::uint8_t, 512> header{};
  file.read(0, {header.data(), std::min<std::uint64_t>(header.size(), file.size())}, "the header");
  const int count = head.decoder.word(header.data() + 298) == 12345 ? head.decoder.word(header.data() + 300) : 0;
  for (int i = 0; i < std::min(count, 18); ++i) {
    const auto* name = reinterpret_cast<const char*>(header.data() + 396 + 4 * i);
    std::string label(name, name + 4);
    label.erase(std::remove_if(label.begin(), label.end(), [](char c) { return c == 0 || c == ' '; }), label.end());
    const float time = head.decoder.real(header.data() + 304 + 4 * i);
    if (std::isfinite(time)) take.events.push_back({label, time});
  }
  const C3dParameters& p = head.parameters;
  const std::vector<std::string> labels = p.long_strings("EVENT", "LABELS"),
                                 contexts = p.long_strings("EVENT", "CONTEXTS");
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::string times = i < 255 ? "TIMES" : "TIMES" + std::to_string(i / 255 + 1);
    const auto minutes = p.number("EVENT", times, 2 * (i % 255)), seconds = p.number("EVENT", times, 2 * (i % 255) + 1);
    if (!minutes || !seconds || !std::isfinite(*minutes * 60.0 + *seconds)) continue;
    const bool sided = i < contexts.size() && !contexts[i].empty() && contexts[i] != "General";
    take.events.push_back({(sided ? contexts[i] + " " : "") + labels[i], *minutes * 60.0 + *seconds});
  }
}

double rate_of(FileBytes& file, const C3dHead& head, std::vector<std::string>& decisions) {
  const double stated = head.parameters.number("POINT", "RATE").value_or(0.0);
  const auto usable = [](double rate) { return std::isfinite(rate) && rate > 0.0 && rate < 1e6; };
  if (!usable(stated) && !usable(head.header.rate_hz)) {
    throw InputError(file.path(), "byte 20", "the frame rate is zero or not a number");
  }
  const double rate = usable(stated) ? stated : head.header.rate_hz;
  if (rate != head.header.rate_hz)
    decisions.push_back("rate: " + std::to_string(rate) + " Hz of POINT:RATE, not the header's");
  return rate;
}

std::string first_or_empty(const std::vector<std::string>& strings) { return strings.empty() ? "" : strings.front(); }

}  // namespace

Take read_c3d(const std::filesystem::path& path, const ReadOptions& options) {
  FileBytes file(path);
  if (file.size() == 0) throw InputError(path, "is empty");
  Take take;
  take.name = path.stem().string();
  const C3dHead head = read_c3d_head(file, take.decisions);
  const C3dLayout& layout = head.layout;
  if (layout.frames > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
    throw InputError(path, "byte 6", "more frames than can be counted");
  }
  take.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : rate_of(file, head, take.decisions);
  take.first_frame = head.header.first_frame;
  take.residual_step = static_cast<float>(layout.scale);
  take.labels = unique_names(head.parameters.long_strings("POINT", "LABELS"), static_cast<std::size_t>(layout.points),
                             take.decisions);
  const std::size_t samples = layout.frames * take.labels.size();
  take.positions.resize(3 * samples);
  take.present.resize(samples);
  take.residuals.resize(samples);
  take.cameras.resize(samples);
  read_samples(file, head, take);
  read_events(file, head, take);
  const C3dParameters& p = head.parameters;
  to_our_frame(take,
               {first_or_empty(p.strings("POINT", "UNITS")), first_or_empty(p.strings("POINT", "X_SCREEN")),
                first_or_empty(p.strings("POINT", "Y_SCREEN"))},
               options);
  return take;
}

}  // namespace vultus::mocap
