// The command line of packmergerd, apart from its main() so that its manual page is made from it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace packmerger {

struct DaemonOptions {
  std::string config;
  bool check = false;
};

void add_options(CLI::App& program, DaemonOptions& options);

}  // namespace packmerger
