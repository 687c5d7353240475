// usb-bed [faults] --record FILE -- COMMAND…: runs a command on a computer whose one USB device is
// a printer that umockdev plays (usb_bed.h), and ends as it does. FILE gets the bytes that the
// printer was given, FILE.events what else happened to it. Lines on standard input: "plug",
// "unplug", and "end", which ends the command by SIGTERM. Run it under umockdev-wrapper.
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "sim/usb_bed.h"

extern char** environ;

namespace {

using packmerger::test::BulkAnswer;
using packmerger::test::UsbBed;
using packmerger::test::UsbPrinterTraits;
using End = BulkAnswer::End;

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

struct Arguments {
  std::string record;
  std::size_t stall_at = kNever;
  std::size_t silent_at = kNever;
  std::size_t unplug_at = kNever;
  int empty_for = 0;  // how many times the printer says that it is out of material
  bool starts_unplugged = false;
  UsbPrinterTraits traits;
  std::vector<std::string> command;
};

// Each fault strikes once, at the byte it is set for.
BulkAnswer answer_of(Arguments& arguments, std::size_t received, std::size_t offered) {
  const auto strikes = [&](std::size_t& at) {
    if (at < received || at > received + offered) return false;
    offered = at - received;
    at = kNever;
    return true;
  };
  if (strikes(arguments.stall_at)) return {offered, End::kStall};
  if (strikes(arguments.silent_at)) return {offered, End::kSilence};
  if (strikes(arguments.unplug_at)) return {offered, End::kUnplugged};
  return {offered, End::kTaken};
}

pid_t start(const std::vector<std::string>& command) {
  std::vector<char*> argv;
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  if (::posix_spawnp(&child, argv[0], nullptr, nullptr, argv.data(), environ) != 0)
    throw std::runtime_error("cannot start " + command[0]);
  return child;
}

// False once nobody is left to give orders.
bool obey(UsbBed& bed, const UsbPrinterTraits& traits, pid_t child) {
  std::string line;
  if (!std::getline(std::cin, line)) return false;
  if (line == "plug") bed.plug_printer(traits);
  if (line == "unplug") bed.unplug_printer();
  if (line == "end") ::kill(child, SIGTERM);
  return true;
}

int run(Arguments& arguments) {
  constexpr int kSlice_ms = 50;
  UsbBed bed;
  bed.on_bulk = [&](std::size_t received, std::size_t offered) {
    return answer_of(arguments, received, offered);
  };
  bed.on_status = [&]() -> std::optional<std::uint8_t> {
    constexpr std::uint8_t kPaperEmpty = 0x38;
    return arguments.empty_for-- > 0 ? kPaperEmpty : UsbBed::kReady;
  };
  if (!arguments.starts_unplugged) bed.plug_printer(arguments.traits);
  const pid_t child = start(arguments.command);
  bool listens = true;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, listens ? 1 : 0, kSlice_ms) > 0)
      listens = obey(bed, arguments.traits, child);
  }
  std::ofstream(arguments.record, std::ios::binary) << bed.received();
  std::ofstream events(arguments.record + ".events");
  for (const std::string& event : bed.events()) events << event << "\n";
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App program("Runs a command beside a USB printer that does not exist.", "usb-bed");
  program.add_option("--record", arguments.record)->required();
  program.add_option("--stall-at", arguments.stall_at);
  program.add_option("--silent-at", arguments.silent_at);
  program.add_option("--unplug-at", arguments.unplug_at);
  program.add_option("--empty-for", arguments.empty_for);
  program.add_flag("--starts-unplugged", arguments.starts_unplugged);
  program.add_option("--serial", arguments.traits.serial_number);
  program.add_flag("--busy", arguments.traits.busy);
  program.add_option("COMMAND", arguments.command)->required();
  CLI11_PARSE(program, argc, argv);
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "usb-bed: " << error.what() << "\n";
    return 70;
  }
}
