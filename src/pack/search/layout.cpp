#include "pack/search/layout.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace packmerger {

int Layout::parts() const {
  return std::accumulate(trays.begin(), trays.end(), 0, [](int sum, const auto& tray) {
    return sum + static_cast<int>(tray->placed.size());
  });
}

namespace {

double unrest(const FilledTray& tray, double unit_mm) {
  double sum = 0;
  for (const Placed& placed : tray.placed) {
    if (placed.off_grid) continue;
    const double top_mm = (placed.z + placed.rotated->rise) * unit_mm;
    sum += placed.part->volume_mm3 * top_mm * top_mm;
  }
  return sum;
}

}  // namespace

bool is_better(const Layout& a, const Layout& b) {
  return std::tuple(a.trays.size(), a.cost, a.unrest) <
         std::tuple(b.trays.size(), b.cost, b.unrest);
}

std::vector<Task> kept(const FilledTray& tray) {
  std::vector<Task> tasks;
  for (const Placed& placed : tray.placed)
    tasks.push_back({placed.part, placed.rotated, {placed.x, placed.x}, {placed.y, placed.y}});
  return tasks;
}

bool Layouter::put(FilledTray& tray, const Task& task, const RotationChoice& rotations,
                   bool on_plate_only) const {
  if (tray.closed) return false;
  const std::vector<const RotatedPart*> tried =
      task.rotated ? std::vector{task.rotated} : rotations(*task.part);
  const std::optional<Spot> spot =
      best_spot(tray.state, tried, task.part->volume_mm3, spec_, {on_plate_only, task.x, task.y});
  if (!spot) return false;
  const RotatedPart* rotated = tried[static_cast<std::size_t>(spot->rotation)];
  tray.state.put(*rotated, spot->x, spot->y, spot->z, spot->support_mm3, task.part->volume_mm3,
                 spec_);
  tray.placed.push_back({task.part, rotated, spot->x, spot->y, spot->z, false});
  return true;
}

bool Layouter::put_near(FilledTray& tray, Task task, const RotationChoice& rotations,
                        bool on_plate_only) const {
  const int most = std::max(spec_.columns(), spec_.rows());
  const auto widened = [](const Range& window) {
    return Range{window.first - window.count(), window.last + window.count()};
  };
  while (!put(tray, task, rotations, on_plate_only)) {
    if (!task.stays_near || std::min(task.x.count(), task.y.count()) > 2 * most) return false;
    task.x = widened(task.x);
    task.y = widened(task.y);
  }
  return true;
}

void Layouter::put_off_grid(FilledTray& tray, const Part& part) const {
  const WayUp& way = part.ways.front();
  tray.closed = true;
  tray.placed.push_back({&part, nullptr, 0, 0, 0, true});
  tray.state.contents = Box3(Vec3::Zero(), way.size_mm);
  tray.state.support_mm3 = way.support_mm3;
  tray.state.material_mm3 = part.volume_mm3;
  tray.state.parts = 1;
}

double Layouter::bound(const std::vector<std::shared_ptr<FilledTray>>& trays) const {
  double sum = 0;
  for (const auto& tray : trays) sum += spec_.cost->lower_bound(tray->state.measure());
  return sum;
}

std::optional<Layout> Layouter::carried_out(const Draft& draft, const RotationChoice& rotations,
                                            double give_up_above, bool on_plate_only) const {
  std::vector<std::shared_ptr<FilledTray>> trays;
  std::vector<Task> loose;
  for (const Draft::Tray& wanted : draft.trays) {
    if (wanted.unchanged) {
      trays.push_back(std::make_shared<FilledTray>(*wanted.unchanged));
      continue;
    }
    auto tray = std::make_shared<FilledTray>(spec_);
    for (const Task& task : wanted.tasks)
      if (!put_near(*tray, task, rotations, on_plate_only)) loose.push_back({task.part});
    if (!tray->placed.empty()) trays.push_back(std::move(tray));
    if (bound(trays) > give_up_above) return std::nullopt;
  }
  loose.insert(loose.end(), draft.loose.begin(), draft.loose.end());
  for (const Task& task : loose) {
    const bool found = std::any_of(trays.begin(), trays.end(), [&](const auto& tray) {
      return put(*tray, task, rotations, on_plate_only);
    });
    if (!found) {
      trays.push_back(std::make_shared<FilledTray>(spec_));
      if (!put(*trays.back(), task, rotations, on_plate_only))
        put_off_grid(*trays.back(), *task.part);
    }
    if (bound(trays) > give_up_above) return std::nullopt;
  }
  Layout layout;
  for (const auto& tray : trays) {
    layout.cost += spec_.cost->evaluate(tray->state.measure());
    layout.unrest += unrest(*tray, spec_.grid.unit_mm);
    layout.trays.push_back(tray);
  }
  return layout;
}

}  // namespace packmerger
