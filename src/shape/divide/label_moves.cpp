#include "shape/divide/label_moves.h"

#include <algorithm>
#include <array>
#include <deque>
#include <tuple>
#include <utility>

#include "shape/divide/boundary_surface.h"
#include "shape/divide/contacts.h"

namespace packmerger {
namespace {

double longest_edge_mm(const TetMesh& mesh, int tetrahedron) {
  const std::array<int, 4>& corners = mesh.tetrahedra[tetrahedron];
  double longest = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j)
      longest = std::max(longest, (mesh.points[corners[i]] - mesh.points[corners[j]]).norm());
  return longest;
}

struct Move {
  int change = 0;  // of defects
  double volume_mm3 = 0;
  int tetrahedron = -1;
  int to = -1;
  bool operator<(const Move& other) const {
    return std::tie(change, volume_mm3, tetrahedron, to) <
           std::tie(other.change, other.volume_mm3, other.tetrahedron, other.to);
  }
};

// The move of one tetrahedron around the point that removes most defects; the smallest such one.
Move best_move(const TetMesh& mesh, LabelMoves& moves, int point, double reach_mm) {
  Move best;
  for (const int t : moves.star(point)) {
    if (longest_edge_mm(mesh, t) > reach_mm) continue;
    for (int face = 0; face < 4; ++face) {
      const int across = mesh.neighbours[t][face];
      if (across < 0 || moves.label(across) == moves.label(t)) continue;
      const Move move{moves.change_of_defects(t, moves.label(across)), mesh.volume_mm3(t), t,
                      moves.label(across)};
      if (move.change < 0 && move < best && moves.can_leave(t)) best = move;
    }
  }
  return best;
}

// What straighten_cuts makes smaller, as far as it depends on one tetrahedron.
class CutLength {
 public:
  CutLength(const TetMesh& mesh) : mesh_(mesh), surface_(boundary_surface(mesh)) {
    face_of_.assign(mesh.tetrahedra.size(), {-1, -1, -1, -1});
    for (int i = 0; i < static_cast<int>(surface_.faces.size()); ++i)
      face_of_[surface_.faces[i].tetrahedron][surface_.faces[i].face] = i;
    double sum = 0;
    for (const auto& face : surface_.faces)
      for (int i = 0; i < 3; ++i) sum += edge_mm(face, i);
    weight_mm_ =
        surface_.faces.empty() ? 0 : sum / (3 * static_cast<double>(surface_.faces.size()));
  }

  // mm²
  double of(const LabelMoves& moves, int tetrahedron, int label) const {
    double sum = 0;
    for (int f = 0; f < 4; ++f) {
      const int across = mesh_.neighbours[tetrahedron][f];
      if (across >= 0) {
        if (moves.label(across) != label) sum += face_area_mm2(mesh_, tetrahedron, f);
        continue;
      }
      const BoundarySurface::Face& face = surface_.faces[face_of_[tetrahedron][f]];
      for (int i = 0; i < 3; ++i) {
        const int beside = surface_.faces[face.across[i]].tetrahedron;
        if (beside != tetrahedron && moves.label(beside) != label)
          sum += weight_mm_ * edge_mm(face, i);
      }
    }
    return sum;
  }

 private:
  double edge_mm(const BoundarySurface::Face& face, int i) const {
    return (mesh_.points[face.corners[i]] - mesh_.points[face.corners[(i + 1) % 3]]).norm();
  }

  const TetMesh& mesh_;
  BoundarySurface surface_;
  std::vector<std::array<int, 4>> face_of_;
  double weight_mm_ = 0;  // one mm of cut curve counts as much as this area
};

}  // namespace

LabelMoves::LabelMoves(const TetMesh& mesh, std::vector<int>& labels, int label_count)
    : mesh_(mesh), labels_(labels), sizes_(label_count, 0), stars_(mesh), mark_(labels.size(), 0) {
  for (const int label : labels_) ++sizes_[label];
}

int LabelMoves::defects_at_corners(int tetrahedron) {
  int sum = 0;
  for (const int point : mesh_.tetrahedra[tetrahedron]) sum += defects(point);
  return sum;
}

