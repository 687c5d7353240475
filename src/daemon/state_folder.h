// The folder in which the daemon keeps jobs, their database, keys and, unless the settings say
// otherwise, the watched folders; and who else may look into it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace packmerger {

// Makes what is missing: the folder with mode 0700, jobs/ in it for those who may enter the folder
// and belong to the user or its group. What earlier versions left open to others is closed: jobs/
// and keys.json. The folder itself is left as it is where it was there, because others may drop
// models below it. Gives what a log should tell, line by line. Throws Error{kCannotWrite}.
std::vector<std::string> furnish_state_folder(const std::filesystem::path& state);

}  // namespace packmerger
