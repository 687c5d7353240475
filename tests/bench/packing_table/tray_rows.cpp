// The rows that end in a tray.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "bench/models.h"
#include "bench/packing_table/instances.h"
#include "bench/packing_table/paper_packer.h"
#include "bench/packing_table/table_case.h"
#include "bench/packing_table/tray_check.h"
#include "bench/packing_table/tray_rows.h"
#include "bench/stopwatch.h"
#include "job/pack_models.h"
#include "model/stl.h"
#include "pack/pack.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSeeds = 5;
constexpr int kFirstHulls = 140;

void write_trays(const std::string& name, const PackProblem& problem, const Packing& packing,
                 const RunSettings& settings) {
  if (settings.trays.empty()) return;
  int number = 0;
  for (const std::vector<Mesh>& tray : standing_parts(problem, packing)) {
    std::vector<const Mesh*> parts;
    for (const Mesh& part : tray) parts.push_back(&part);
    write_file_whole(
        settings.trays / fmt::format("{}.{}.{}.tray_{}.stl", name, settings.seeds.instance,
                                     settings.seeds.search, ++number),
        binary_stl(parts));
  }
}

Json check_json(const TrayCheck& check) {
  return {{"apart_mm", check.apart_mm},
          {"outside_mm", std::max(0.0, check.outside_mm)},
          {"straight_up", check.straight_up},
          {"by_path", check.by_path},
          {"broken", check.broken}};
}

// The same packer on one thread, which is what the others have.
Packing packed_on_one_thread(const PackProblem& problem) {
  const ThreadLimit one_thread(1);
  return pack(problem, {});
}

double support_cm3(const Packing& packing) {
  double sum = 0;
  for (const TrayMeasure& tray : packing.trays) sum += tray.support_mm3 / 1000;
  return sum;
}

struct HeightRow {
  std::string name;
  std::string what;
  std::string aim;
  double budget_s;
  std::function<PackProblem(std::uint64_t instance)> problem;
};

Json sampled_run(const HeightRow& row, const RunSettings& settings) {
  const PackProblem problem = row.problem(settings.seeds.instance);
  const Stopwatch watch;
  const SampledAnswer answer = paper_sampled(problem, row.budget_s, settings.seeds.search);
  Json run = timed_run(watch);
  double volume = 0;
  for (const PackItem& item : problem.items) volume += item.volume_mm3;
  run["figures"] = {
      {"height_mm", answer.cost},
      {"density", volume / (problem.build_mm.x() * problem.build_mm.y() * answer.cost)}};
  return run;
}

Json apart_run(const HeightRow& row, const RunSettings& settings) {
  const PackProblem problem = row.problem(settings.seeds.instance);
  const Stopwatch watch;
  const ApartAnswer answer = paper_apart(problem, row.budget_s, settings.seeds.search);
  Json run = timed_run(watch);
  const TrayCheck check = check_packing(problem, answer.packing);
  run["figures"] = {{"height_mm", check.height_mm}, {"density", check.density}};
  run["check"] = check_json(check);
  write_trays(row.name + ".paper-apart", problem, answer.packing, settings);
  return run;
}

void add_height_row(const HeightRow& row, std::vector<TableCase>& cases) {
  const auto add = [&](const std::string& packer, auto measure) {
    cases.push_back({row.name, packer, row.what, row.aim, kSeeds, row.budget_s, measure});
  };
  for (const bool anywhere : {false, true})
    add(anywhere ? "anywhere" : "drop", [row, anywhere](const RunSettings& settings) {
      return height_run(row.name + (anywhere ? ".anywhere" : ".drop"),
                        row.problem(settings.seeds.instance), anywhere, row.budget_s, settings);
    });
  add("paper", [row](const RunSettings& settings) { return sampled_run(row, settings); });
  add("paper-apart", [row](const RunSettings& settings) { return apart_run(row, settings); });
}

Json nested_run(const RunSettings& settings) {
  PackProblem problem = nested_problem();
  problem.seed = settings.seeds.search;
  const Stopwatch watch;
  const Packing packing = pack(problem, {});
  Json run = timed_run(watch);
  const TrayCheck check = check_packing(problem, packing);
  run["figures"] = {{"height_mm", check.height_mm},
                    {"height_ratio", check.height_mm / nested_height_mm()}};
  run["check"] = check_json(check);
  write_trays("sphere6", problem, packing, settings);
  return run;
}

// By the printer's own objective, with its defaults.
Json segments_run(const std::string& name, const Mesh& model, bool anywhere,
                  const RunSettings& settings) {
  const Profile profile = read_profile("objet30");
  PackProblem problem =
      packing_problem({planned_division(model, profile)}, profile, settings.seeds.search, 0);
  problem.anywhere = anywhere;
  const Stopwatch watch;
  const Packing packing = pack(problem, {});
  Json run = timed_run(watch);
  const TrayCheck check = check_packing(problem, packing);
  run["figures"] = {{"cost", packing.cost},
                    {"parts", packing.parts.size()},
                    {"height_mm", check.height_mm},
                    {"support_cm3", support_cm3(packing)}};
  run["check"] = check_json(check);
  write_trays(name, problem, packing, settings);
  return run;
}

