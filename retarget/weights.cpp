#include "retarget/weights.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/array_io.h"
#include "core/error.h"
#include "core/files.h"

namespace vultus::retarget {
namespace {

std::filesystem::path axes_file(std::filesystem::path npy) { return npy.replace_extension(".json"); }

std::size_t row(const Weights& weights, int frame, int region) {
  return (static_cast<std::size_t>(frame) * weights.regions.size() + region) * weights.poses.size();
}

std::vector<std::string> names_of(const std::filesystem::path& file, const nlohmann::json& json, const char* key) {
  if (!json.contains(key) || !json[key].is_array()) throw InputError(file, key, "a list of names is needed");
  std::vector<std::string> names;
  for (const auto& name : json[key]) {
    if (!name.is_string()) throw InputError(file, key, "every entry must be a name");
    names.push_back(name.get<std::string>());
  }
  return names;
}

void check_rows(const std::filesystem::path& npy, const Weights& weights) {
  for (int frame = 0; frame < weights.frames(); ++frame) {
    for (int region = 0; region < static_cast<int>(weights.regions.size()); ++region) {
      double sum = 0.0;
      bool negative = false;
      for (float value : weights.at(frame, region)) {
        sum += value;
        negative = negative || !(value >= 0.0f);
      }
      if (negative || std::abs(sum - 1.0) > 1e-3) {
        throw InputError(npy, "frame " + std::to_string(frame) + ", region " + weights.regions[region],
                         "weights must be at least 0 and sum to one");
      }
    }
  }
}

}  // namespace

int Weights::frames() const {
  const std::size_t stride = regions.size() * poses.size();
  return stride == 0 ? 0 : static_cast<int>(values.size() / stride);
}

std::span<float> Weights::at(int frame, int region) {
  return {values.data() + row(*this, frame, region), poses.size()};
}

std::span<const float> Weights::at(int frame, int region) const {
  return {values.data() + row(*this, frame, region), poses.size()};
}

Weights Weights::zeros(double rate_hz, std::vector<std::string> regions, std::vector<std::string> poses, int frames) {
  Weights weights{rate_hz, std::move(regions), std::move(poses), {}};
  weights.values.assign(static_cast<std::size_t>(frames) * weights.regions.size() * weights.poses.size(), 0.0f);
  return weights;
}

void write_weights(const std::filesystem::path& npy, const Weights& weights) {
  const std::size_t frames = static_cast<std::size_t>(weights.frames());
  write_npy(npy, Array{{frames, weights.regions.size(), weights.poses.size()}, weights.values});
  write_json(axes_file(npy), {{"axes", {"frame", "region", "pose"}},
                              {"rate_hz", weights.rate_hz},
                              {"regions", weights.regions},
                              {"poses", weights.poses}});
}

Weights read_weights(const std::filesystem::path& npy) {
  const std::filesystem::path axes = axes_file(npy);
  const nlohmann::json json = read_json(axes);
  if (!json.is_object()) throw InputError(axes, "an object with rate_hz, regions and poses is needed");
  Weights weights;
  weights.regions = names_of(axes, json, "regions");
  weights.poses = names_of(axes, json, "poses");
  if (!json.contains("rate_hz") || !json["rate_hz"].is_number() || !(json["rate_hz"].get<double>() > 0.0)) {
    throw InputError(axes, "rate_hz", "a positive number is needed");
  }
  weights.rate_hz = json["rate_hz"].get<double>();
  Array array = read_npy(npy);
  if (array.shape.size() != 3 || array.shape[1] != weights.regions.size() || array.shape[2] != weights.poses.size()) {
    throw InputError(npy, "shape must be frames × " + std::to_string(weights.regions.size()) + " regions × " +
                              std::to_string(weights.poses.size()) + " poses, as " + axes.filename().string() +
                              " says");
  }
  weights.values = std::move(array.values);
  check_rows(npy, weights);
  return weights;
}

}  // namespace vultus::retarget
