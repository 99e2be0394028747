#include "retarget/anchors.h"

#include <charconv>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"

namespace vultus::retarget {
namespace {

constexpr int kIbugPoints = 68;

// "ibug:36" (or "ibug.36", as the registration writes it) → 36; -1 for other names.
int ibug_number(const std::string& name) {
  if (!name.starts_with("ibug:") && !name.starts_with("ibug.")) return -1;
  int number = -1;
  const char* end = name.data() + name.size();
  const auto parsed = std::from_chars(name.data() + 5, end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end || number >= kIbugPoints) return -1;
  return number;
}

int vertex_of(const std::string& landmark, const rig::Actor& actor) {
  const auto& named = actor.topology->landmarks();
  if (const auto found = named.find(landmark); found != named.end()) return found->second;
  const int number = ibug_number(landmark);
  return number >= 0 && actor.ibug68 ? (*actor.ibug68)[number] : -1;
}

std::string unknown_landmark(const std::string& landmark, const rig::Actor& actor) {
  if (ibug_number(landmark) >= 0) return "the actor's template has no 68-point vertex for \"" + landmark + "\"";
  std::vector<std::string> names;
  for (const auto& [name, vertex] : actor.topology->landmarks()) names.push_back(name);
  const std::string nearest = nearest_name(landmark, names);
  return "unknown landmark \"" + landmark + "\"" +
         (nearest.empty() ? ": the actor has no named landmarks; use \"ibug:0\" … \"ibug:67\" or a triangle"
                          : "; did you mean \"" + nearest + "\"?");
}

}  // namespace

Anchors read_anchors(const std::filesystem::path& file, const Topology& topology) {
  const nlohmann::json json = read_json(file);
  Anchors result;
  if (json.is_object() && json.contains("markers")) {
    result.places = rig::read_markers(file, topology);
    return result;
  }
  if (!json.is_object() || !json.contains("anchors") || !json["anchors"].is_object()) {
    throw InputError(file, "needs {\"anchors\": {\"MARKER\": \"landmark\", …}}");
  }
  for (const auto& [label, entry] : json["anchors"].items()) {
    if (entry.is_string()) {
      result.landmarks[label] = entry.get<std::string>();
    } else {
      result.places[label] = rig::place_from_json(entry, topology, file, "anchor \"" + label + "\"");
    }
  }
  if (result.landmarks.empty() && result.places.empty()) throw InputError(file, "anchors", "names no marker");
  return result;
}

Anchors anchors_by_name(const std::vector<std::string>& labels, const rig::Actor& actor) {
  Anchors anchors;
  for (const std::string& label : labels) {
    if (vertex_of(label, actor) >= 0) anchors.landmarks[label] = label;
  }
  return anchors;
}

rig::MarkerPlaces resolve(const Anchors& anchors, const rig::Actor& actor) {
  rig::MarkerPlaces places = anchors.places;
  for (const auto& [label, landmark] : anchors.landmarks) {
    if (places.contains(label)) continue;
    const int vertex = vertex_of(landmark, actor);
    const SurfacePoint place = vertex < 0 ? SurfacePoint{} : rig::place_of_vertex(*actor.topology, vertex);
    if (!place.valid()) throw InputError("anchor " + label + ": " + unknown_landmark(landmark, actor));
    places[label] = place;
  }
  return places;
}

}  // namespace vultus::retarget
