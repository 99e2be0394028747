#pragma once

#include <filesystem>

#include "register/template.h"

namespace vultus::registration {

/// Reads a template from its `template.obj`, its `template.json` or the folder that holds both (DESIGN §2).
///
/// The JSON names units ("mm", "cm", "m" or "in"), landmarks (`scheme` "ibug-68" with 68 `vertices`, -1 where the
/// template has none; and/or `points`, name → vertex) and vertex `sets`; optional are `name`, `subdivisions` (0…4) and
/// `major` (names of landmarks a person would place). Positions come out in mm in the file's own axes.
///
/// An OBJ without a JSON beside it gives a template without landmarks, its units guessed from its size;
/// `with_found_landmarks` names some.
/// Throws `InputError` naming file, entry and what would be accepted.
Template read_template(const std::filesystem::path& path);

/// Writes `template.obj` and `template.json` into `folder`, each atomically.
void write_template(const std::filesystem::path& folder, const Template& value);

/// Millimetres in one unit named in a file; throws `InputError` with the nearest name.
double millimetres(const std::string& unit);

}  // namespace vultus::registration
