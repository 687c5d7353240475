// Where on the tray a part may stand: a plate that is no rectangle, and areas that are kept out.
#pragma once

#include <limits>
#include <optional>

#include "model/mesh.h"
#include "model/plane/polygon.h"

namespace packmerger {

// Walls are vertical and as high as the build volume: no part may stand out over the outline or
// over a kept-out area, at any height. It may touch them: parts keep their gap from one another
// only. The rectangle of the build volume is not part of it; whoever places parts knows that
// anyhow. Tray coordinates, mm. Const, so any thread may read it.
class Plate {
 public:
  // No walls but the build volume's.
  Plate() = default;
  // outline: where parts may stand; empty: the whole rectangle. kept_out: where they may not; they
  // may overlap and reach out of the plate. Every polygon is a simple one (fault_of()).
  Plate(const Polygon& outline, const std::vector<Polygon>& kept_out);

  // The same with walls that stand margin_mm nearer from every side, seen from a tray whose corner
  // lies at `corner`. What is rounded by the margin becomes a polygon with eight corners outside of
  // the round.
  Plate drawn_in(const Vec2& corner, double margin_mm) const;

  bool is_whole() const { return hull_.empty() && barred_.empty(); }

  // All walls are those of the hull, which parts stay within, and of the barred areas, which they
  // stay out of: the kept-out areas, and what lies between the outline and its convex hull. Each
  // counter-clockwise; the hull is empty where the outline is.
  const Polygon& hull() const { return hull_; }
  struct Side {  // of the hull: points at outward · p <= offset are inside
    Vec2 outward;
    double offset;
  };
  const std::vector<Side>& sides() const { return sides_; }
  const std::vector<Polygon>& barred() const { return barred_; }

  // The wall nearest to a point. clearance_mm is above 0 where a part may be, below 0 beyond a
  // wall: the depth; it grows in the direction `away`, a unit vector, or zero on the wall itself.
  struct Wall {
    double clearance_mm = std::numeric_limits<double>::infinity();
    Vec2 away = Vec2::Zero();
  };
  Wall nearest_wall(const Vec2& at) const;
  // The same of the barred areas alone.
  Wall nearest_barred(const Vec2& at) const;

  // How far a surface, moved by the pose, stands over a wall, mm; 0 where it does not. Exact for
  // what is outside of the hull; over barred areas it is above 0 where anything stands over them,
  // and a measure of how deep.
  double breach_mm(const TriangleView& surface, const Pose& pose) const;

  // Whether nothing within the box can stand over a wall.
  bool surely_clear(const Box3& box) const;

  // A shift in x and y that puts a surface within the rectangle from 0 to room_mm, clear of all
  // walls: the middle of what is free within the hull where nothing else is barred, and otherwise
  // the first on a lattice, from the front and the left, or where its convex hull touches
  // walls on two sides. The same for the same surface. Empty where none was found.
  std::optional<Vec2> spot_for(const TriangleView& surface, const Vec2& room_mm) const;

 private:
  std::vector<Vec2> touching(const Eigen::AlignedBox2d& box,
                             const Eigen::AlignedBox2d& range) const;

  Polygon hull_;
  std::vector<Side> sides_;
  std::vector<Polygon> barred_;
  std::vector<Eigen::AlignedBox2d> boxes_;  // of the barred areas
  std::vector<Vec2> inner_points_;          // one within each
};

// What a breach may be by rounding alone, mm.
inline constexpr double kWallTolerance_mm = 1e-6;

}  // namespace packmerger
