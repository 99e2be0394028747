#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/session_basis.h"
#include "core/manifest.h"
#include "retarget/marker_weights.h"
#include "retarget/regional.h"

namespace vultus::apps {

/// What the solves of one session share.
struct SolveSetup {
  const rig::Actor& actor;
  const SessionBasis& basis;
  retarget::SolveOptions options;
  bool regional = true;                           ///< else the global solve gives the weights
  std::vector<retarget::MarkerWeights> compared;  ///< other divisions of the face, for the table alone
  std::vector<std::string> decisions, warnings;   ///< of the session, repeated in each take's report
};

/// Marker weights of the face divided into 2, 6, 9 and 12 regions as in Liu's table 1; the actor's own number is left
/// out.
std::vector<retarget::MarkerWeights> compared_divisions(const rig::Actor& actor, const SessionBasis& basis,
                                                        std::uint64_t seed);

/// Artefacts of a solved take.
std::vector<std::string> solved_artefacts(const std::string& take);

/// Solves one take globally, by region and by the compared divisions, and writes weights, errors, errors_global.csv and
/// report.json with Liu's table 1, which is returned.
nlohmann::json solve_and_write(const SessionTake& take, const SolveSetup& setup, const Provenance& provenance,
                               Manifest& session, Progress& progress);

}  // namespace vultus::apps
