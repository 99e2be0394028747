#include "apps/bench_registration/case_set.h"

#include "core/error.h"
#include "core/files.h"
#include "register/fill.h"

namespace vultus::apps::bench {

std::vector<std::string> set_names() { return {"virtual", "ict", "meshmonk", "real", "large"}; }

std::unique_ptr<CaseSet> case_set(const std::string& name, const SetOptions& options) {
  if (name == "virtual") return virtual_set(options);
  if (name == "ict") return ict_set(options);
  if (name == "large") return large_set(options);
  if (name == "meshmonk") return meshmonk_set(options);
  if (name == "real") return real_set(options);
  throw UsageError("unknown set \"" + name + "\"; did you mean \"" + nearest_name(name, set_names()) + "\"?");
}

std::vector<bool> measured_vertices(const Topology& refined, const Points& refined_neutral, const std::string& set) {
  std::vector<bool> exposed = registration::exposed_vertices(refined, refined_neutral);
  if (!refined.has_set(set)) return exposed;
  std::vector<bool> measured(exposed.size(), false);
  for (const int v : refined.set(set)) measured[v] = exposed[v];
  return measured;
}

std::vector<int> marked_triangles(const Topology& topology, const std::vector<bool>& marked) {
  std::vector<int> triangles;
  const Triangles& all = topology.triangles();
  for (int t = 0; t < all.rows(); ++t)
    if (marked[all(t, 0)] && marked[all(t, 1)] && marked[all(t, 2)]) triangles.push_back(t);
  return triangles;
}

}  // namespace vultus::apps::bench
