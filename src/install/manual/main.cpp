// packmerger-manual FOLDER SOURCE: writes completions, manual pages and udev rules into FOLDER.
// Part of the build; it is not installed.
#include <exception>
#include <iostream>
#include <set>

#include "base/files.h"
#include "cli/verb.h"
#include "daemon/options.h"
#include "install/manual/write.h"

namespace {

using namespace packmerger;

constexpr std::uint64_t kMaxBytes = 1 << 20;

std::vector<Profile> profiles_in(const fs::path& folder) {
  std::set<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".toml") files.insert(entry.path());
  std::vector<Profile> profiles;
  for (const fs::path& file : files) profiles.push_back(read_profile(file.string()));
  return profiles;
}

void write_all(const fs::path& out, const fs::path& source) {
  CLI::App cli;
  cli::add_verbs(cli);
  const manual::Command packmerger = manual::command_line(cli, "packmerger");
  CLI::App daemon;
  DaemonOptions unused;
  add_options(daemon, unused);
  const manual::Command packmergerd = manual::command_line(daemon, "packmergerd");
  const auto page = [&](const std::string& name, const std::string& content) {
    const std::string text = read_file(source / "src/install/man" / name, kMaxBytes);
    write_file_whole(out / name, manual::filled(text, content));
  };
  fs::create_directories(out);
  write_file_whole(out / "packmerger.bash", manual::bash_completion(packmerger));
  write_file_whole(out / "_packmerger", manual::zsh_completion(packmerger));
  write_file_whole(out / "packmerger.fish", manual::fish_completion(packmerger));
  write_file_whole(out / "70-packmerger.rules",
                   manual::udev_rules(profiles_in(source / "profiles")));
  page("packmerger.1", manual::verbs_as_man(packmerger));
  page("packmergerd.8", manual::options_as_man(packmergerd));
  const std::string docs = read_file(source / "docs/DAEMON.md", kMaxBytes);
  page("packmergerd.toml.5", manual::keys_as_man(manual::daemon_rows(daemon_keys(), docs)));
  page("packmerger-profile.5", manual::keys_as_man(manual::profile_rows(profile_keys())));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: packmerger-manual FOLDER SOURCE\n";
    return static_cast<int>(Fault::kUsage);
  }
  try {
    write_all(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return 1;
  }
}
