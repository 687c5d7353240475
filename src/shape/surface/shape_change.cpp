#include "shape/surface/shape_change.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "shape/read/soup.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

// Pieces of a triangle smaller than this part of the distance are not looked into any more.
constexpr double kSmallest = 0.1;
// What changes more than this of the area or the volume is told, and of the longest side: how far
// points may be moved, and how far surface that is new may reach from what was there. The middle of
// a hole that was closed is half its width from its rim.
constexpr double kChanged = 0.01;

using Corners = std::array<Vec3, 3>;
using Place = std::array<std::array<double, 3>, 3>;

Corners corners_of(const TriangleSoup& soup, std::size_t i) {
  const auto& [a, b, c] = soup.triangles[i];
  return {soup.points[a], soup.points[b], soup.points[c]};
}

// The corners in an order that does not depend on how the triangle is turned.
Place place_of(const TriangleSoup& soup, std::size_t i) {
  Place place{};
  const Corners corners = corners_of(soup, i);
  for (std::size_t k = 0; k < 3; ++k) place[k] = {corners[k].x(), corners[k].y(), corners[k].z()};
  std::sort(place.begin(), place.end());
  return place;
}

std::vector<Corners> triangles_missing_in(const TriangleSoup& other, const TriangleSoup& soup) {
  std::set<Place> places;
  for (std::size_t i = 0; i < other.triangles.size(); ++i) places.insert(place_of(other, i));
  std::vector<Corners> missing;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    if (!places.contains(place_of(soup, i))) missing.push_back(corners_of(soup, i));
  return missing;
}

TriangleSoup without_flat(const TriangleSoup& soup) {
  TriangleSoup kept;
  kept.points = soup.points;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const auto [a, b, c] = corners_of(soup, i);
    if ((b - a).cross(c - a).norm() > 0) kept.triangles.push_back(soup.triangles[i]);
  }
  return kept;
}

// Halves what may reach further until it is proved or too small.
template <typename Counts>
bool reaches_further(const Corners& whole, const SurfaceQuery& from, double distance_mm,
                     const Counts& counts) {
  std::vector<Corners> open{whole};
  while (!open.empty()) {
    const auto [a, b, c] = open.back();
    open.pop_back();
    const Vec3 middle = (a + b + c) / 3;
    const double radius = std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()});
    const double distance = from.distance_mm(middle);
    if (distance > distance_mm) {
      if (counts(middle)) return true;
      if (distance >= radius) continue;  // all of it is on the same side of the surface
    }
    if (distance + radius <= distance_mm || radius < kSmallest * distance_mm) continue;
    // The longest side is cut.
    std::array<Corners, 3> turned{{{a, b, c}, {b, c, a}, {c, a, b}}};
    const auto& [p, q, r] = *std::max_element(
        turned.begin(), turned.end(), [](const Corners& one, const Corners& other) {
          return (one[1] - one[0]).squaredNorm() < (other[1] - other[0]).squaredNorm();
        });
    const Vec3 half = (p + q) / 2;
    open.push_back({p, half, r});
    open.push_back({half, q, r});
  }
  return false;
}

template <typename Counts>
bool any_reaches_further(const std::vector<Corners>& triangles, const TriangleSoup& from,
                         double distance_mm, const Counts& counts, const Progress& progress) {
  if (triangles.empty()) return false;
  const SurfaceQuery query(from);
  std::atomic<bool> found{false};
  parallel_for(triangles.size(), [&](std::size_t i) {
    progress.check();
    const auto counts_here = [&](const Vec3& point) { return counts(query, point); };
    if (!found && reaches_further(triangles[i], query, distance_mm, counts_here)) found = true;
  });
  return found;
}

bool closed_a_wide_hole(const Mending& mending, double longest_mm, const Progress& progress) {
  return any_reaches_further(
      triangles_missing_in(mending.before, mending.after), without_flat(mending.before),
      kChanged * longest_mm, [](const SurfaceQuery&, const Vec3&) { return true; }, progress);
}

bool left_something_out(const Mending& mending, double longest_mm, const Progress& progress) {
  const auto is_outside = [](const SurfaceQuery& surface, const Vec3& point) {
    return surface.winding_number(point) == 0;
  };
  return any_reaches_further(triangles_missing_in(mending.after, mending.before), mending.after,
                             kChanged * longest_mm, is_outside, progress);
}

// Of figures that should be the same; of nothing, nothing.
double change(double before, double after) {
  return before > 0 ? std::abs(after - before) / before : 0;
}

std::string percent(double part) {
  return std::to_string(std::max(1L, std::lround(100 * part))) + " %";
}

}  // namespace

void warn_of_change(const Mending& mending, Warnings& warnings, const Progress& progress) {
  const double area = change(area_mm2(mending.before), area_mm2(mending.after));
  const double volume = mending.was_closed ? change(std::abs(signed_volume_mm3(mending.before)),
                                                    signed_volume_mm3(mending.after))
                                           : 0;
  const double longest_mm = bounding_box(mending.before).sizes().maxCoeff();
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : " and ") + what; };
  if (area > kChanged) add("changed its area by " + percent(area));
  if (volume > kChanged) add("changed its volume by " + percent(volume));
  if (!mending.is_skin && closed_a_wide_hole(mending, longest_mm, progress))
    add("closed a hole wider than 2 % of its longest side");
  if (left_something_out(mending, longest_mm, progress))
    add("moved or left out what is further than 1 % of its longest side from the rest");
  if (text.empty() && !mending.is_skin) return;
  std::string sentence = text.empty() ? "" : "Mending the model " + text;
  if (mending.is_skin)
    sentence += (text.empty() ? "The model" : ": it") +
                std::string(
                    " was open over its whole width and was closed to a solid body; if it "
                    "is a skin without thickness, give it one in the program it was drawn "
                    "with");
  else if (mending.swallowed)
    sentence += ": pieces within other pieces, turned like them, are matter, not cavities";
  warnings.push_back({"shape_changed", sentence});
}

}  // namespace packmerger
