#include "pack/search/search.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "base/random.h"

namespace packmerger {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSearchShare = 0.8;  // of the packing's progress, and of its budget
constexpr int kKickMoves = 2;
constexpr double kDetour = 1.02;         // dearer than the best so far a layout on the way may be
constexpr std::size_t kStartWays = 6;    // ways up in every turn for the first layout
constexpr double kWorthKeeping = 1.05;   // of the cheapest cost
constexpr std::size_t kKeptOfCount = 2;  // layouts of equally many parts
constexpr std::size_t kMostKept = 2;

void lower(std::atomic<double>& least, double value) {
  double known = least.load();
  while (value < known && !least.compare_exchange_weak(known, value)) {
  }
}

// The first of the cheapest; empty where all were given up.
std::optional<std::size_t> cheapest(const std::vector<std::optional<Layout>>& layouts) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < layouts.size(); ++i)
    if (layouts[i] && (!best || is_better(*layouts[i], *layouts[*best]))) best = i;
  return best;
}

// The largest parts first, or in any order, each where it is cheapest.
Layout greedy(const Layouter& layouter, Moves& moves, Random& random) {
  const RotationChoice good = [&moves](const Part& part) {
    return moves.good_rotations(part, kStartWays);
  };
  const std::vector<Draft> drafts{moves.start(true, random), moves.start(false, random)};
  std::vector<Layout> layouts(drafts.size());
  parallel_tasks(drafts.size(), [&](std::size_t i) {
    layouts[i] = *layouter.carried_out(drafts[i], good, kInfinity);
  });
  return std::move(layouts[is_better(layouts[1], layouts[0]) ? 1 : 0]);
}

class TabuSearch {
 public:
  TabuSearch(const PackProblem& problem, const Layouter& layouter, PartMaker& maker, Pace& pace,
             const OnBetter& on_better)
      : problem_(problem),
        layouter_(layouter),
        moves_(problem, maker),
        pace_(pace),
        on_better_(on_better),
        random_(problem.seed) {}

  std::vector<Layout> run() {
    Layout current = greedy(layouter_, moves_, random_);
    improve(current);
    keep(current);
    int kicks = 0;
    while (!over()) {
      const double before = best_.cost;
      descend(current);
      kicks = best_.cost < before ? 0 : kicks + 1;
      if (over()) break;
      if (kicks <= problem_.tabu_restarts) {
        current = kicked(best_);
      } else {
        if (!pace_.has_budget() || best_.parts() == 1) break;
        current = fresh_layout();
        kicks = 0;
      }
      progress_of(kicks);
    }
    merge_on();
    return worth_keeping();
  }

 private:
  bool over() const { return pace_.passed() >= kSearchShare; }

  void progress_of(int kicks) {
    pace_.reached(std::max(pace_.passed(), kSearchShare * kicks / (problem_.tabu_restarts + 1)));
  }

  // Of another order than any before.
  Layout fresh_layout() {
    const RotationChoice some = [this](const Part& part) {
      return moves_.some_rotations(part, random_);
    };
    return *layouter_.carried_out(moves_.start(false, random_), some, kInfinity);
  }

  // Tabu search from a layout until nothing better was found for a while.
  void descend(Layout& current) {
    std::deque<std::vector<const Part*>> forbidden;
    int rounds_without_better = 0;
    Layout reached = current;
    while (rounds_without_better < problem_.tabu_patience && !over()) {
      const std::vector<Move> moves = permitted(current, forbidden);
      std::vector<std::optional<Layout>> layouts = carried_out(moves);
      ++rounds_without_better;
      const std::optional<std::size_t> chosen = cheapest(layouts);
      if (!chosen || layouts[*chosen]->cost > kDetour * reached.cost) continue;
      current = std::move(*layouts[*chosen]);
      forbidden.push_back(moves[*chosen].touched);
      if (static_cast<int>(forbidden.size()) > problem_.tabu_memory) forbidden.pop_front();
      keep(current);
      if (is_better(current, reached)) {
        reached = current;
        rounds_without_better = 0;
      }
      if (is_better(current, best_)) improve(current);
    }
  }

  std::vector<Move> permitted(const Layout& layout,
                              const std::deque<std::vector<const Part*>>& forbidden) {
    const auto is_tabu = [&forbidden](const Move& move) {
      return std::any_of(forbidden.begin(), forbidden.end(), [&](const auto& parts) {
        return std::any_of(parts.begin(), parts.end(), [&](const Part* part) {
          return std::find(move.touched.begin(), move.touched.end(), part) != move.touched.end();
        });
      });
    };
    const std::size_t wanted = static_cast<std::size_t>(std::max(1, problem_.tabu_samples));
    std::vector<Move> moves;
    // With few parts all of them may be forbidden; then any move will do.
    for (std::size_t tries = 0; moves.size() < wanted; ++tries) {
      Move move = moves_.draw(layout, random_);
      if (tries < 4 * wanted && is_tabu(move)) continue;
      moves.push_back(std::move(move));
    }
    return moves;
  }

