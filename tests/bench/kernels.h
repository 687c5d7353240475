// How fast the placement kernel is, and how fast it could be.
#pragma once

namespace packmerger::bench {

struct FallRates {  // 1e9 cells of parts compared with cells of the field, a second, one core
  double ours = 0;
  double bare = 0;
};

// Measures both one after the other, some seconds; prints nothing.
FallRates measured_fall_rates();

}  // namespace packmerger::bench
