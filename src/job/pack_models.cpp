#include "job/pack_models.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "job/promises.h"
#include "pack/pack.h"
#include "printers/estimate/packing_cost.h"
#include "shape/divide/adjacency.h"
#include "shape/divide/manifold_parts.h"
#include "shape/divide/part_surface.h"

namespace packmerger {
namespace {

using Models = std::vector<std::shared_ptr<const Divided>>;

// The first item of each model; items of a model are its segments in order, or the whole model.
std::vector<int> first_items(const Models& models) {
  std::vector<int> first{0};
  for (const auto& model : models)
    first.push_back(first.back() + (model->tets.count() > 0 ? model->segments.count : 1));
  return first;
}

// The parts' surfaces after the packer's merges, and the glue between them. `placed` lists the
// parts of one divided model as indices into packing.parts; results are written into parts by that
// index.
void extract_parts(const Divided& model, int first_item, const std::vector<int>& placed,
                   const Packing& packing, std::vector<JobPart>& parts, const Progress& progress) {
  std::vector<std::vector<int>> groups;
  for (const int index : placed) {
    std::vector<int> group = packing.parts[index].items;
    for (int& item : group) item -= first_item;
    groups.push_back(std::move(group));
  }
  TetMesh tets = model.tets;
  Segments merged = united(model.segments, groups);
  make_manifold(tets, merged, progress);
  std::vector<SegmentSurface> surfaces = part_surfaces(tets, merged);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    parts[placed[i]].surface = std::move(surfaces[i].surface);
    parts[placed[i]].volume_mm3 = surfaces[i].volume_mm3;
  }
  for (const SegmentEdge& edge : adjacency(tets, merged)) {
    parts[placed[edge.a]].neighbours.push_back({parts[placed[edge.b]].id, edge.area_mm2});
    parts[placed[edge.b]].neighbours.push_back({parts[placed[edge.a]].id, edge.area_mm2});
  }
}

// room: the packer's tray within the printer's.
Arrangement arrange(const Models& models, const PackProblem& problem, const Packing& packing,
                    const Room& room, const Progress& progress) {
  const std::vector<int> first = first_items(models);
  Arrangement arrangement;
  arrangement.trays = static_cast<int>(packing.trays.size());
  std::vector<std::vector<int>> placed(models.size());
  for (int i = 0; i < static_cast<int>(packing.parts.size()); ++i) {
    const PlacedPart& from = packing.parts[i];
    JobPart part;
    part.id = i + 1;
    part.model = problem.items[from.items.front()].model;
    part.tray = from.tray + 1;
    part.pose = from.pose;
    part.pose.pretranslate(room.corner_mm);
    placed[part.model].push_back(i);
    arrangement.parts.push_back(std::move(part));
  }
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (models[m]->tets.count() > 0) {
      extract_parts(*models[m], first[m], placed[m], packing, arrangement.parts, progress);
    } else {
      JobPart& whole = arrangement.parts[placed[m].front()];
      whole.surface = problem.items[first[m]].surface;
      whole.volume_mm3 = problem.items[first[m]].volume_mm3;
    }
  }
  for (const int index : packing.removal_order)
    arrangement.removal_order.push_back(arrangement.parts[index].id);
  for (std::size_t i = 0; i < packing.removal_paths.size(); ++i)
    if (!packing.removal_paths[i].empty())
      arrangement.removal_paths[arrangement.parts[i].id] = packing.removal_paths[i];
  return arrangement;
}

// Sliced trays stand in the middle of the plate, where no clip, edge or priming line is in the way,
// or as far towards it as the plate's walls let them. What is handed over is moved by the maker's
// program as it likes.
void centre(Arrangement& arrangement, const Profile& profile, const Plate& plate) {
  if (!profile.is_sliced()) return;
  std::vector<Box3> contents(arrangement.trays);
  for (const JobPart& part : arrangement.parts)
    contents[part.tray - 1].extend(bounding_box(transformed(part.surface, part.pose)));
  for (int tray = 1; tray <= arrangement.trays; ++tray) {
    Vec3 to_middle = profile.build() / 2 - contents[tray - 1].center();
    to_middle.z() = 0;
    const auto all_clear = [&](const Vec3& shift) {
      return std::all_of(
          arrangement.parts.begin(), arrangement.parts.end(), [&](const JobPart& part) {
            return part.tray != tray ||
                   plate.breach_mm(part.surface, Eigen::Translation3d(shift) * part.pose) <=
                       kWallTolerance_mm;
          });
    };
    Vec3 shift = Vec3::Zero();
    for (const double share : {1.0, 0.75, 0.5, 0.25})
      if (shift.isZero() && all_clear(share * to_middle)) shift = share * to_middle;
    for (JobPart& part : arrangement.parts)
      if (part.tray == tray) part.pose.pretranslate(shift);
  }
}

