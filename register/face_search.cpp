#include "register/face_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/neighbours.h"

namespace vultus::registration {
namespace {

constexpr double surely_a_face = 0.6, hardly_a_face = 0.25;  // scores of the finder seen close; heads reach 1 to 3

struct Candidate {
  FacePlace place;
  double score;
  std::string how;
};
using Candidates = std::vector<Candidate>;

// Centre and share of the diagonal of where points are, whatever a few stray ones add to their box.
PictureTarget middle_of(const Points& positions, double share_of_diagonal) {
  Eigen::Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values(positions.rows());
    for (Eigen::Index i = 0; i < positions.rows(); ++i) values[i] = positions(i, axis);
    const std::size_t tail = values.size() / 200;
    std::nth_element(values.begin(), values.begin() + tail, values.end());
    low[axis] = values[tail];
    std::nth_element(values.begin(), values.end() - 1 - tail, values.end());
    high[axis] = values[values.size() - 1 - tail];
  }
  return {0.5 * (low + high), share_of_diagonal * (high - low).norm()};
}

Eigen::Vector3d median_of(const Points& positions) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values(positions.rows());
    for (Eigen::Index i = 0; i < positions.rows(); ++i) values[i] = positions(i, axis);
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    middle[axis] = values[values.size() / 2];
  }
  return middle;
}

// The pieces of a scan that could be heads of their own; one entry for a scan in one piece.
std::vector<Points> large_pieces(const Mesh& scan) {
  const std::vector<int> piece = components(*scan.topology);
  std::vector<std::vector<int>> vertices(1 + *std::max_element(piece.begin(), piece.end()));
  for (int v = 0; v < static_cast<int>(piece.size()); ++v) vertices[piece[v]].push_back(v);
  std::vector<Points> pieces;
  for (const std::vector<int>& rows : vertices)
    if (5 * rows.size() > piece.size()) pieces.push_back(scan.positions(rows, Eigen::all));
  if (pieces.empty()) pieces.push_back(scan.positions);
  return pieces;
}

// Share of the surface that faces a camera far along `direction`: about half of a closed head from anywhere, next to
// nothing of an open shell from behind.
class FacingShare {
 public:
  explicit FacingShare(const Mesh& scan) {
    const Triangles& triangles = scan.topology->triangles();
    const Eigen::Index step = std::max<Eigen::Index>(1, triangles.rows() / 4000);
    for (Eigen::Index t = 0; t < triangles.rows(); t += step) {
      const Eigen::Vector3d a = scan.positions.row(triangles(t, 0)), b = scan.positions.row(triangles(t, 1)),
                            c = scan.positions.row(triangles(t, 2));
      areas_.push_back((b - a).cross(c - a));
    }
  }
  double towards(const Eigen::Vector3d& direction) const {
    double facing = 0.0, all = 0.0;
    for (const Eigen::Vector3d& area : areas_) {
      const double projected = area.dot(direction);
      facing += std::max(0.0, projected);
      all += std::abs(projected);
    }
    return all > 0.0 ? facing / all : 0.0;
  }

 private:
  std::vector<Eigen::Vector3d> areas_;
};

std::vector<FaceFrame> upright_frames() {
  std::vector<FaceFrame> frames;
  for (double pitch : {0.0, -20.0, 20.0})
    for (double yaw : {0.0, -25.0, 25.0}) frames.push_back(turned(FaceFrame::Identity(), yaw, pitch, 0.0));
  return frames;
}

// Along the axes, edges and corners of a cube (1, 2, 3 ones), the usual front first. All together no two neighbours are
// more than 45 degrees apart; the finder bears some 30.
std::vector<Eigen::Vector3d> fronts_all_around(std::initializer_list<int> ones) {
  std::vector<Eigen::Vector3d> fronts;
  for (int wanted : ones)
    for (int z : {1, 0, -1})
      for (int y : {0, 1, -1})
        for (int x : {0, 1, -1})
          if (std::abs(x) + std::abs(y) + std::abs(z) == wanted)
            fronts.push_back(Eigen::Vector3d(x, y, z).normalized());
  return fronts;
}

