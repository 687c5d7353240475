#include "bench/packing_table/tray_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "pack/exact/exact_figures.h"
#include "pack/exact/exact_gap.h"
#include "pack/exact/exact_removal.h"

namespace packmerger::bench {
namespace {

constexpr double kRounding_mm = 1e-6;
constexpr double kTold_mm = 0.1;  // above the gap
constexpr double kRounding = 1e-9;

// Indices into packing.parts, by tray.
std::vector<std::vector<int>> by_tray(const Packing& packing) {
  std::vector<std::vector<int>> trays;
  for (std::size_t i = 0; i < packing.parts.size(); ++i) {
    const auto tray = static_cast<std::size_t>(packing.parts[i].tray);
    trays.resize(std::max(trays.size(), tray + 1));
    trays[tray].push_back(static_cast<int>(i));
  }
  return trays;
}

void check_items(const PackProblem& problem, const Packing& packing, TrayCheck& check) {
  std::multiset<int> placed;
  for (const PlacedPart& part : packing.parts) {
    placed.insert(part.items.begin(), part.items.end());
    const Mat3 turn = part.pose.linear();
    if (!(turn * turn.transpose()).isApprox(Mat3::Identity(), kRounding) || turn.determinant() < 0)
      check.broken.emplace_back("A part's pose is no rotation");
  }
  std::multiset<int> asked;
  for (std::size_t i = 0; i < problem.items.size(); ++i) asked.insert(static_cast<int>(i));
  if (placed != asked) check.broken.emplace_back("Not every item is in exactly one part");
}

void check_ways_out(const Packing& packing, const std::vector<int>& on_tray,
                    const std::vector<Mesh>& meshes, TrayCheck& check) {
  std::vector<int> order;
  std::vector<std::vector<Vec3>> paths;
  for (const int part : on_tray)
    paths.push_back(packing.removal_paths[static_cast<std::size_t>(part)]);
  for (const int part : packing.removal_order) {
    const auto at = std::find(on_tray.begin(), on_tray.end(), part);
    if (at != on_tray.end()) order.push_back(static_cast<int>(at - on_tray.begin()));
  }
  if (std::set<int>(order.begin(), order.end()).size() != on_tray.size() ||
      order.size() != on_tray.size())
    check.broken.emplace_back("The order of taking parts out does not list every part once");
  for (const auto& path : paths) ++(path.empty() ? check.straight_up : check.by_path);
  if (const auto met = first_obstacle(meshes, order, paths, Progress()))
    check.broken.push_back(fmt::format("Part {} cannot be taken out past part {}",
                                       on_tray[static_cast<std::size_t>(met->taken)],
                                       on_tray[static_cast<std::size_t>(met->by)]));
}

}  // namespace

TrayCheck check_packing(const PackProblem& problem, const Packing& packing) {
  TrayCheck check;
  check.apart_mm = problem.gap_mm + kTold_mm;
  check.outside_mm = -std::numeric_limits<double>::infinity();
  check_items(problem, packing, check);
  const auto trays = by_tray(packing);
  const auto standing = standing_parts(problem, packing);
  for (std::size_t tray = 0; tray < trays.size(); ++tray) {
    Box3 box;
    for (const Mesh& mesh : standing[tray]) {
      box.extend(bounding_box(mesh));
      check.volume_mm3 += volume_mm3(mesh);
    }
    check.height_mm += box.max().z();
    check.outside_mm = std::max(
        {check.outside_mm, -box.min().minCoeff(), (box.max() - problem.build_mm).maxCoeff()});
    check.apart_mm = std::min(check.apart_mm, least_gap_mm(standing[tray], check.apart_mm));
    check_ways_out(packing, trays[tray], standing[tray], check);
  }
  check.density =
      check.volume_mm3 / (problem.build_mm.x() * problem.build_mm.y() * check.height_mm);
  double volume_mm3 = 0;
  for (const PackItem& item : problem.items) volume_mm3 += item.volume_mm3;
  if (std::abs(check.volume_mm3 - volume_mm3) > kRounding_mm * volume_mm3)
    check.broken.emplace_back("The parts do not hold the items' matter");
  if (check.outside_mm > kRounding_mm)
    check.broken.push_back(fmt::format("A part stands {:.4f} mm out of the box", check.outside_mm));
  // What touches cannot be told from what cuts in: only what is apart is sure to be apart.
  if (check.apart_mm < problem.gap_mm - kRounding_mm || check.apart_mm <= 0)
    check.broken.push_back(fmt::format("Two parts are {:.4f} mm apart where {:g} mm are asked for",
                                       check.apart_mm, problem.gap_mm));
  return check;
}

std::vector<std::vector<Mesh>> standing_parts(const PackProblem& problem, const Packing& packing) {
  std::vector<std::vector<Mesh>> trays;
  for (const std::vector<int>& on_tray : by_tray(packing)) {
    trays.emplace_back();
    for (const int part : on_tray)
      trays.back().push_back(placed_mesh(problem, packing.parts[static_cast<std::size_t>(part)]));
  }
  return trays;
}

}  // namespace packmerger::bench
