// How near the links come to what a serial line allows, and what they cost the processor.
#include <fmt/format.h>
#include <sys/resource.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench.h"
#include "bench/paced_line.h"
#include "bench/stopwatch.h"
#include "bench/told.h"
#include "firmware_io/gcode/gcode.h"
#include "firmware_io/gcode/gcode_link.h"
#include "firmware_io/ports/port.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_link.h"
#include "firmware_io/simulated/marlin.h"
#include "firmware_io/simulated/replicator.h"

namespace packmerger::bench {
namespace {

using nlohmann::ordered_json;

struct Arguments {
  double baud = 115200;
  int commands = 3000;
  bool json = false;
};

// Of this thread, which prints.
double processor_s() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Program {
  std::string bytes;
  double exchanged = 0;  // bytes on the line, commands and answers
};

// As a slicer writes it.
Program gcode_program(int commands) {
  Program program;
  for (int i = 1; i <= commands; ++i) {
    const std::string line = fmt::format("G1 X{:.3f} Y{:.3f} E{:.5f}", 50 + i % 97 * 1.011,
                                         50 + i % 89 * 1.013, 0.01 + i % 13 * 0.00731);
    program.bytes += line + "\n";
    constexpr double kOk = 3;
    program.exchanged += static_cast<double>(numbered_gcode(i, line).size()) + kOk;
  }
  return program;
}

// Moves of 32 bytes, the longest there are and nearly all of a print.
Program x3g_program(int commands) {
  Program program;
  program.bytes = s3g::build_start("link");
  for (int i = 0; i < commands; ++i) {
    std::string move = "\x9B" + std::string(31, '\0');
    move[1] = static_cast<char>(i);
    program.bytes += move;
    constexpr double kReply = 4;
    program.exchanged += static_cast<double>(s3g::packet(move).size()) + kReply;
  }
  program.bytes += s3g::build_end();
  return program;
}

ordered_json measure(const Arguments& arguments, bool gcode, double latency_s,
                     std::size_t window_bytes) {
  simulated::Marlin marlin(simulated::Pace{1, true});
  simulated::Replicator replicator(simulated::Pace{1, true});
  simulated::Firmware& firmware = gcode ? static_cast<simulated::Firmware&>(marlin) : replicator;
  PacedLine line(firmware, arguments.baud, latency_s);
  const Program program =
      gcode ? gcode_program(arguments.commands) : x3g_program(arguments.commands);
  const auto port = open_port(line.path(), static_cast<int>(arguments.baud));
  StreamOptions options;
  options.boot_wait_s = 0.1;
  options.window_bytes = window_bytes;
  std::unique_ptr<Stopwatch> watch;
  double used_s = 0;
  const PrintListener begins = [&](const PrintReport& report) {
    if (report.state != PrintState::kPrinting || watch) return;
    watch = std::make_unique<Stopwatch>();
    used_s = processor_s();
  };
  PrintControl control;
  if (gcode)
    print_gcode(*port, program.bytes, options, begins, control);
  else
    print_x3g(*port, program.bytes, options, begins, control);
  const double took_s = watch->seconds();
  used_s = processor_s() - used_s;
  const double ideal_s = program.exchanged * 10 / arguments.baud + arguments.commands * latency_s;
  return {{"protocol", gcode ? "G-code" : "s3g"},
          {"latency_ms", latency_s * 1000},
          {"window_bytes", window_bytes},
          {"commands", arguments.commands},
          {"took_s", took_s},
          {"ping_pong_s", ideal_s},
          {"share_percent", 100 * ideal_s / took_s},
          {"core_percent", 100 * used_s / took_s}};
}

void run(const Arguments& arguments) {
  struct Case {
    bool gcode;
    double latency_s;
    std::size_t window_bytes;
  };
  ordered_json rows = ordered_json::array();
  if (!arguments.json)
    fmt::print("{:<8} {:>10} {:>7} {:>8} {:>8} {:>11} {:>9} {:>7}\n", "", "latency ms", "window",
               "commands", "took s", "ping-pong s", "share %", "core %");
  for (const Case& one : {Case{true, 0, 0}, Case{true, 0.001, 0}, Case{true, 0.001, 96},
                          Case{false, 0, 0}, Case{false, 0.001, 0}}) {
    const ordered_json row = measure(arguments, one.gcode, one.latency_s, one.window_bytes);
    rows.push_back(row);
    if (arguments.json) continue;
    fmt::print("{:<8} {:>10} {:>7} {:>8} {:>8.2f} {:>11.2f} {:>9.1f} {:>7.2f}\n",
               row["protocol"].get<std::string>(), row["latency_ms"].get<double>(),
               row["window_bytes"].get<int>(), row["commands"].get<int>(),
               row["took_s"].get<double>(), row["ping_pong_s"].get<double>(),
               row["share_percent"].get<double>(), row["core_percent"].get<double>());
    std::fflush(stdout);
  }
  if (arguments.json) print_told(rows, true);
}

}  // namespace

void add_link(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "link", "The links over a line of a given rate: how near to ping-pong, and at what cost");
  verb->add_option("--baud", arguments->baud)->capture_default_str();
  verb->add_option("--commands", arguments->commands)->capture_default_str();
  verb->add_flag("--json", arguments->json);
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
