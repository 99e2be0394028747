#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/array_io.h"
#include "core/files.h"
#include "core/image.h"
#include "core/manifest.h"
#include "mocap/clean.h"
#include "retarget/errors.h"
#include "retarget/face.h"
#include "retarget/regional.h"
#include "rig/database.h"
#include "rig/markers.h"
#include "tests/unit/retarget/small_face.h"

namespace vultus::apps {
namespace fs = std::filesystem;
namespace testing {

using retarget::testing::SmallFace;

/// A finished session of the small face on disk, gone at the end.
class ReviewFolder {
 public:
  explicit ReviewFolder(const std::string& actor_name = "Ada") {
    root_ = fs::temp_directory_path() /
            (std::string("vultus_review_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
    write_actor(actor_name);
    write_session();
  }
  ~ReviewFolder() {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }

  fs::path session() const { return root_ / "session"; }
  fs::path actor() const { return root_ / "actor"; }
  fs::path take() const { return session() / "takes" / "smile"; }

 private:
  void write_actor(const std::string& name) {
    rig_ = SmallFace::actor(2, 1, 15.0);
    rig_.name = name;
    rig_.region_masks = Image(8, 8, {"R00", "R01"});
    for (float& value : rig_.region_masks.pixels()) value = 0.5F;
    rig::save_actor(actor(), rig_, {"test", {}, {}});
    rig_.region_masks = Image();  // the solve takes the vertex masks
    write_json(actor() / "report" / "registration.json",
               {{"method", "default"},
                {"poses",
                 {{{"pose", "neutral"}, {"source", "scan"}, {"verdict", "pass"}, {"distance_mm", {{"mean", 0.2}}}},
                  {{"pose", "smile"}, {"source", "scan"}, {"verdict", "fail"}, {"reason", "lips not sealed"}},
                  {{"pose", "brows_up"}, {"source", "scan"}, {"verdict", "warn"}, {"reason", "coverage 71 %"}}}}});
    Array distance = Array::zeros({static_cast<std::size_t>(rig_.topology->vertex_count())});
    distance.values[3] = 1.25F;
    distance.values[4] = std::nanf("");
    write_npy(actor() / "report" / "neutral.distance.npy", distance);
  }

  void write_session() {
    const auto places = SmallFace::places(6);
    const auto labels = SmallFace::labels(places.size());
    const retarget::Weights truth = SmallFace::asymmetric(rig_, 24, 3);
    const retarget::Face face(rig_, truth.poses, truth.regions);
    std::vector<Points> frames;
    for (int f = 0; f < 24; ++f) frames.push_back(SmallFace::positions(rig_, places, face.at(truth, f)));
    const mocap::Take take = SmallFace::take(labels, frames);
    const auto basis = retarget::basis_from_surface(rig_, labels, places);
    const auto regional = retarget::marker_weights(rig_, labels, places),
               global = retarget::MarkerWeights::global(labels);
    const auto solved = retarget::solve_take(take, basis, regional), whole = retarget::solve_take(take, basis, global);
    retarget::write_weights(this->take() / "weights.npy", solved.weights);
    retarget::write_errors(this->take() / "errors.csv", retarget::marker_errors(take, basis, regional, solved.weights));
    retarget::write_errors(this->take() / "errors_global.csv",
                           retarget::marker_errors(take, basis, global, whole.weights));
    write_json(this->take() / "report.json", {{"space", "surface"}, {"warnings", {"M3: 9.0 mm from the face"}}});
    write_samples();
    rig::MarkerPlaces markers;
    for (std::size_t i = 0; i < labels.size(); ++i) markers[labels[i]] = places[i];
    rig::write_markers(session() / "markers.json", markers);
    Image picture = Image::rgb(40, 30);
    for (float& value : picture.pixels()) value = 0.25F;
    for (const char* name : {"000004.png", "000010.png"}) {
      make_folder(session() / "render" / "smile" / "reference");
      write_image(session() / "render" / "smile" / "reference" / name, picture);
    }
    Manifest manifest = Manifest::open(session() / "session.json", "session");
    manifest.facts() = {{"actor", actor().string()}, {"takes", {"smile"}}, {"solver", "qp"}};
    manifest.record("takes/smile/weights.npy", {"test", {}, {}});
    manifest.save();
  }

  void write_samples() {
    mocap::CleanReport report;
    report.take = "smile";
    report.head_method = "jig";
    report.rate_hz = 60.0;
    report.labels = SmallFace::labels(36);
    report.missing.assign(36, 0.0);
    report.head_residuals.assign(24, 0.1);
    report.head_residuals[9] = 2.5;
    report.head_rms = 0.5;
    report.origins.assign(36 * 24, mocap::Origin::measured);
    report.expected_errors.assign(36 * 24, 0.0F);
    report.gaps = {{2, 5, 8, mocap::Origin::spline, 0.2},
                   {7, 10, 20, mocap::Origin::rigid_group, 1.75},
                   {9, 3, 4, mocap::Origin::missing, 0.0}};
    for (const mocap::Gap& gap : report.gaps) {
      for (int f = gap.first; f <= gap.last; ++f) {
        report.origins[36 * f + gap.marker] = gap.method;
        report.expected_errors[36 * f + gap.marker] = static_cast<float>(gap.expected_error);
      }
    }
    report.repeats = {{mocap::Repeat::Kind::doubled, "", 6, 7}};
    report.label_edits = {
        {mocap::LabelEdit::Kind::swap, {{10, 12, "M4", "M5"}, {10, 12, "M5", "M4"}}, 0.8, "9.0 mm off", true},
        {mocap::LabelEdit::Kind::phantom, {{4, 5, "M6", ""}}, 0.9, "", true},
        {mocap::LabelEdit::Kind::fragment, {{18, 19, "*12", "M6"}, {21, 21, "*12", "M6"}}, 0.3, "", false}};
    report.slips = {{"jig2", 14, 16, 2.5}};
    mocap::write_samples(take() / "samples.json", report);
  }

  fs::path root_;
  rig::Actor rig_;
};

}  // namespace testing
}  // namespace vultus::apps
