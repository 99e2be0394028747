#include <algorithm>

#include "apps/bench_registration/case_set.h"
#include "apps/bench_registration/resample.h"
#include "core/error.h"
#include "core/mesh_io.h"
#include "register/subdivide.h"
#include "register/template_file.h"

namespace vultus::apps::bench {
namespace {

namespace fs = std::filesystem;

class MeshmonkSet final : public CaseSet {
 public:
  explicit MeshmonkSet(const SetOptions& options) : options_(options) {
    if (options.data.empty()) throw InputError("the set needs meshmonk's folder: --data or VULTUS_DATA");
    const fs::path folder = options.data / "meshmonk";
    head_ = registration::read_template(folder / "Template.obj");
    measured_ = measured_vertices(*head_.topology, head_.neutral, "face");
    if (!fs::is_directory(folder / "simulated_faces")) throw InputError(folder / "simulated_faces", "is no folder");
    for (const auto& entry : fs::directory_iterator(folder / "simulated_faces"))
      if (entry.path().extension() == ".obj") files_.push_back(entry.path());
    if (files_.empty()) throw InputError(folder / "simulated_faces", "has no faces");
    std::sort(files_.begin(), files_.end());
    if (options.people > 0 && files_.size() > static_cast<std::size_t>(options.people)) files_.resize(options.people);
  }

  std::string name() const override { return "meshmonk"; }
  const registration::Template& head() const override { return head_; }
  const std::vector<bool>& measured() const override { return measured_; }
  std::vector<std::string> people() const override {
    std::vector<std::string> names;
    for (const fs::path& file : files_) names.push_back(file.stem().string());
    return names;
  }
  std::vector<std::string> poses() const override { return {"neutral"}; }

  ScanCase make(int person, const std::string&) const override {
    const fs::path& file = files_[static_cast<std::size_t>(person)];
    Mesh face{head_.topology, read_mesh(file).positions, {}, {}};
    if (face.positions.rows() != head_.topology->vertex_count())
      throw InputError(file, "is not in the template's topology");
    std::vector<int> all(static_cast<std::size_t>(face.positions.rows()));
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<int>(v);
    ResampleOptions resampling;
    resampling.seed = options_.seed * 1000 + static_cast<std::uint64_t>(person);
    resampling.triangles = options_.triangles > 0 ? options_.triangles : 200'000;
    resampling.holes = 0.0;
    ResampledScan scan = resample(face, all, resampling);
    ScanCase result;
    result.scan = std::move(scan.mesh);
    Truth& truth = result.truth.emplace();
    truth.surface = face;
    truth.surface.positions = transformed(scan.scan_from_surface, face.positions);
    truth.triangles = marked_triangles(*face.topology, measured_);
    truth.vertices = truth.surface.positions;
    return result;
  }

 private:
  SetOptions options_;
  registration::Template head_;
  std::vector<bool> measured_;
  std::vector<fs::path> files_;
};

}  // namespace

std::unique_ptr<CaseSet> meshmonk_set(const SetOptions& options) { return std::make_unique<MeshmonkSet>(options); }

}  // namespace vultus::apps::bench
