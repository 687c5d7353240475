// Where the axes of a machine that executes s3g actions stand, as far as the actions tell.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace packmerger::s3g {

inline constexpr std::size_t kAxes = 5;  // x, y, z, a, b
using Steps = std::array<std::int32_t, kAxes>;

// After Sailfish's sources: a move is executed from where the planner is to its target; setting the
// position changes what the planner counts from, which the position query shows with the next move.
class Axes {
 public:
  // The action was executed, or will be.
  void apply(std::string_view action);

  // What the position query tells once all is executed; nothing where it cannot be known, as after
  // homing.
  const std::optional<std::int32_t>& shown(std::size_t axis) const { return shown_[axis]; }

 private:
  using Known = std::array<std::optional<std::int32_t>, kAxes>;

  void move(std::string_view action, unsigned relative);
  void lose(unsigned axes);

  Known planned_;
  Known shown_;
};

// `stands`: what the position query told of a machine at rest. True: it has executed all that led
// to `with`, false: only what led to `without`; nothing where it fits neither, or the two do not
// differ in what is known.
std::optional<bool> tells(const Steps& stands, const Axes& without, const Axes& with);

}  // namespace packmerger::s3g
