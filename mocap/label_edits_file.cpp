#include <algorithm>

#include "core/error.h"
#include "core/files.h"
#include "core/named_values.h"
#include "mocap/label_edits_json.h"

namespace vultus::mocap {

using Json = nlohmann::json;

namespace {

constexpr Named<LabelEdit::Kind> kKinds[] = {{LabelEdit::Kind::swap, "swap"},
                                             {LabelEdit::Kind::moved, "moved"},
                                             {LabelEdit::Kind::fragment, "fragment"},
                                             {LabelEdit::Kind::phantom, "phantom"}};

LabelEdits::Dropped dropped_of(const Json& json) {
  LabelEdits::Dropped d;
  d.column = json.at("column").get<std::string>();
  d.frame = json.at("frame").get<int>();
  const auto position = json.at("position").get<std::vector<float>>();
  if (position.size() != 3) throw Error("\"position\" must be three numbers");
  std::copy_n(position.begin(), 3, d.position);
  d.residual = json.value("residual", 0.0F);
  d.cameras = json.value("cameras", std::uint8_t{0});
  return d;
}

}  // namespace

std::string name_of(LabelEdit::Kind kind) { return name_in(kKinds, kind); }

nlohmann::json json_of(const LabelEdit& edit) {
  Json json = {{"kind", name_of(edit.kind)},
               {"frames", {edit.first(), edit.last()}},
               {"score", edit.score},
               {"why", edit.why},
               {"applied", edit.applied}};
  for (const LabelMove& move : edit.moves) {
    json["moves"].push_back({{"frames", {move.first, move.last}},
                             {"from", move.from},
                             {"to", move.to.empty() ? Json(nullptr) : Json(move.to)}});
  }
  return json;
}

LabelEdit edit_of(const nlohmann::json& json) {
  LabelEdit edit;
  edit.kind = value_named(kKinds, json.at("kind").get<std::string>(), "kind of edit");
  edit.score = json.value("score", 1.0);
  edit.why = json.value("why", std::string());
  edit.applied = json.value("applied", true);
  for (const Json& move : json.at("moves")) {
    const auto frames = move.at("frames").get<std::vector<int>>();
    if (frames.size() != 2) throw Error("\"frames\" must be [first, last]");
    const Json& to = move.at("to");
    edit.moves.push_back({frames[0], frames[1], move.at("from").get<std::string>(),
                          to.is_null() ? std::string() : to.get<std::string>()});
  }
  if (edit.moves.empty()) throw Error("\"moves\" is empty");
  return edit;
}

void write_edits(const std::filesystem::path& file, const LabelEdits& edits) {
  Json json = {{"take", edits.take}, {"labels", edits.labels}, {"edits", Json::array()}, {"dropped", Json::array()}};
  for (const LabelEdit& edit : edits.edits) json["edits"].push_back(json_of(edit));
  for (const LabelEdits::Dropped& d : edits.dropped) {
    json["dropped"].push_back({{"column", d.column},
                               {"frame", d.frame},
                               {"position", {d.position[0], d.position[1], d.position[2]}},
                               {"residual", d.residual},
                               {"cameras", d.cameras}});
  }
  write_json(file, json);
}

LabelEdits read_edits(const std::filesystem::path& file) {
  const Json json = read_json(file);
  std::string place = "top level";
  try {
    LabelEdits edits;
    edits.take = json.value("take", std::string());
    edits.labels = json.value("labels", std::vector<std::string>());
    for (const Json& entry : json.at("edits")) {
      place = "edits[" + std::to_string(edits.edits.size()) + "]";
      edits.edits.push_back(edit_of(entry));
    }
    for (const Json& entry : json.value("dropped", Json::array())) {
      place = "dropped[" + std::to_string(edits.dropped.size()) + "]";
      edits.dropped.push_back(dropped_of(entry));
    }
    return edits;
  } catch (const std::exception& problem) {
    throw InputError(file, place, std::string("is no list of label edits: ") + problem.what());
  }
}

}  // namespace vultus::mocap
