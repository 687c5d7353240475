#include "pack/anywhere/disassembly_order.h"

#include <algorithm>

#include "pack/anywhere/escape_path.h"

namespace packmerger {
namespace {

// Whether b stands above some matter of a, so that a cannot be lifted before it.
bool blocks(const SolidPlace& a, const SolidPlace& b) {
  const Outline& lower = a.part->outline;
  const Outline& upper = b.part->outline;
  const int ax = a.x + lower.x0;
  const int ay = a.y + lower.y0;
  const int bx = b.x + upper.x0;
  const int by = b.y + upper.y0;
  const int first = std::max(ax, bx);
  const int count = std::min(ax + lower.width, bx + upper.width) - first;
  const int last_row = std::min(ay + lower.height, by + upper.height) - 1;
  if (count <= 0) return false;
  const int rise = b.z - a.z;
  for (int y = std::max(ay, by); y <= last_row; ++y) {
    const Height* low = &lower.low[static_cast<std::size_t>((y - ay) * lower.width + first - ax)];
    const Height* top = &upper.top[static_cast<std::size_t>((y - by) * upper.width + first - bx)];
    int over = 0;  // counted without a branch, so that many cells are compared at once
    for (int i = 0; i < count; ++i) over += top[i] + rise > low[i];
    if (over > 0) return true;
  }
  return false;
}

std::vector<std::vector<bool>> blocking(const std::vector<SolidPlace>& places) {
  std::vector<std::vector<bool>> result(places.size(), std::vector<bool>(places.size(), false));
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < places.size(); ++b)
      if (a != b) result[a][b] = blocks(places[a], places[b]);
  return result;
}

}  // namespace

std::optional<DisassemblyOrder> disassembly_order(const SolidGrid& grid,
                                                  const std::vector<SolidPlace>& places) {
  const std::vector<std::vector<bool>> blocked_by = blocking(places);
  DisassemblyOrder plan;
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
        return blocked_by[static_cast<std::size_t>(part)][static_cast<std::size_t>(other)];
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
      auto way = escape_path(rest, places[static_cast<std::size_t>(*part)]);
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
