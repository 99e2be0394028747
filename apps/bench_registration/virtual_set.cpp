#include <algorithm>

#include "apps/bench_registration/case_set.h"
#include "apps/virtual_stage/expressions.h"
#include "apps/virtual_stage/stage.h"
#include "register/subdivide.h"
#include "register/template_head.h"

namespace vultus::apps::bench {
namespace {

using virtual_stage::StageOptions;

struct Person {
  StageOptions options;
  virtual_stage::VirtualActor actor;
  virtual_stage::VisibleActor visible;
  Person(const registration::Template& head, const StageOptions& given)
      : options(given), actor(virtual_stage::scanned_actor(head, given)), visible(actor) {}
};

StageOptions stage_options(const SetOptions& set, int person) {
  StageOptions options;
  options.seed = set.seed + static_cast<std::uint64_t>(person);
  if (set.triangles > 0) options.scan_triangles = set.triangles;
  return options;
}

class VirtualSet final : public CaseSet {
 public:
  explicit VirtualSet(const SetOptions& options) : options_(options), head_(registration::template_head()) {
    const registration::LoopSubdivision loop(head_.topology, head_.subdivisions);
    measured_ = measured_vertices(*loop.refined(), loop(head_.neutral), "face");
    // The scanned surface is the face model subdivided once more each way; the set comes along.
    TopologyData data = loop.refined()->data();
    data.sets.clear();
    for (int v = 0; v < data.vertex_count; ++v)
      if (measured_[v]) data.sets["measured"].push_back(v);
    constexpr int fine_levels = virtual_stage::DetailOptions{}.levels;
    const registration::LoopSubdivision fine(Topology::make(std::move(data)), fine_levels);
    std::vector<bool> marked(fine.refined()->vertex_count(), false);
    for (const int v : fine.refined()->set("measured")) marked[v] = true;
    triangles_ = marked_triangles(*fine.refined(), marked);
    if (options_.people <= 0) options_.people = 3;
  }

  std::string name() const override { return "virtual"; }
  const registration::Template& head() const override { return head_; }
  const std::vector<bool>& measured() const override { return measured_; }
  std::vector<std::string> people() const override {
    std::vector<std::string> names;
    for (int p = 0; p < options_.people; ++p)
      names.push_back("seed " + std::to_string(stage_options(options_, p).seed));
    return names;
  }
  std::vector<std::string> poses() const override {
    std::vector<std::string> names;
    for (const auto& expression : virtual_stage::expression_database()) names.push_back(expression.name);
    return names;
  }

  ScanCase make(int person, const std::string& pose) const override {
    if (!person_ || person != shown_) {
      person_ = std::make_unique<Person>(head_, stage_options(options_, person));
      shown_ = person;
    }
    virtual_stage::StagedScan staged = virtual_stage::stage_scan(person_->visible, pose, person_->options);
    ScanCase result;
    result.scan = std::move(staged.scan.mesh);
    Truth& truth = result.truth.emplace();
    truth.surface = std::move(staged.subject.surface);
    truth.surface.positions = transformed(staged.scan.scan_from_face, truth.surface.positions);
    truth.triangles = triangles_;
    truth.vertices = truth.surface.positions.topRows(static_cast<Eigen::Index>(measured_.size()));
    return result;
  }

 private:
  SetOptions options_;
  registration::Template head_;
  std::vector<bool> measured_;
  std::vector<int> triangles_;              // of the fine surface
  mutable std::unique_ptr<Person> person_;  // the last one asked for
  mutable int shown_ = -1;
};

}  // namespace

std::unique_ptr<CaseSet> virtual_set(const SetOptions& options) { return std::make_unique<VirtualSet>(options); }

}  // namespace vultus::apps::bench
