#include "scan/clean.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scan/soup.h"

namespace vultus::scan {
namespace {

Mesh mesh_from(Soup&& soup, const Mesh& raw) {
  TopologyData data;
  data.vertex_count = static_cast<int>(soup.positions.rows());
  data.face_offsets.reserve(soup.triangles.size() + 1);
  data.face_offsets.push_back(0);
  data.corner_vertex.reserve(3 * soup.triangles.size());
  for (const auto& triangle : soup.triangles) {
    data.corner_vertex.insert(data.corner_vertex.end(), triangle.begin(), triangle.end());
    data.face_offsets.push_back(static_cast<int>(data.corner_vertex.size()));
  }
  if (!soup.uv_rows.empty()) {
    data.uvs = raw.topology->uvs();
    for (const auto& row : soup.uv_rows) data.corner_uv.insert(data.corner_uv.end(), row.begin(), row.end());
  }
  Mesh mesh;
  mesh.topology = Topology::make(std::move(data));
  mesh.positions = std::move(soup.positions);
  mesh.colours = std::move(soup.colours);
  mesh.texture = soup.uv_rows.empty() ? std::string() : raw.texture;
  return mesh;
}

std::vector<bool> used_vertices(const Soup& soup) {
  std::vector<bool> used(soup.positions.rows(), false);
  for (const auto& triangle : soup.triangles)
    for (int v : triangle) used[v] = true;
  return used;
}

// Vertices that triangles used before and do not use now; what vertices were doubled into comes after them.
Points no_longer_used(const Soup& soup, const std::vector<bool>& before) {
  const std::vector<bool> now = used_vertices(soup);
  std::vector<int> rows;
  for (std::size_t v = 0; v < before.size(); ++v)
    if (before[v] && !now[v]) rows.push_back(static_cast<int>(v));
  return soup.positions(rows, Eigen::all);
}

}  // namespace

void CleanOptions::validate() const {
  if (!(mm_per_unit >= 0.0) || !std::isfinite(mm_per_unit))
    throw InputError("cleaning: millimetres per unit must be positive");
  if (!(smallest_component >= 0.0 && smallest_component <= 1.0))
    throw InputError("cleaning: the smallest component must be a share from 0 to 1");
  if (!(spike_factor > 1.0)) throw InputError("cleaning: the spike factor must be above 1");
  if (!(wildness > 0.0 && wildness <= 1.0)) throw InputError("cleaning: the wildness must be a share from 0 to 1");
  if (!(largest_filled_hole >= 0.0)) throw InputError("cleaning: the largest hole to fill cannot be negative");
  if (!(target_triangles >= 0.0)) throw InputError("cleaning: the number of triangles cannot be negative");
}

std::vector<std::string> CleanReport::lines() const {
  std::vector<std::string> text;
  text.push_back("units: " + units.name + (units.certain ? "" : " (size fits no head)"));
  auto say = [&](int count, const std::string& what) {
    if (count > 0) text.push_back(std::to_string(count) + " " + what);
  };
  say(non_finite_vertices, "vertices were not finite");
  say(duplicate_vertices, "vertices repeated others and were merged");
  say(degenerate_triangles, "triangles without area removed");
  say(duplicate_triangles, "triangles repeated others and were removed");
  say(non_manifold_splits, "vertices split where sheets met in one edge or point");
  say(stray_triangles, "triangles in " + std::to_string(stray_components) + " stray pieces removed");
  say(spike_vertices, "spikes removed");
  say(clutter_vertices, "vertices of hair-like clutter removed");
  if (turned_inside_out) text.push_back("the scan was inside out: every triangle turned round");
  say(other_heads, "further pieces of a head's size kept");
  say(unused_vertices, "vertices without triangles left out");
  say(holes_filled, "holes filled with " + std::to_string(invented_triangles) + " invented triangles");
  say(open_boundaries, "holes and borders left open");
  text.push_back(std::to_string(vertices_after) + " of " + std::to_string(vertices_before) + " vertices and " +
                 std::to_string(triangles_after) + " of " + std::to_string(triangles_before) + " triangles kept");
  return text;
}

CleanScan clean_scan(const Mesh& raw, const CleanOptions& options, Progress& progress) {
  options.validate();
  Soup soup = soup_from(raw);
  CleanScan result;
  CleanReport& report = result.report;
  report.vertices_before = static_cast<int>(soup.positions.rows());
  report.triangles_before = static_cast<int>(soup.triangles.size());
  if (soup.triangles.empty()) throw InputError("scan has no triangles to clean");
  report.units =
      options.mm_per_unit > 0.0 ? Units{"as told", options.mm_per_unit, true, false} : guess_units(soup.positions);
  soup.positions *= report.units.mm_per_unit;
  progress.check();

  report.non_finite_vertices = drop_non_finite(soup);
  report.duplicate_vertices = merge_equal_vertices(soup);
  report.degenerate_triangles = drop_degenerate(soup);
  report.duplicate_triangles = drop_repeated_triangles(soup);
  const std::vector<bool> sound = used_vertices(soup);  // repeated and broken ones do not count as taken out
  report.spike_vertices = drop_spikes(soup, options.spike_factor, 3);
  for (int pass = 0; pass < 3; ++pass) {
    const int found = drop_clutter(soup, options.wildness);
    report.clutter_vertices += found;
    if (found == 0) break;
  }
  report.spike_vertices += drop_border_spikes(soup, 0.5 * options.spike_factor, 6);
  progress.check();
  // Pieces are told apart after sheets that only touch have been taken apart and spikes' stumps cut loose.
  report.non_manifold_splits = orient(soup);
  const StrayPieces stray = drop_stray_pieces(soup, options.smallest_component);
  report.stray_components = stray.pieces;
  report.stray_triangles = stray.triangles;
  if (soup.triangles.empty()) throw InputError("nothing of the scan is left after cleaning");
  report.turned_inside_out = turn_outwards(soup);
  report.other_heads = std::max(0, count_large_pieces(soup, 0.3, 120.0) - 1);
  result.removed = no_longer_used(soup, sound);
  report.unused_vertices = drop_unused(soup) - report.spike_vertices - report.clutter_vertices -
                           report.duplicate_vertices - report.non_finite_vertices;
  report.unused_vertices = std::max(0, report.unused_vertices);
  progress.check();

  if (options.target_triangles > 0.0) decimate(soup, static_cast<int>(options.target_triangles));
  const std::size_t measured = soup.triangles.size();
  if (options.largest_filled_hole > 0.0) report.holes_filled = fill_holes(soup, options.largest_filled_hole);
  report.invented_triangles = static_cast<int>(soup.triangles.size() - measured);
  result.invented.assign(soup.triangles.size(), false);
  std::fill(result.invented.begin() + measured, result.invented.end(), true);
  report.open_boundaries = count_boundaries(soup);
  report.vertices_after = static_cast<int>(soup.positions.rows());
  report.triangles_after = static_cast<int>(soup.triangles.size());
  result.mesh = mesh_from(std::move(soup), raw);
  for (const std::string& line : report.lines()) progress.note(line);
  return result;
}

}  // namespace vultus::scan
