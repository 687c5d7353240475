// packmerger VERB …: parses the command line, runs one verb, and turns an Error into its exit code.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/names.h"
#include "base/nearest.h"
#include "base/process/end_at_once.h"
#include "cli/verb.h"

namespace {

using packmerger::did_you_mean;
using packmerger::Error;
using packmerger::Fault;
using packmerger::printable_lines;
using packmerger::yield_to_an_end;

int report(const Error& error) {
  yield_to_an_end();
  std::cerr << "error: " << printable_lines(error.what()) << ".\n";
  if (!error.hint().empty()) std::cerr << "hint: " << printable_lines(error.hint()) << "\n";
  return error.exit_code();
}

std::vector<std::string> verbs_of(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::App* one : verb.get_subcommands({})) names.push_back(one->get_name());
  return names;
}

// What is spoken to: "packmerger jobs list". Throws where a verb is missing, or another word stands
// in its place.
std::string spoken_to(const CLI::App& program, int argc, char** argv) {
  const CLI::App* verb = &program;
  std::string spoken = "packmerger";
  int next = 1;
  for (; next < argc && argv[next][0] != '-'; ++next) {
    const std::vector<std::string> known = verbs_of(*verb);
    if (known.empty()) return spoken;
    if (std::find(known.begin(), known.end(), argv[next]) == known.end())
      throw Error(Fault::kUsage, spoken + " has no verb \"" + argv[next] + "\"",
                  did_you_mean(argv[next], known) + "`" + spoken + " --help` lists its verbs.");
    verb = verb->get_subcommand(argv[next]);
    spoken += std::string(" ") + argv[next];
  }
  if (const std::vector<std::string> known = verbs_of(*verb); next == argc && !known.empty())
    throw Error(
        Fault::kUsage, spoken + " needs a verb",
        fmt::format("{}. `{} --help` tells what each does.", fmt::join(known, ", "), spoken));
  return spoken;
}

int run(int argc, char** argv) {
  CLI::App program;
  packmerger::cli::add_verbs(program);
  const std::string spoken = spoken_to(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& wanted) {  // --help, --version
    return program.exit(wanted);
  } catch (const CLI::ParseError& error) {
    throw Error(Fault::kUsage, error.what(), "`" + spoken + " --help` tells how it is used.");
  }
  std::cout.flush();
  if (!std::cout)
    return report(
        Error(Fault::kIo, "Cannot write to standard output", "Check where the output is sent to."));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    return report(error);
  } catch (const std::bad_alloc&) {
    return report(Error(Fault::kBadInput, "There is not enough memory for this model",
                        "Reduce the model or raise the memory limit, and try again."));
  } catch (const std::exception& error) {
    return report(Error(Fault::kInternal, std::string("Internal error: ") + error.what(),
                        "Please report this with the command and the model."));
  }
}
