#include "bench/balls_and_sticks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace packmerger::bench {
namespace {

using Triangle = std::array<int, 3>;

// The convex hull of points no four of which lie on one face of it, by wrapping: beyond each edge
// lies the point that leaves all others on the inner side. Triangles counter-clockwise from
// outside.
std::vector<Triangle> hull_of(const std::vector<Vec3>& points) {
  const auto count = static_cast<int>(points.size());
  const auto beyond = [&](int a, int b, const Vec3& to) {
    const Vec3 edge = to - points[a];
    int best = -1;
    for (int p = 0; p < count; ++p) {
      if (p == a || p == b) continue;
      if (best < 0 || edge.cross(points[best] - points[a]).dot(points[p] - points[a]) > 0) best = p;
    }
    return best;
  };
  const auto lower = [](const Vec3& p, const Vec3& q) { return p.z() < q.z(); };
  const auto lowest =
      static_cast<int>(std::min_element(points.begin(), points.end(), lower) - points.begin());
  const int next = beyond(lowest, lowest, points[lowest] + Vec3::UnitX());

  std::vector<Triangle> triangles;
  std::set<std::pair<int, int>> done;
  std::vector<std::pair<int, int>> open{{lowest, next}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    if (done.contains({a, b})) continue;
    const int c = beyond(a, b, points[b]);
    triangles.push_back({a, b, c});
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      done.emplace(p, q);
      open.emplace_back(q, p);
    }
  }
  return triangles;
}

// Points spread evenly over the unit sphere, on a spiral from pole to pole.
std::vector<Vec3> spread_over_sphere(int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count;
    const double angle = 2 * std::numbers::pi * i / std::numbers::phi;
    const double r = std::sqrt(1 - z * z);
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return points;
}

// Where a stick meets a ball.
struct Rim {
  Vec3 way;  // from the ball's centre along the stick, unit length
  int first_point = 0;
};

class Builder {
 public:
  Builder(double stick_radius_mm, double spacing_mm)
      : stick_mm_(stick_radius_mm),
        spacing_mm_(spacing_mm),
        sides_(static_cast<int>(std::lround(2 * std::numbers::pi * stick_radius_mm / spacing_mm))) {
  }

  // Returns its rims at both ends.
  std::array<Rim, 2> add_stick(const Ball& from, const Ball& to, int number) {
    const Vec3 way = (to.centre - from.centre).normalized();
    const Vec3 u = way.unitOrthogonal(), v = way.cross(u);
    const Vec3 start = from.centre + rim_height(from) * way;
    const Vec3 end = to.centre - rim_height(to) * way;
    const int steps =
        std::max(1, static_cast<int>(std::lround((end - start).norm() / spacing_mm_)));
    const auto base = static_cast<int>(soup_.points.size());
    // Sticks that meet at a ball in a regular pattern must not meet it in points of one circle.
    const double turn = 0.37 * number;
    for (int step = 0; step <= steps; ++step)
      for (int side = 0; side < sides_; ++side) {
        const double angle = 2 * std::numbers::pi * side / sides_ + turn;
        soup_.points.push_back(start + (end - start) * step / steps +
                               stick_mm_ * (std::cos(angle) * u + std::sin(angle) * v));
      }
    for (int step = 0; step < steps; ++step)
      for (int side = 0; side < sides_; ++side) {
        const int a = base + step * sides_ + side;
        const int b = base + step * sides_ + (side + 1) % sides_;
        soup_.triangles.push_back({a, b, b + sides_});
        soup_.triangles.push_back({a, b + sides_, a + sides_});
      }
    return {Rim{way, base}, Rim{-way, base + steps * sides_}};
  }

  // The hull of points on the ball, without what lies inside the rims: a point amid each rim marks
  // the triangles there.
  void add_ball(const Ball& ball, const std::vector<Rim>& rims) {
    constexpr int kAmidRim = -1;
    std::vector<Vec3> points;
    std::vector<int> index;  // in the soup
    for (const Rim& rim : rims) {
      points.push_back(ball.centre + ball.radius_mm * rim.way);
      index.push_back(kAmidRim);
      for (int side = 0; side < sides_; ++side) {
        index.push_back(rim.first_point + side);
        points.push_back(soup_.points[index.back()]);
      }
    }
    const double free = std::asin(stick_mm_ / ball.radius_mm) + 0.7 * spacing_mm_ / ball.radius_mm;
    const double area = 4 * std::numbers::pi * ball.radius_mm * ball.radius_mm;
    const double per_point = spacing_mm_ * spacing_mm_ * std::numbers::sqrt3 / 2;
    for (const Vec3& way : spread_over_sphere(static_cast<int>(area / per_point))) {
      const bool clear = std::all_of(rims.begin(), rims.end(), [&](const Rim& rim) {
        return std::acos(std::clamp(way.dot(rim.way), -1.0, 1.0)) > free;
      });
      if (!clear) continue;
      points.push_back(ball.centre + ball.radius_mm * way);
      index.push_back(static_cast<int>(soup_.points.size()));
      soup_.points.push_back(points.back());
    }
    for (const auto& [a, b, c] : hull_of(points))
      if (std::min({index[a], index[b], index[c]}) != kAmidRim)
        soup_.triangles.push_back({index[a], index[b], index[c]});
  }

  TriangleSoup finish() { return std::move(soup_); }

 private:
  double rim_height(const Ball& ball) const {
    return std::sqrt(ball.radius_mm * ball.radius_mm - stick_mm_ * stick_mm_);
  }

  double stick_mm_;
  double spacing_mm_;
  int sides_;
  TriangleSoup soup_;
};

}  // namespace

TriangleSoup balls_and_sticks(const std::vector<Ball>& balls, const std::vector<Stick>& sticks,
                              double stick_radius_mm, double spacing_mm) {
  Builder builder(stick_radius_mm, spacing_mm);
  std::vector<std::vector<Rim>> rims(balls.size());
  for (std::size_t i = 0; i < sticks.size(); ++i) {
    const auto from = static_cast<std::size_t>(sticks[i].from);
    const auto to = static_cast<std::size_t>(sticks[i].to);
    const auto ends = builder.add_stick(balls[from], balls[to], static_cast<int>(i));
    rims[from].push_back(ends[0]);
    rims[to].push_back(ends[1]);
  }
  for (std::size_t i = 0; i < balls.size(); ++i) builder.add_ball(balls[i], rims[i]);
  return builder.finish();
}

}  // namespace packmerger::bench
