#include "register/register_options.h"

#include "core/error.h"
#include "core/files.h"

namespace vultus::registration {

std::vector<std::string> method_names() { return {"default", "zhu", "sanchez"}; }

Method method_named(const std::string& name) {
  if (name == "default") return Method::standard;
  if (name == "zhu") return Method::zhu;
  if (name == "sanchez") return Method::sanchez;
  throw UsageError("unknown registration method \"" + name + "\"; did you mean \"" +
                   nearest_name(name, method_names()) + "\"?");
}

std::string name_of(Method method) {
  switch (method) {
    case Method::zhu: return "zhu";
    case Method::sanchez: return "sanchez";
    case Method::standard: break;
  }
  return "default";
}

void RegisterOptions::validate() const {
  if (!(displacement_limit > 0.0)) throw InputError("registration: the displacement limit must be positive");
  if (!(least_confidence >= 0.0 && least_confidence <= 1.0))
    throw InputError("registration: the least confidence must lie between 0 and 1");
}

}  // namespace vultus::registration
