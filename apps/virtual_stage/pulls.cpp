#include "apps/virtual_stage/pulls.h"

#include <array>

namespace vultus::virtual_stage {
namespace {

using Table = std::array<std::vector<Pull>, muscle_count>;

void add_brow(Table& t) {
  // Landmarks 4.1, brow_middle, 4.5: inner, middle and outer brow. The forehead follows, less and less up to the hair.
  t[int(Muscle::frontalis_inner)] = {{"4.1", {-2, 8, 0}, {31, 38, 40}, {0, 8.0, -0.6}, 0.5}};
  t[int(Muscle::frontalis_outer)] = {{"4.5", {-3, 7, 4}, {28, 36, 40}, {0, 8.0, -1.0}, 0.4}};
  t[int(Muscle::brow_lowerer)] = {{"brow_middle_left", {-4, 2, 0}, {36, 24, 40}, {-0.6, -5.2, 0.3}, 0.5},
                                  {"glabella", {2, 1, 0}, {22, 24, 30}, {0, -2.2, 0}, 0.2}};
  t[int(Muscle::corrugator)] = {{"4.1", {4, 0, 0}, {22, 17, 30}, {-5.0, -2.0, 0.8}, 1.2}};
}

void add_eye_and_nose(Table& t) {
  t[int(Muscle::cheek_raiser)] = {{"orbit_lower_left", {5, -10, 0}, {32, 19, 34}, {0.5, 5.5, 0.6}, 2.4},
                                  {"orbit_outer_left", {-4, 0, 6}, {20, 17, 24}, {-3.0, 0, 0.5}, 0.8}};
  t[int(Muscle::lid_tightener)] = {{"3.9", {0, -7, 0}, {20, 9, 20}, {-0.5, 1.6, 0.5}, 0.8}};
  t[int(Muscle::nose_wrinkler)] = {{"9.1", {0, 4, 0}, {17, 24, 26}, {0.4, 5.0, -0.4}, 0.6},
                                   {"9.7", {2, -6, 0}, {14, 20, 24}, {0, 2.4, 0}, 1.2},
                                   {"8.5", {2, 5, 0}, {20, 14, 30}, {0.6, 3.4, 0.2}, 0.0, Layer::above_mouth},
                                   {"4.1", {0, 0, 0}, {20, 18, 30}, {-1.0, -3.2, 0}, 0.5}};
  t[int(Muscle::nostril_flare)] = {{"9.1", {0, -2, 0}, {10, 12, 16}, {2.4, 0.6, 0.2}, 0.4}};
}

void add_upper_mouth(Table& t) {
  t[int(Muscle::upper_lip_raiser)] = {{"8.5", {-8, 2, 0}, {31, 22, 36}, {0.8, 5.6, -0.6}, 0.4, Layer::above_mouth},
                                      {"nasolabial_left", {0, 13, 0}, {24, 24, 34}, {1.0, 3.5, 0.2}, 1.6},
                                      {"9.1", {2, -2, 0}, {12, 14, 20}, {0.6, 2.0, 0}, 0.3}};
  t[int(Muscle::zygomaticus)] = {{"8.3", {3, 2, -2}, {38, 33, 50}, {8.5, 6.5, -6.5}, 0.3},
                                 {"5.3", {-14, -13, 0}, {31, 26, 38}, {0.6, 4.2, 0.8}, 3.2},
                                 {"8.5", {2, 0, 0}, {24, 18, 30}, {1.2, 0.4, -1.8}, -0.3}};
  t[int(Muscle::dimpler)] = {{"8.3", {1, 0, 0}, {17, 16, 30}, {4.0, 0.5, -4.0}, -0.8},
                             {"8.3", {9, 1, -3}, {11, 15, 20}, {0, 0, 0}, 1.6}};
  t[int(Muscle::risorius)] = {{"8.3", {4, -2, -2}, {40, 30, 52}, {9.0, -1.0, -6.5}, 0.0},
                              {"8.3", {20, -4, -8}, {26, 32, 36}, {1.0, 0, 0}, 1.4}};
}

void add_lower_mouth(Table& t) {
  t[int(Muscle::anguli_depressor)] = {{"8.3", {2, -3, 0}, {30, 27, 42}, {2.0, -8.5, -2.4}, 0.0},
                                      {"mouth_chin_left", {4, 0, 0}, {24, 20, 34}, {0.3, -1.5, 0}, 1.2}};
  t[int(Muscle::lower_lip_depressor)] = {{"8.7", {-7, 0, 0}, {28, 21, 36}, {1.2, -6.0, 0.4}, 0.3, Layer::below_mouth}};
  t[int(Muscle::chin_raiser)] = {{"2.10", {5, -2, 0}, {22, 17, 30}, {-0.4, 5.0, 1.0}, 1.8, Layer::below_mouth},
                                 {"8.7", {-6, 1, 0}, {22, 14, 30}, {0, 4.2, 1.8}, 0.0, Layer::below_mouth}};
  t[int(Muscle::cheek_puff)] = {{"nasolabial_low_left", {8, 1, -4}, {37, 37, 46}, {1.0, 0, 0}, 8.0}};
}

}  // namespace

const std::vector<Pull>& pulls(Muscle muscle) {
  static const Table table = [] {
    Table t;
    add_brow(t);
    add_eye_and_nose(t);
    add_upper_mouth(t);
    add_lower_mouth(t);
    return t;
  }();
  return table[static_cast<int>(muscle)];
}

bool LipAction::any() const {
  return narrow != 0 || forward != 0 || open_upper != 0 || open_lower != 0 || thin_upper != 0 || thin_lower != 0 ||
         in_upper != 0 || in_lower != 0;
}

LipAction lip_action(Muscle muscle) {
  LipAction a;
  switch (muscle) {
    case Muscle::pucker:
      a.reach = 30, a.narrow = 0.37, a.forward = 7.0;
      break;
    case Muscle::funnel:
      a.reach = 25, a.narrow = 0.24, a.forward = 6.0, a.open_upper = 4.2, a.open_lower = 5.2;
      break;
    case Muscle::cheek_puff:
      a.reach = 24, a.forward = 2.2;
      break;
    case Muscle::lip_press:
      a.reach = 15, a.thin_upper = 0.45, a.thin_lower = 0.5, a.in_upper = 1.8, a.in_lower = 2.2, a.narrow = -0.03;
      break;
    case Muscle::upper_lip_roll:
      a.reach = 14, a.thin_upper = 0.7, a.in_upper = 5.0;
      break;
    case Muscle::lower_lip_roll:
      a.reach = 14, a.thin_lower = 0.7, a.in_lower = 5.5;
      break;
    case Muscle::lips_part:
      a.reach = 16, a.open_upper = 2.0, a.open_lower = 3.2;
      break;
    default:
      break;
  }
  return a;
}

}  // namespace vultus::virtual_stage
