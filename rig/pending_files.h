#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/manifest.h"

namespace vultus::rig {

/// One artefact (path relative to the manifest's folder) and how to write it to a given path of the same extension.
using PendingFile = std::pair<std::string, std::function<void(const std::filesystem::path&)>>;

/// Writes several artefacts as one transaction: all are written under `.pending/`, the manifest is saved with their
/// hashes under the fact "pending" together with what `change` alters in it (the point of no return), then the files
/// are moved over the old ones and recorded. A process that dies before the save leaves the previous state; after it,
/// `finish_pending` or `current_path` arrive at the new one.
void commit_files(Manifest& manifest, const std::vector<PendingFile>& files, const Provenance& provenance,
                  const std::function<void(Manifest&)>& change = {});

/// Hash of an artefact of the transaction under way; for `change`.
std::string pending_hash(const Manifest& manifest, const std::string& artefact);

/// Completes a transaction that was announced but not finished.
void finish_pending(Manifest& manifest);

/// Where the recorded content of an artefact lies, verified, without writing anything. Throws `InputError` when it is
/// missing or differs from its record.
std::filesystem::path current_path(const Manifest& manifest, const std::string& artefact);

/// Deletes files below the named folders that the manifest does not list.
void remove_unlisted(const Manifest& manifest, const std::vector<std::string>& folders);

}  // namespace vultus::rig
