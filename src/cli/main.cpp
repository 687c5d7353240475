// packmerger VERB …: parses the command line, runs one verb, and turns an Error into its exit code.
#include <cstdio>
#include <exception>
#include <iostream>
#include <sstream>

#include "base/error.h"
#include "base/names.h"
#include "cli/verb.h"

namespace {

using packmerger::Error;
using packmerger::Fault;
using packmerger::printable_lines;

int report(const Error& error) {
  std::cerr << "error: " << printable_lines(error.what()) << ".\n";
  if (!error.hint().empty()) std::cerr << "hint: " << printable_lines(error.hint()) << "\n";
  return error.exit_code();
}

int run(int argc, char** argv) {
  CLI::App program;
  packmerger::cli::add_verbs(program);
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
