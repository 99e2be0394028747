#include "register/register_options.h"

#include "core/error.h"
#include "core/files.h"

namespace vultus::registration {

std::vector<std::string> method_names() { return {"default", "zhu"}; }

Method method_named(const std::string& name) {
  if (name == "default") return Method::standard;
  if (name == "zhu") return Method::zhu;
  throw UsageError("unknown registration method \"" + name + "\"; did you mean \"" +
                   nearest_name(name, method_names()) + "\"?");
}

std::string name_of(Method method) { return method == Method::zhu ? "zhu" : "default"; }

void RegisterOptions::validate() const {
  if (!(displacement_limit > 0.0)) throw InputError("registration: the displacement limit must be positive");
  if (!(least_confidence >= 0.0 && least_confidence <= 1.0))
    throw InputError("registration: the least confidence must lie between 0 and 1");
}

}  // namespace vultus::registration
