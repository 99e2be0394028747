#include "register/template_landmarks.h"

#include <string>

namespace vultus::registration::layout {
namespace {

/// A point and its mirror image; MPEG-4 numbers the left one in `left`.
struct Pair {
  const char *left, *right;
  int vertex;
  bool major = false;
};
struct Single {
  const char* name;
  int vertex;
  bool major = false;
};

std::vector<Single> feature_points_on_midline(const Weave& w) {
  return {{"2.1", w.face[1][25], true},  {"2.2", w.mouth[3][0]},       {"2.3", w.mouth[3][12]},
          {"2.10", w.mouth[8][12]},      {"7.1", w.side[8][9]},        {"8.1", w.mouth[5][0], true},
          {"8.2", w.mouth[5][12], true}, {"9.3", w.nose[7][0], true},  {"9.12", w.nose[4][0]},
          {"9.15", w.mouth[8][0], true}, {"11.1", w.face[4][0], true}, {"11.4", w.side[4][0]},
          {"11.6", w.side[8][4], true}};
}

std::vector<Pair> feature_point_pairs(const Weave& w) {
  return {
      {"2.4", "2.5", w.mouth[3][6]},       {"2.6", "2.7", w.mouth[3][3]},         {"2.8", "2.9", w.mouth[3][9]},
      {"2.11", "2.12", w.face[1][23]},     {"2.13", "2.14", w.face[4][19], true}, {"3.1", "3.2", w.eye[1][4]},
      {"3.3", "3.4", w.eye[1][12]},        {"3.5", "3.6", w.eyeball[0][0]},       {"3.7", "3.12", w.eye[2][8], true},
      {"3.9", "3.10", w.eye[2][12], true}, {"3.11", "3.8", w.eye[2][0], true},    {"3.13", "3.14", w.eye[2][4], true},
      {"4.1", "4.2", w.face[0][2], true},  {"4.3", "4.4", w.eye[6][5]},           {"4.5", "4.6", w.eye[6][6], true},
      {"5.1", "5.2", w.face[1][15]},       {"5.3", "5.4", w.face[1][11]},         {"8.3", "8.4", w.mouth[5][6], true},
      {"8.5", "8.6", w.mouth[5][3]},       {"8.7", "8.8", w.mouth[5][9]},         {"8.10", "8.9", w.mouth[5][1]},
      {"9.1", "9.2", w.nose[7][3], true},  {"9.5", "9.4", w.mouth[8][3]},         {"9.7", "9.6", w.eye[6][1]},
      {"9.13", "9.14", w.nose[5][2]},      {"10.1", "10.2", w.ear[2][11]},        {"10.3", "10.4", w.ear[2][8]},
      {"10.5", "10.6", w.ear[2][5], true}, {"10.7", "10.8", w.ear[0][4]},         {"10.9", "10.10", w.ear[0][0]},
      {"11.3", "11.2", w.face[4][5]}};
}

std::vector<Single> more_on_midline(const Weave& w) {
  return {{"glabella", w.nose[0][0]},       {"sellion", w.nose[2][0], true},   {"nose_bridge", w.nose[3][0]},
          {"supratip", w.nose[6][0]},       {"columella", w.columella},        {"philtrum", w.mouth[7][0]},
          {"labiomental", w.mouth[7][12]},  {"submental", w.face[2][25]},      {"under_chin", w.face[4][25]},
          {"throat_top", w.throat[1][6]},   {"throat", w.throat[2][6]},        {"throat_low", w.throat[3][6]},
          {"neck_front", w.throat[4][6]},   {"forehead_low", w.face[1][0]},    {"forehead", w.face[2][0]},
          {"forehead_high", w.face[3][0]},  {"skull_front", w.side[2][0]},     {"skull_top_front", w.side[3][0]},
          {"skull_top_back", w.side[6][0]}, {"skull_back_high", w.side[8][0]}, {"occiput_high", w.side[8][2]},
          {"occiput_low", w.side[8][6]},    {"inion", w.side[8][7]},           {"nape", w.side[8][11]},
          {"neck_back", w.side[8][14]}};
}

std::vector<Pair> more_pairs(const Weave& w) {
  return {{"brow_inner", nullptr, w.eye[6][3]},        {"brow_middle", nullptr, w.eye[6][4]},
          {"lid_upper_inner", nullptr, w.eye[2][2]},   {"lid_upper_outer", nullptr, w.eye[2][6]},
          {"lid_lower_inner", nullptr, w.eye[2][14]},  {"lid_lower_outer", nullptr, w.eye[2][10]},
          {"lid_crease", nullptr, w.eye[4][4]},        {"orbit_lower", nullptr, w.eye[5][12]},
          {"orbit_outer", nullptr, w.eye[6][8]},       {"nose_crease", nullptr, w.nose[7][4]},
          {"nose_wing_top", nullptr, w.nose[6][3]},    {"nostril_front", nullptr, w.nostril[0]},
          {"nostril_back", nullptr, w.nostril[4]},     {"nasolabial_high", nullptr, w.mouth[8][4]},
          {"nasolabial", nullptr, w.mouth[8][5]},      {"nasolabial_low", nullptr, w.mouth[8][6]},
          {"mouth_chin", nullptr, w.mouth[8][8]},      {"lip_upper_outer", nullptr, w.mouth[5][4]},
          {"lip_lower_outer", nullptr, w.mouth[5][8]}, {"temple", nullptr, w.face[2][7]},
          {"hairline_inner", nullptr, w.face[4][2]},   {"hairline_temple", nullptr, w.face[4][7]},
          {"sideburn", nullptr, w.face[4][9]},         {"zygomatic_arch", nullptr, w.face[2][10]},
          {"cheek_low", nullptr, w.face[1][18]},       {"jaw_high", nullptr, w.face[4][16]},
          {"jaw_front", nullptr, w.face[4][22]},       {"jaw_chin", nullptr, w.face[4][24]},
          {"side_hair_front", nullptr, w.side[2][5]},  {"side_hair_top", nullptr, w.side[4][3]},
          {"side_hair", nullptr, w.side[4][5]},        {"side_hair_back", nullptr, w.side[6][5]},
          {"mastoid", nullptr, w.side[2][15]},         {"neck_side", nullptr, w.side[2][19]},
          {"neck_base", nullptr, w.side[2][24]},       {"neck_front_side", nullptr, w.throat[4][3]}};
}

}  // namespace

std::vector<Landmark> landmarks(const Weave& w) {
  std::vector<Landmark> all;
  const auto add_single = [&](const Single& s) { all.push_back({s.name, s.vertex, s.major}); };
  const auto add_pair = [&](const Pair& p) {
    const bool numbered = p.right != nullptr;
    all.push_back({numbered ? p.left : std::string(p.left) + "_left", p.vertex, p.major});
    all.push_back({numbered ? p.right : std::string(p.left) + "_right", w.mirror[p.vertex], p.major});
  };
  for (const Single& s : feature_points_on_midline(w)) add_single(s);
  for (const Pair& p : feature_point_pairs(w)) add_pair(p);
  for (const Single& s : more_on_midline(w)) add_single(s);
  for (const Pair& p : more_pairs(w)) add_pair(p);
  return all;
}

Ibug68 ibug68(const Weave& w) {
  Ibug68 points;
  points.fill(-1);
  const auto both = [&](int left, int right, int vertex) {
    points[left] = vertex;
    points[right] = w.mirror[vertex];
  };
  const int jaw[] = {w.face[4][11], w.face[4][13], w.face[4][15], w.face[4][17],
                     w.face[4][19], w.face[3][20], w.face[2][21], w.face[1][23]};
  for (int i = 0; i < 8; ++i) both(16 - i, i, jaw[i]);
  points[8] = w.face[1][25];
  const int brow[] = {w.face[0][2], w.eye[6][3], w.eye[6][4], w.eye[6][5], w.eye[6][6]};
  for (int i = 0; i < 5; ++i) both(22 + i, 21 - i, brow[i]);
  const int bridge[] = {2, 4, 5, 7};
  for (int i = 0; i < 4; ++i) points[27 + i] = w.nose[bridge[i]][0];
  both(35, 31, w.mouth[8][3]);
  both(34, 32, w.mouth[8][1]);
  points[33] = w.mouth[8][0];
  const int lid[] = {0, 3, 5, 8, 11, 13}, left_eye[] = {42, 43, 44, 45, 46, 47}, right_eye[] = {39, 38, 37, 36, 41, 40};
  for (int i = 0; i < 6; ++i) both(left_eye[i], right_eye[i], w.eye[2][lid[i]]);
  const int outer[] = {0, 1, 3, 6, 8, 10, 12}, left_lip[] = {51, 52, 53, 54, 55, 56, 57},
            right_lip[] = {51, 50, 49, 48, 59, 58, 57};
  for (int i = 0; i < 7; ++i) both(left_lip[i], right_lip[i], w.mouth[5][outer[i]]);
  const int inner[] = {0, 2, 6, 10, 12}, left_inner[] = {62, 63, 64, 65, 66}, right_inner[] = {62, 61, 60, 67, 66};
  for (int i = 0; i < 5; ++i) both(left_inner[i], right_inner[i], w.mouth[3][inner[i]]);
  return points;
}

}  // namespace vultus::registration::layout
