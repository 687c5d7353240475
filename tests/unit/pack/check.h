// What every packing must hold, checked without the packer's own code.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "model/packing.h"

namespace packmerger::check {

using Triangle = std::array<Vec3, 3>;

inline std::vector<Triangle> placed_triangles(const PackProblem& problem, const PlacedPart& part) {
  std::vector<Triangle> triangles;
  for (const int item : part.items) {
    const Mesh& mesh = problem.items[static_cast<std::size_t>(item)].surface;
    for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
      Triangle triangle = mesh.corners(i);
      for (Vec3& corner : triangle) corner = part.pose * corner;
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

inline double segment_distance(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  // Convex in both parameters: alternate exact minimisation converges; the ends are tried as well.
  const auto nearest = [](const Vec3& a, const Vec3& b, const Vec3& x) {
    const double length = (b - a).squaredNorm();
    const double t = length > 0 ? std::clamp((x - a).dot(b - a) / length, 0.0, 1.0) : 0.0;
    return Vec3(a + t * (b - a));
  };
  const Vec3 u = q - p;
  const Vec3 v = s - r;
  const double a = u.squaredNorm();
  const double b = u.dot(v);
  const double c = v.squaredNorm();
  const double det = a * c - b * b;
  double best = std::numeric_limits<double>::infinity();
  for (const Vec3& x : {p, q}) best = std::min(best, (x - nearest(r, s, x)).norm());
  for (const Vec3& x : {r, s}) best = std::min(best, (x - nearest(p, q, x)).norm());
  if (det > 1e-12 * a * c) {
    const Vec3 w = p - r;
    const double t = (b * v.dot(w) - c * u.dot(w)) / det;
    const double k = (a * v.dot(w) - b * u.dot(w)) / det;
    if (t >= 0 && t <= 1 && k >= 0 && k <= 1) best = std::min(best, (p + t * u - r - k * v).norm());
  }
  return best;
}

// By the solid angle of all facets.
inline bool is_inside(const Mesh& mesh, const Vec3& p) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    const auto corner = mesh.corners(i);
    const Vec3 a = corner[0] - p;
    const Vec3 b = corner[1] - p;
    const Vec3 c = corner[2] - p;
    sum += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                 b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return sum > 2 * std::numbers::pi;
}

inline double point_distance(const Vec3& x, const Triangle& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  double best = std::numeric_limits<double>::infinity();
  bool inside = normal.norm() > 1e-12;
  for (std::size_t i = 0; i < 3 && inside; ++i)
    inside = normal.dot((t[(i + 1) % 3] - t[i]).cross(x - t[i])) >= 0;
  if (inside) best = std::abs(normal.normalized().dot(x - t[0]));
  return best;
}

// Distance of two surfaces that do not cross.
inline double brute_force_distance(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
  double best = std::numeric_limits<double>::infinity();
  for (const Triangle& s : a)
    for (const Triangle& t : b) {
      for (std::size_t i = 0; i < 3; ++i) {
        best = std::min({best, point_distance(s[i], t), point_distance(t[i], s)});
        for (std::size_t j = 0; j < 3; ++j)
          best = std::min(best, segment_distance(s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]));
      }
    }
  return best;
}

// Lowest and highest matter on a lattice of vertical lines.
struct Columns {
  double step;
  int width;
  int height;
  std::vector<double> low;
  std::vector<double> high;

