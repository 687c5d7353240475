// What a part meets on its way: straight up, decided facet by facet, or along a path, by distances
// between the meshes.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/effort.h"
#include "base/progress.h"
#include "pack/exact/exact_gap.h"

namespace packmerger {

using Facet = std::array<Vec3, 3>;

inline constexpr double kTouch_mm = 1e-3;      // what overlaps by less touches
inline constexpr double kLeastRoom_mm = 0.02;  // along a path

// Facets of a closed surface that look up, or down, in cells seen from above. Their corners go
// round to the left.
class Facing {
 public:
  Facing(const Mesh& mesh, bool up);

  const std::vector<Facet>& facets() const { return facets_; }
  const Box3& box() const { return box_; }

  // Those that may lie over or under the facet, some of them several times.
  template <typename Visit>
  void near(const Facet& facet, const Visit& visit) const {
    for_cells(*this, facet, [&](const std::vector<int>& cell) {
      for (const int i : cell) visit(facets_[static_cast<std::size_t>(i)]);
    });
  }

 private:
  template <typename Self, typename Visit>
  static void for_cells(Self& self, const Facet& facet, const Visit& visit) {
    if (self.cells_.empty()) return;
    const Vec3 origin = self.box_.min();
    const Vec3 low = facet[0].cwiseMin(facet[1]).cwiseMin(facet[2]) - origin;
    const Vec3 high = facet[0].cwiseMax(facet[1]).cwiseMax(facet[2]) - origin;
    const auto cell = [&](double at) { return static_cast<int>(std::floor(at / self.cell_mm_)); };
    for (int y = std::max(0, cell(low.y())); y <= std::min(self.height_ - 1, cell(high.y())); ++y)
      for (int x = std::max(0, cell(low.x())); x <= std::min(self.width_ - 1, cell(high.x())); ++x)
        visit(self.cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(self.width_) +
                          static_cast<std::size_t>(x)]);
  }

  std::vector<Facet> facets_;
  Box3 box_;
  double cell_mm_ = 1;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::vector<int>> cells_;
};

// Closed parts where they stand on one tray, and what is asked of them again and again.
class StandingParts {
 public:
  // parts: mm. progress must outlive it; every question may be cancelled by it.
  StandingParts(const std::vector<Mesh>& parts, const Progress& progress);
  // surfaces: of the same parts, in frames of their own that stand at the poses.
  StandingParts(const std::vector<Mesh>& parts, std::vector<MovableSurface> surfaces,
                std::vector<Pose> poses, const Progress& progress);

  int size() const { return static_cast<int>(boxes_.size()); }
  const Mesh& mesh(int part) const { return parts_[static_cast<std::size_t>(part)]; }
  const Box3& box(int part) const { return boxes_[static_cast<std::size_t>(part)]; }
  const Progress& progress() const { return progress_; }
  // How much work (base/effort.h) went into answers; the same on any number of threads.
  std::uint64_t steps() const { return effort_.spent(); }

  // Whether the part, moved first, meets the other one on its way straight up. What overlaps by
  // less than kTouch_mm, seen from above, touches.
  bool is_under(int part, const Vec3& moved, int other) const;
  // Of the part, moved, to the other one, told up to `enough`, mm. Not while other threads ask.
  double distance_mm(int part, const Vec3& moved, int other, double enough) const;
  // The part that this one meets along its path, or comes closer to than kLeastRoom_mm, of those
  // that are there: where it is told from one place to the next by steps that are as long as the
  // room around it.
  std::optional<int> met_on_path(int part, const std::vector<int>& there,
                                 const std::vector<Vec3>& path) const;

 private:
  std::vector<Mesh> parts_;
  const Progress& progress_;
  std::vector<Box3> boxes_;
  std::vector<std::optional<Facing>> tops_;
  std::vector<std::optional<Facing>> bottoms_;
  mutable std::vector<MovableSurface> surfaces_;  // made when a distance is asked for
  std::vector<Pose> poses_;                       // of the surfaces
  mutable Effort effort_;
};

}  // namespace packmerger
