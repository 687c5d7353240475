#include "pack/removal_plan.h"

#include <algorithm>

#include "pack/way_out.h"

namespace packmerger {
namespace {

// One part over one cell.
struct Slab {
  int part;
  int low;
  int high;
};

// blocks[a][b]: b stands above some matter of a, so that a cannot be lifted before it.
std::vector<std::vector<bool>> blocking(const SolidGrid& grid,
                                        const std::vector<SolidPlace>& places) {
  const auto columns = static_cast<std::size_t>(grid.columns());
  std::vector<std::int32_t> first(columns * static_cast<std::size_t>(grid.rows()) + 1, 0);
  const auto for_each_cell = [&](const auto& body) {
    for (std::size_t part = 0; part < places.size(); ++part) {
      const std::vector<SpanCell>& spans = places[part].part->matter;
      for (std::size_t i = 0, end = 0; i < spans.size(); i = end) {
        while (end < spans.size() && spans[end].x == spans[i].x && spans[end].y == spans[i].y)
          ++end;
        const std::size_t cell = static_cast<std::size_t>(places[part].y + spans[i].y) * columns +
                                 static_cast<std::size_t>(places[part].x + spans[i].x);
        body(cell, Slab{static_cast<int>(part), places[part].z + spans[i].low,
                        places[part].z + spans[end - 1].high});
      }
    }
  };
  for_each_cell([&](std::size_t cell, const Slab&) { ++first[cell + 1]; });
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  std::vector<Slab> slabs(static_cast<std::size_t>(first.back()));
  std::vector<std::int32_t> next(first.begin(), first.end() - 1);
  for_each_cell([&](std::size_t cell, const Slab& slab) {
    slabs[static_cast<std::size_t>(next[cell]++)] = slab;
  });
  std::vector<std::vector<bool>> blocks(places.size(), std::vector<bool>(places.size(), false));
  for (std::size_t cell = 0; cell + 1 < first.size(); ++cell)
    for (std::int32_t i = first[cell]; i < first[cell + 1]; ++i)
      for (std::int32_t j = first[cell]; j < first[cell + 1]; ++j) {
        const Slab& lower = slabs[static_cast<std::size_t>(i)];
        const Slab& upper = slabs[static_cast<std::size_t>(j)];
        if (i != j && upper.high > lower.low)
          blocks[static_cast<std::size_t>(lower.part)][static_cast<std::size_t>(upper.part)] = true;
      }
  return blocks;
}

}  // namespace

std::optional<RemovalPlan> removal_plan(const SolidGrid& grid,
                                        const std::vector<SolidPlace>& places) {
  const std::vector<std::vector<bool>> blocks = blocking(grid, places);
  RemovalPlan plan;
  plan.paths.resize(places.size());
  std::vector<int> there;
  for (std::size_t i = 0; i < places.size(); ++i) there.push_back(static_cast<int>(i));
  const auto take_out = [&](int part) {
    plan.order.push_back(part);
    there.erase(std::find(there.begin(), there.end(), part));
  };
  while (!there.empty()) {
    const auto lifted = std::find_if(there.rbegin(), there.rend(), [&](int part) {
      return std::none_of(there.begin(), there.end(), [&](int other) {
        return blocks[static_cast<std::size_t>(part)][static_cast<std::size_t>(other)];
      });
    });
    if (lifted != there.rend()) {
      take_out(*lifted);
      continue;
    }
    bool found = false;
    for (auto part = there.rbegin(); part != there.rend() && !found; ++part) {
      std::vector<SolidPlace> others;
      for (const int other : there)
        if (other != *part) others.push_back(places[static_cast<std::size_t>(other)]);
      const SolidTray rest(grid, others);
      auto way = way_out(rest, places[static_cast<std::size_t>(*part)]);
      if (!way) continue;
      plan.paths[static_cast<std::size_t>(*part)] = std::move(*way);
      take_out(*part);
      found = true;
      break;
    }
    if (!found) return std::nullopt;
  }
  return plan;
}

}  // namespace packmerger
