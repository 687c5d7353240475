// A disk that is full to the last byte has no room to open the jobs' database, and so nobody would
// ever clear it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "daemon/orders/messages.h"

namespace packmerger {

// Whether the disk takes what a daemon writes while it starts. One that cannot be written to for
// another reason says so itself, later.
bool has_room_to_start(const std::filesystem::path& state);

// Where it has none: deletes the folders of the jobs that ended first, those of the last day
// excepted, until it has, and returns which; they are still to be recorded. Before the database is
// opened, and while no other daemon works there. Throws nothing: where nothing can be done, opening
// the database tells. log takes one line.
Deleted make_room_to_start(const std::filesystem::path& state,
                           const std::function<void(const std::string&)>& log,
                           const std::function<bool()>& has_room);
Deleted make_room_to_start(const std::filesystem::path& state,
                           const std::function<void(const std::string&)>& log);

}  // namespace packmerger
