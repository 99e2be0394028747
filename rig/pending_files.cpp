#include "rig/pending_files.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"

namespace vultus::rig {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path pending_path(const Manifest& manifest, const std::string& artefact) {
  return manifest.folder() / ".pending" / artefact;
}

const Json* pending(const Manifest& manifest) {
  const auto found = manifest.facts().find("pending");
  if (found == manifest.facts().end()) return nullptr;
  bool sound = found->is_object() && found->contains("provenance") && found->contains("files") &&
               (*found)["files"].is_object() && (*found)["provenance"].is_object();
  for (const char* part : {"command", "options", "inputs"}) sound = sound && (*found)["provenance"].contains(part);
  if (sound)
    for (const Json& hash : (*found)["files"]) sound = sound && hash.is_string();
  if (!sound) throw InputError(manifest.folder(), "its manifest was damaged or edited by hand at \"pending\"");
  return &*found;
}

Json provenance_json(const Provenance& provenance) {
  return {{"command", provenance.command}, {"options", provenance.options}, {"inputs", provenance.inputs}};
}

Provenance provenance_from(const Json& json) {
  return {json.at("command"), json.at("options"), json.at("inputs").get<std::map<std::string, std::string>>()};
}

void move_over(const fs::path& from, const fs::path& to) {
  make_folder(to.parent_path());
  std::error_code error;
  fs::rename(from, to, error);
  if (error) throw OutputError(to, error.message());
}

bool has_hash(const fs::path& file, const std::string& hash) {
  std::error_code error;
  return fs::is_regular_file(file, error) && sha256_of_file(file) == hash;
}

}  // namespace

void commit_files(Manifest& manifest, const std::vector<PendingFile>& files, const Provenance& provenance,
                  const std::function<void(Manifest&)>& change) {
  Json announced = {{"provenance", provenance_json(provenance)}, {"files", Json::object()}};
  for (const auto& [artefact, write] : files) {
    const fs::path aside = pending_path(manifest, artefact);
    make_folder(aside.parent_path());
    write(aside);
    announced["files"][artefact] = sha256_of_file(aside);
  }
  manifest.facts()["pending"] = announced;
  if (change) change(manifest);
  manifest.save();
  finish_pending(manifest);
}

std::string pending_hash(const Manifest& manifest, const std::string& artefact) {
  return pending(manifest)->at("files").at(artefact);
}

void finish_pending(Manifest& manifest) {
  const Json* announced = pending(manifest);
  if (announced == nullptr) return;
  const Provenance provenance = provenance_from(announced->at("provenance"));
  for (const auto& [artefact, hash] : announced->at("files").items()) {
    const fs::path aside = pending_path(manifest, artefact), place = manifest.folder() / artefact;
    if (has_hash(aside, hash)) move_over(aside, place);
    // A file that is neither aside nor in place was removed by hand: it is then no artefact, and is made again.
    if (has_hash(place, hash))
      manifest.record(artefact, provenance);
    else
      manifest.forget(artefact);
  }
  manifest.facts().erase("pending");
  manifest.save();
  std::error_code ignored;
  fs::remove_all(manifest.folder() / ".pending", ignored);
}

fs::path current_path(const Manifest& manifest, const std::string& artefact) {
  const Json* announced = pending(manifest);
  if (announced != nullptr && announced->at("files").contains(artefact)) {
    const std::string hash = announced->at("files").at(artefact);
    for (const fs::path& place : {pending_path(manifest, artefact), manifest.folder() / artefact})
      if (has_hash(place, hash)) return place;
    throw InputError(manifest.folder() / artefact, "is missing or differs from its record");
  }
  manifest.verify(artefact);
  return manifest.folder() / artefact;
}

void remove_unlisted(const Manifest& manifest, const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    const fs::path root = manifest.folder() / folder;
    if (!fs::is_directory(root)) continue;
    std::vector<fs::path> unlisted;
    for (const auto& entry : fs::recursive_directory_iterator(root))
      if (entry.is_regular_file() && !manifest.has(entry.path().lexically_relative(manifest.folder()).generic_string()))
        unlisted.push_back(entry.path());
    for (const fs::path& file : unlisted) {
      std::error_code error;
      fs::remove(file, error);
      if (error) throw OutputError(file, error.message());
    }
  }
}

}  // namespace vultus::rig
