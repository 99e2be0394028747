#include "apps/capture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "register/template_file.h"

namespace vultus::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

bool is_scan(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".obj" || extension == ".ply" || extension == ".stl";
}

std::map<std::string, CapturedPose> poses_in_folder(const fs::path& scans) {
  std::map<std::string, CapturedPose> poses;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(scans, error)) {
    if (!is_scan(entry.path())) continue;
    const std::string name = entry.path().stem().string();
    const auto [known, is_new] = poses.try_emplace(name, CapturedPose{name, {}, entry.path(), {}});
    if (!is_new) {
      const auto [first, second] =
          std::minmax({known->second.scan.filename().string(), entry.path().filename().string()});
      throw InputError(scans, "pose \"" + name + "\" has two scans, " + first + " and " + second);
    }
  }
  if (error && error != std::errc::no_such_file_or_directory) throw InputError(scans, error.message());
  return poses;
}

// The rotation that turns `axis` ("z", "-x", …) to +y without mirroring.
Eigen::Matrix3d upright_from(const fs::path& file, const std::string& axis) {
  const std::map<std::string, Eigen::Vector3d> axes = {{"x", {1, 0, 0}},   {"y", {0, 1, 0}},   {"z", {0, 0, 1}},
                                                       {"-x", {-1, 0, 0}}, {"-y", {0, -1, 0}}, {"-z", {0, 0, -1}}};
  const auto found = axes.find(axis);
  if (found == axes.end()) throw InputError(file, "up", "\"" + axis + "\" is not one of x, y, z, -x, -y, -z");
  const Eigen::Vector3d up = found->second;
  Eigen::Matrix3d rotation;
  rotation.row(1) = up.transpose();
  rotation.row(2) = Eigen::RowVector3d(up.z(), up.x(), up.y());
  rotation.row(0) = Eigen::RowVector3d(rotation.row(1)).cross(Eigen::RowVector3d(rotation.row(2)));
  return rotation;
}

void add_entry(const fs::path& file, const std::string& name, const json& entry,
               std::map<std::string, CapturedPose>& poses) {
  CapturedPose& pose = poses[name];
  pose.name = name;
  if (entry.contains("scan")) pose.scan = file.parent_path() / entry.at("scan").get<std::string>();
  if (entry.contains("tags")) pose.tags = entry.at("tags").get<std::vector<std::string>>();
  if (pose.scan.empty()) throw InputError(file, "pose \"" + name + "\"", "has no scan");
  if (!fs::is_regular_file(pose.scan)) {
    throw InputError(file, "pose \"" + name + "\"", "its scan " + pose.scan.string() + " is missing");
  }
}

void read_description(const fs::path& file, Capture& capture, std::map<std::string, CapturedPose>& poses) {
  const json description = read_json(file);
  try {
    for (const auto& [key, value] : description.items()) {
      if (key == "units")
        capture.mm_per_unit = registration::millimetres(value.get<std::string>());
      else if (key == "up")
        capture.upright = upright_from(file, value.get<std::string>());
      else if (key == "poses")
        for (const auto& [name, entry] : value.items()) add_entry(file, name, entry, poses);
      else if (key != "name" && key != "comment")
        throw InputError(file, "\"" + key + "\" is not units, up or poses");
    }
  } catch (const json::exception& problem) {
    throw InputError(file, std::string("is not a capture description: ") + problem.what());
  }
}

}  // namespace

Capture read_capture(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder, "is no capture folder");
  Capture capture;
  capture.folder = folder;
  auto poses = poses_in_folder(folder / "scans");
  if (fs::exists(folder / "capture.json")) read_description(folder / "capture.json", capture, poses);
  if (poses.empty()) throw InputError(folder, "holds no scans; scans/neutral.{obj,ply,stl} is needed at least");
  if (!poses.contains("neutral")) {
    std::vector<std::string> names;
    for (const auto& [name, pose] : poses) names.push_back(name);
    throw InputError(folder,
                     "has no pose called \"neutral\"; the nearest is \"" + nearest_name("neutral", names) + "\"");
  }
  for (auto& [name, pose] : poses) {
    const fs::path landmarks = folder / "landmarks" / (name + ".json");
    if (fs::exists(landmarks)) pose.landmarks = landmarks;
    capture.poses.insert(name == "neutral" ? capture.poses.begin() : capture.poses.end(), pose);
  }
  return capture;
}

}  // namespace vultus::apps
