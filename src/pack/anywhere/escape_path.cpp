#include "pack/anywhere/escape_path.h"

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

namespace packmerger {
namespace {

constexpr std::size_t kMostPositions = 4000;

// Heights at which the part is free at one position: from `first` to the one after `last`, in
// samples.
struct Stretch {
  int x = 0;
  int y = 0;
  int first = 0;
  int last = 0;
  int parent = -1;
};

class Flood {
 public:
  Flood(const SolidTray& rest, const SolidPlace& place)
      : rest_(rest),
        place_(place),
        reach_(grown(place.part->matter, rest.grid(), kEscapeClearance_mm)) {
    int reach_low = 0;
    for (const SpanCell& cell : reach_) reach_low = std::min<int>(reach_low, cell.low);
    highest_ = rest.top() - reach_low;
    while ((highest_ >> shift_) + 1 >= TakenHeights::kCount) ++shift_;
    count_ = (highest_ >> shift_) + 2;
    xs_ = inside_tray(place.part->box, rest.grid().build_mm, rest.grid().cell_mm, 0);
    ys_ = inside_tray(place.part->box, rest.grid().build_mm, rest.grid().cell_mm, 1);
  }

  std::optional<std::vector<Vec3>> run() {
    std::deque<int> open = starts();
    if (straight_up_) return std::vector<Vec3>{};
    while (!open.empty() && seen_.size() < kMostPositions) {
      const int at = open.front();
      open.pop_front();
      for (const auto& [dx, dy] :
           {std::pair{1, 0}, std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}}) {
        const Stretch from = stretches_[static_cast<std::size_t>(at)];
        const int x = from.x + dx;
        const int y = from.y + dy;
        if (x < xs_.first || x > xs_.last || y < ys_.first || y > ys_.last) continue;
        if (!place_.part->barred.empty() && place_.part->barred.at(x, y)) continue;
        for (const int next : stretches_at(x, y)) {
          Stretch& to = stretches_[static_cast<std::size_t>(next)];
          if (to.parent >= -1 || to.last < from.first || to.first > from.last) continue;
          to.parent = at;
          if (to.last == count_ - 1) return steps_to(next);
          open.push_back(next);
        }
      }
    }
    return std::nullopt;
  }

 private:
  static constexpr int kUnreached = -2;

  // The stretches that the part reaches by moving up and down where it stands.
  std::deque<int> starts() {
    std::deque<int> open;
    const std::vector<FreeHeights> free = rest_.free_heights(reach_, place_.x, place_.y);
    const auto here = std::find_if(free.begin(), free.end(), [&](const FreeHeights& heights) {
      return heights.low <= place_.z && place_.z <= heights.high;
    });
    if (here == free.end()) return open;
    straight_up_ = here->high == kUpAndAway;
    for (const int index : stretches_at(place_.x, place_.y)) {
      Stretch& stretch = stretches_[static_cast<std::size_t>(index)];
      if (stretch.first << shift_ < here->low || (stretch.last + 1) << shift_ > here->high)
        continue;
      stretch.parent = -1;
      open.push_back(index);
    }
    return open;
  }

  const std::vector<int>& stretches_at(int x, int y) {
    const auto [entry, is_new] = seen_.try_emplace({x, y});
    if (!is_new) return entry->second;
    TakenHeights taken;
    rest_.meetings(reach_, x, y, [&](int low, int high) {
      taken.take_ways_between(low, high, shift_);
      return true;
    });
    for (int first = taken.next_free(0); first < count_;) {
      int last = first;
      while (last + 1 < count_ && !taken.taken(last + 1)) ++last;
      entry->second.push_back(static_cast<int>(stretches_.size()));
      stretches_.push_back({x, y, first, last, kUnreached});
      if (last + 1 >= count_) break;
      first = taken.next_free(last + 1);
    }
    return entry->second;
  }

  std::vector<Vec3> steps_to(int end) const {
    std::vector<Stretch> way;
    for (int at = end; at != -1; at = way.back().parent)
      way.push_back(stretches_[static_cast<std::size_t>(at)]);
    std::reverse(way.begin(), way.end());
    std::vector<Vec3> steps;
    const SolidGrid& grid = rest_.grid();
    const auto add = [&steps](const Vec3& step) {
      if (!steps.empty() && steps.back().normalized().isApprox(step.normalized(), 1e-9))
        steps.back() += step;
      else
        steps.push_back(step);
    };
    int z = place_.z;
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      const int low = std::max(way[i].first, way[i + 1].first) << shift_;
      const int high = (std::min(way[i].last, way[i + 1].last) + 1) << shift_;
      const int next_z = std::clamp(z, low, high);
      if (next_z != z) add(Vec3(0, 0, (next_z - z) * grid.unit_mm));
      z = next_z;
      add(Vec3((way[i + 1].x - way[i].x) * grid.cell_mm, (way[i + 1].y - way[i].y) * grid.cell_mm,
               0));
    }
    return steps;
  }

  const SolidTray& rest_;
  const SolidPlace& place_;
  std::vector<SpanCell> reach_;
  int highest_ = 0;
  int shift_ = 0;
  int count_ = 0;  // samples; the last lies above everything
  Range xs_;
  Range ys_;
  bool straight_up_ = false;
  std::map<std::pair<int, int>, std::vector<int>> seen_;  // indices into stretches_
  std::vector<Stretch> stretches_;
};

}  // namespace

std::optional<std::vector<Vec3>> escape_path(const SolidTray& rest, const SolidPlace& place) {
  return Flood(rest, place).run();
}

}  // namespace packmerger
