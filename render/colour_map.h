#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/image.h"

namespace vultus::render {

/// Colours whose lightness changes evenly to the eye, made in Oklab (Ottosson 2020).
enum class ColourMap {
  sequential,  ///< 0 pale, over yellow, orange and red, to 1 dark violet: what is wrong stands out on a pale face
  diverging,   ///< 0 blue, ½ near white, 1 red: for signed values
};

/// Linear RGB for `t`, clamped to [0, 1]; grey for NaN (no value there).
Eigen::Vector3f mapped_colour(ColourMap map, double t);

/// `count` colours of equal lightness and saturation, hues apart; for regions. Linear RGB.
std::vector<Eigen::Vector3f> distinct_colours(int count);

/// A legend: the map from its low end at the left to its high end at the right.
Image colour_bar(ColourMap map, int width, int height);

}  // namespace vultus::render
