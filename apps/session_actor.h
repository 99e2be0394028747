#pragma once

#include <cstdint>
#include <filesystem>

#include "core/manifest.h"
#include "rig/actor.h"

namespace vultus::apps {

/// The actor a session retargets to. With `regions` > 0 the actor is divided anew into that many and the division is
/// kept in the session (regions/, in the actor folder's form); 0 takes the actor's own and drops an older one.
rig::Actor session_actor(const std::filesystem::path& actor, int regions, std::uint64_t seed, Manifest& session);

/// The actor of a finished session, with the session's own regions where it has any. Throws `InputError` for what is no
/// session and for damaged files.
rig::Actor load_session_actor(const Manifest& session);

/// The actor's folder as a session names it.
std::filesystem::path actor_folder(const Manifest& session);

}  // namespace vultus::apps
