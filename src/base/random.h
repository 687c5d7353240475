// Seeded pseudo-random numbers that are the same on every machine: the C++ library's
// distributions are not specified bit by bit, so they are not used.
#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace packmerger {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }

  // Uniform in [0, n); n > 0. The modulo bias is below n / 2^64.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

  // Uniform in [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  template <typename T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(i)]);
  }

 private:
  std::mt19937_64 engine_;  // its sequence is fixed by the standard
};

}  // namespace packmerger
