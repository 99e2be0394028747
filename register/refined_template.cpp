#include "register/refined_template.h"

#include <utility>

#include "register/fill.h"

namespace vultus::registration {

RefinedTemplate::RefinedTemplate(Template given)
    : head(std::move(given)), loop(head.topology, head.subdivisions), neutral(loop(head.neutral)) {
  fitted = exposed_vertices(topology(), neutral);
  fitted_control.assign(fitted.begin(), fitted.begin() + head.topology->vertex_count());
}

std::vector<int> RefinedTemplate::rigid() const {
  std::vector<int> vertices;
  if (topology().has_set("rigid"))
    for (int v : topology().set("rigid"))
      if (fitted[v]) vertices.push_back(v);
  if (vertices.size() >= 50) return vertices;
  vertices.clear();
  for (int v = 0; v < topology().vertex_count(); ++v)
    if (fitted[v]) vertices.push_back(v);
  return vertices;
}

std::vector<int> RefinedTemplate::above_lips() const {
  const bool pointed = head.ibug68 && (*head.ibug68)[33] >= 0;
  std::vector<int> vertices;
  for (int v = 0; v < topology().vertex_count(); ++v)
    if (fitted[v] && (!pointed || neutral(v, 1) > head.neutral((*head.ibug68)[33], 1))) vertices.push_back(v);
  return vertices;
}

}  // namespace vultus::registration