FaceFrame frame_towards(const Eigen::Vector3d& front) {
  Eigen::Vector3d up = std::abs(front.y()) < 0.9 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  up = (up - front * front.dot(up)).normalized();
  FaceFrame frame;
  frame << up.cross(front), up, front;
  return frame;
}

std::vector<FaceFrame> frames_all_around(const FacingShare& facing, std::initializer_list<int> ones,
                                         std::initializer_list<double> rolls) {
  std::vector<FaceFrame> frames;
  for (const Eigen::Vector3d& front : fronts_all_around(ones)) {
    if (facing.towards(front) < 0.3) continue;
    for (double roll : rolls) frames.push_back(turned(frame_towards(front), 0, 0, roll));
  }
  return frames;
}

// A face seen in hair or on the inside of a shell has eyes and mouth where no face has them.
bool plausible(const FacePlace& place, const FaceView& view, const FaceFrame& seen_from) {
  if (place.frame.col(2).dot(seen_from.col(2)) < 0.4) return false;
  double deepest = 0.0;
  for (const auto& point : view.points)
    if (point) deepest = std::max(deepest, std::abs((*point - place.target.centre).dot(place.frame.col(2))));
  return deepest < 2.5 * place.eye_distance;
}

Candidates candidates_from(const ScanPictures& pictures, const FaceFinder& finder, const std::vector<FaceFrame>& frames,
                           const std::vector<PictureTarget>& targets, int pixels, const std::string& how) {
  std::vector<Shot> shots;
  for (const PictureTarget& target : targets)
    for (const FaceFrame& frame : frames) shots.push_back({frame, target, light_from_above});
  const auto views = look(pictures, finder, shots, pixels, -0.1, 3);
  Candidates found;
  for (std::size_t i = 0; i < shots.size(); ++i)
    for (const FaceView& view : views[i]) {
      const auto place = place_of(view);
      if (place && place->target.radius > 0.05 * shots[i].target.radius && plausible(*place, view, shots[i].frame))
        found.push_back({*place, view.face.score, how});
    }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  return found;
}

bool same_face(const FacePlace& a, const FacePlace& b) {
  return (a.target.centre - b.target.centre).norm() < 0.8 * std::max(a.eye_distance, b.eye_distance);
}

// Close pictures straight on settle axes and size; their score tells faces from chance.
std::optional<Candidate> looked_at_closely(const ScanPictures& pictures, const FaceFinder& finder,
                                           Candidate candidate) {
  const int pixels = 300;
  for (int round = 0; round < 2; ++round) {
    const auto views = look(pictures, finder,
                            {{candidate.place.frame, candidate.place.target, light_from_above},
                             {candidate.place.frame, candidate.place.target, light_from_front}},
                            pixels, -0.3);
    double score = 0.0;
    const FaceView* better = nullptr;
    for (const auto& view : views)
      if (!view.empty()) {
        score += 0.5 * view.front().face.score;
        if (!better) better = &view.front();
      }
    if (!better) return {};
    const auto place = place_of(*better);
    if (place && !same_face(*place, candidate.place)) return {};
    if (place) candidate.place = *place;
    candidate.score = score;
  }
  return candidate;
}

// The best candidate that a close look confirms; the first sure one ends the search.
std::optional<Candidate> confirmed(const ScanPictures& pictures, const FaceFinder& finder,
                                   const Candidates& candidates) {
  const int most_looks = 8;
  std::optional<Candidate> best;
  Candidates tried;
  for (const Candidate& candidate : candidates) {
    if (static_cast<int>(tried.size()) == most_looks) break;
    const bool seen = std::any_of(tried.begin(), tried.end(), [&](const Candidate& other) {
      return same_face(other.place, candidate.place) &&
             other.place.frame.col(1).dot(candidate.place.frame.col(1)) > 0.8;
    });
    if (seen) continue;
    tried.push_back(candidate);
    const auto close = looked_at_closely(pictures, finder, candidate);
    if (close && (!best || close->score > best->score)) best = close;
    if (best && best->score > surely_a_face) break;
  }
  return best;
}

