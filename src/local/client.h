// Speaking to a running daemon from another program.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace packmerger {

// What the daemon of every version says of a verb that it does not know: by this sentence a later
// program knows that it speaks to an older one.
inline constexpr const char* kUnknownVerb = "The request's verb is unknown";

// Sends one request and returns the reply's result. Throws Error{kUnavailable} when no daemon
// answers there, Error{kUsage} where it is of an earlier version that does not know the verb, and
// the daemon's own Error when it refuses.
nlohmann::json ask_daemon(const std::filesystem::path& socket, const nlohmann::json& request);

}  // namespace packmerger
