#include "pack/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "base/parallel.h"
#include "base/random.h"
#include "pack/fill.h"

namespace packmerger {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kSnapshots = 32;  // of an order's prefixes; each holds trays' height fields
constexpr double kSnapshotMemory_bytes = 256e6;
constexpr double kSearchShare = 0.9;  // of the packing's progress

// Costs of orders of one list of parts, with the trays kept as they were after some prefixes of the
// order the search stands at, so that a swap is packed again from its first change only.
class OrderPacker {
 public:
  OrderPacker(const Filler& filler, std::size_t parts, const PackProblem& problem, Pace& pace)
      : filler_(filler), pace_(pace) {
    const double cells = problem.build_mm.x() * problem.build_mm.y() / std::pow(problem.grid_mm, 2);
    const double affordable = kSnapshotMemory_bytes / (2 * sizeof(float) * std::max(1.0, cells));
    const auto snapshots =
        static_cast<std::size_t>(std::clamp(affordable, 1.0, static_cast<double>(kSnapshots)));
    stride_ = (parts + snapshots - 1) / snapshots;
  }

  // Packs the whole order and stands there.
  double start(const Order& order) {
    snapshots_.assign(1, Filling{});
    Filling filling;
    extend(filling, order, 0);
    return filler_.cost(filling);
  }

  double evaluate(const Order& order, std::size_t first_change, double give_up_above) const {
    const std::size_t snapshot = snapshot_before(first_change);
    Filling filling = snapshots_[snapshot];
    for (std::size_t i = snapshot * stride_; i < order.size(); ++i) {
      pace_.tick();
      filler_.add(filling, order[i]);
      if (filler_.bound(filling) > give_up_above) return kInfinity;
    }
    return filler_.cost(filling);
  }

  void moved(const Order& order, std::size_t first_change) {
    const std::size_t snapshot = snapshot_before(first_change);
    snapshots_.resize(snapshot + 1);
    Filling filling = snapshots_[snapshot];
    extend(filling, order, snapshot * stride_);
  }

 private:
  std::size_t snapshot_before(std::size_t position) const {
    return std::min(position / stride_, snapshots_.size() - 1);
  }

  void extend(Filling& filling, const Order& order, std::size_t from) {
    for (std::size_t i = from; i < order.size(); ++i) {
      if (i % stride_ == 0 && i / stride_ == snapshots_.size()) snapshots_.push_back(filling);
      pace_.tick();
      filler_.add(filling, order[i]);
    }
  }

  const Filler& filler_;
  Pace& pace_;
  std::size_t stride_ = 1;
  std::vector<Filling> snapshots_;  // [k]: after the first k · stride_ parts
};

// The paper starts from a random order; largest first is often better, and is tried as well.
FoundOrder first_order(const std::vector<Part>& parts, OrderPacker& packer, Random& random) {
  Order by_volume(parts.size());
  std::iota(by_volume.begin(), by_volume.end(), 0);
  Order shuffled = by_volume;
  random.shuffle(shuffled);
  std::stable_sort(by_volume.begin(), by_volume.end(), [&parts](int a, int b) {
    return parts[static_cast<std::size_t>(a)].volume_mm3 >
           parts[static_cast<std::size_t>(b)].volume_mm3;
  });
  const double cost = packer.start(by_volume);
  const double shuffled_cost = packer.start(shuffled);
  return shuffled_cost < cost ? FoundOrder{shuffled, shuffled_cost} : FoundOrder{by_volume, cost};
}

// Parts a and b become one, which takes the earlier one's place in the order.
Configuration contracted(const Configuration& from, int a, int b) {
  Configuration to;
  std::vector<int> renamed(from.parts.size());
  for (int part = 0; part < static_cast<int>(from.parts.size()); ++part) {
    const std::size_t at = static_cast<std::size_t>(part);
    renamed[at] = part == b ? a : static_cast<int>(to.parts.size());
    if (part == a)
      to.parts.push_back(merged(from.parts[at], from.parts[static_cast<std::size_t>(b)]));
    else if (part != b)
      to.parts.push_back(from.parts[at]);
  }
  bool placed = false;
  for (const int part : from.order) {
    if ((part == a || part == b) && std::exchange(placed, true)) continue;
    to.order.push_back(renamed[static_cast<std::size_t>(part)]);
  }
  return to;
}

class MergeSearch {
 public:
  MergeSearch(const PackProblem& problem, PartMaker& maker, Pace& pace)
      : problem_(problem), maker_(maker), pace_(pace), random_(problem.seed) {}

