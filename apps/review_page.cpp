#include "apps/review_page.h"

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
  return library(folder, "dygraphs/dygraph.min.js", "libjs-dygraphs") + "\n" +
         library(folder, "three/three.min.js", "libjs-three") + "\n" +
         library(folder, "three/examples/js/controls/OrbitControls.js", "libjs-three");
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

std::string replaced_once(const std::string& text, const std::string& mark, const std::string& with) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return text;
  return text.substr(0, at) + with + text.substr(at + mark.size());
}

std::string escaped(const std::string& text) {
  std::string result;
  for (char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else
      result += c;
  }
  return result;
}

std::string page_text(const std::string& title, const nlohmann::json& data, const std::string& library_text) {
  // Order matters: the data comes last, so that nothing inside it is taken for a mark.
  std::string page = std::string(review_asset("page.html"));
  page = replaced_once(page, "@TITLE@", escaped(title));
  page = replaced_once(page, "@STYLE@", style_text(review_asset("page.css")));
  page = replaced_once(page, "@LIBRARIES@", script_text(library_text));
  std::string scripts;
  for (const char* name : {"data.js", "colours.js", "head.js", "charts.js", "gaps.js", "tables.js", "page.js"}) {
    scripts += std::string(review_asset(name)) + "\n";
  }
  page = replaced_once(page, "@SCRIPTS@", script_text(scripts));
  return replaced_once(page, "@DATA@", json_text(data.dump()));
}

}  // namespace

ReviewPage write_review(const fs::path& folder, const ReviewOptions& options, Progress& progress) {
  const std::string library_text = libraries(options.javascript);
  const ReviewSession session = read_review_session(folder);
  ReviewPage page;
  page.file = folder / "review" / "index.html";
  nlohmann::json data = {{"version", version()}, {"actor", actor_json(session)}, {"session", session.facts}};
  data["registration"] = registration_json(session, options.pictures.width);
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