// The parts of the fullest tray, by themselves.
Packing fullest_tray(const Packing& packing) {
  std::size_t fullest = 0;
  for (std::size_t i = 1; i < packing.trays.size(); ++i)
    if (packing.trays[i].parts > packing.trays[fullest].parts) fullest = i;
  Packing one;
  std::vector<int> numbers(packing.parts.size(), -1);
  for (std::size_t i = 0; i < packing.parts.size(); ++i) {
    if (packing.parts[i].tray != static_cast<int>(fullest)) continue;
    numbers[i] = static_cast<int>(one.parts.size());
    one.parts.push_back(packing.parts[i]);
    one.parts.back().tray = 0;
    one.parts.back().items = {numbers[i]};
    one.removal_paths.push_back(packing.removal_paths[i]);
  }
  for (const int part : packing.removal_order)
    if (const int number = numbers[static_cast<std::size_t>(part)]; number >= 0)
      one.removal_order.push_back(number);
  return one;
}

// How many copies the packer brings into the volume: more are given to it than one tray holds.
Json hulls_run(const RunSettings& settings) {
  constexpr double kBudget_s = 10;
  for (int given = kFirstHulls;; given *= 2) {
    PackProblem problem = hull_problem(given);
    problem.budget_s = kBudget_s;
    problem.seed = settings.seeds.search;
    const Stopwatch watch;
    const Packing packing = pack(problem, {});
    Json run = timed_run(watch);
    if (packing.trays.size() == 1) continue;
    const Packing one = fullest_tray(packing);
    problem.items.resize(one.parts.size());
    const TrayCheck check = check_packing(problem, one);
    run["figures"] = {{"copies", one.parts.size()},
                      {"density", check.volume_mm3 / problem.build_mm.prod()}};
    run["check"] = check_json(check);
    write_trays("hulls", problem, one, settings);
    return run;
  }
}

}  // namespace

Json height_run(const std::string& name, PackProblem problem, bool anywhere, double budget_s,
                const RunSettings& settings) {
  problem.anywhere = anywhere;
  problem.budget_s = budget_s;
  problem.seed = settings.seeds.search;
  const Stopwatch watch;
  const Packing packing = packed_on_one_thread(problem);
  Json run = timed_run(watch);
  const TrayCheck check = check_packing(problem, packing);
  run["figures"] = {{"height_mm", check.height_mm},
                    {"density", check.density},
                    {"trays", packing.trays.size()},
                    {"support_cm3", support_cm3(packing)}};
  run["check"] = check_json(check);
  write_trays(name, problem, packing, settings);
  return run;
}

std::vector<TableCase> tray_rows() {
  std::vector<TableCase> cases;
  for (const double budget_s : {10.0, 60.0})
    add_height_row(
        {fmt::format("mixed-{:g}", budget_s),
         fmt::format("28 mixed parts, 100 × 100 mm, no gap, one thread, {:g} s", budget_s),
         budget_s < 60 ? "density 47 %" : "density 49.5 %, stretch 51.5 %", budget_s,
         mixed_problem},
        cases);
  add_height_row({"functional", "60 functional parts, 150 × 110 mm, 1 mm gap, one thread, 30 s",
                  "density 36.5 %, 0.63 of `drop`'s height", 30, functional_problem},
                 cases);
  add_height_row(
      {"powder",
       "60 mixed parts in powder, 165 × 165 × 300 mm, 1 mm to each other and to the walls, one "
       "thread, 30 s",
       "told", 30, powder_problem},
      cases);
  const auto bunny_parts = [](std::uint64_t) {
    static const PackProblem kProblem = bunny_parts_problem();
    return kProblem;
  };
  add_height_row(
      {"bunny-parts",
       "the bunny's parts (100 mm, `parts=8`) on 110 × 110 mm, 1 mm gap, one thread, 12 s",
       "20 % lower than `drop`", 12, bunny_parts},
      cases);
  using Model = std::pair<std::string, Mesh (*)()>;
  for (const auto& [name, model] : {Model{"bunny", bunny_model}, Model{"molecule", molecule_model},
                                    Model{"sphere", sphere_model}}) {
    for (const bool anywhere : {false, true}) {
      const auto measure = [name = name, model = model, anywhere](const RunSettings& settings) {
        return segments_run(name + "-segments", model(), anywhere, settings);
      };
      cases.push_back({name + "-segments", anywhere ? "anywhere" : "drop",
                       "the " + name + "'s segments on objet30, cost of printing", "5 % cheaper",
                       kSeeds, 15, measure});
    }
  }
  cases.push_back({"sphere6", "default", "six patches of a shell, 72 × 72 mm, no gap",
                   "47.93 mm in 0.1 s", kSeeds, 1, nested_run});
  cases.push_back({"hulls", "default", "copies of a boat in 165 × 165 × 320 mm, 1 mm gap, 10 s", "",
                   kSeeds, 20, hulls_run});
  return cases;
}

}  // namespace packmerger::bench
