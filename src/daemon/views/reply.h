// The frame of a reply to a request of docs/DAEMON.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace packmerger {

// A reply that tells this result, which is JSON text.
std::string reply_with(std::string_view result);

// The result within either reply, as JSON text; nothing where it tells an error. Refers to `reply`.
std::optional<std::string_view> result_in(std::string_view reply);

}  // namespace packmerger
