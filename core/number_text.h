#pragma once

#include <string>

namespace vultus {

/// A number for a sentence; `format` is printf's for one double.
std::string number(double value, const char* format = "%.2f");

}  // namespace vultus
