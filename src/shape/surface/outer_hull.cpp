#include "shape/surface/outer_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "shape/read/soup.h"
#include "shape/surface/cut_crossings.h"
#include "shape/surface/draw_apart.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

// How far from a piece its two sides are looked at, of the piece's size.
constexpr double kAside = 1e-4;

Vec3 twice_area(const TriangleSoup& soup, std::size_t i) {
  const auto& [a, b, c] = soup.triangles[i];
  return (soup.points[b] - soup.points[a]).cross(soup.points[c] - soup.points[a]);
}

// Pieces with their numbers in patches, which nothing but edges borders at which several sheets
// meet: what lies before one piece of a patch lies before all of them.
class Patches {
 public:
  explicit Patches(const TriangleSoup& pieces) : of_(pieces.triangles.size()) {
    std::iota(of_.begin(), of_.end(), std::size_t{0});
    struct Side {
      std::pair<int, int> edge;  // the lower end first
      bool is_upward;            // whether the piece goes from the lower end to the other
      std::size_t piece;
    };
    std::vector<Side> sides;
    for (std::size_t i = 0; i < of_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const int from = pieces.triangles[i][k];
        const int to = pieces.triangles[i][(k + 1) % 3];
        sides.push_back({std::minmax({from, to}), from < to, i});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.edge, a.piece) < std::tie(b.edge, b.piece);
    });
    for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
      while (end < sides.size() && sides[end].edge == sides[first].edge) ++end;
      if (end - first == 2 && sides[first].is_upward != sides[first + 1].is_upward)
        join(sides[first].piece, sides[first + 1].piece);
    }
    for (std::size_t i = 0; i < of_.size(); ++i) of_[i] = root(i);
  }

  // The number of the patch's first piece.
  std::size_t of(std::size_t piece) const { return of_[piece]; }

 private:
  std::size_t root(std::size_t i) {
    while (of_[i] != i) i = of_[i] = of_[of_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    const auto [first, second] = std::minmax({root(a), root(b)});
    of_[second] = first;
  }

  std::vector<std::size_t> of_;
};

// The pieces with nothing on one side and matter on the other, turned so that the matter is behind.
TriangleSoup outside_of(const TriangleSoup& pieces, const SurfaceQuery& model,
                        const Progress& progress) {
  const Patches patches(pieces);
  // Of each patch its largest piece is asked, which rounding has changed least.
  std::vector<std::size_t> largest(pieces.triangles.size());
  std::iota(largest.begin(), largest.end(), std::size_t{0});
  for (std::size_t i = 0; i < largest.size(); ++i) {
    std::size_t& best = largest[patches.of(i)];
    if (twice_area(pieces, i).norm() > twice_area(pieces, best).norm()) best = i;
  }
  enum class Fate : char { kDrop, kKeep, kTurn };
  std::vector<Fate> fates(pieces.triangles.size(), Fate::kDrop);
  parallel_for(pieces.triangles.size(), [&](std::size_t i) {
    if (patches.of(i) != i) return;
    progress.check();
    const auto& [a, b, c] = pieces.triangles[largest[i]];
    const Vec3 normal = twice_area(pieces, largest[i]);
    if (!(normal.norm() > 0)) return;
    const Vec3 aside = normal * (kAside / std::sqrt(normal.norm()));
    const Vec3 middle = (pieces.points[a] + pieces.points[b] + pieces.points[c]) / 3;
    const bool before = model.winding_number(middle + aside) != 0;
    const bool behind = model.winding_number(middle - aside) != 0;
    if (before != behind) fates[i] = behind ? Fate::kKeep : Fate::kTurn;
  });
  TriangleSoup kept;
  kept.points = pieces.points;
  for (std::size_t i = 0; i < fates.size(); ++i) {
    const Fate fate = fates[patches.of(i)];
    if (fate == Fate::kDrop) continue;
    kept.triangles.push_back(pieces.triangles[i]);
    if (fate == Fate::kTurn) std::swap(kept.triangles.back()[1], kept.triangles.back()[2]);
  }
  return kept;
}

}  // namespace

std::optional<Mesh> outer_hull(const Mesh& mesh, double gap_mm, const Progress& progress) {
  try {
    const auto pieces = cut_at_crossings(mesh, progress);
    if (!pieces) return std::nullopt;
    const TriangleSoup outside = outside_of(*pieces, SurfaceQuery(mesh), progress);
    Warnings of_pieces;  // what closing the pieces took concerns nobody: the deviation is measured
    return repair(drawn_apart(outside, gap_mm), of_pieces, progress);
  } catch (const Error& error) {
    if (error.fault() == Fault::kInterrupted) throw;
    return std::nullopt;
  } catch (const std::exception&) {  // CGAL's failures
    return std::nullopt;
  }
}

}  // namespace packmerger