// Turning segments into parts may move a cut by a little, so a part may stand a little too deep.
void lift_above_plate(Arrangement& arrangement, const Room& room) {
  for (JobPart& part : arrangement.parts) {
    const double lowest =
        bounding_box(transformed(part.surface, part.pose)).min().z() - room.corner_mm.z();
    if (lowest < 0) part.pose.pretranslate(Vec3(0, 0, -lowest));
  }
}

// As many as the profile asks for of each model that is divided for the printer; the paper's
// clusters merge as it pays.
int most_parts(const Models& models, const Profile& profile) {
  if (profile.shape.segmentation == Segmentation::kPaper) return 0;
  int most = 0;
  for (const auto& model : models) most += model->tets.count() > 0 ? profile.shape.parts : 1;
  return most;
}

}  // namespace

PackProblem packing_problem(const Models& models, const Profile& profile, std::uint64_t seed,
                            double budget_s) {
  PackProblem problem;
  for (int m = 0; m < static_cast<int>(models.size()); ++m) {
    const Divided& model = *models[m];
    if (model.tets.count() == 0) {
      problem.items.push_back({shell_surface(model.shell), model.shell.volume_mm3, m});
      continue;
    }
    const int first = static_cast<int>(problem.items.size());
    for (SegmentSurface& segment : part_surfaces(model.tets, model.segments))
      problem.items.push_back({std::move(segment.surface), segment.volume_mm3, m});
    for (const SegmentEdge& edge : adjacency(model.tets, model.segments))
      problem.edges.push_back({edge.a + first, edge.b + first, edge.area_mm2});
    for (std::vector<int>& round_it : segments_round_cavities(model.tets, model.segments)) {
      for (int& item : round_it) item += first;
      problem.enclosures.push_back(std::move(round_it));
    }
  }
  const Room room = room_of(profile);
  problem.build_mm = room.size_mm;
  problem.plate = room.plate.drawn_in(room.corner_mm.head<2>(), 0);
  problem.gap_mm = std::max(profile.pack.gap_mm, kLeastGap_mm);
  problem.grid_mm = profile.pack.grid_mm;
  problem.rotation_step = radians(profile.pack.rotation_step_deg);
  problem.support_angle = radians(profile.support_angle_deg);
  problem.search_grid_mm = profile.pack.search_grid_mm;
  problem.cost = packing_cost(profile);
  problem.anywhere = profile.pack.placement == Placement::kAnywhere;
  problem.tabu_memory = profile.pack.tabu_memory;
  problem.tabu_patience = profile.pack.tabu_patience;
  problem.tabu_samples = profile.pack.tabu_samples;
  problem.most_parts = most_parts(models, profile);
  problem.budget_s = budget_s;
  problem.seed = seed;
  return problem;
}

Arrangement pack_models(const Models& models, const Profile& profile, std::uint64_t seed,
                        double budget_s, const Progress& progress) {
  PackProblem problem = packing_problem(models, profile, seed, budget_s);
  const Room room = room_of(profile);
  std::optional<BrokenPromise> broken;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const Packing packing = pack(problem, progress);
    Arrangement arrangement = arrange(models, problem, packing, room, progress);
    lift_above_plate(arrangement, room);
    centre(arrangement, profile, room.plate);
    broken = broken_promise(arrangement, profile.pack.gap_mm, room, progress);
    if (!broken) return arrangement;
    problem.gap_mm += broken->missing_mm + 0.05;
    problem.build_mm -= Vec3::Constant(broken->missing_mm);
    problem.plate = problem.plate.drawn_in(Vec2(0, 0), broken->missing_mm);
  }
  throw Error(Fault::kInternal, broken->what + ", and another layout did not help",
              "Try another --seed, or a finer --set grid_mm, and report this model.");
}

}  // namespace packmerger
