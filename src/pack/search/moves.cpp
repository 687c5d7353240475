#include "pack/search/moves.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pack/maps/merge.h"

namespace packmerger {
namespace {

constexpr std::size_t kRotationsTried = 20;
constexpr std::size_t kBetterWays = 8;  // by what the part costs alone: tried most of the time
constexpr std::size_t kMostPutAgain = 3;

struct Place {
  std::size_t tray = 0;
  std::size_t index = 0;
};

std::vector<Place> places(const Layout& layout) {
  std::vector<Place> all;
  for (std::size_t tray = 0; tray < layout.trays.size(); ++tray)
    for (std::size_t i = 0; i < layout.trays[tray]->placed.size(); ++i) all.push_back({tray, i});
  return all;
}

const Part* part_at(const Layout& layout, const Place& place) {
  return layout.trays[place.tray]->placed[place.index].part;
}

Draft unchanged(const Layout& layout) {
  Draft draft;
  for (const auto& tray : layout.trays) draft.trays.push_back({tray, {}});
  return draft;
}

// The tray's tasks, all parts kept, to be changed.
std::vector<Task>& opened(Draft& draft, std::size_t tray) {
  Draft::Tray& open = draft.trays[tray];
  if (open.unchanged) {
    open.tasks = kept(*open.unchanged);
    open.unchanged.reset();
  }
  return open.tasks;
}

// Takes parts out of their trays.
void take_out(Draft& draft, const Layout& layout, const std::vector<const Part*>& parts) {
  for (std::size_t tray = 0; tray < layout.trays.size(); ++tray) {
    const auto& placed = layout.trays[tray]->placed;
    const bool holds = std::any_of(placed.begin(), placed.end(), [&](const Placed& one) {
      return std::find(parts.begin(), parts.end(), one.part) != parts.end();
    });
    if (!holds) continue;
    std::erase_if(opened(draft, tray), [&](const Task& task) {
      return std::find(parts.begin(), parts.end(), task.part) != parts.end();
    });
  }
}

// The pairs of parts that may become one.
std::vector<std::pair<const Part*, const Part*>> neighbours(const Layout& layout,
                                                            const PackProblem& problem) {
  if (problem.edges.empty()) return {};
  std::vector<const Part*> parts;
  std::vector<ItemSet> sets;
  for (const Place& place : places(layout)) {
    parts.push_back(part_at(layout, place));
    sets.push_back(parts.back()->items);
  }
  std::vector<std::pair<const Part*, const Part*>> pairs;
  for (const auto& [a, b] : mergeable_pairs(sets, problem))
    pairs.emplace_back(parts[static_cast<std::size_t>(a)], parts[static_cast<std::size_t>(b)]);
  return pairs;
}

// From here on in the order, parts keep their rotations and look for new places.
void look_again(std::vector<Task>& tasks, std::size_t first) {
  for (std::size_t i = first; i < tasks.size(); ++i) tasks[i].x = tasks[i].y = kAllCells;
}

}  // namespace

std::vector<const RotatedPart*> Moves::some_rotations(const Part& part, Random& random) {
  std::vector<std::pair<std::size_t, std::size_t>> chosen;  // way, turn
  for (std::size_t i = 0; i < kRotationsTried; ++i) {
    const std::size_t among =
        random.below(8) == 0 ? part.ways.size() : std::min(part.ways.size(), kBetterWays);
    chosen.emplace_back(random.below(among), random.below(maker_.turns()));
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  std::vector<const RotatedPart*> rotations;
  for (const auto& [way, turn] : chosen)
    if (const RotatedPart* rotated = maker_.rotated(part, way, turn)) rotations.push_back(rotated);
  return different(rotations);
}

std::vector<const RotatedPart*> Moves::good_rotations(const Part& part, std::size_t ways) {
  std::vector<const RotatedPart*> rotations;
  for (std::size_t way = 0; way < std::min(ways, part.ways.size()); ++way)
    for (std::size_t turn = 0; turn < maker_.turns(); ++turn)
      if (const RotatedPart* rotated = maker_.rotated(part, way, turn))
        rotations.push_back(rotated);
  return different(rotations);
}

Draft Moves::start(bool largest_first, Random& random) {
  Draft draft;
  for (int item = 0; item < static_cast<int>(problem_.items.size()); ++item)
    draft.loose.push_back({maker_.make({item})});
  if (largest_first)
    std::stable_sort(draft.loose.begin(), draft.loose.end(), [](const Task& a, const Task& b) {
      return a.part->volume_mm3 > b.part->volume_mm3;
    });
  else
    random.shuffle(draft.loose);
  return draft;
}

Move Moves::draw(const Layout& layout, Random& random) {
  constexpr int kTries = 8;
  for (int i = 0; i < kTries; ++i) {
    const std::size_t kind = random.below(16);
    Move move = kind < 6    ? put_again(layout, random)
                : kind < 9  ? put_earlier(layout, random)
                : kind < 11 ? exchange(layout, random)
                : kind < 13 ? turn(layout, random)
                : kind < 15 ? merge(layout, random)
                            : undo_merge(layout, random);
    move.seed = random.bits();
    if (!move.touched.empty()) return move;
  }
  return put_again(layout, random);
}

// Ejects some parts and puts them on top of what is left.
Move Moves::put_again(const Layout& layout, Random& random) {
  Move move{unchanged(layout), {}, 0};
  std::vector<Place> all = places(layout);
  random.shuffle(all);
  all.resize(std::min(all.size(), 1 + random.below(kMostPutAgain)));
  for (const Place& place : all) move.touched.push_back(part_at(layout, place));
  take_out(move.draft, layout, move.touched);
  for (const Part* part : move.touched) move.draft.loose.push_back({part});
  return move;
}

// Ejects a part and puts it below some of the others, which are dropped on it where they were.
Move Moves::put_earlier(const Layout& layout, Random& random) {
  Move move{unchanged(layout), {}, 0};
  const std::vector<Place> all = places(layout);
  const Place from = all[random.below(all.size())];
  if (from.index == 0) return move;
  std::vector<Task>& tasks = opened(move.draft, from.tray);
  const Task task{tasks[from.index].part};
  tasks.erase(tasks.begin() + static_cast<std::ptrdiff_t>(from.index));
  const std::size_t to = random.below(from.index);
  tasks.insert(tasks.begin() + static_cast<std::ptrdiff_t>(to), task);
  if (random.below(2) == 0) look_again(tasks, to + 1);
  move.touched = {task.part};
  return move;
}

// Two parts of a tray change places in the order; they and all that follow look for new places.
Move Moves::exchange(const Layout& layout, Random& random) {
  Move move{unchanged(layout), {}, 0};
  const std::size_t tray = random.below(layout.trays.size());
  const std::size_t count = layout.trays[tray]->placed.size();
  if (count < 2) return move;
  std::size_t a = random.below(count);
  std::size_t b = random.below(count - 1);
  if (b >= a) ++b;
  if (a > b) std::swap(a, b);
  std::vector<Task>& tasks = opened(move.draft, tray);
  std::swap(tasks[a], tasks[b]);
  look_again(tasks, a);
  move.touched = {tasks[a].part, tasks[b].part};
  return move;
}

// A part looks for another rotation where it stands in the order.
Move Moves::turn(const Layout& layout, Random& random) {
  Move move{unchanged(layout), {}, 0};
  const std::vector<Place> all = places(layout);
  const Place place = all[random.below(all.size())];
  std::vector<Task>& tasks = opened(move.draft, place.tray);
  tasks[place.index] = {tasks[place.index].part};
  if (random.below(2) == 0) look_again(tasks, place.index + 1);
  move.touched = {tasks[place.index].part};
  return move;
}

// Two neighbours become one part, which is put on top.
Move Moves::merge(const Layout& layout, const Part& one, const Part& other) {
  Move move{unchanged(layout), {}, 0};
  const Part* both = maker_.make(merged(one.items, other.items));
  if (both == nullptr) return move;
  move.touched = {&one, &other};
  take_out(move.draft, layout, move.touched);
  move.draft.loose.push_back({both});
  move.touched.push_back(both);
  return move;
}

Move Moves::merge(const Layout& layout, Random& random) {
  const auto pairs = neighbours(layout, problem_);
  if (pairs.empty()) return {};
  const auto& [one, other] = pairs[random.below(pairs.size())];
  return merge(layout, *one, *other);
}

std::vector<Move> Moves::merges(const Layout& layout, Random& random) {
  std::vector<Move> moves;
  for (const auto& [one, other] : neighbours(layout, problem_)) {
    Move move = merge(layout, *one, *other);
    move.seed = random.bits();
    if (!move.touched.empty()) moves.push_back(std::move(move));
  }
  return moves;
}

// A merged part becomes two again, along a cut between its items.
Move Moves::undo_merge(const Layout& layout, Random& random) {
  Move move{unchanged(layout), {}, 0};
  std::vector<const Part*> divisible;
  for (const Place& place : places(layout))
    if (part_at(layout, place)->items.size() > 1) divisible.push_back(part_at(layout, place));
  if (divisible.empty()) return move;
  const Part* whole = divisible[random.below(divisible.size())];
  const auto halves = divided(whole->items, problem_, random);
  move.touched = {whole, maker_.make(halves.first), maker_.make(halves.second)};
  if (move.touched[1] == nullptr || move.touched[2] == nullptr) return {unchanged(layout), {}, 0};
  take_out(move.draft, layout, {whole});
  move.draft.loose.push_back({move.touched[1]});
  move.draft.loose.push_back({move.touched[2]});
  return move;
}

}  // namespace packmerger