  std::vector<Configuration> run() {
    Configuration configuration;
    for (int item = 0; item < static_cast<int>(problem_.items.size()); ++item)
      configuration.parts.push_back({item});
    levels_ = 1 + expected_merges();
    std::vector<Configuration> visited;
    while (true) {
      optimize_order(configuration, static_cast<int>(visited.size()));
      visited.push_back(configuration);
      if (pace_.time_is_up()) break;
      auto next = merge_randomly(configuration);
      if (!next) break;
      configuration = std::move(*next);
    }
    return visited;
  }

 private:
  int expected_merges() const {
    return problem_.edges.empty() ? 0 : static_cast<int>(problem_.items.size()) - 1;
  }

  void optimize_order(Configuration& configuration, int level) {
    const std::vector<Part> parts = make_parts(configuration.parts, maker_, problem_, pace_);
    const Filler filler(problem_, maker_, parts);
    OrderPacker packer(filler, parts.size(), problem_, pace_);
    FoundOrder start{configuration.order, 0};
    if (configuration.order.empty()) start = first_order(parts, packer, random_);
    start.cost = packer.start(start.order);

    const TabuSettings settings{problem_.tabu_memory, problem_.tabu_patience, problem_.tabu_samples,
                                random_.bits()};
    OrderCost cost;
    cost.evaluate = [&packer](const Order& order, std::size_t first_change, double give_up) {
      return packer.evaluate(order, first_change, give_up);
    };
    cost.moved = [&packer](const Order& order, std::size_t first_change) {
      packer.moved(order, first_change);
    };
    cost.go_on = [&](int rounds_without_better) {
      const double part_done = static_cast<double>(rounds_without_better) / settings.patience;
      pace_.reached(kSearchShare * (level + part_done) / levels_);
      return !pace_.time_is_up();
    };
    const FoundOrder found = tabu_search(start.order, start.cost, settings, cost);
    configuration.order = found.order;
    configuration.cost = found.cost;
  }

  // Contracts a random edge whose two parts together fit the build volume; empty where none does.
  std::optional<Configuration> merge_randomly(const Configuration& configuration) {
    std::vector<std::pair<int, int>> pairs = mergeable_pairs(configuration.parts, problem_);
    random_.shuffle(pairs);
    for (const auto& [a, b] : pairs) {
      pace_.tick();
      Configuration next = contracted(configuration, a, b);
      if (maker_.make(next.parts[static_cast<std::size_t>(a)])) return next;
    }
    return std::nullopt;
  }

  const PackProblem& problem_;
  PartMaker& maker_;
  Pace& pace_;
  Random random_;
  int levels_ = 1;
};

[[noreturn]] void refuse(const ItemSet& items, const PackProblem& problem) {
  Box3 box;
  for (const int item : items)
    box.extend(bounding_box(problem.items[static_cast<std::size_t>(item)].surface));
  const Vec3 size = box.sizes();
  const Vec3& build = problem.build_mm;
  throw Error(
      Fault::kBadInput,
      fmt::format("Part {} of model {} measures {:.1f} × {:.1f} × {:.1f} mm and fits the "
                  "build volume of {:.1f} × {:.1f} × {:.1f} mm in no rotation",
                  items.front() + 1,
                  problem.items[static_cast<std::size_t>(items.front())].model + 1, size.x(),
                  size.y(), size.z(), build.x(), build.y(), build.z()),
      "Scale the model down, let it be divided into more parts, or choose a larger printer.");
}

}  // namespace

Pace::Pace(const Progress& progress, double budget_s)
    : progress_(progress),
      end_(budget_s > 0 ? Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                             std::chrono::duration<double>(budget_s))
                        : Clock::time_point::max()),
      reported_(Clock::now()) {
  progress.report("packing", 0);
}

void Pace::reached(double fraction) {
  {
    const std::lock_guard lock(mutex_);
    fraction_ = std::max(fraction_, fraction);
  }
  tick();
}

void Pace::tick() {
  progress_.check();
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (now - reported_ < std::chrono::milliseconds(200)) return;
  reported_ = now;
  progress_.report("packing", fraction_);
}

bool Pace::time_is_up() const { return Clock::now() >= end_; }

std::vector<Part> make_parts(const std::vector<ItemSet>& sets, PartMaker& maker,
                             const PackProblem& problem, Pace& pace) {
  std::vector<Part> parts(sets.size());
  parallel_for(sets.size(), [&](std::size_t i) {
    pace.tick();
    std::optional<Part> part = maker.make(sets[i]);
    if (!part) refuse(sets[i], problem);
    parts[i] = std::move(*part);
  });
  return parts;
}

std::vector<Configuration> search(const PackProblem& problem, PartMaker& maker, Pace& pace) {
  return MergeSearch(problem, maker, pace).run();
}

}  // namespace packmerger
