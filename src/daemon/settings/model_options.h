// How a model is prepared beyond its printer's profile: the options of packmerger prepare, as the
// daemon's settings give them for a printer, and as a settings file beside a model gives them for
// it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/settings/config_table.h"
#include "model/printer.h"

namespace packmerger {

// A settings file beside a model, whose name is the model's and ".toml". Throws Error{kBadProfile}
// ("bunny.stl.toml:3: …") where it is no regular file of at most 64 KiB, no TOML, or where a key is
// unknown, of the wrong type or out of its range; `profile` is what its [set] is tried on.
ModelOptions read_model_settings(const std::filesystem::path& file, const Profile& profile);

// The keys of such a file, as docs/DAEMON.md shows them.
std::vector<DaemonKey> model_settings_keys();

// For config.cpp: the keys of a printer's table.
void read_printer_options(TableReader& reader, ModelOptions& options);

// What `above` says counts, `below` where it says nothing; a size takes the place of a scale, and
// the contrary. Settings of the profile are added up, those of `above` last, so that they count.
ModelOptions laid_over(ModelOptions below, const ModelOptions& above);

// As packmerger prepare takes them.
std::vector<std::string> arguments_of(const ModelOptions& options);
// The part that is about the profile: --set.
std::vector<std::string> profile_arguments_of(const ModelOptions& options);

}  // namespace packmerger
