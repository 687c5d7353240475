#include "base/nearest.h"

#include <algorithm>
#include <cctype>

namespace packmerger {
namespace {

bool same(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

// Damerau and Levenshtein's, two neighbours swapped counting as one.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1,
                                             std::vector<std::size_t>(b.size() + 1, 0));
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = cost[i - 1][j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, changed});
      const bool swapped = i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]);
      if (swapped) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> nearest(std::string_view given, const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 64;  // nobody mistypes more
  std::size_t least = std::max<std::size_t>(1, given.size() / 3) + 1;
  std::optional<std::string> found;
  if (given.size() > kLongest) return found;
  for (const std::string& word : known) {
    const std::size_t letters = distance(given, word);
    if (letters >= least) continue;
    least = letters;
    found = word;
  }
  return found;
}

std::string did_you_mean(std::string_view given, const std::vector<std::string>& known) {
  const auto word = nearest(given, known);
  return word ? "Did you mean \"" + *word + "\"? " : "";
}

}  // namespace packmerger
