#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/mesh.h"

/// How the template head's control mesh is woven: named rings and rows of vertices joined by strips of triangles.
namespace vultus::registration::layout {

using Ring = std::vector<int>;

/// Charts of the texture; triangles of one patch share one.
enum class Patch { skin, mouth_cavity, eyeball_front, eyeball_back, teeth_upper, teeth_lower };

/// The left half (x ≥ 0), or the whole head after `mirrored`, with its named rings (always those of the left half).
struct Weave {
  std::vector<Eigen::Vector3d> position;      ///< as placed by hand, before fairing, mm
  std::vector<double> hold;                   ///< how firmly fairing keeps a vertex in place (0 free)
  std::vector<double> set_back;               ///< share of Loop's shrinking that `loop_controls` undoes there, 0 … 1
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<Patch> patch;                   ///< of each triangle
  std::vector<int> mirror;                    ///< vertex on the other side; itself on the midline

  std::array<Ring, 7> eye;      ///< 16 vertices each, see `shape::eye_ring`
  std::array<Ring, 9> mouth;    ///< 13 each, see `shape::mouth_ring`
  Ring mouth_back;              ///< 13, end of the cavity
  std::array<Ring, 9> nose;     ///< rows 0–8
  Ring nostril, nostril_inner;  ///< 7 each
  int nostril_centre = -1, columella = -1;
  std::array<Ring, 5> face;     ///< 26 each: 0 around eyes, nose and mouth, 4 the face's outline
  std::array<Ring, 5> throat;   ///< 7 each, last is the neck's boundary
  std::array<Ring, 9> side;     ///< column 0 (25: outline, then neck), 1–2 (25; -1 inside the ear), 3–8 (15)
  std::array<Ring, 8> ear;      ///< 12 each, 0 on the skull; 7 the canal alone
  std::array<Ring, 7> eyeball;  ///< front pole, five rings of 12, back pole
  std::array<Ring, 4> teeth_upper, teeth_lower;  ///< 7 each
};

/// The woven left half.
Weave left_half();
/// Both halves: the left half's vertices first, then the right half's.
Weave mirrored(const Weave& left);

}  // namespace vultus::registration::layout
