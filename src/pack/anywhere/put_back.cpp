#include "pack/anywhere/put_back.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pack/anywhere/disassembly_order.h"

namespace packmerger {
namespace {

constexpr double kSampling = 0.005;       // of a cost: what two grids may differ in support
constexpr int kSettleCells = 2;           // coarse: samples let parts in where bounds do not quite
constexpr std::size_t kCoveredTried = 4;  // places below something

}  // namespace

PutBack::Scene PutBack::fine_scene(const std::vector<StandingPart>& parts) {
  Scene scene;
  for (const StandingPart& one : parts) {
    scene.drawings.push_back(solids_.fine(one.part, one.attitude));
    scene.places.push_back({scene.drawings.back().get(), one.x, one.y, one.z});
  }
  return scene;
}

PutBack::Scene PutBack::coarse_scene(const std::vector<StandingPart>& parts) {
  Scene scene;
  const int ratio = solids_.ratio();
  for (const StandingPart& one : parts) {
    scene.drawings.push_back(coarse_of(one));
    scene.places.push_back({scene.drawings.back().get(), one.x / ratio, one.y / ratio, one.z});
  }
  return scene;
}

std::shared_ptr<const SolidPart> PutBack::coarse_of(const StandingPart& part) {
  return solids_.coarse(part.part, part.attitude, part.x % solids_.ratio(),
                        part.y % solids_.ratio());
}

TrayMeasure PutBack::measure(const SolidTray& tray, const std::vector<StandingPart>& parts) const {
  TrayMeasure measure;
  if (parts.empty()) return measure;
  const Vec3 size = tray.contents().sizes();
  measure.size_mm = Vec3(size.x(), size.y(), tray.contents().max().z());
  measure.support_mm3 = tray.support_mm3();
  for (const StandingPart& one : parts) measure.material_mm3 += volume(one.part);
  measure.parts = static_cast<int>(parts.size());
  return measure;
}

Arranged PutBack::rated(std::vector<StandingPart> parts) {
  int lowest = std::numeric_limits<int>::max();
  for (const StandingPart& part : parts) lowest = std::min(lowest, part.z);
  Arranged arranged;
  for (StandingPart& part : parts) {
    part.z -= lowest;
    const double top_mm = top(part) * coarse_.unit_mm;
    arranged.unrest += volume(part.part) * top_mm * top_mm;
  }
  const Scene scene = coarse_scene(parts);
  arranged.cost = problem_.cost.evaluate(measure(SolidTray(coarse_, scene.places), parts));
  arranged.parts = std::move(parts);
  return arranged;
}

std::optional<StandingPart> PutBack::anywhere(
    const std::vector<StandingPart>& rest, int part,
    const std::vector<std::shared_ptr<const Attitude>>& attitudes, double most_cost) {
  const Scene scene = coarse_scene(rest);
  const SolidTray tray(coarse_, scene.places);
  const TrayMeasure before = measure(tray, rest);
  std::vector<std::shared_ptr<const SolidPart>> drawings;
  std::vector<const SolidPart*> rotations;
  for (const auto& attitude : attitudes) {
    drawings.push_back(solids_.coarse(part, attitude, 0, 0));
    rotations.push_back(drawings.back().get());
  }
  SolidRules rules;
  rules.give_up_above = most_cost;
  rules.most = kCoveredTried;
  const std::vector<SolidSpot> spots =
      solid_spots(tray, before, rotations, volume(part), problem_.cost, rules);
  if (spots.empty()) return std::nullopt;
  const Scene standing = fine_scene(rest);
  const int ratio = solids_.ratio();
  for (const SolidSpot& spot : spots) {
    const StandingPart near{part, attitudes[static_cast<std::size_t>(spot.rotation)],
                            spot.x * ratio, spot.y * ratio, spot.z};
    const auto put = settled(standing.places, before, near, most_cost);
    if (put) return put;
  }
  return std::nullopt;
}

std::optional<StandingPart> PutBack::nearby(const std::vector<StandingPart>& rest,
                                            const StandingPart& part, double most_cost) {
  const Scene scene = coarse_scene(rest);
  const SolidTray tray(coarse_, scene.places);
  return settled(fine_scene(rest).places, measure(tray, rest), part, most_cost);
}

std::optional<StandingPart> PutBack::settled(const std::vector<SolidPlace>& rest,
                                             const TrayMeasure& before, const StandingPart& near,
                                             double most_cost) {
  const std::shared_ptr<const SolidPart> drawing = solids_.fine(near.part, near.attitude);
  SolidRules rules;
  const int reach = kSettleCells * solids_.ratio();
  rules.x = {near.x - reach, near.x + reach};
  rules.y = {near.y - reach, near.y + reach};
  rules.give_up_above = most_cost + kSampling * std::abs(most_cost);
  const auto window = [&](const Range& positions, int axis) {
    const int stands_out = fine_.growth() + 1;
    return Range{
        positions.first - stands_out,
        positions.last + stands_out + static_cast<int>(drawing->box.max()[axis] / fine_.cell_mm)};
  };
  const SolidTray tray(fine_, rest, {window(rules.x, 0), window(rules.y, 1)});
  const std::array<const SolidPart*, 1> one{drawing.get()};
  for (const SolidSpot& spot :
       solid_spots(tray, before, one, volume(near.part), problem_.cost, rules)) {
    if (!spot.open) {
      std::vector<SolidPlace> all = rest;
      all.push_back({drawing.get(), spot.x, spot.y, spot.z});
      if (!disassembly_order(fine_, all)) continue;
    }
    return StandingPart{near.part, near.attitude, spot.x, spot.y, spot.z};
  }
  return std::nullopt;
}

}  // namespace packmerger