  Columns(const std::vector<Triangle>& triangles, const Vec3& build, double step_mm)
      : step(step_mm),
        width(static_cast<int>(build.x() / step_mm)),
        height(static_cast<int>(build.y() / step_mm)),
        low(static_cast<std::size_t>(width * height), std::numeric_limits<double>::infinity()),
        high(static_cast<std::size_t>(width * height), -std::numeric_limits<double>::infinity()) {
    for (const Triangle& t : triangles) {
      const double det = (t[1].x() - t[0].x()) * (t[2].y() - t[0].y()) -
                         (t[2].x() - t[0].x()) * (t[1].y() - t[0].y());
      if (std::abs(det) < 1e-12) continue;
      const auto [x0, x1] = std::minmax({t[0].x(), t[1].x(), t[2].x()});
      const auto [y0, y1] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
      for (int j = std::max(0, static_cast<int>(y0 / step)); j < height && line(j) <= y1; ++j)
        for (int i = std::max(0, static_cast<int>(x0 / step)); i < width && line(i) <= x1; ++i) {
          const double dx = line(i) - t[0].x();
          const double dy = line(j) - t[0].y();
          const double u = (dx * (t[2].y() - t[0].y()) - dy * (t[2].x() - t[0].x())) / det;
          const double v = (dy * (t[1].x() - t[0].x()) - dx * (t[1].y() - t[0].y())) / det;
          if (u < 0 || v < 0 || u + v > 1) continue;
          const double z = t[0].z() + u * (t[1].z() - t[0].z()) + v * (t[2].z() - t[0].z());
          const std::size_t at = static_cast<std::size_t>(j * width + i);
          low[at] = std::min(low[at], z);
          high[at] = std::max(high[at], z);
        }
    }
  }
  double line(int i) const { return (i + 0.4637) * step; }
};

inline void expect_rigid(const Pose& pose) {
  EXPECT_TRUE((pose.linear() * pose.linear().transpose()).isApprox(Mat3::Identity(), 1e-12));
  EXPECT_NEAR(pose.linear().determinant(), 1, 1e-12);
}

// Taken out in the order told, each along its path and then straight up, nothing that is still
// there may be in the way.
inline void expect_removable(const PackProblem& problem, const Packing& packing,
                             const std::vector<std::vector<Triangle>>& placed,
                             double column_step_mm) {
  constexpr double kStep_mm = 0.2;
  const std::vector<int>& order = packing.removal_order;
  ASSERT_EQ(order.size(), packing.parts.size());
  ASSERT_EQ(packing.removal_paths.size(), packing.parts.size());
  std::set<int> there(order.begin(), order.end());
  ASSERT_EQ(there.size(), order.size());
  std::vector<Columns> columns;
  for (const auto& triangles : placed)
    columns.emplace_back(triangles, problem.build_mm, column_step_mm);
  for (const int taken : order) {
    there.erase(taken);
    const auto at = static_cast<std::size_t>(taken);
    std::vector<Triangle> moving = placed[at];
    const auto move = [&moving](const Vec3& by) {
      for (Triangle& triangle : moving)
        for (Vec3& corner : triangle) corner += by;
    };
    for (const Vec3& step : packing.removal_paths[at]) {
      const int count = static_cast<int>(std::ceil(step.norm() / kStep_mm));
      for (int i = 0; i < count; ++i) {
        move(step / count);
        for (const int other : there)
          if (packing.parts[static_cast<std::size_t>(other)].tray == packing.parts[at].tray) {
            ASSERT_GT(brute_force_distance(moving, placed[static_cast<std::size_t>(other)]), 0.01)
                << taken << " meets " << other << " on its way";
          }
      }
    }
    const Columns up = packing.removal_paths[at].empty()
                           ? columns[at]
                           : Columns(moving, problem.build_mm, column_step_mm);
    for (const int other : there) {
      if (packing.parts[static_cast<std::size_t>(other)].tray != packing.parts[at].tray) continue;
      const Columns& rest = columns[static_cast<std::size_t>(other)];
      for (std::size_t cell = 0; cell < up.low.size(); ++cell)
        ASSERT_FALSE(rest.high[cell] > up.low[cell]) << taken << " is caught under " << other;
    }
  }
}

// Everything that src/pack/pack.h promises, but for what only a second run can show.
inline void expect_valid(const PackProblem& problem, const Packing& packing,
                         double column_step_mm) {
  std::multiset<int> items;
  std::vector<std::vector<Triangle>> placed;
  for (const PlacedPart& part : packing.parts) {
    ASSERT_TRUE(std::is_sorted(part.items.begin(), part.items.end()));
    items.insert(part.items.begin(), part.items.end());
    for (const int item : part.items)
      EXPECT_EQ(problem.items[static_cast<std::size_t>(item)].model,
                problem.items[static_cast<std::size_t>(part.items.front())].model);
    expect_rigid(part.pose);
    placed.push_back(placed_triangles(problem, part));
  }
  std::multiset<int> expected;
  for (int i = 0; i < static_cast<int>(problem.items.size()); ++i) expected.insert(i);
  EXPECT_EQ(items, expected);

  double cost = 0;
  for (std::size_t tray = 0; tray < packing.trays.size(); ++tray) {
    Box3 box;
    double material = 0;
    int parts = 0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      if (packing.parts[i].tray != static_cast<int>(tray)) continue;
      ++parts;
      for (const Triangle& triangle : placed[i])
        for (const Vec3& corner : triangle) box.extend(corner);
      for (const int item : packing.parts[i].items)
        material += problem.items[static_cast<std::size_t>(item)].volume_mm3;
    }
    EXPECT_GE(box.min().minCoeff(), -1e-9);
    EXPECT_LE((box.max() - problem.build_mm).maxCoeff(), 1e-9);
    EXPECT_NEAR(box.min().z(), 0, 1e-9);
    const TrayMeasure& figures = packing.trays[tray];
    EXPECT_EQ(figures.parts, parts);
    EXPECT_NEAR(figures.material_mm3, material, 1e-6 * material);
    EXPECT_NEAR(figures.size_mm.x(), box.sizes().x(), 1e-6);
    EXPECT_NEAR(figures.size_mm.y(), box.sizes().y(), 1e-6);
    EXPECT_NEAR(figures.size_mm.z(), box.max().z(), 1e-6);
    EXPECT_GE(figures.support_mm3, 0);
    cost += problem.cost.evaluate(figures);
  }
  EXPECT_NEAR(packing.cost, cost, 1e-9 * std::abs(cost));

  for (std::size_t i = 0; i < placed.size(); ++i)
    for (std::size_t j = i + 1; j < placed.size(); ++j)
      if (packing.parts[i].tray == packing.parts[j].tray &&
          placed[i].size() * placed[j].size() < 300000) {
        EXPECT_GE(brute_force_distance(placed[i], placed[j]), problem.gap_mm - 1e-5)
            << i << " " << j;
      }

  expect_removable(problem, packing, placed, column_step_mm);
}

// The same parts in the same poses to the last bit, and taken out alike.
inline void expect_same(const Packing& one, const Packing& other) {
  EXPECT_EQ(one.cost, other.cost);
  EXPECT_EQ(one.removal_order, other.removal_order);
  EXPECT_EQ(one.removal_paths, other.removal_paths);
  ASSERT_EQ(one.parts.size(), other.parts.size());
  for (std::size_t i = 0; i < one.parts.size(); ++i)
    EXPECT_EQ(one.parts[i].pose.matrix(), other.parts[i].pose.matrix());
}

}  // namespace packmerger::check
