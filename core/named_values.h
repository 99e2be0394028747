#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "core/error.h"

namespace vultus {

/// A table of an enumeration's values and what files and reports call them, said once for writing and reading.
template <class Value>
using Named = std::pair<Value, const char*>;

/// The value's name; the first of the table for a value that it lacks.
template <class Value, std::size_t N>
const char* name_in(const Named<Value> (&names)[N], Value value) {
  for (const auto& [each, name] : names) {
    if (each == value) return name;
  }
  return names[0].second;
}

/// Throws `InputError` ("'spleen' is no WHAT; there are …") for a name that the table lacks.
template <class Value, std::size_t N>
Value value_named(const Named<Value> (&names)[N], const std::string& name, const std::string& what) {
  std::string known;
  for (const auto& [value, each] : names) {
    if (name == each) return value;
    known += (known.empty() ? "" : ", ") + std::string(each);
  }
  throw InputError("'" + name + "' is no " + what + "; there are " + known);
}

}  // namespace vultus
