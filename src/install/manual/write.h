// The files that are made from the program itself: completions for three shells, manual pages, and
// udev rules. Each returns the whole text of one file.
#pragma once

#include <string>
#include <vector>

#include "daemon/settings/config.h"
#include "install/manual/command_line.h"
#include "model/printer.h"

namespace packmerger::manual {

std::string bash_completion(const Command& program);
std::string zsh_completion(const Command& program);
std::string fish_completion(const Command& program);

// How values are completed where they are neither files nor one of a few words: a command that
// prints them, one a line. Empty for every other kind.
std::string lister_of(const std::string& value);
// Whether the value names a file or a folder.
bool is_path(const std::string& value);

// The page's prose is a template; a line "@OPTIONS@" in it stands for what is made here.
std::string filled(const std::string& page, const std::string& content);
std::string verbs_as_man(const Command& program);
std::string options_as_man(const Command& command);

// One key of a settings file.
struct KeyRow {
  std::string name;
  std::string takes;
  std::string initial;
  std::string meaning;
};
// docs/DAEMON.md's table, in the order of the keys that the program reads. Throws
// std::runtime_error where it lacks one.
std::vector<KeyRow> daemon_rows(const std::vector<DaemonKey>& keys, const std::string& docs);
std::vector<KeyRow> profile_rows(const std::vector<ProfileKey>& keys);
std::string keys_as_man(const std::vector<KeyRow>& rows);

// Access, a stable name below /dev/packmerger, and no ModemManager, for every USB id of profiles.
std::string udev_rules(const std::vector<Profile>& profiles);

}  // namespace packmerger::manual
