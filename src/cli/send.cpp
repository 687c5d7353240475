#include "delivery/send.h"

#include <fmt/format.h>

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/names.h"
#include "cli/checks.h"
#include "cli/daemon_verb.h"
#include "cli/print_dialogue.h"
#include "cli/verb.h"
#include "delivery/job_folder.h"
#include "delivery/progress_file.h"
#include "delivery/way.h"
#include "model/files/job_folder_names.h"

namespace packmerger::cli {
namespace {

struct Arguments {
  std::string folder;
  std::string port;
  std::string to;
  int tray = 1;
  bool json = false;
};

// How long the link may take to write the last it has to say.
constexpr std::chrono::seconds kLeave{2};

// The thread that prints cannot be waited for.
[[noreturn]] void end_hot() {
  fmt::print(stderr,
             "\nEnded without an answer from the printer: its heaters may be on, look at it.\n");
  std::fflush(stderr);
  std::_Exit(128 + SIGINT);
}

// The print runs on a thread of its own; this one listens to people.
void stream_watched(const Arguments& arguments, const std::string& port,
                    const fs::path& told_file) {
  PrintControl control;
  PrintDialogue dialogue(control, ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1);
  auto print = std::async(std::launch::async, [&] {
    send_tray(
        arguments.folder, arguments.tray, port, told_file,
        [&](const PrintReport& report) { dialogue.tell(report); }, control);
  });
  while (print.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    dialogue.listen();
    if (dialogue.has_left() && print.wait_for(kLeave) != std::future_status::ready) end_hot();
  }
  print.get();
}

void tell_interrupted_print(const fs::path& told_file, std::string_view unit) {
  const std::optional<Told> told = read_told(told_file);
  if (told && told->done < told->total)
    fmt::print(stderr, "The print of this tray before ended at {}.\n", told_text(*told, unit));
}

void stream(const Arguments& arguments, int trays) {
  const Profile profile = read_prepared_profile(arguments.folder);
  const DeliveryWay& way = way_of(profile);
  const std::string port = arguments.port.empty() ? way.find_printer(profile) : arguments.port;
  const fs::path told_file = fs::path(arguments.folder) / progress_file(arguments.tray);
  tell_interrupted_print(told_file, way.unit);
  stream_watched(arguments, port, told_file);
  if (arguments.json)
    return print_json(
        {{"state", "done"}, {"tray", arguments.tray}, {"trays", trays}, {"port", port}});
  fmt::print("Printed tray {} of {}.\n", arguments.tray, trays);
  if (arguments.tray < trays)
    fmt::print("Clear the bed, then send the next one with --tray {}.\n", arguments.tray + 1);
}

void deliver(const Arguments& arguments) {
  const std::filesystem::path from =
      std::filesystem::absolute(arguments.folder + "/.").lexically_normal().parent_path();
  const std::filesystem::path target =
      hand_over(arguments.folder, arguments.to, portable_name(from.filename().string()));
  if (arguments.json) return print_json({{"state", "handed_over"}, {"folder", target.string()}});
  fmt::print("Handed over in {}; open it in the printer's own software.\n",
             printable(target.string()));
}

void run(const Arguments& arguments) {
  const PreparedJob job = read_prepared(arguments.folder);
  if (arguments.to.empty())
    stream(arguments, job.trays);
  else
    deliver(arguments);
}

}  // namespace

void add_send(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb =
      program.add_subcommand("send", "Streams a prepared job to its printer, or hands it over");
  verb->add_option("DIR", arguments->folder, "the job folder that prepare made")->required();
  CLI::Option* port = verb->add_option("--port", arguments->port,
                                       "the printer's port: a device, usb:VID:PID:SERIAL or "
                                       "tcp:HOST:PORT; default: the one its USB id is found at")
                          ->type_name("PORT");
  CLI::Option* tray = verb->add_option("--tray", arguments->tray, "which tray of several")
                          ->check(counted_from_one());
  verb->add_option("--to", arguments->to,
                   "the folder to hand over in, for printers that take no job over a cable")
      ->type_name("FOLDER")
      ->excludes(port)
      ->excludes(tray);
  verb->add_flag("--json", arguments->json, "prints JSON");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::cli
