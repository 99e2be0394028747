#include "apps/review_page.h"

#include <map>
#include <string_view>

#include "apps/review_assets.h"
#include "apps/review_data.h"
#include "apps/review_encoding.h"
#include "apps/review_findings.h"
#include "apps/review_head.h"
#include "apps/review_takes.h"
#include "core/error.h"
#include "core/files.h"
#include "core/manifest.h"

namespace vultus::apps {
namespace fs = std::filesystem;
namespace {

std::string library(const fs::path& folder, const char* file, const char* package) {
  const fs::path path = folder / file;
  if (!fs::exists(path)) {
    throw ToolError("the review page needs " + path.string() + "; install it with: apt install " + package);
  }
  return read_file(path);
}

std::string libraries(const fs::path& folder) {
  std::string text = library(folder, "dygraphs/dygraph.min.js", "libjs-dygraphs");
  text += "\n" + library(folder, "three/three.min.js", "libjs-three");
  return text + "\n" + library(folder, "three/examples/js/controls/OrbitControls.js", "libjs-three");
}

nlohmann::json actor_json(const ReviewSession& session) {
  nlohmann::json poses = nlohmann::json::array();
  for (const rig::Pose& pose : session.actor.poses) poses.push_back({{"name", pose.name}, {"tags", pose.tags}});
  return {{"name", session.actor.name},
          {"template", session.actor.template_name},
          {"vertices", session.actor.topology->vertex_count()},
          {"poses", poses}};
}

nlohmann::json registration_json(const ReviewSession& session, int width) {
  nlohmann::json registration = session.registration;
  if (!registration.is_object() || !registration.contains("poses")) return registration;
  for (auto& pose : registration["poses"]) {
    if (!pose.is_object() || !pose.contains("picture") || !pose["picture"].is_string()) continue;
    const fs::path picture = session.actor_folder / pose["picture"].get<std::string>();
    pose["picture"] = fs::exists(picture) ? inlined_picture(picture, width) : nlohmann::json(nullptr);
  }
  return registration;
}

nlohmann::json provenance_json(const ReviewSession& session) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [artefact, hash] : session.hashes) rows.push_back({{"artefact", artefact}, {"sha256", hash}});
  return rows;
}

/// The skeleton with its marks filled in; what is filled in is not searched for marks again.
std::string filled(std::string_view skeleton, const std::map<std::string_view, std::string>& marks) {
  std::string page;
  while (!skeleton.empty()) {
    const std::size_t open = skeleton.find('@');
    page += skeleton.substr(0, open);
    if (open == std::string_view::npos) break;
    const std::size_t close = skeleton.find('@', open + 1);
    page += marks.at(skeleton.substr(open + 1, close - open - 1));
    skeleton.remove_prefix(close + 1);
  }
  return page;
}

std::string page_text(const std::string& title, const nlohmann::json& data, const std::string& library_text) {
  std::string scripts;
  for (const char* name : {"data.js", "colours.js", "head.js", "charts.js", "tables.js", "repairs.js", "gaps.js",
                           "cleaning.js", "page.js"}) {
    scripts += std::string(review_asset(name)) + "\n";
  }
  return filled(review_asset("page.html"), {{"TITLE", html_text(title)},
                                            {"STYLE", style_text(review_asset("page.css"))},
                                            {"LIBRARIES", script_text(library_text)},
                                            {"DATA", json_text(data.dump())},
                                            {"SCRIPTS", script_text(scripts)}});
}

}  // namespace

ReviewPage write_review(const fs::path& folder, const ReviewOptions& options, Progress& progress) {
  const std::string library_text = libraries(options.javascript);
  const ReviewSession session = read_review_session(folder);
  ReviewPage page;
  page.file = folder / "review" / "index.html";
  nlohmann::json data = {{"version", version()}, {"actor", actor_json(session)}, {"session", session.facts}};
  data["registration"] = registration_json(session, 2 * options.pictures.width);  // four panels abreast
  data["head"] = head_json(session);
  data["provenance"] = provenance_json(session);
  data["findings"] = nlohmann::json::array();
  for (const Finding& finding : find_what_stands_out(session)) data["findings"].push_back(finding.json());
  data["takes"] = nlohmann::json::array();
  progress.begin("review pictures", 0);
  for (const ReviewTake& take : session.takes) {
    nlohmann::json json = take_json(take);
    const fs::path render = session.folder / "render" / take.name;
    json["pictures"] = pictures_json(render, session.folder / "review", options.pictures, progress);
    json["film"] = film_json(render, session.folder / "review", options.pictures);
    page.pictures += static_cast<int>(json["pictures"].size());
    data["takes"].push_back(std::move(json));
  }
  const std::string text = page_text("Review: " + session.actor.name, data, library_text);
  write_file(page.file, text);
  page.bytes = text.size();
  page.findings = static_cast<int>(data["findings"].size());
  page.takes = static_cast<int>(session.takes.size());
  return page;
}

}  // namespace vultus::apps
