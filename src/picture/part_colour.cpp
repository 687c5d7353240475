#include "picture/part_colour.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace packmerger {
namespace {

// One channel of a hue (0..1) at full saturation.
float channel(double hue, double shift) {
  const double k = std::fmod(hue + shift, 1.0) * 6;
  return static_cast<float>(std::clamp(std::abs(k - 3) - 1, 0.0, 1.0));
}

}  // namespace

Colour part_colour(int index) {
  // Steps of the golden ratio around the colour circle never come close to an earlier one soon.
  constexpr double kGolden = 0.61803398874989485;
  struct Tone {
    float saturation;
    float value;
  };
  constexpr std::array<Tone, 3> kTones{{{0.62F, 0.93F}, {0.60F, 0.80F}, {0.45F, 0.97F}}};
  const double hue = std::fmod(0.08 + kGolden * index, 1.0);
  const Tone& tone = kTones[static_cast<std::size_t>(index) % kTones.size()];
  const auto shade = [&](double shift) {
    return tone.value * (1 - tone.saturation * (1 - channel(hue, shift)));
  };
  return {shade(0), shade(2.0 / 3), shade(1.0 / 3)};
}

Colour model_colour() { return {0.74F, 0.76F, 0.79F}; }

}  // namespace packmerger
