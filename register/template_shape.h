#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

/// Hand-placed coordinates of the template head's left half (x ≥ 0), mm, in the face frame: +y up, +z out of the face,
/// origin midway between the outer eye corners, 18 mm behind the corneas' tips. Proportions follow published adult
/// averages (Farkas 1994): pupils 63 apart, outer canthi 90, sellion to chin 115, head 150 × 190.
namespace vultus::registration::shape {

using Curve = std::vector<Eigen::Vector3d>;

/// Eyeball, shared by the lids that lie on it.
struct Eyeball {
  Eigen::Vector3d centre{31.3, 0.0, 5.4};
  double radius = 12.6;
};

inline constexpr int eye_count = 16;    ///< vertices of an eye ring: 0 inner corner, over the upper lid, 8 outer corner
inline constexpr int mouth_count = 13;  ///< of half a mouth ring: 0 upper midline, 6 corner, 12 lower midline
inline constexpr int face_count = 26;   ///< of half a face ring: 0 forehead midline, 25 chin midline
inline constexpr int throat_first = 19;  ///< face-ring index of the jaw corner: the throat spans it to the midline

Curve eye_ring(
    int ring);  ///< 0 hidden behind the lid, 1 inner and 2 outer lid margin, 3 lid, 4 crease, 5 orbit, 6 brow
Curve mouth_ring(
    int ring);  ///< 0 cavity, 1–3 lip contact from behind to front, 4 vermilion, 5 its border, 6–8 skin around
Curve nose_row(int row);      ///< 0 brow … 4 with 2 columns, 5 with 3, 6–8 with 5; the first is the midline
Curve nostril();              ///< 7 vertices of the rim: front, columella, base, sill, back, outer, front outer
Eigen::Vector3d columella();  ///< between infratip and subnasale, on the midline
Curve cheek_strip();          ///< 12 vertices beside nose wing and mouth, from under the eye to the chin midline
Curve face_ring(int ring);    ///< 0 cheekbone, 1 middle of the side, 2 the outline: hairline, front of the ear, jaw
Curve throat_row(int row);  ///< 0–4, last is the neck's boundary; 7 vertices from below the jaw corner to the midline
Curve side_column(int column);  ///< 1–2 with 25 rows, 3–8 with 15: crown to neck, from the ear to the back midline
Curve ear_ring(int ring);       ///< 1 behind … 6 concha with 12 vertices, 7 the canal alone
Curve tooth_row(bool upper, int row);  ///< 0–3 gum, edge, edge behind, gum behind; 7 vertices from the midline

}  // namespace vultus::registration::shape
