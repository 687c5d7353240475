// The packer's placements against the plain loops of the reference (tests/bench), on the same maps.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "base/random.h"
#include "bench/fast_packing.h"
#include "bench/reference_packing.h"
#include "unit/pack/problems.h"

namespace packmerger::bench {
namespace {

Mesh random_part(Random& random) {
  const auto mm = [&random](double low, double high) { return low + (high - low) * random.unit(); };
  switch (random.below(6)) {
    case 0:
      return shapes::box(Vec3(mm(2, 20), mm(2, 20), mm(2, 20)));
    case 1:
      return shapes::l_shape(mm(8, 20), mm(2, 5), mm(3, 12));
    case 2:
      return shapes::cup(mm(4, 9), mm(6, 15), mm(1, 2));
    case 3:
      return shapes::bowl(mm(5, 12), mm(1, 3));
    case 4:
      return shapes::tetrahedron(mm(6, 18));
    default:
      return shapes::sphere_patch(mm(8, 14), 2, static_cast<int>(random.below(6)), 4);
  }
}

PackProblem random_problem(Random& random) {
  std::vector<Mesh> meshes(2 + random.below(5));
  for (Mesh& mesh : meshes) mesh = random_part(random);
  // The long tray has rows of several blocks, of groups of positions too.
  const Vec3 build_mm = random.below(4) == 0 ? Vec3(180, 24, 60) : Vec3(48, 40, 60);
  PackProblem problem = shapes::problem_of(std::move(meshes), build_mm);
  constexpr std::array<double, 3> kGaps{0, 1, 1.7};
  constexpr std::array<double, 3> kCells{1, 2, 4};
  problem.gap_mm = kGaps[random.below(3)];
  problem.grid_mm = kCells[random.below(3)];
  problem.rotation_step = radians(random.below(2) == 0 ? 90 : 60);
  problem.support_angle = radians(random.below(2) == 0 ? 0 : 45);
  if (random.below(4) == 0) {
    problem.cost.evaluate = [](const TrayMeasure& m) { return m.size_mm.z(); };
    problem.cost.lower_bound = problem.cost.evaluate;
  } else {
    problem.cost = shapes::paper_cost(0.25 * static_cast<double>(random.below(5)));
  }
  return problem;
}

RC_GTEST_PROP(SameAnswers, AsThePlainLoopsOverTheSameMaps, (std::uint64_t seed)) {
  Random random(seed);
  const PackProblem problem = random_problem(random);
  ReferencePacker reference(problem, Ties::kLowestTop);
  const FastPacker fast(problem, reference.unit_mm());
  std::vector<std::vector<ReferenceMaps>> maps;
  std::vector<std::vector<RotatedPart>> parts;
  std::vector<double> volumes;
  for (int item = 0; item < static_cast<int>(problem.items.size()); ++item) {
    maps.push_back(reference.draw({item}));
    parts.push_back(fast.laid_out(maps.back()));
    volumes.push_back(problem.items[static_cast<std::size_t>(item)].volume_mm3);
  }
  Order order(maps.size());
  std::iota(order.begin(), order.end(), 0);
  random.shuffle(order);
  const ReferencePacking expected = reference.pack(maps, volumes, order);
  const ReferencePacking found = fast.pack(parts, volumes, order);
  RC_ASSERT(found.placed.size() == expected.placed.size());
  for (std::size_t i = 0; i < found.placed.size(); ++i) {
    const ReferencePlacement& a = expected.placed[i];
    const ReferencePlacement& b = found.placed[i];
    RC_LOG() << i << ": rotation " << a.rotation << " " << b.rotation << ", x " << a.x << " " << b.x
             << ", y " << a.y << " " << b.y << ", z " << a.z << " " << b.z << ", cost " << a.cost
             << " " << b.cost << '\n';
    RC_ASSERT(a.part == b.part && a.rotation == b.rotation && a.x == b.x && a.y == b.y &&
              a.z == b.z && a.cost == b.cost);
  }
  RC_ASSERT(found.cost == expected.cost);
}

// Over a large tray groups of positions are bounded together, over a strip of it they are not.
RC_GTEST_PROP(SameAnswers, AsTheBestOfAllStripsOfALargeTray, (std::uint64_t seed)) {
  Random random(seed);
  PackProblem problem = random_problem(random);
  problem.build_mm = Vec3(160, 96, 60);
  problem.grid_mm = 1;
  ReferencePacker reference(problem, Ties::kLowestTop);
  const std::vector<RotatedPart> rotations =
      FastPacker(problem, reference.unit_mm()).laid_out(reference.draw({0}));
  const TraySpec spec{
      problem.build_mm, {1, reference.unit_mm(), problem.gap_mm, false}, &problem.cost};
  TrayState tray(spec);
  for (int i = 0; i < 40; ++i) {
    const RotatedPart& part = rotations[random.below(rotations.size())];
    const auto any = [&random](double room_mm) {
      return static_cast<int>(random.below(static_cast<std::size_t>(room_mm) + 1));
    };
    tray.put(part, any(160 - part.box.max().x()), any(96 - part.box.max().y()),
             static_cast<Height>(any(spec.ceiling() - part.rise)), 0, 1, spec);
  }
  std::vector<const RotatedPart*> all;
  for (const RotatedPart& part : rotations) all.push_back(&part);
  const auto rank = [](const Spot& spot) {
    return std::tuple(spot.cost, spot.top, spot.z, spot.y, spot.x, spot.rotation);
  };
  std::optional<Spot> expected;
  for (int y = 0; y < 96; y += 4) {
    const auto found = best_spot(tray, all, 1, spec, {false, kAllCells, {y, y + 3}});
    if (found && (!expected || rank(*found) < rank(*expected))) expected = found;
  }
  const auto found = best_spot(tray, all, 1, spec);
  RC_ASSERT(found.has_value() == expected.has_value());
  if (found) RC_ASSERT(rank(*found) == rank(*expected));
}

}  // namespace
}  // namespace packmerger::bench
