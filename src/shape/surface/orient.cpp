#include "shape/surface/orient.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "shape/read/soup.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

// A closed piece whose volume is below this fraction of its box's diagonal cubed is a flat sheet.
constexpr double kFlatVolume = 1e-9;

enum class Fate { kKeep, kTurn, kDrop, kSwallow };

bool inside(const TriangleSoup& inner, const SurfaceQuery& outer) {
  return std::all_of(inner.points.begin(), inner.points.end(),
                     [&](const Vec3& point) { return outer.winding_number(point) % 2 != 0; });
}

// For each piece those that hold it entirely. flat: left out.
std::vector<std::vector<std::size_t>> holders_of(const std::vector<TriangleSoup>& parts,
                                                 const std::vector<char>& flat) {
  std::vector<std::vector<std::size_t>> holders(parts.size());
  std::vector<Box3> boxes;
  for (const TriangleSoup& part : parts) boxes.push_back(bounding_box(part));
  for (std::size_t outer = 0; outer < parts.size(); ++outer) {
    if (flat[outer] != 0) continue;
    std::unique_ptr<SurfaceQuery> query;
    for (std::size_t inner = 0; inner < parts.size(); ++inner) {
      if (inner == outer || flat[inner] != 0 || !boxes[outer].contains(boxes[inner])) continue;
      if (!query) query = std::make_unique<SurfaceQuery>(parts[outer]);
      if (inside(parts[inner], *query)) holders[inner].push_back(outer);
    }
  }
  return holders;
}

std::vector<Fate> fates_of(const std::vector<TriangleSoup>& parts, double diagonal) {
  std::vector<int> sign;
  std::vector<char> flat;
  for (const TriangleSoup& part : parts) {
    const double volume = signed_volume_mm3(part);
    flat.push_back(std::abs(volume) <= kFlatVolume * diagonal * diagonal * diagonal ? 1 : 0);
    sign.push_back(volume < 0 ? -1 : 1);
  }
  const auto holders = holders_of(parts, flat);
  std::vector<Fate> fates;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (flat[i] != 0) {
      fates.push_back(Fate::kDrop);
      continue;
    }
    const auto outermost =
        std::find_if(holders[i].begin(), holders[i].end(),
                     [&](std::size_t holder) { return holders[holder].empty(); });
    const int outward = outermost == holders[i].end() ? sign[i] : sign[*outermost];
    int around = 0;  // how often the pieces that hold it wind around it
    for (const std::size_t holder : holders[i]) around += outward * sign[holder];
    const bool matter_outside = around > 0;
    const bool matter_inside = around + outward * sign[i] > 0;
    if (matter_outside == matter_inside)
      fates.push_back(Fate::kSwallow);
    else
      fates.push_back((sign[i] > 0) == matter_inside ? Fate::kKeep : Fate::kTurn);
  }
  return fates;
}

}  // namespace

Orientation orient_outwards(TriangleSoup& soup) {
  const Components components = components_of(soup);
  const std::vector<Fate> fates =
      fates_of(split_components(soup), bounding_box(soup).diagonal().norm());
  Orientation result;
  for (const Fate fate : fates) {
    result.pieces += fate == Fate::kKeep || fate == Fate::kTurn ? 1 : 0;
    result.swallowed += fate == Fate::kSwallow ? 1 : 0;
  }
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const Fate fate = fates[static_cast<std::size_t>(components.of_triangle[i])];
    if (fate == Fate::kDrop || fate == Fate::kSwallow) {
      ++result.facets_removed;
      continue;
    }
    triangles.push_back(soup.triangles[i]);
    if (fate == Fate::kTurn) std::swap(triangles.back()[1], triangles.back()[2]);
  }
  soup.triangles = std::move(triangles);
  soup = without_unused_points(std::move(soup));
  return result;
}

}  // namespace packmerger