std::optional<Candidate> search_everywhere(const ScanPictures& pictures, const FaceFinder& finder) {
  std::vector<PictureTarget> whole, near;
  for (const Points& piece : large_pieces(pictures.scan())) {
    whole.push_back(middle_of(piece, 0.55));
    near.push_back(middle_of(piece, 0.36));
  }
  const FacingShare facing(pictures.scan());
  std::optional<Candidate> best;
  const auto sure_after = [&](const std::vector<FaceFrame>& frames, const std::vector<PictureTarget>& targets,
                              int pixels, const char* how) {
    const auto found = confirmed(pictures, finder, candidates_from(pictures, finder, frames, targets, pixels, how));
    if (found && (!best || found->score > best->score)) best = found;
    return best && best->score > surely_a_face;
  };
  const auto quarter_turns = {0.0, 180.0, 90.0, 270.0}, between = {45.0, 315.0, 135.0, 225.0};
  const auto all_turns = {0.0, 180.0, 90.0, 270.0, 45.0, 315.0, 135.0, 225.0};
  // Most scans look along +z, more or less: one picture of each piece is enough then.
  if (sure_after({FaceFrame::Identity()}, whole, 320, "upright, looking along +z")) return best;
  if (sure_after(upright_frames(), whole, 320, "upright, looking along +z")) return best;
  if (sure_after(frames_all_around(facing, {1}, quarter_turns), near, 200, "along the scan's axes")) return best;
  if (sure_after(frames_all_around(facing, {2, 3}, all_turns), near, 200, "turned freely")) return best;
  if (sure_after(frames_all_around(facing, {1}, between), near, 200, "turned freely")) return best;
  sure_after(frames_all_around(facing, {1, 3}, all_turns), whole, 280, "far from the middle of the scan");
  return best;
}

// Vertices beyond the head that the face belongs to; few of them for a head alone, more for a bust.
Points beyond_head(const Points& positions, const FacePlace& face) {
  const Eigen::Vector3d middle = face.target.centre - 1.2 * face.eye_distance * face.frame.col(2);
  std::vector<int> rows;
  for (int v = 0; v < positions.rows(); ++v)
    if ((positions.row(v).transpose() - middle).norm() > 2.6 * face.eye_distance) rows.push_back(v);
  return positions(rows, Eigen::all);
}

std::vector<FacePlace> other_faces(const ScanPictures& pictures, const FaceFinder& finder, const FacePlace& face) {
  const Points rest = beyond_head(pictures.scan().positions, face);
  if (rest.rows() < pictures.scan().positions.rows() / 8) return {};
  std::vector<FaceFrame> frames;
  for (double roll : {0.0, 180.0, 90.0, 270.0})
    for (double yaw : {0.0, -50.0, 50.0, 180.0}) frames.push_back(turned(face.frame, yaw, 0.0, roll));
  // Most of what lies beyond is the other head, if there is one: its middle is the median, its size the first one's.
  const PictureTarget like_this{median_of(rest), 3.0 * face.eye_distance};
  const Candidates seen = candidates_from(pictures, finder, frames, {like_this, middle_of(rest, 0.55)}, 280, "");
  std::vector<FacePlace> others;
  for (const Candidate& candidate : seen) {
    const double size = candidate.place.eye_distance / face.eye_distance;
    const double apart = (candidate.place.target.centre - face.target.centre).norm();
    if (size < 0.5 || size > 2.0 || apart < 2.0 * face.eye_distance) continue;
    if (std::any_of(others.begin(), others.end(), [&](const auto& o) { return same_face(o, candidate.place); }))
      continue;
    const auto close = looked_at_closely(pictures, finder, candidate);
    if (close && close->score > surely_a_face) others.push_back(close->place);
  }
  return others;
}

}  // namespace

FaceSearch search_face(const ScanPictures& pictures, const FaceFinder& finder) {
  const auto found = search_everywhere(pictures, finder);
  if (!found || found->score < hardly_a_face)
    throw InputError(
        "no face found in the scan from any side; place landmarks by hand (landmarks/<pose>.json) or check that the "
        "scan shows a face");
  return {found->place, found->score, found->how, other_faces(pictures, finder, found->place)};
}

}  // namespace vultus::registration
