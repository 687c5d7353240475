#include "firmware_io/s3g/s3g_actions.h"

#include <algorithm>

#include "base/error.h"
#include "firmware_io/s3g/s3g.h"

namespace packmerger::s3g {

Actions::Actions(std::string_view program) : program_(program) {
  if (program.empty())
    throw Error(Fault::kBadInput, "The x3g program is empty", "Prepare the model again.");
  if (program.size() > UINT32_MAX)
    throw Error(Fault::kBadInput, "The program is larger than 4 GiB", "Divide it.");
  // Counted first: places that grow would need twice the memory for a while.
  std::size_t count = 0;
  for (std::size_t at = 0; at < program.size(); at += checked_action_length(program, at)) ++count;
  places_.reserve(count);
  for (std::size_t at = 0; at < program.size(); at += action_length(program.substr(at)))
    places_.push_back(static_cast<std::uint32_t>(at));
}

bool Actions::holds(std::uint8_t code) const {
  return std::any_of(places_.begin(), places_.end(), [&](std::uint32_t place) {
    return static_cast<std::uint8_t>(program_[place]) == code;
  });
}

void Actions::complete(std::string_view build_name) {
  if (!holds(kBuildStart)) start_ = build_start(build_name);
  if (!holds(kBuildEnd)) end_ = build_end();
}

std::string_view Actions::operator[](std::size_t index) const {
  if (index < lead()) return start_;
  if (index - lead() == places_.size()) return end_;
  const std::string_view rest = program_.substr(places_[index - lead()]);
  return rest.substr(0, action_length(rest));
}

std::size_t Actions::done(std::size_t index) const {
  const std::size_t behind = index + 1 - lead();
  return behind < places_.size() ? places_[behind] : program_.size();
}

}  // namespace packmerger::s3g
