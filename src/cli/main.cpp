// packmerger VERB …: parses the command line, runs one verb, and turns an Error into its exit code.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/names.h"
#include "base/nearest.h"
#include "cli/verb.h"

namespace {

using packmerger::did_you_mean;
using packmerger::Error;
using packmerger::Fault;
using packmerger::printable_lines;

int report(const Error& error) {
  std::cerr << "error: " << printable_lines(error.what()) << ".\n";
  if (!error.hint().empty()) std::cerr << "hint: " << printable_lines(error.hint()) << "\n";
  return error.exit_code();
}

// A word where a verb belongs, which CLI11 would only call unexpected.
void check_verbs(const CLI::App& program, int argc, char** argv) {
  const CLI::App* verb = &program;
  std::string spoken = "packmerger";
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    std::vector<std::string> known;
    for (const CLI::App* one : verb->get_subcommands({})) known.push_back(one->get_name());
    if (known.empty()) return;
    if (std::find(known.begin(), known.end(), argv[i]) == known.end())
      throw Error(Fault::kUsage, spoken + " has no verb \"" + argv[i] + "\"",
                  did_you_mean(argv[i], known) + "`" + spoken + " --help` lists its verbs.");
    verb = verb->get_subcommand(argv[i]);
    spoken += std::string(" ") + argv[i];
  }
}

int run(int argc, char** argv) {
  CLI::App program;
  packmerger::cli::add_verbs(program);
  check_verbs(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& wanted) {  // --help, --version
    return program.exit(wanted);
  } catch (const CLI::ParseError& error) {
    std::ostringstream text;
    program.exit(error, std::cout, text);
    std::cerr << printable_lines(text.str());
    return static_cast<int>(Fault::kUsage);
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
