#include "register/template_shape.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>

#include "register/template_curves.h"

namespace vultus::registration::shape {
namespace {

/// Puts a point on the sphere `clearance` outside the eyeball where the sphere reaches that far, else keeps its z.
Eigen::Vector3d on_lid(const Eigen::Vector3d& p, double clearance) {
  const Eyeball eye;
  const double r = eye.radius + clearance;
  const double rest = r * r - (p - eye.centre).head<2>().squaredNorm();
  const double z = rest > 9.0 ? eye.centre.z() + std::sqrt(rest) : p.z();
  return {p.x(), p.y(), rest > 9.0 ? z : p.z()};
}

Curve lid_margin() {
  Curve c = {{17.0, -1.8, 10.2}, {18.9, 0.8, 0},  {22.2, 2.9, 0},   {26.4, 4.3, 0},  {30.8, 4.7, 0},  {35.2, 4.3, 0},
             {39.4, 3.2, 0},     {42.8, 1.8, 0},  {45.2, 0.4, 8.2}, {42.6, -1.6, 0}, {39.0, -3.5, 0}, {35.0, -4.8, 0},
             {30.6, -5.2, 0},    {26.2, -4.9, 0}, {22.0, -4.0, 0},  {19.0, -3.0, 0}};
  for (int i = 0; i < eye_count; ++i)
    if (i % 8 != 0) c[i] = on_lid(c[i], 1.7);
  return c;
}

Curve lid_crease() {
  return {{14.3, -2.2, 12.0},  {15.6, 3.3, 12.8},   {19.0, 7.4, 15.4},  {24.5, 10.0, 16.9},
          {31.0, 10.9, 17.4},  {37.5, 10.3, 16.4},  {43.5, 8.0, 13.6},  {48.0, 4.6, 10.0},
          {49.8, 0.0, 7.4},    {47.5, -4.8, 8.8},   {43.0, -8.5, 12.0}, {37.5, -10.6, 14.6},
          {31.0, -11.2, 15.8}, {24.8, -10.6, 15.3}, {19.3, -8.5, 13.6}, {15.6, -5.4, 12.2}};
}

Curve lid_middle() {
  const Curve margin = lid_margin(), crease = lid_crease();
  Curve c(eye_count);
  for (int i = 0; i < eye_count; ++i) {
    const Eigen::Vector3d p = 0.5 * (margin[i] + crease[i]);
    c[i] = i % 8 == 0 ? p : on_lid(p, 2.2);
  }
  return c;
}

/// Inner edge of the lid margin, resting on the eyeball (clearance 0.1), or the hidden ring inside it (-1.6).
Curve lid_inside(double widen, double clearance) {
  const Eyeball eye;
  Curve c = lid_margin();
  for (int i = 0; i < eye_count; ++i) {
    Eigen::Vector3d direction = c[i] - eye.centre;
    direction.head<2>() *= widen * (i % 8 == 0 ? 0.88 : 1.0);
    c[i] = eye.centre + (eye.radius + clearance) * direction.normalized();
  }
  return c;
}

Curve orbit() {
  return {{12.2, -2.5, 16.0},  {12.6, 4.5, 16.5},   {16.0, 10.6, 20.0},  {22.5, 14.4, 21.4},
          {31.0, 16.4, 21.6},  {40.0, 16.0, 19.8},  {48.2, 12.4, 15.0},  {53.5, 7.0, 9.2},
          {55.2, 0.3, 5.0},    {53.2, -7.0, 6.2},   {48.2, -12.5, 10.0}, {40.5, -15.6, 13.6},
          {32.0, -16.6, 15.8}, {24.0, -15.8, 16.4}, {17.4, -13.0, 15.8}, {13.4, -8.5, 16.6}};
}

Curve brow() {
  return {{8.3, -3.0, 24.2},   {8.6, 4.5, 23.0},    {12.5, 13.0, 26.4},  {20.5, 20.0, 28.2},
          {31.0, 23.6, 27.4},  {42.0, 23.2, 23.6},  {52.0, 18.6, 15.4},  {58.6, 10.5, 5.6},
          {60.6, 0.5, 0.8},    {58.8, -9.0, 2.6},   {53.0, -17.0, 8.2},  {44.5, -22.0, 13.8},
          {34.5, -23.5, 17.6}, {24.5, -22.5, 20.0}, {13.2, -17.8, 24.2}, {9.2, -10.5, 26.0}};
}

/// Line where the lips meet, seen from the front: contact depth 0 is its front edge; the rest lies behind it.
Curve lip_contact(double depth, double gap) {
  const Curve upper = {{0, -66.9, 36.4},    {4.5, -66.4, 36.1},  {9.2, -66.6, 34.6}, {13.9, -67.0, 32.0},
                       {18.6, -67.5, 28.6}, {22.2, -67.9, 25.4}, {24.1, -68.1, 23.4}};
  Curve c(mouth_count);
  for (int i = 0; i < mouth_count; ++i) {
    const int k = i <= 6 ? i : 12 - i;
    c[i] = upper[k];
    const double across = k / 6.0;
    c[i].x() *= 1.0 - 0.012 * depth;
    c[i].z() -= depth * (1.0 - 0.35 * across);
    if (k < 6) c[i].y() += i < 6 ? 0.5 * gap : -0.5 * gap;
  }
  return c;
}

Curve mouth_cavity() {
  Curve c = lip_contact(7.5, 0.0);
  for (int i = 0; i < mouth_count; ++i) {
    const double open = std::cos(0.5 * M_PI * (i <= 6 ? i : 12 - i) / 6.0);
    c[i].y() += (i <= 6 ? 11.5 : -10.5) * open;
  }
  return c;
}

const Curve vermilion = {{0, -64.4, 39.4},    {4.5, -63.8, 39.3},  {9.2, -64.3, 37.5},  {13.9, -65.3, 34.5},
                         {18.6, -66.4, 30.4}, {22.6, -67.4, 26.2}, {24.7, -68.1, 23.6}, {22.6, -69.0, 25.8},
                         {18.6, -70.2, 30.2}, {13.9, -71.0, 34.5}, {9.2, -71.5, 37.4},  {4.5, -71.9, 39.0},
                         {0, -71.9, 39.3}};
const Curve vermilion_border = {{0, -60.9, 38.5},    {4.5, -59.0, 38.7},  {9.4, -60.2, 36.5},  {14.3, -62.3, 33.3},
                                {19.0, -64.6, 29.4}, {23.1, -66.8, 25.3}, {25.7, -68.1, 23.0}, {23.1, -70.2, 25.0},
                                {18.8, -72.9, 29.0}, {14.1, -75.1, 32.8}, {9.3, -76.4, 35.2},  {4.6, -77.0, 36.4},
                                {0, -77.1, 36.6}};
const Curve lip_skin = {{0, -56.0, 35.9},    {4.4, -55.2, 37.5},  {9.8, -56.0, 35.2},  {15.6, -58.2, 32.2},
                        {21.3, -61.6, 28.2}, {26.1, -65.6, 24.2}, {29.2, -68.9, 21.8}, {25.7, -73.2, 23.4},
                        {20.4, -77.0, 26.0}, {15, -79.6, 28.7},   {9.8, -81.0, 30.6},  {4.8, -81.4, 31.6},
                        {0, -81.5, 31.9}};
const Curve lip_outside = {{0, -51.2, 34.8},    {4.4, -50.6, 36.0},  {9.8, -51.0, 33.8},  {16.9, -52.8, 31.0},
                           {23.9, -57.0, 27.2}, {29.8, -63.2, 23.6}, {32.3, -69.2, 21.0}, {29, -76.4, 22.2},
                           {23.1, -82.0, 24.6}, {16.9, -85.0, 27.2}, {11, -86.4, 29.2},   {5.5, -86.9, 30.2},
                           {0, -87.0, 29.6}};
const Curve mouth_outline = {{0, -46.4, 34.2},    {4.5, -46.2, 33.4},  {9.3, -46.0, 31.6},  {13.6, -46.0, 29.6},
                             {22.0, -49.5, 27.0}, {30.0, -58.5, 24.4}, {35.2, -69.2, 20.4}, {32.6, -79.6, 21.0},
                             {26.6, -87.6, 23.2}, {19.8, -92.8, 26.6}, {13.2, -95.8, 29.8}, {6.6, -97.0, 31.6},
                             {0, -97.2, 33.0}};

}  // namespace

Curve eye_ring(int ring) {
  switch (ring) {
    case 0:
      return lid_inside(1.25, -1.6);
    case 1:
      return lid_inside(1.0, 0.1);
    case 2:
      return lid_margin();
    case 3:
      return lid_middle();
    case 4:
      return lid_crease();
    case 5:
      return orbit();
    default:
      return brow();
  }
}

Curve mouth_ring(int ring) {
  switch (ring) {
    case 0:
      return mouth_cavity();
    case 1:
      return lip_contact(4.2, 0.2);
    case 2:
      return lip_contact(1.5, 0.1);
    case 3:
      return lip_contact(0.0, 0.1);
    case 4:
      return vermilion;
    case 5:
      return vermilion_border;
    case 6:
      return lip_skin;
    case 7:
      return lip_outside;
    default:
      return mouth_outline;
  }
}

Curve nose_row(int row) {
  switch (row) {
    case 0:
      return {{0, 17.5, 32.6}, {6.5, 17.5, 31.6}};
    case 1:
      return {{0, 10.0, 30.4}, {4.8, 10.0, 29.2}};
    case 2:
      return {{0, 3.5, 28.0}, {4.0, 3.5, 26.6}};
    case 3:
      return {{0, -4.5, 30.2}, {3.7, -4.5, 28.8}};
    case 4:
      return {{0, -13.0, 35.0}, {3.9, -13.0, 33.4}};
    case 5:
      return {{0, -22.0, 40.8}, {4.3, -22.0, 39.4}, {8.3, -21.0, 32.8}};
    case 6:
      return {{0, -29.8, 46.2}, {5.2, -29.6, 44.4}, {9.6, -29.2, 37.0}, {12.6, -30.2, 29.4}, {16.2, -27.5, 23.6}};
    case 7:
      return {{0, -36.8, 51.4}, {6.6, -36.4, 49.2}, {10.4, -35.6, 40.6}, {16.8, -36.4, 35.4}, {18.0, -36.8, 24.8}};
    default:
      return {{0, -43.0, 48.4}, {4.7, -42.9, 46.8}, {10.0, -40.9, 41.6}, {16.4, -43.2, 35.0}, {17.4, -44.2, 26.4}};
  }
}

Curve nostril() {
  return {{4.2, -43.2, 44.4},  {3.2, -45.2, 40.4},  {4.2, -46.0, 36.0}, {8.6, -45.8, 32.8},
          {12.4, -45.2, 33.6}, {12.8, -43.6, 37.4}, {8.8, -41.8, 42.0}};
}

Eigen::Vector3d columella() { return {0, -45.6, 41.8}; }

Curve cheek_strip() {
  return {{24.5, -29.5, 23.2},  {26.5, -37.0, 24.6},  {29.2, -45.0, 24.8}, {34.2, -54.0, 22.6},
          {39.0, -64.5, 18.2},  {39.6, -75.6, 15.2},  {36.0, -86.0, 16.4}, {29.4, -95.0, 19.6},
          {21.8, -100.8, 23.6}, {14.6, -103.8, 27.0}, {7.4, -105.3, 29.4}, {0, -105.7, 30.2}};
}

Curve face_ring(int ring) {
  if (ring == 0)
    return {{0, 31, 33.6},       {9, 31, 33.2},      {17, 31, 31.8},     {25, 31.5, 29.8},   {35.5, 33, 26},
            {46.5, 31, 18.2},    {56, 25.5, 7.2},    {61.8, 15.5, -3.8}, {63.8, 5.5, -7.8},  {63.8, -5, -7},
            {61.5, -14, -4},     {57.5, -21.5, 1.8}, {52.5, -27.5, 8.2}, {47.5, -32.5, 13},  {45, -38.5, 14.4},
            {44.5, -44.5, 13.8}, {44.8, -51, 12},    {45.4, -59, 8.6},   {46, -68, 4.6},     {45.2, -77, 3.6},
            {41.2, -85.6, 6},    {35, -94.8, 10.5},  {27, -102, 16},     {18.6, -106.4, 21}, {9.6, -108.8, 24.8},
            {0, -109.6, 25.4}};
  if (ring == 1)
    return {{0, 45, 34},         {9.5, 45, 33.5},  {20, 44.5, 31.5},    {31, 43, 27.5},       {42, 40.5, 20.5},
            {51, 36.5, 10},      {57.5, 31.5, -2}, {62, 23, -11},       {65, 12, -17},        {67, 1, -20},
            {67.5, -9, -21},     {66.2, -18, -20}, {63.5, -26, -17.5},  {60.5, -34, -15},     {58.5, -41, -14.5},
            {57, -48, -14.5},    {55.5, -55, -15}, {54, -62, -16},      {52.2, -69.5, -16},   {49.8, -77.5, -13.5},
            {45.4, -85.6, -6.5}, {39, -94.4, 1},   {30.8, -102.4, 8.5}, {21.4, -107.6, 14.6}, {11.2, -110.4, 19},
            {0, -111.2, 20.4}};
  return {{0, 76, 19},          {9.5, 76, 18.3},    {20, 75, 15.5},     {30.5, 72.5, 10.5},   {41.5, 68, 2.5},
          {51, 61, -7},         {58.5, 52, -17},    {63.5, 40.5, -26},  {66.8, 28.5, -35},    {69, 17, -45},
          {70.5, 6, -54},       {71.5, -4, -61},    {71.5, -14, -64},   {71, -24, -64.5},     {70, -35, -63.5},
          {68.3, -43.5, -62.5}, {65.8, -52, -61},   {62.4, -60.5, -59}, {58.4, -69.5, -55.5}, {53.8, -78, -49.5},
          {49.0, -86, -38.5},   {42.6, -93.4, -25}, {34, -101, -11},    {24.5, -107, -1},     {13, -111, 4},
          {0, -112.4, 6}};
}

Curve throat_row(int row) {
  static const std::vector<std::pair<double, Eigen::Vector3d>> keys[] = {
      {{0, {51, -87.5, -58}}, {3, {28.5, -103, -24}}, {6, {0, -114.5, -8.5}}},
      {{0, {51, -101.5, -63}}, {3, {29, -114.5, -33}}, {6, {0, -121.5, -20.5}}},
      {{0, {51.5, -122, -67}}, {3, {30.5, -132, -39}}, {6, {0, -136, -22.5}}},
      {{0, {53, -144, -72}}, {3, {31, -151, -43}}, {6, {0, -154, -29}}},
      {{0, {56, -166, -77}}, {3, {32.5, -170, -49}}, {6, {0, -172, -36}}}};
  // The sternomastoid crosses the rows from below the ear to the pit of the neck, with a hollow in front of it.
  static const double muscle[] = {-0.8, 0.2, 1.5, 2.8, 4.0};
  Curve c = through(keys[row], 7);
  for (int i = 0; i < 6; ++i) {
    const double d = i - muscle[row];
    const double swell = 2.4 * std::exp(-d * d) - 1.6 * std::exp(-(d - 1.7) * (d - 1.7));
    c[i] += swell * Eigen::Vector3d(c[i].x(), 0.0, c[i].z() + 82.0).normalized();
  }
  return c;
}

Curve side_column(int column) {
  switch (column) {
    case 1:
      return through({{0, {0, 93, 4}},
                      {2, {21, 91, 0}},
                      {4, {43, 81, -11}},
                      {6, {60, 61, -29}},
                      {8, {69.5, 36, -48}},
                      {10, {73, 14, -70}},
                      {14, {70, -41, -73}},
                      {16, {65.4, -57, -74}},
                      {19, {56.5, -84, -74}},
                      {24, {58, -164, -90}}},
                     25);
    case 2:
      return through({{0, {0, 106, -16}},
                      {2, {23, 103, -20}},
                      {4, {46, 90, -31}},
                      {6, {63, 70, -47}},
                      {8, {72, 42, -66}},
                      {10, {74.4, 11, -87}},
                      {12, {73, -12, -93}},
                      {14, {69.5, -36, -86}},
                      {16, {65, -55, -86}},
                      {19, {56.5, -85, -88}},
                      {24, {57.5, -161, -101}}},
                     25);
    case 3:
      return through({{0, {0, 113, -36}},
                      {1.5, {30, 106, -42}},
                      {3, {57, 83, -56}},
                      {4.5, {72, 52, -75}},
                      {6, {75.5, 18, -95}},
                      {7.5, {71, -14, -102}},
                      {9, {64, -47, -100}},
                      {11.5, {55, -98, -101}},
                      {14, {55.5, -158, -111}}},
                     15);
    case 4:
      return through({{0, {0, 116, -58}},
                      {1.5, {32, 109, -64}},
                      {3, {60, 84, -76}},
                      {4.5, {74, 50, -93}},
                      {6, {73, 14, -111}},
                      {7.5, {66, -16, -115}},
                      {9, {57, -47, -111}},
                      {11.5, {51.5, -98, -110}},
                      {14, {52, -156, -120}}},
                     15);
    case 5:
      return through({{0, {0, 115, -81}},
                      {1.5, {31, 108, -86}},
                      {3, {57, 81, -97}},
                      {4.5, {68.5, 46, -111}},
                      {6, {66, 11, -124}},
                      {7.5, {57.5, -18, -126}},
                      {9, {48, -47.5, -119}},
                      {11.5, {44, -98, -117}},
                      {14, {45, -154, -128}}},
                     15);
    case 6:
      return through({{0, {0, 109.5, -103}},
                      {1.5, {27, 103, -107}},
                      {3, {49, 76, -118}},
                      {4.5, {58, 42, -130}},
                      {6, {54, 8, -137}},
                      {7.5, {45.5, -20, -135}},
                      {9, {37, -48, -125}},
                      {11.5, {33.5, -98, -122}},
                      {14, {34, -152, -134}}},
                     15);
    case 7:
      return through({{0, {0, 99.5, -123}},
                      {1.5, {18, 92.5, -127.5}},
                      {3, {30.5, 68, -138}},
                      {4.5, {33.5, 37, -147}},
                      {6, {30, 6, -149}},
                      {7.5, {25, -21, -142}},
                      {9, {20, -49, -129.5}},
                      {11.5, {18, -98, -124.5}},
                      {14, {18, -150.5, -138}}},
                     15);
    default:
      return through({{0, {0, 86, -139}},
                      {1.5, {0, 77, -145.5}},
                      {3, {0, 58, -153.5}},
                      {4.5, {0, 32, -157.5}},
                      {6, {0, 4, -153}},
                      {7.5, {0, -22, -144}},
                      {9, {0, -49, -131}},
                      {11.5, {0, -98, -125.5}},
                      {14, {0, -150, -140}}},
                     15);
  }
}

Curve ear_ring(int ring) {
  // Outline in the ear's own plane: u towards the back, v up, from the tragus; w out of that plane.
  static const std::array<Eigen::Vector2d, 12> outline = {{{0, 20},
                                                           {-1, 10},
                                                           {-0.5, -1},
                                                           {0, -12},
                                                           {2, -24},
                                                           {9, -29.5},
                                                           {17, -21},
                                                           {24.5, -9},
                                                           {30, 4},
                                                           {32, 18},
                                                           {26, 30},
                                                           {12, 34}}};
  static const Eigen::Vector2d middle(13, 3), concha(7.5, -3);
  static const double scale[] = {0, 0.90, 1.0, 0.84, 0.70, 0.54, 0.30, 0.0};
  static const double helix[] = {0, -4.0, -0.5, 2.0, -1.0, 1.5, -5.5, -7.0};
  static const double cheek[] = {0, 0.2, 0.6, 0.2, -2.0, -4.0, -6.0, -7.0};
  static const double tragus_lobe[] = {0, 0.2, 2.0, 2.6, 0.6, -3.0, -6.0, -7.0};
  static const double lobe[] = {0, -2.5, -0.5, 1.2, 1.4, 0.6, -4.5, -7.0};
  const Eigen::Vector3d tragus(72.0, -15.0, -66.0), up(0.0, 0.985, -0.17), out_of_head(0.5, -0.147, -0.853);
  const Eigen::Vector3d normal = -up.cross(out_of_head).normalized();
  const Eigen::Vector3d backwards = out_of_head.normalized();
  Curve c(ring == 7 ? 1 : 12);
  for (int i = 0; i < static_cast<int>(c.size()); ++i) {
    const Eigen::Vector2d centre = ring >= 5 ? concha : middle;
    // In front the skin runs up to the ear without the fold there is behind it.
    const double size = ring == 1 && i >= 1 && i <= 3 ? 1.12 : scale[ring];
    const Eigen::Vector2d p = ring == 7 ? concha : Eigen::Vector2d(centre + size * (outline[i] - centre));
    const double* w = i == 2 ? tragus_lobe : i == 1 || i == 3 ? cheek : i == 4 || i == 5 ? lobe : helix;
    c[i] = tragus + p.y() * up + p.x() * backwards + w[ring] * normal;
  }
  return c;
}

Curve tooth_row(bool upper, int row) {
  const double gum = upper ? -56.5 : -77.5, edge = upper ? -66.4 : -67.6;
  Curve c(7);
  for (int i = 0; i < 7; ++i) {
    const double x = 3.6 * i, inset = row >= 2 ? 0.78 : 1.0;
    c[i] = {x * inset, row == 0 || row == 3 ? gum : edge,
            26.6 - 0.030 * x * x - (row >= 2 ? 4.0 : 0.0) - (upper ? 0 : 2.0)};
  }
  return c;
}

}  // namespace vultus::registration::shape
