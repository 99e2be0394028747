#include "register/landmark_advice.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace vultus::registration {
namespace {

constexpr std::array<std::pair<int, const char*>, 22> exact_places = {{
    {8, "tip of the chin"},
    {17, "outer end of the right brow"},
    {21, "inner end of the right brow"},
    {22, "inner end of the left brow"},
    {26, "outer end of the left brow"},
    {27, "root of the nose, between the eyes"},
    {30, "tip of the nose"},
    {31, "right side of the nose's base"},
    {33, "middle of the nose's base, above the lip"},
    {35, "left side of the nose's base"},
    {36, "outer corner of the right eye"},
    {39, "inner corner of the right eye"},
    {42, "inner corner of the left eye"},
    {45, "outer corner of the left eye"},
    {48, "right corner of the mouth"},
    {51, "middle of the upper lip's upper edge"},
    {54, "left corner of the mouth"},
    {57, "middle of the lower lip's lower edge"},
    {60, "right end of the opening between the lips"},
    {62, "middle of the upper lip's inner edge"},
    {64, "left end of the opening between the lips"},
    {66, "middle of the lower lip's inner edge"},
}};

constexpr std::array<int, 11> holding_points = {30, 36, 39, 42, 45, 48, 54, 51, 57, 62, 66};

const char* stretch_of(int i) {
  if (i < 17) return i < 8 ? "right half of the jaw's outline" : "left half of the jaw's outline";
  if (i < 27) return i < 22 ? "right brow" : "left brow";
  if (i < 31) return "ridge of the nose";
  if (i < 36) return "base of the nose";
  if (i < 42) return i < 39 ? "right upper lid's edge" : "right lower lid's edge";
  if (i < 48) return i < 45 ? "left upper lid's edge" : "left lower lid's edge";
  if (i < 60) return i < 55 ? "upper lip's upper edge" : "lower lip's lower edge";
  return i < 64 ? "upper lip's inner edge" : "lower lip's inner edge";
}

}  // namespace

std::string place_in_words(const std::string& name) {
  const auto index = ibug_index(name);
  if (!index) return {};
  for (const auto& [point, words] : exact_places)
    if (point == *index) return words;
  return stretch_of(*index);
}

std::string landmark_advice(const std::string& pose, const ScanLandmarks& found, double doubtful) {
  std::vector<std::string> wanted;
  bool any = false;
  for (const ScanLandmark& landmark : found) any = any || ibug_index(landmark.name);
  if (!any) return {};  // a template with names of its own
  for (int point : holding_points) {
    const std::string name = ibug_name(point);
    const auto same = [&](const ScanLandmark& landmark) { return landmark.name == name; };
    const auto place = std::find_if(found.begin(), found.end(), same);
    if (place == found.end() || place->confidence < doubtful) wanted.push_back(name);
  }
  if (wanted.empty()) return {};
  std::string list;
  for (const std::string& name : wanted) list += (list.empty() ? "" : ", ") + name + " (" + place_in_words(name) + ")";
  const std::string them = wanted.size() == 1 ? "it" : "them";
  return pose + ": not sure of " + list + "; to be sure place " + them + " in landmarks/" + pose +
         R"(.json of the capture or a file for "vultus register --landmarks", as {"points": {")" + wanted.front() +
         R"(": [x, y, z]}} in the scan's units; went on without)";
}

}  // namespace vultus::registration
