#include <algorithm>
#include <cmath>

#include "core/number_text.h"
#include "register/quality.h"

namespace vultus::registration {
namespace {

std::string percent(double share) { return number(100.0 * share, "%.0f") + " %"; }

// Reasons as they come up, failures and warnings apart.
class Reasons {
 public:
  void fail(const std::string& text) { failures_.push_back(text); }
  void warn(const std::string& text) { warnings_.push_back(text); }
  void check(double value, double pass, double fail_at, const std::string& text) {
    if (value >= fail_at)
      fail(text);
    else if (value >= pass)
      warn(text);
  }
  bool failed() const { return !failures_.empty(); }
  void conclude(Quality& quality) const {
    quality.verdict = !failures_.empty() ? Verdict::fail : !warnings_.empty() ? Verdict::warn : Verdict::pass;
    quality.reasons = failures_;
    quality.reasons.insert(quality.reasons.end(), warnings_.begin(), warnings_.end());
  }

 private:
  std::vector<std::string> failures_, warnings_;
};

std::string unit_in_words(const std::string& unit) {
  return unit == "cm" ? "centimetres" : unit == "m" ? "metres" : unit;
}

// What cleaning and detection had to repair: right or not, a person should confirm it once.
void check_scan(const QualityLimits& limits, const Quality& quality, Reasons& reasons) {
  const ScanFacts& facts = quality.facts;
  if (quality.facing_away > 0.5) reasons.fail("the scan is inside out: its triangles look inwards");
  if (facts.inside_out) reasons.warn("the scan was inside out and has been turned");
  if (facts.tilt_degrees > 100.0)
    reasons.warn("the head stands upside down in the scan (" + number(facts.tilt_degrees, "%.0f") +
                 " degrees from +y) and has been turned; if that is how the scanner works, say \"up\" in capture.json");
  if (!facts.unit_certain)
    reasons.warn("the scan's size fits no head in millimetres, centimetres, metres or inches: wrong scale?");
  else if (!facts.unit.empty())
    reasons.warn("the scan's unit was taken to be " + unit_in_words(facts.unit) +
                 " from its size; confirm it by \"units\" in capture.json");
  if (facts.rescaled != 1.0)
    reasons.warn("the scan was scaled by " + number(facts.rescaled, "%.4g") +
                 " to make its eyes a person's distance apart: wrong units?");
  if (facts.other_heads > 0)
    reasons.warn("the scan shows " + std::to_string(facts.other_heads + 1) +
                 " heads or pieces of that size; one was taken and the rest left aside");
  else if (quality.elsewhere > limits.pass_elsewhere)
    reasons.warn(percent(quality.elsewhere) + " of the scan lies more than " + number(limits.elsewhere_beyond, "%.0f") +
                 " mm from the head found: a second head, a body?");
  for (const std::string& doubt : facts.doubts) reasons.warn(doubt);
}

void check_landmarks(const QualityLimits& limits, const Quality& quality, Reasons& reasons) {
  const ScanFacts& facts = quality.facts;
  reasons.check(facts.landmark_offset, limits.pass_offset, limits.fail_offset,
                "the landmarks lie " + number(facts.landmark_offset, "%.1f") +
                    " mm off the scan's surface: another scan's or another person's?");
  reasons.check(facts.landmark_misfit, limits.pass_misfit, limits.fail_misfit,
                "the landmarks do not form a face (" + number(facts.landmark_misfit, "%.1f") +
                    " mm from any head's): wrong names or another scan's?");
  if (!quality.landmarks.empty())
    reasons.check(quality.landmark_mean, limits.pass_landmarks, limits.fail_landmarks,
                  "landmarks lie " + number(quality.landmark_mean) + " mm from their places on average");
  reasons.check(std::abs(std::log(quality.size_ratio)), std::log(1.25), std::log(1.6),
                "the eyes' distance is " + number(quality.size_ratio) +
                    " times the reference's: wrong units or wrong landmarks?");
}

const SetQuality& main_region(const Quality& quality) {
  const auto face = quality.sets.find("face");
  return face != quality.sets.end() ? face->second : quality.sets.at("all");
}

std::string words(const std::string& region) {
  std::string text = "the " + region;
  std::replace(text.begin(), text.end(), '_', ' ');
  if (region == "under_chin") return "the skin under the chin";
  return region == "left_half" || region == "right_half" ? text + " of the face" : text;
}

void check_face(const QualityLimits& limits, const Quality& quality, Reasons& reasons) {
  const SetQuality& face = main_region(quality);
  // What templates call the face may reach behind the ears and down the neck, where scans are cropped.
  const auto front = quality.sets.find("front");
  const double coverage = front != quality.sets.end() ? front->second.coverage : face.coverage;
  reasons.check(-coverage, -limits.pass_coverage, -limits.fail_coverage,
                "only " + percent(coverage) + " of the face lies on data");
  reasons.check(face.scan_to_mesh_mean, limits.pass_mean, limits.fail_mean,
                "the scan lies " + number(face.scan_to_mesh_mean) + " mm from the mesh on average");
  reasons.check(face.mesh_to_scan_p95, 5 * limits.pass_mean, 5 * limits.fail_mean,
                "a twentieth of the face lies more than " + number(face.mesh_to_scan_p95) + " mm from the scan");
}

void check_regions(const QualityLimits& limits, const Quality& quality, Reasons& reasons) {
  for (const std::string region :
       {"left_half", "right_half", "forehead", "eyes", "nose", "lips", "chin", "under_chin", "ears"}) {
    const auto found = quality.sets.find(region);
    if (found == quality.sets.end()) continue;
    const SetQuality& part = found->second;
    const bool may_lack = region == "ears" || region == "under_chin";  // hair, and what scanners seldom see
    if (part.coverage < limits.region_coverage && !may_lack)
      reasons.warn("only " + percent(part.coverage) + " of " + words(region) + " has data");
    if (part.scan_to_mesh_mean > limits.pass_region && part.coverage > 0.1)
      reasons.warn(words(region) + ": " + number(part.scan_to_mesh_mean) + " mm from the scan on average");
  }
}

std::string triangles_in_words(int count) { return std::to_string(count) + (count == 1 ? " triangle" : " triangles"); }

std::string where(const Quality& quality, int SetQuality::*count) {
  std::string names;
  for (const std::string region : {"lips", "eyes", "nose", "chin", "forehead"}) {
    const auto found = quality.sets.find(region);
    if (found == quality.sets.end() || found->second.*count == 0) continue;
    names += (names.empty() ? " (" : ", ") + region + " " + std::to_string(found->second.*count);
  }
  return names.empty() ? names : names + ")";
}

void check_triangles(const QualityLimits& limits, const Quality& quality, Reasons& reasons) {
  const double triangles = std::max(1, main_region(quality).triangles);
  // The true lids of a closed eye roll over in up to three.
  reasons.check(quality.flipped_triangles, 4, std::max(50.0, 0.01 * triangles),
                triangles_in_words(quality.flipped_triangles) + " folded over" + where(quality, &SetQuality::flipped));
  reasons.check(quality.stretched_triangles, std::max(20.0, 0.005 * triangles), std::max(400.0, 0.1 * triangles),
                triangles_in_words(quality.stretched_triangles) + " stretched more than " +
                    number(limits.stretch, "%.0f") + " times" + where(quality, &SetQuality::stretched));
  reasons.check(quality.crumpled_triangles, std::max(40.0, 0.003 * triangles), std::max(400.0, 0.1 * triangles),
                std::to_string(quality.crumpled_triangles) + " triangles crumpled against their neighbours" +
                    where(quality, &SetQuality::crumpled));
  reasons.check(quality.crossing_triangles, std::max(20.0, 0.003 * triangles), std::max(400.0, 0.05 * triangles),
                std::to_string(quality.crossing_triangles) + " triangles pass through others" +
                    where(quality, &SetQuality::crossing));
}

void check_seals(const QualityLimits& limits, const Quality& quality, Reasons& reasons) {
  for (const Seal& seal : quality.seals) {
    if (seal.scan_gap < 0.0) continue;
    if (seal.mesh_gap <= limits.sealed_gap && seal.scan_gap >= limits.open_gap)
      reasons.warn("the " + seal.name + " are sealed in the mesh but " + number(seal.scan_gap, "%.1f") +
                   " mm open in the scan");
    if (seal.mesh_gap >= limits.open_gap && seal.scan_gap < sealed_groove)
      reasons.warn("the " + seal.name + " are " + number(seal.mesh_gap, "%.1f") +
                   " mm open in the mesh but sealed in the scan");
  }
}

}  // namespace

std::string verdict_name(Verdict verdict) {
  return verdict == Verdict::pass ? "pass" : verdict == Verdict::warn ? "warn" : "fail";
}

void reach_verdict(const QualityLimits& limits, Quality& quality) {
  Reasons reasons;
  check_scan(limits, quality, reasons);
  check_landmarks(limits, quality, reasons);
  check_face(limits, quality, reasons);
  check_triangles(limits, quality, reasons);
  // Where the whole is wrong, its parts say nothing new.
  if (!reasons.failed()) {
    check_regions(limits, quality, reasons);
    check_seals(limits, quality, reasons);
  }
  reasons.conclude(quality);
}

}  // namespace vultus::registration
