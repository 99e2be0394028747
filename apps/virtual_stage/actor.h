#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "register/template.h"

namespace vultus::virtual_stage {

inline constexpr int trait_count = 31;

/// A person's build: each trait in standard deviations from the template's averages, kept within ±2. The spreads follow
/// adult anthropometric surveys (Farkas 1994; Zhuang et al. 2010).
struct Identity {
  std::array<double, trait_count> traits{};  ///< named by `trait_name`
  std::array<double, 5> asymmetry{};         ///< left against right: nose, eye height, jaw, mouth corners, cheeks
};

/// "head_width", "nose_length", …; `trait` 0 … trait_count-1.
const std::string& trait_name(int trait);

/// The same person for the same seed, everywhere. `asymmetry` 0 … 2 scales how much the two sides differ.
Identity random_identity(std::uint64_t seed, double asymmetry = 1.0);

/// The head of a person on the template's control mesh (vertex_count×3, mm, face frame): smooth deformations of the
/// neutral that move each eyeball and its lids as one, and keep lips sealed. `head` is
/// `registration::template_head()`.
Points shaped(const registration::Template& head, const Identity& identity);

/// `shaped(head, random_identity(seed))`.
Points identity(const registration::Template& head, std::uint64_t seed);

}  // namespace vultus::virtual_stage
