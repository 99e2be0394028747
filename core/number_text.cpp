#include "core/number_text.h"

#include <cstdio>

namespace vultus {

std::string number(double value, const char* format) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace vultus
