#pragma once

#include "register/refined_template.h"
#include "register/template_head.h"

namespace vultus::registration::test {

inline const RefinedTemplate& model() {
  static const RefinedTemplate built(template_head());
  return built;
}

/// A pose of it (refined vertices).
inline Mesh shape_of(const Points& positions) {
  Mesh mesh;
  mesh.topology = model().loop.refined();
  mesh.positions = positions;
  return mesh;
}

}  // namespace vultus::registration::test
