// How a verb of the command line is made: one file each, one function that adds it to the program.
// Data goes to stdout, everything else to stderr; Error is caught in main.
#pragma once

#include <CLI/CLI.hpp>

#include "base/progress.h"

namespace packmerger::cli {

// All verbs, and what the program says of itself.
void add_verbs(CLI::App& program);

// Each adds one subcommand with its options, --json among them, and its callback.
void add_prepare(CLI::App& program);
void add_compare(CLI::App& program);
void add_profiles(CLI::App& program);
void add_calibrate(CLI::App& program);
void add_devices(CLI::App& program);
void add_send(CLI::App& program);
void add_simulate(CLI::App& program);
void add_jobs(CLI::App& program);
void add_keys(CLI::App& program);
void add_printers(CLI::App& program);

// Progress on stderr: a bar on a terminal, otherwise a line "[ 42%] packing" whenever a stage has
// moved by at least five per cent. Cancelled by SIGINT and SIGTERM.
Progress terminal_progress();

// Set by SIGINT and SIGTERM once terminal_progress() was called.
const std::atomic<bool>& interrupted();

// From now on SIGINT is counted instead, and the one that makes it `deadly` ends the program at
// once; SIGTERM sets interrupted() still.
void count_interrupts(int deadly);
int interrupts();
void forget_interrupts();

}  // namespace packmerger::cli
