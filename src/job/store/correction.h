// How much longer prints really take than was predicted, learned from those that ended well.
#pragma once

#include <optional>
#include <vector>

namespace packmerger {

struct FinishedPrint {
  double predicted_s = 0;
  double printed_s = 0;  // pauses left out
};

// A print that stood still for this long or longer teaches nothing.
inline constexpr double kLongPause_s = 3600;

// True time over predicted time.
struct Correction {
  double factor = 1;
  double low = 1;  // the factor lies from low to high with 95 % confidence
  double high = 1;
  int prints = 0;    // that it was learned from
  int left_out = 0;  // others that were too far off
};

// Fewer prints teach nothing.
inline constexpr int kLeastPrints = 3;

// The mean of the logarithms of the ratios and its confidence interval by Student's t. Ratios
// further from their median than 3.5 of their spread are left out (the spread is 1.4826 times the
// median absolute deviation, and at least 5 %), so that one print that stood still for a night does
// not count. A spread below 1 % counts as 1 %. Times that are not positive and finite are passed
// over. Nothing where fewer than kLeastPrints are left.
std::optional<Correction> learn_correction(const std::vector<FinishedPrint>& prints);

}  // namespace packmerger
