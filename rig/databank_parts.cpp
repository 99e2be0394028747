#include "rig/databank_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "rig/feature_points.h"
#include "rig/geodesic.h"

namespace vultus::rig {
namespace {

/// One part of the model: its vertices and where its unit texture tile goes.
struct Part {
  const char* name;
  int begin, end;  // vertices [begin, end)
  double u, v, size;
};

// Eyeballs are two tiles each, the sclera before the iris.
constexpr std::array<Part, 19> kParts = {{
    {"face", 0, 9409, 0.0, 0.0, 0.75},
    {"head_neck", 9409, 11248, 0.75, 0.0, 0.25},
    {"mouth_cavity", 11248, 13294, 0.75, 0.0, 0.25},
    {"eye_socket_left", 13294, 13678, 0.75, 0.0, 0.25},
    {"eye_socket_right", 13678, 14062, 0.75, 0.0, 0.25},
    {"gums_tongue", 14062, 17039, 0.75, 0.25, 0.25},
    {"teeth", 17039, 21451, 0.75, 0.5, 0.25},
    {"sclera_left", 21451, 22221, 0.0, 0.75, 0.125},
    {"iris_left", 22221, 23021, 0.125, 0.75, 0.125},
    {"sclera_right", 23021, 23791, 0.25, 0.75, 0.125},
    {"iris_right", 23791, 24591, 0.375, 0.75, 0.125},
    {"lacrimal_left", 24591, 24795, 0.5, 0.75, 0.125},
    {"lacrimal_right", 24795, 24999, 0.625, 0.75, 0.125},
    {"eye_blend_left", 24999, 25023, 0.75, 0.75, 0.125},
    {"eye_blend_right", 25023, 25047, 0.875, 0.75, 0.125},
    {"eye_occlusion_left", 25047, 25199, 0.0, 0.875, 0.125},
    {"eye_occlusion_right", 25199, 25351, 0.125, 0.875, 0.125},
    {"eyelashes_left", 25351, 26035, 0.25, 0.875, 0.125},
    {"eyelashes_right", 26035, 26719, 0.375, 0.875, 0.125},
}};
constexpr int kNarrowFaceEnd = 6706, kLowerTeethBegin = 19247;

// A polygon at the border of two parts is counted with the later one, whose tile its corners use: the model's polygons
// follow the same order as its vertices, and a later part borrows the border vertices of an earlier one.
const Part& part_of_face(const TopologyData& data, int face) {
  int highest = 0;
  for (int c = data.face_offsets[face]; c < data.face_offsets[face + 1]; ++c)
    highest = std::max(highest, data.corner_vertex[c]);
  return *std::find_if(kParts.begin(), kParts.end(), [&](const Part& part) { return highest < part.end; });
}

std::vector<int> range(int begin, int end) {
  std::vector<int> vertices(static_cast<std::size_t>(end - begin));
  std::iota(vertices.begin(), vertices.end(), begin);
  return vertices;
}

std::vector<int> joined(const VertexSets& sets, const std::vector<std::string>& names) {
  std::vector<int> all;
  for (const std::string& name : names) all.insert(all.end(), sets.at(name).begin(), sets.at(name).end());
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<int> landmark_range(const registration::Ibug68& ibug68, int begin, int end) {
  return {ibug68.begin() + begin, ibug68.begin() + end};
}

struct FaceGraph {
  Adjacency adjacency;
  const Points& positions;
  std::vector<bool> face;
};

void add_lips(VertexSets& sets, const FaceGraph& graph, const registration::Ibug68& ibug68) {
  const std::vector<int> outer =
      closed_contour(graph.adjacency, graph.positions, landmark_range(ibug68, 48, 60), graph.face);
  sets["lips"] = inside_contour(graph.adjacency, outer, landmark_range(ibug68, 60, 68), graph.face);
  std::vector<bool> lips(graph.face.size(), false);
  for (int v : sets["lips"]) lips[v] = true;
  const std::array<int, 7> upper = {49, 50, 51, 52, 53, 61, 63}, lower = {55, 56, 57, 58, 59, 65, 67};
  std::vector<int> sources;
  for (int i : upper) sources.push_back(ibug68[i]);
  for (int i : lower) sources.push_back(ibug68[i]);
  const EdgeDistances nearest = edge_distances(graph.adjacency, graph.positions, sources, lips);
  for (int v : sets["lips"])
    if (nearest.source[v] >= 0) sets[nearest.source[v] < 7 ? "upper_lip" : "lower_lip"].push_back(v);
}

/// The skin within a fifth of the eye's width of its opening.
void add_lids(VertexSets& sets, const FaceGraph& graph, const registration::Ibug68& ibug68, int first,
              const std::string& name) {
  const std::vector<int> margin =
      closed_contour(graph.adjacency, graph.positions, landmark_range(ibug68, first, first + 6), graph.face);
  const double width = (graph.positions.row(ibug68[first]) - graph.positions.row(ibug68[first + 3])).norm();
  const EdgeDistances distances = edge_distances(graph.adjacency, graph.positions, margin, graph.face);
  for (int v = 0; v < static_cast<int>(graph.face.size()); ++v)
    if (distances.distance[v] <= 0.2 * width) sets[name].push_back(v);
}

}  // namespace

VertexSets ict_vertex_sets(const Topology& topology, const Points& positions, const registration::Ibug68& ibug68,
                           std::vector<int> rigid) {
  VertexSets sets;
  for (const Part& part : kParts) sets[part.name] = range(part.begin, part.end);
  sets["face_narrow"] = range(0, kNarrowFaceEnd);
  sets["teeth_upper"] = range(sets["teeth"].front(), kLowerTeethBegin);
  sets["teeth_lower"] = range(kLowerTeethBegin, sets["teeth"].back() + 1);
  sets["skin"] = joined(sets, {"face", "head_neck"});
  sets["eyeball_left"] = joined(sets, {"sclera_left", "iris_left"});
  sets["eyeball_right"] = joined(sets, {"sclera_right", "iris_right"});
  sets["eyeballs"] = joined(sets, {"eyeball_left", "eyeball_right"});
  sets["hidden"] = joined(sets, {"mouth_cavity", "eye_socket_left", "eye_socket_right", "gums_tongue", "teeth",
                                 "lacrimal_left", "lacrimal_right", "eye_blend_left", "eye_blend_right",
                                 "eye_occlusion_left", "eye_occlusion_right", "eyelashes_left", "eyelashes_right"});
  std::sort(rigid.begin(), rigid.end());
  sets["rigid"] = std::move(rigid);

  FaceGraph graph{adjacency(topology), positions, std::vector<bool>(ict_vertex_count, false)};
  for (int v : sets["face"]) graph.face[v] = true;
  add_lips(sets, graph, ibug68);
  add_lids(sets, graph, ibug68, 36, "lids_right");
  add_lids(sets, graph, ibug68, 42, "lids_left");
  sets["lids"] = joined(sets, {"lids_left", "lids_right"});
  return sets;
}

void lay_out_ict_uvs(TopologyData& data) {
  // A row of the UV table may serve corners in two tiles, so that each corner gets a row of its own per part.
  std::map<std::pair<int, const Part*>, int> row_of;
  std::vector<Eigen::RowVector2d> rows;
  for (int f = 0; f + 1 < static_cast<int>(data.face_offsets.size()); ++f) {
    const Part& part = part_of_face(data, f);
    Eigen::RowVector2d middle = Eigen::RowVector2d::Zero();
    for (int c = data.face_offsets[f]; c < data.face_offsets[f + 1]; ++c) middle += data.uvs.row(data.corner_uv[c]);
    middle /= data.face_offsets[f + 1] - data.face_offsets[f];
    const Eigen::RowVector2d tile(std::floor(middle.x()), std::floor(middle.y()));
    for (int c = data.face_offsets[f]; c < data.face_offsets[f + 1]; ++c) {
      const auto [entry, added] = row_of.try_emplace({data.corner_uv[c], &part}, static_cast<int>(rows.size()));
      if (added)
        rows.push_back(Eigen::RowVector2d(part.u, part.v) + part.size * (data.uvs.row(data.corner_uv[c]) - tile));
      data.corner_uv[c] = entry->second;
    }
  }
  data.uvs.resize(static_cast<Eigen::Index>(rows.size()), 2);
  for (std::size_t r = 0; r < rows.size(); ++r) data.uvs.row(static_cast<Eigen::Index>(r)) = rows[r];
}

std::vector<registration::Landmark> mpeg4_landmarks(const registration::Ibug68& ibug68) {
  std::vector<registration::Landmark> landmarks;
  for (const auto& [point, name] : mpeg4_names())
    if (ibug68[point] >= 0) landmarks.push_back({name, ibug68[point], false});
  return landmarks;
}

std::vector<std::string> ict_pose_tags(const std::string& pose) {
  static const std::map<std::string, const char*> units = {
      {"browInnerUp", "AU1"},      {"browOuterUp", "AU2"},     {"browDown", "AU4"},         {"eyeWide", "AU5"},
      {"cheekSquint", "AU6"},      {"cheekRaiser", "AU6"},     {"eyeSquint", "AU7"},        {"noseSneer", "AU9"},
      {"mouthShrugUpper", "AU10"}, {"mouthUpperUp", "AU11"},   {"mouthSmile", "AU12"},      {"mouthDimple", "AU14"},
      {"mouthFrown", "AU15"},      {"mouthLowerDown", "AU16"}, {"mouthShrugLower", "AU17"}, {"mouthPucker", "AU18"},
      {"mouthStretch", "AU20"},    {"mouthFunnel", "AU22"},    {"mouthPress", "AU24"},      {"jawOpen", "AU27"},
      {"mouthRollLower", "AU28"},  {"mouthRollUpper", "AU28"}, {"jawForward", "AU29"},      {"jawLeft", "AU30"},
      {"jawRight", "AU30"},        {"cheekPuff", "AU33"},      {"eyeBlink", "AU45"},        {"eyeLookUp", "AU63"},
      {"eyeLookDown", "AU64"}};
  std::string base = pose, side;
  if (pose.ends_with("_L") || pose.ends_with("_R")) {
    base = pose.substr(0, pose.size() - 2);
    side = pose.back() == 'L' ? "Left" : "Right";
  }
  // ARKit has one shape for both sides of these two.
  const bool both_sides = base == "browInnerUp" || base == "cheekPuff";
  std::vector<std::string> tags = {base + (both_sides ? "" : side)};
  if (const auto found = units.find(base); found != units.end())
    tags.push_back(found->second + (side.empty() ? std::string() : std::string(1, side[0])));
  return tags;
}

}  // namespace vultus::rig
