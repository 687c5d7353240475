#include "firmware_io/s3g/s3g_axes.h"

#include "firmware_io/s3g/s3g.h"

namespace packmerger::s3g {

namespace {

std::int32_t steps_at(std::string_view action, std::size_t axis) {
  return static_cast<std::int32_t>(read_integer(action.substr(1 + 4 * axis, 4)));
}

unsigned byte_at(std::string_view action, std::size_t i) {
  return static_cast<std::uint8_t>(action[i]);
}

// Sailfish passes over a move that says it is 0 mm long.
bool has_length(std::string_view action) { return read_integer(action.substr(26, 4)) != 0; }

}  // namespace

void Axes::apply(std::string_view action) {
  switch (byte_at(action, 0)) {
    case kFindMinimum:
    case kFindMaximum:
    case kRecallHome:
      return lose(byte_at(action, 1));
    case kSetPosition:
      for (std::size_t i = 0; i < kAxes; ++i) planned_[i] = steps_at(action, i);
      return;
    case kMoveTo:
      return move(action, 0);
    case kMoveIn:
      return move(action, byte_at(action, 25));
    case kMoveAlong:
      if (has_length(action)) move(action, byte_at(action, 25));
      return;
    default:
      return;
  }
}

void Axes::move(std::string_view action, unsigned relative) {
  Known target = planned_;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const bool adds = (relative >> i & 1U) != 0;
    if (!adds)
      target[i] = steps_at(action, i);
    else if (target[i])
      target[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(*target[i]) +
                                            static_cast<std::uint32_t>(steps_at(action, i)));
  }
  if (target == planned_) return;
  planned_ = shown_ = target;
}

void Axes::lose(unsigned axes) {
  for (std::size_t i = 0; i < kAxes; ++i)
    if ((axes >> i & 1U) != 0) planned_[i] = shown_[i] = std::nullopt;
}

std::optional<bool> tells(const Steps& stands, const Axes& without, const Axes& with) {
  bool fits_without = true;
  bool fits_with = true;
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (!without.shown(i) || !with.shown(i) || without.shown(i) == with.shown(i)) continue;
    fits_without = fits_without && stands[i] == *without.shown(i);
    fits_with = fits_with && stands[i] == *with.shown(i);
  }
  if (fits_without == fits_with) return std::nullopt;
  return fits_with;
}

}  // namespace packmerger::s3g
