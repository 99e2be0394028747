#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/bench_registration/real_landmarks.h"
#include "core/mesh.h"
#include "register/template.h"

namespace vultus::apps::bench {

/// What a perfect registration would find.
struct Truth {
  Mesh surface;                ///< what was scanned, without noise; the scan's frame, mm
  std::vector<int> triangles;  ///< of `surface` (triangulated view): where distances count
  Points vertices;             ///< refined template vertex_count×3, the scan's frame, mm
};

/// One scan to register.
struct ScanCase {
  Mesh scan;                   ///< raw
  std::optional<Truth> truth;  ///< none for scans of real people
  PlacedLandmarks placed;      ///< by others, in the scan's own unit; on some real scans
};

struct SetOptions {
  std::filesystem::path data;  ///< unpacked real data (VULTUS_DATA); empty where there is none
  std::uint64_t seed = 1;      ///< of the people, their poses and the noise
  int people = 0;              ///< at most; 0: as many as the set has
  int triangles = 0;           ///< of a test scan; 0: the set's own density
};

/// The scans of one row of the bench's table. Cases are made when asked for, one at a time.
class CaseSet {
 public:
  virtual ~CaseSet() = default;

  virtual std::string name() const = 0;
  virtual const registration::Template& head() const = 0;
  /// Vertices of the refined template where distances count: of the face, and such as a scanner can see.
  virtual const std::vector<bool>& measured() const = 0;
  virtual std::vector<std::string> people() const = 0;
  /// Of every person, "neutral" first.
  virtual std::vector<std::string> poses() const = 0;
  virtual ScanCase make(int person, const std::string& pose) const = 0;
};

/// The virtual stage: raw scans of 22 poses of three people, as `vultus simulate --seed 1` to `3` would write them.
std::unique_ptr<CaseSet> virtual_set(const SetOptions& options);
/// Five random people of ICT-FaceKit's first five modes (σ 1.5), neutral and twelve expressions, resampled.
/// Throws `InputError` where the data is missing.
std::unique_ptr<CaseSet> ict_set(SetOptions options);
/// Two neutrals of the same in 700,000 triangles, for seconds and memory; what a method makes ready once for a template
/// counts into the first.
std::unique_ptr<CaseSet> large_set(SetOptions options);
/// Meshmonk's synthetic faces in its template's topology, resampled to 200,000 triangles with noise and without holes;
/// the template's landmarks are found. Throws `InputError` where the data is missing.
std::unique_ptr<CaseSet> meshmonk_set(const SetOptions& options);
/// Raw scans of real people, DemoFace and james, with the landmarks that come with them; the template is ICT-FaceKit's.
/// Throws `InputError` where the data is missing.
std::unique_ptr<CaseSet> real_set(const SetOptions& options);

/// Names of all sets, in the table's order.
std::vector<std::string> set_names();
/// The set of that name. Throws `UsageError` for another, `InputError` where its data is missing.
std::unique_ptr<CaseSet> case_set(const std::string& name, const SetOptions& options);

/// The members of `set` (all where there is none of that name) that a scanner can see on the template's own shape.
std::vector<bool> measured_vertices(const Topology& refined, const Points& refined_neutral, const std::string& set);
/// Triangles (triangulated view) whose three vertices are marked.
std::vector<int> marked_triangles(const Topology& topology, const std::vector<bool>& marked);

}  // namespace vultus::apps::bench