  // Layouts on more trays than the best are none. One that exceeds another of the round may be
  // given up, which never is the cheapest: the choice does not depend on the threads.
  std::vector<std::optional<Layout>> carried_out(const std::vector<Move>& moves) {
    std::vector<std::optional<Layout>> layouts(moves.size());
    std::atomic<double> least = kInfinity;
    parallel_tasks(moves.size(), [&](std::size_t i) {
      pace_.tick();
      Random random(moves[i].seed);
      const RotationChoice some = [&](const Part& part) {
        return moves_.some_rotations(part, random);
      };
      layouts[i] = layouter_.carried_out(moves[i].draft, some, least.load());
      if (layouts[i] && layouts[i]->trays.size() > best_.trays.size()) layouts[i].reset();
      if (layouts[i]) lower(least, layouts[i]->cost);
    });
    return layouts;
  }

  Layout kicked(Layout layout) {
    for (int i = 0; i < kKickMoves; ++i) {
      std::vector<std::optional<Layout>> next = carried_out({moves_.draw(layout, random_)});
      if (next.front()) layout = std::move(*next.front());
    }
    return layout;
  }

  // Additional merging (paper, section 6.3): from the best layout on, the merge that costs least,
  // as long as there are too many parts or the result is worth keeping.
  void merge_on() {
    Layout layout = best_;
    while (true) {
      std::vector<std::optional<Layout>> merged = carried_out(moves_.merges(layout, random_));
      const std::optional<std::size_t> chosen = cheapest(merged);
      if (!chosen) break;
      if (!has_too_many(layout) && merged[*chosen]->cost > kWorthKeeping * best_.cost) break;
      layout = std::move(*merged[*chosen]);
      keep(layout);
      if (is_better(layout, best_)) improve(layout);
    }
  }

  void improve(const Layout& layout) {
    const bool is_told = !best_.trays.empty() && layout.cost == best_.cost;
    best_ = layout;
    if (on_better_ && !is_told) on_better_(layout.cost);
  }

  void keep(const Layout& layout) {
    std::vector<Layout>& known = cheapest_[layout.parts()];
    const auto same = std::find_if(known.begin(), known.end(), [&layout](const Layout& other) {
      return other.trays.size() == layout.trays.size() && other.cost == layout.cost;
    });
    if (same != known.end() && !is_better(layout, *same)) return;
    if (same != known.end()) known.erase(same);
    known.insert(std::lower_bound(known.begin(), known.end(), layout, is_better), layout);
    if (known.size() > kKeptOfCount) known.pop_back();
  }

  bool has_too_many(const Layout& layout) const {
    return problem_.most_parts > 0 && layout.parts() > problem_.most_parts;
  }

  // Where merging did not lead to few enough parts, the fewest will do.
  std::vector<Layout> worth_keeping() const {
    std::vector<Layout> layouts;
    for (const auto& [parts, known] : cheapest_)
      if (layouts.empty() || !has_too_many(known.front()))
        layouts.insert(layouts.end(), known.begin(), known.end());
    std::stable_sort(layouts.begin(), layouts.end(), is_better);
    const double limit = kWorthKeeping * layouts.front().cost;
    std::erase_if(layouts, [limit](const Layout& layout) { return layout.cost > limit; });
    if (layouts.size() > kMostKept) layouts.resize(kMostKept);
    return layouts;
  }

  const PackProblem& problem_;
  const Layouter& layouter_;
  Moves moves_;
  Pace& pace_;
  const OnBetter& on_better_;
  Random random_;
  Layout best_;
  std::map<int, std::vector<Layout>> cheapest_;  // by number of parts
};

}  // namespace

Pace::Pace(const Progress& progress, double budget_s)
    : progress_(progress),
      silent_({}, progress.cancelled()),
      budget_s_(budget_s),
      start_(Clock::now()),
      reported_(start_) {
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

double Pace::passed() const {
  if (budget_s_ <= 0) return 0;
  return std::min(
      1.0, std::chrono::duration<double>(Clock::now() - start_).count() / (share_ * budget_s_));
}

std::vector<Layout> search(const PackProblem& problem, const Layouter& layouter, PartMaker& maker,
                           Pace& pace, const OnBetter& on_better) {
  return TabuSearch(problem, layouter, maker, pace, on_better).run();
}

Layout first_layout(const PackProblem& problem, const Layouter& layouter, PartMaker& maker) {
  Moves moves(problem, maker);
  Random random(problem.seed);
  return greedy(layouter, moves, random);
}

}  // namespace packmerger
