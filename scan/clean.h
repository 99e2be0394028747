#pragma once

#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/progress.h"
#include "scan/units.h"

namespace vultus::scan {

struct CleanOptions {
  double mm_per_unit = 0.0;           ///< 0: guess from the size
  double smallest_component = 0.004;  ///< of the largest component's area, [0, 1]; smaller ones are stray
  double spike_factor = 6.0;          ///< > 1: a vertex farther from its neighbours' plane than this many usual steps
                                      ///< (robust over the scan) is a spike; so is a border vertex whose edges are all
                                      ///< half as many times the usual length; large values keep everything
  double wildness = 0.3;              ///< (0, 1]: share of the triangles around a vertex that may stand steep on one
                                      ///< another; beyond it is hair-like clutter. 1 keeps everything
  double largest_filled_hole = 0.0;   ///< mm of boundary length; 0 leaves every hole open
  double target_triangles = 0;        ///< decimate down to about so many (0: keep the density)
  void validate() const;              ///< throws `InputError`
};

/// What cleaning found, counted in the order in which it was done.
struct CleanReport {
  Units units;
  int vertices_before = 0, triangles_before = 0;
  int non_finite_vertices = 0, duplicate_vertices = 0, degenerate_triangles = 0, duplicate_triangles = 0;
  int non_manifold_splits = 0;                    ///< vertices doubled so that every edge has at most two sides
  int stray_components = 0, stray_triangles = 0;  ///< small pieces, strands and shreds
  int spike_vertices = 0, clutter_vertices = 0;
  bool turned_inside_out = false;  ///< triangles looked inwards and were turned round
  int other_heads = 0;             ///< further pieces as large as a head: kept, though at most one is wanted
  int unused_vertices = 0;
  int open_boundaries = 0;  ///< holes and borders left open
  int holes_filled = 0, invented_triangles = 0;
  int vertices_after = 0, triangles_after = 0;
  std::vector<std::string> lines() const;  ///< one sentence a finding, for a log
};

struct CleanScan {
  Mesh mesh;                   ///< mm, triangles, oriented and manifold; UVs and colours kept
  std::vector<bool> invented;  ///< per triangle: made by hole filling, never to be trusted as data
  Points removed;              ///< mm: spikes, clutter and stray pieces, for pictures of what was removed
  CleanReport report;
};

/// Raw scan → clean geometry (DESIGN §3.1). Throws `InputError` when nothing is left or the scan has no triangles.
CleanScan clean_scan(const Mesh& raw, const CleanOptions& options = {}, Progress& progress = Progress::none());

}  // namespace vultus::scan