int LabelMoves::change_of_defects(int tetrahedron, int to) {
  const int before = defects_at_corners(tetrahedron);
  const int from = std::exchange(labels_[tetrahedron], to);
  const int after = defects_at_corners(tetrahedron);
  labels_[tetrahedron] = from;
  return after - before;
}

bool LabelMoves::can_leave(int tetrahedron) {
  const int label = labels_[tetrahedron];
  if (sizes_[label] < 2) return false;
  std::array<int, 4> mates{};
  int mate_count = 0;
  for (const int across : mesh_.neighbours[tetrahedron])
    if (across >= 0 && labels_[across] == label) mates[mate_count++] = across;
  if (mate_count < 2) return true;

  // All mates must be reached from the first without leaving the stars of the four corners.
  const int nearby = ++last_mark_;
  const int visited = ++last_mark_;
  for (const int point : mesh_.tetrahedra[tetrahedron])
    for (const int t : stars_.of(point))
      if (labels_[t] == label) mark_[t] = nearby;
  mark_[tetrahedron] = visited;
  mark_[mates[0]] = visited;
  stack_.assign(1, mates[0]);
  while (!stack_.empty()) {
    const int t = stack_.back();
    stack_.pop_back();
    for (const int across : mesh_.neighbours[t]) {
      if (across < 0 || mark_[across] != nearby) continue;
      mark_[across] = visited;
      stack_.push_back(across);
    }
  }
  return std::all_of(mates.begin(), mates.begin() + mate_count,
                     [&](int mate) { return mark_[mate] == visited; });
}

void LabelMoves::move(int tetrahedron, int to) {
  --sizes_[labels_[tetrahedron]];
  ++sizes_[to];
  labels_[tetrahedron] = to;
}

int reassign_pinched(const TetMesh& mesh, Segments& segments, double reach_mm,
                     const Progress& progress) {
  LabelMoves moves(mesh, segments.of_tetrahedron, segments.count);
  std::deque<int> pinched;
  for (int point = 0; point < static_cast<int>(mesh.points.size()); ++point)
    if (moves.defects(point) > 0) pinched.push_back(point);

  // Every move takes away at least one defect of all, so this ends.
  int count = 0;
  while (!pinched.empty()) {
    progress.check();
    const int point = pinched.front();
    pinched.pop_front();
    if (moves.defects(point) == 0) continue;
    const Move move = best_move(mesh, moves, point, reach_mm);
    if (move.tetrahedron < 0) continue;
    moves.move(move.tetrahedron, move.to);
    ++count;
    for (const int corner : mesh.tetrahedra[move.tetrahedron])
      if (moves.defects(corner) > 0) pinched.push_back(corner);
  }
  return count;
}

int straighten_cuts(const TetMesh& mesh, Segments& segments, const Progress& progress) {
  constexpr int kSweeps = 8;
  constexpr double kLeastGain_mm2 = 1e-9;  // so that rounding never makes two moves undo each other
  LabelMoves moves(mesh, segments.of_tetrahedron, segments.count);
  const CutLength cut(mesh);
  const Contacts contacts(mesh, segments);
  // The label that gains most from the tetrahedron; -1 where it is best left alone.
  const auto best_label = [&](int t) {
    const double now = cut.of(moves, t, moves.label(t));
    int best = -1;
    double least = now - kLeastGain_mm2;
    for (const int across : mesh.neighbours[t]) {
      if (across < 0 || moves.label(across) == moves.label(t)) continue;
      const double then = cut.of(moves, t, moves.label(across));
      if (then >= least) continue;
      least = then;
      best = moves.label(across);
    }
    return best;
  };
  const auto touches_strangers = [&](int t, int label) {
    return std::any_of(mesh.neighbours[t].begin(), mesh.neighbours[t].end(), [&](int across) {
      return across >= 0 && !contacts.has(moves.label(across), label);
    });
  };
  int count = 0;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    progress.check();
    const int before = count;
    for (int t = 0; t < mesh.count(); ++t) {
      const int to = best_label(t);
      if (to < 0 || touches_strangers(t, to) || moves.change_of_defects(t, to) > 0 ||
          !moves.can_leave(t))
        continue;
      moves.move(t, to);
      ++count;
    }
    if (count == before) break;
  }
  return count;
}

}  // namespace packmerger
