#include "gcode/arc.h"

#include <algorithm>
#include <cmath>

namespace packmerger {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kSamePointMm = 1e-6;
constexpr int kMostPieces = 100000;

}  // namespace

double Arc::length_mm(double rise_mm) const {
  return std::hypot((start_radius_mm + end_radius_mm) / 2 * sweep, rise_mm);
}

Vec2 Arc::at(double part) const {
  const double radius = start_radius_mm + part * (end_radius_mm - start_radius_mm);
  const double angle = start + part * sweep;
  return centre + radius * Vec2(std::cos(angle), std::sin(angle));
}

Eigen::AlignedBox2d Arc::extent() const {
  Eigen::AlignedBox2d box(at(0));
  box.extend(at(1));
  const double radius = std::max(start_radius_mm, end_radius_mm);
  const double direction = sweep > 0 ? 1 : -1;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double angle = quarter * std::numbers::pi / 2;
    const double way = direction * (angle - start);
    if (way - kTurn * std::floor(way / kTurn) > std::abs(sweep)) continue;
    box.extend(Vec2(centre + radius * Vec2(std::cos(angle), std::sin(angle))));
  }
  return box;
}

int Arc::pieces(double deviation_mm) const {
  const double radius = std::max(start_radius_mm, end_radius_mm);
  const double cosine = std::clamp(1 - deviation_mm / std::max(radius, deviation_mm), -1.0, 1.0);
  const double step = std::clamp(2 * std::acos(cosine), 1e-3, kTurn / 8);
  return std::clamp(static_cast<int>(std::ceil(std::abs(sweep) / step)), 1, kMostPieces);
}

std::optional<Arc> arc_around(const Vec2& from, const Vec2& to, const Vec2& offset, bool clockwise,
                              int turns) {
  if (offset.norm() < kSamePointMm) return std::nullopt;
  Arc arc;
  arc.centre = from + offset;
  const Vec2 a = from - arc.centre;
  const Vec2 b = to - arc.centre;
  arc.start_radius_mm = a.norm();
  arc.end_radius_mm = b.norm();
  arc.start = std::atan2(a.y(), a.x());
  const double direction = clockwise ? -1 : 1;
  const double way = direction * (std::atan2(b.y(), b.x()) - arc.start);
  double sweep = way - kTurn * std::floor(way / kTurn);
  if ((to - from).norm() < kSamePointMm) sweep = kTurn;
  arc.sweep = direction * (sweep + turns * kTurn);
  return arc;
}

std::optional<Arc> arc_by_radius(const Vec2& from, const Vec2& to, double radius_mm, bool clockwise,
                                 int turns) {
  const Vec2 chord = to - from;
  const double half = chord.norm() / 2;
  if (half < kSamePointMm || std::abs(radius_mm) < half * (1 - 1e-6)) return std::nullopt;
  const double rise = std::sqrt(std::max(0.0, radius_mm * radius_mm - half * half));
  const double side = !clockwise == (radius_mm > 0) ? 1 : -1;
  const Vec2 across = Vec2(-chord.y(), chord.x()).normalized();
  return arc_around(from, to, chord / 2 + side * rise * across, clockwise, turns);
}

}  // namespace packmerger
