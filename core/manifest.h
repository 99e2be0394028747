#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace vultus {

std::string sha256_of_bytes(std::string_view bytes);                  ///< 64 hex digits
std::string sha256_of_file(const std::filesystem::path& file);        ///< throws `InputError`

/// How an artefact came to be. Two equal provenances make equal artefacts, so a second run skips the work.
struct Provenance {
  std::string command;                         ///< such as "onboard"
  nlohmann::json options;                      ///< every option that changes the result
  std::map<std::string, std::string> inputs;   ///< path or label → SHA-256
  nlohmann::json json() const;                 ///< includes the Vultus version
};

/// One folder's manifest (`actor.json`, `session.json`): artefacts with hash and provenance, and the folder's own facts.
class Manifest {
 public:
  /// Reads `file` or starts an empty manifest of `kind` ("actor", "session", …). Throws `InputError` for a damaged
  /// file or another kind.
  static Manifest open(const std::filesystem::path& file, const std::string& kind);

  nlohmann::json& facts() { return facts_; }
  const nlohmann::json& facts() const { return facts_; }

  /// True when `artefact` (path relative to the folder) is on disk with its recorded hash and was made by `provenance`.
  bool is_current(const std::string& artefact, const Provenance& provenance) const;
  /// Records an artefact that has just been written.
  void record(const std::string& artefact, const Provenance& provenance);
  void forget(const std::string& artefact);
  bool has(const std::string& artefact) const { return artefacts_.contains(artefact); }

  /// Throws `InputError` naming the artefact that is missing or differs from its recorded hash.
  void verify(const std::string& artefact) const;
  std::vector<std::string> damaged() const;    ///< artefacts that are missing or differ
  std::vector<std::string> artefacts() const;
  std::string hash(const std::string& artefact) const;  ///< recorded; throws `InputError` when not recorded

  void save() const;  ///< atomically
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path file_, folder_;
  std::string kind_;
  nlohmann::json facts_ = nlohmann::json::object();
  std::map<std::string, nlohmann::json> artefacts_;
};

/// Vultus' version, from CMake.
std::string version();

}  // namespace vultus
