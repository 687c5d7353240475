#include "bench/packing_table/instances.h"

#include <cmath>
#include <utility>

#include "bench/mixed_parts.h"
#include "bench/models.h"
#include "bench/packing_table/functional_parts.h"
#include "bench/packing_table/hull_part.h"
#include "bench/packing_table/solids.h"
#include "job/choose_division.h"
#include "job/pack_models.h"
#include "shape/cut/cut_plans.h"
#include "shape/divide/premerge.h"
#include "unit/pack/shapes.h"

namespace packmerger::bench {
namespace {

constexpr double kShellRadius_mm = 50;
constexpr double kShellWall_mm = 3;
constexpr int kPatches = 6;
constexpr int kFacets = 24;  // along a patch's edge

constexpr double kBunnyPartsLongest_mm = 100;
constexpr int kBunnyParts = 8;

constexpr double kPartPrice = 0.02;  // of the matter's volume: what a part more must save at least

PackItem item_of(Mesh surface, int model) {
  PackItem item;
  item.volume_mm3 = volume_mm3(surface);
  item.surface = std::move(surface);
  item.model = model;
  return item;
}

std::vector<PackItem> copies(const Mesh& surface, int count) {
  std::vector<PackItem> items;
  for (int i = 0; i < count; ++i) items.push_back(item_of(surface, i));
  return items;
}

}  // namespace

PackProblem height_problem(std::vector<PackItem> items, const Vec3& build_mm, double gap_mm) {
  PackProblem problem;
  problem.items = std::move(items);
  problem.build_mm = build_mm;
  problem.gap_mm = gap_mm;
  problem.grid_mm = 1;
  problem.search_grid_mm = 2;
  problem.rotation_step = radians(90);
  problem.cost.evaluate = [](const TrayMeasure& tray) { return tray.size_mm.z(); };
  problem.cost.lower_bound = problem.cost.evaluate;
  return problem;
}

PackProblem mixed_problem(std::uint64_t instance) {
  return height_problem(mixed_items(28, instance), {100, 100, 150}, 0);
}

PackProblem functional_problem(std::uint64_t instance) {
  return height_problem(functional_items(instance), {150, 110, 200}, 1);
}

PackProblem powder_problem(std::uint64_t instance) {
  constexpr double kGap_mm = 1;
  const Vec3 room_mm = Vec3(165, 165, 300) - Vec3::Constant(2 * kGap_mm);
  return height_problem(mixed_items(60, instance), room_mm, kGap_mm);
}

PackProblem nested_problem() {
  std::vector<PackItem> items;
  for (int face = 0; face < kPatches; ++face)
    items.push_back(
        item_of(shapes::sphere_patch(kShellRadius_mm, kShellWall_mm, face, kFacets), face));
  PackProblem problem = height_problem(std::move(items), {72, 72, 200}, 0);
  problem.search_grid_mm = 3;
  return problem;
}

// Two spheres' sides, raised by d against one another, meet first at a corner c of the inner side:
// |c + d·up| = R, where c lies r / √3 along up.
double nested_height_mm() {
  const double inner = kShellRadius_mm - kShellWall_mm;
  const double corner = inner / std::sqrt(3.0);
  const double spacing =
      std::sqrt(corner * corner + kShellRadius_mm * kShellRadius_mm - inner * inner) - corner;
  return kShellRadius_mm - corner + (kPatches - 1) * spacing;
}

PackProblem hull_problem(int count) {
  return height_problem(copies(hull_part(), count), {165, 165, 320}, 1);
}

PackProblem bunny_parts_problem() {
  Profile profile = read_profile("objet30");
  profile.shape.parts = kBunnyParts;
  const Mesh bunny = scaled(bunny_model(), kBunnyPartsLongest_mm / kBunnyLongest_mm);
  Warnings warnings;
  const auto divided = std::make_shared<const Divided>(
      choose_division(bunny, profile, true, 1, warnings, Progress()));
  const Arrangement job = pack_models({divided}, profile, 1, 0, Progress());
  std::vector<PackItem> items;
  for (const JobPart& part : job.parts)
    items.push_back(item_of(part.surface, static_cast<int>(items.size())));
  return height_problem(std::move(items), {110, 110, 150}, 1);
}

std::shared_ptr<const Divided> planned_division(const Mesh& model, const Profile& profile) {
  Warnings warnings;
  auto divided = std::make_shared<Divided>(undivided(model, profile, true, warnings, Progress()));
  CutSearch search;
  search.support_angle = radians(profile.support_angle_deg);
  search.part_price_mm3 = kPartPrice * total_volume_mm3(divided->tets);
  const BuildVolume build = build_volume(profile);
  const auto plans = cut_plans(divided->tets, profile.shape, build, search, 1, Progress());
  if (plans.empty()) {
    divide_by_clusters(*divided, profile, 1, warnings, Progress());
    return divided;
  }
  const Segments cut = cut_as_planned(divided->tets, plans.front(), Progress());
  divided->clusters = cut.count;
  divided->segments = premerge(divided->tets, cut, profile.shape, build, warnings, Progress());
  return divided;
}

PackProblem growth_problem(int count, bool all_alike, std::uint64_t instance) {
  PackProblem problem = packing_problem({}, read_profile("objet30"), 1, 0);
  problem.items =
      all_alike ? copies(shapes::l_shape(22, 5, 12), count) : mixed_items(count, instance);
  return problem;
}

}  // namespace packmerger::bench
