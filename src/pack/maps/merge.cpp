#include "pack/maps/merge.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace packmerger {

std::vector<std::pair<int, int>> mergeable_pairs(const std::vector<ItemSet>& parts,
                                                 const PackProblem& problem) {
  std::vector<int> part_of(problem.items.size(), -1);
  for (std::size_t part = 0; part < parts.size(); ++part)
    for (const int item : parts[part])
      part_of[static_cast<std::size_t>(item)] = static_cast<int>(part);
  std::set<std::pair<int, int>> pairs;
  for (const SegmentEdge& edge : problem.edges) {
    const std::size_t a = static_cast<std::size_t>(edge.a);
    const std::size_t b = static_cast<std::size_t>(edge.b);
    if (problem.items[a].model != problem.items[b].model) continue;
    if (part_of[a] != part_of[b]) pairs.insert(std::minmax(part_of[a], part_of[b]));
  }
  for (const std::vector<int>& enclosure : problem.enclosures) {
    std::set<int> round_it;
    for (const int item : enclosure) round_it.insert(part_of[static_cast<std::size_t>(item)]);
    if (round_it.size() == 2) pairs.erase({*round_it.begin(), *round_it.rbegin()});
  }
  return {pairs.begin(), pairs.end()};
}

ItemSet merged(const ItemSet& a, const ItemSet& b) {
  ItemSet all;
  std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

std::pair<ItemSet, ItemSet> divided(const ItemSet& items, const PackProblem& problem,
                                    Random& random) {
  std::vector<int> shuffled = items;
  random.shuffle(shuffled);
  std::map<int, int> half;  // item → 0 or 1
  half[shuffled[0]] = 0;
  half[shuffled[1]] = 1;
  const auto belongs = [&items](int item) {
    return std::binary_search(items.begin(), items.end(), item);
  };
  // Edges are looked at in random order until none joins an item to a half.
  std::vector<std::pair<int, int>> edges;
  for (const SegmentEdge& edge : problem.edges)
    if (belongs(edge.a) && belongs(edge.b)) edges.emplace_back(edge.a, edge.b);
  random.shuffle(edges);
  for (bool grew = true; grew;) {
    grew = false;
    for (const auto& [a, b] : edges) {
      if (half.contains(a) == half.contains(b)) continue;
      const int from = half.contains(a) ? a : b;
      const int to = half.contains(a) ? b : a;
      half[to] = half[from];
      grew = true;
    }
  }
  std::pair<ItemSet, ItemSet> halves;
  for (const int item : items) {
    const auto known = half.find(item);
    (known != half.end() && known->second == 1 ? halves.second : halves.first).push_back(item);
  }
  return halves;
}

}  // namespace packmerger
