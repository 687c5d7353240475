#include <iostream>

#include "base/error.h"
#include "bench/bench.h"

int main(int argc, char** argv) {
  CLI::App program("What the docs say was measured, measured again");
  program.require_subcommand(1);
  packmerger::bench::add_cuts(program);
  packmerger::bench::add_kernels(program);
  packmerger::bench::add_link(program);
  packmerger::bench::add_partitions(program);
  packmerger::bench::add_figures(program);
  packmerger::bench::add_pack(program);
  packmerger::bench::add_packing_table(program);
  packmerger::bench::add_reference(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error);
  } catch (const packmerger::Error& error) {
    std::cerr << error.what() << '\n' << error.hint() << '\n';
    return error.exit_code();
  }
  return 0;
}
