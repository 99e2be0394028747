#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/manifest.h"
#include "mocap/clean.h"

namespace vultus::apps {

/// A take that a session works on.
struct SessionTake {
  std::string name;  ///< the file's stem; names the folder below takes/
  std::filesystem::path file;
  mocap::Take clean;  ///< as written to takes/<name>/clean.c3d
  mocap::CleanReport report;
};

/// Where a take's artefact lies, relative to the session: "takes/<take>/<file>".
std::string take_artefact(const std::string& take, const std::string& file);

/// Takes by name, unread. Throws `UsageError` when two files have one name or a file is missing.
std::vector<SessionTake> session_takes(const std::vector<std::filesystem::path>& files);

/// Cleans every take into takes/<take>/{clean.c3d,measured.c3d,samples.json,labels.json}, all in the head coordinates
/// of the first, and fills `clean` and `report`. Changes of labels that were looked through by hand lie beside a take
/// as TAKE.labels.json. Current files are read back instead; returns how many takes were.
int clean_takes(std::vector<SessionTake>& takes, const mocap::CleanOptions& options, Manifest& session,
                Progress& progress);

}  // namespace vultus::apps
