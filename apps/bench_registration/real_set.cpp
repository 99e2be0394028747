#include <algorithm>

#include "apps/bench_registration/case_set.h"
#include "core/error.h"
#include "core/mesh_io.h"
#include "rig/databank.h"

namespace vultus::apps::bench {
namespace {

namespace fs = std::filesystem;

class RealSet final : public CaseSet {
 public:
  explicit RealSet(const SetOptions& options) : data_(options.data) {
    if (data_.empty()) throw InputError("the set needs the real scans: --data or VULTUS_DATA");
    head_ = rig::read_ict_facekit(data_ / "ict-facekit").head;
    measured_ = measured_vertices(*head_.topology, head_.neutral, "face_narrow");
    if (options.people > 0 && people_.size() > static_cast<std::size_t>(options.people)) people_.resize(options.people);
  }

  std::string name() const override { return "real"; }
  const registration::Template& head() const override { return head_; }
  const std::vector<bool>& measured() const override { return measured_; }
  std::vector<std::string> people() const override { return people_; }
  std::vector<std::string> poses() const override { return {"neutral"}; }

  ScanCase make(int person, const std::string&) const override {
    ScanCase result;
    if (people_[static_cast<std::size_t>(person)] == "DemoFace") {
      result.scan = read_mesh(data_ / "meshmonk" / "DemoFace_10K.obj", NonFinite::keep);
      result.placed = read_five_points(data_ / "meshmonk" / "DemoFaceLandmarks.csv");
    } else {
      result.scan = read_mesh(data_ / "menpo3d-james" / "james.obj", NonFinite::keep);
      result.placed = read_ljson(data_ / "menpo3d-james" / "james.ljson");
    }
    return result;
  }

 private:
  fs::path data_;
  registration::Template head_;
  std::vector<bool> measured_;
  std::vector<std::string> people_ = {"DemoFace", "james"};
};

}  // namespace

std::unique_ptr<CaseSet> real_set(const SetOptions& options) { return std::make_unique<RealSet>(options); }

}  // namespace vultus::apps::bench
