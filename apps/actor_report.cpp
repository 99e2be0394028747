#include "apps/actor_report.h"

#include <cstdio>
#include <filesystem>
#include <map>

#include "apps/review_encoding.h"

namespace vultus::apps {
namespace {

using nlohmann::json;

constexpr const char* style = R"(
body { font: 14px/1.45 system-ui, sans-serif; margin: 0 auto; max-width: 1180px; padding: 20px; color: #22252a; background: #f5f5f3; }
h1 { font-size: 22px; margin: 0 0 4px; } h2 { font-size: 16px; margin: 28px 0 8px; }
.dim { color: #6a6f78; } ul { margin: 6px 0; padding-left: 20px; }
section { background: #fff; border: 1px solid #dddcd7; border-radius: 6px; padding: 14px 16px; margin: 14px 0; }
section h3 { margin: 0 0 8px; font-size: 15px; }
.verdict { display: inline-block; border-radius: 3px; padding: 1px 8px; font-size: 12px; font-weight: 600; color: #fff; }
.pass { background: #3b7d4f; } .warn { background: #b07a10; } .fail { background: #b3372c; } .transfer { background: #6a6f78; }
figure { margin: 0; } img { width: 100%; border-radius: 4px; display: block; }
figcaption { display: grid; grid-template-columns: repeat(4, minmax(0, 1fr)); color: #6a6f78; font-size: 12px; padding: 4px 0 8px; }
table { border-collapse: collapse; font-size: 13px; margin: 8px 0; }
td, th { padding: 2px 14px 2px 0; text-align: right; font-variant-numeric: tabular-nums; } td:first-child, th:first-child { text-align: left; }
th { color: #6a6f78; font-weight: 500; } summary { cursor: pointer; color: #6a6f78; } a { color: inherit; }
)";

std::string number(const json& value, const char* format = "%.2f") {
  if (!value.is_number()) return "–";
  char text[32];
  std::snprintf(text, sizeof text, format, value.get<double>());
  return text;
}

std::string list(const json& lines) {
  std::string html;
  for (const json& line : lines)
    if (line.is_string()) html += "<li>" + html_text(line.get<std::string>()) + "</li>";
  return html.empty() ? html : "<ul>" + html + "</ul>";
}

std::string badge(const json& pose) {
  const std::string verdict = pose.value("verdict", "pass");
  const bool given = pose.value("source", "scan") == "transfer" && verdict == "pass";
  return "<span class=\"verdict " + std::string(given ? "transfer" : verdict) + "\">" +
         (given ? "transferred" : verdict) + "</span>";
}

std::string spaced(std::string region) {
  for (char& c : region)
    if (c == '_') c = ' ';
  return region;
}

std::string region_table(const json& regions) {
  std::string rows;
  for (const char* name :
       {"face", "forehead", "eyes", "nose", "lips", "chin", "under_chin", "ears", "neck", "left_half", "right_half"}) {
    if (!regions.contains(name)) continue;
    const json& region = regions.at(name);
    rows += "<tr><td>" + spaced(name) + "</td><td>" + number(region.value("mean", json())) + "</td><td>" +
            number(region.value("p95", json())) + "</td><td>" +
            number(100.0 * region.value("coverage", 0.0), "%.0f %%") + "</td>";
    for (const char* count : {"flipped", "stretched", "crossing", "crumpled"})
      rows += "<td>" + number(region.value(count, json()), "%.0f") + "</td>";
    rows += "</tr>";
  }
  if (rows.empty()) return rows;
  return "<table><tr><th>region</th><th>mean, mm</th><th>95 %</th><th>on data</th><th>flipped</th><th>stretched</th>"
         "<th>crossing</th><th>crumpled</th></tr>" +
         rows + "</table>";
}

std::string seal_lines(const json& seals) {
  std::string text;
  for (const json& seal : seals) {
    const json scan = seal.value("scan_mm", json());
    text += (text.empty() ? "" : "; ") + seal.value("name", std::string()) + " open by " +
            number(seal.value("mesh_mm", json()), "%.1f") + " mm" +
            (scan.is_number() ? ", in the scan by " + number(scan, "%.1f") : ", the scan does not tell");
  }
  return text.empty() ? text : "<p class=\"dim\">" + html_text(text) + "</p>";
}

std::string details(const std::string& title, const json& lines) {
  const std::string content = list(lines);
  return content.empty() ? content : "<details><summary>" + title + "</summary>" + content + "</details>";
}

std::string pose_section(const json& pose) {
  const std::string name = pose.value("pose", std::string());
  std::string html = "<section id=\"" + html_text(name) + "\"><h3>" + html_text(name) + " " + badge(pose) + "</h3>";
  html += list(pose.value("reasons", json::array()));
  if (const std::string picture = pose.value("picture", std::string()); !picture.empty()) {
    html += "<figure><img loading=\"lazy\" alt=\"" + html_text(name) + "\" src=\"" +
            html_text(std::filesystem::path(picture).filename().string()) +
            "\"><figcaption><span>scan as cleaned; removed red, invented blue</span><span>result</span>"
            "<span>distance to the scan, light 0 to dark 1 mm; grey: no data</span><span>the whole scan</span>"
            "</figcaption></figure>";
  }
  html += region_table(pose.value("regions", json::object())) + seal_lines(pose.value("seals", json::array()));
  html += details("What was removed and repaired", pose.value("cleaning", json::array()));
  return html + details("What was decided", pose.value("decisions", json::array())) + "</section>";
}

// Failures first, then warnings.
std::string where_to_look(const json& poses) {
  std::string html;
  for (const std::string verdict : {"fail", "warn"})
    for (const json& pose : poses) {
      if (pose.value("verdict", "pass") != verdict) continue;
      const std::string name = html_text(pose.value("pose", std::string()));
      html += "<li>" + badge(pose) + " <a href=\"#" + name + "\">" + name +
              "</a>: " + html_text(pose.value("reason", std::string())) + "</li>";
    }
  return html.empty() ? "<p>Nothing stands out: every pose passed.</p>" : "<ul>" + html + "</ul>";
}

}  // namespace

std::string actor_report_page(const std::string& actor, const json& report) {
  const json poses = report.value("poses", json::array());
  std::map<std::string, int> counts;
  for (const json& pose : poses) ++counts[pose.value("verdict", "pass")];
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Registration of " +
                     html_text(actor) + "</title><style>" + style + "</style></head><body><h1>Registration of " +
                     html_text(actor) + "</h1><p class=\"dim\">template " +
                     html_text(report.value("template", std::string())) + ", method " +
                     html_text(report.value("method", std::string())) + "; " + std::to_string(counts["pass"]) +
                     " passed, " + std::to_string(counts["warn"]) + " to look at, " + std::to_string(counts["fail"]) +
                     " failed</p><h2>Where to look</h2>" + where_to_look(poses) +
                     list(report.value("warnings", json::array())) + "<h2>Poses</h2>";
  for (const json& pose : poses) html += pose_section(pose);
  return html + "</body></html>\n";
}

}  // namespace vultus::apps
