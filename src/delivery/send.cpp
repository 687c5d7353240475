#include "delivery/send.h"

#include <fmt/format.h>

#include "base/error.h"
#include "delivery/job_folder.h"
#include "delivery/progress_file.h"
#include "delivery/tray_to_send.h"
#include "delivery/way.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxProgramBytes = std::uint64_t{1} << 30;

StreamOptions stream_options(const Profile& profile, const PreparedJob& job, int tray) {
  StreamOptions options;
  options.timeout_s = profile.link.timeout_s;
  options.boot_wait_s = profile.link.boot_wait_s;
  options.build_name =
      job.trays > 1 ? fmt::format("{} {}/{}", job.title, tray, job.trays) : job.title;
  options.safe_gcode = profile.link.safe_gcode;
  options.pause_gcode = profile.link.pause_gcode;
  options.resume_gcode = profile.link.resume_gcode;
  options.window_bytes = static_cast<std::size_t>(profile.link.window_bytes);
  options.machine = profile.link.machine;
  return options;
}

}  // namespace

void send_tray(const fs::path& job_folder, int tray, const std::string& port,
               const fs::path& told_file, const PrintListener& listener, PrintControl& control,
               const std::string& tray_files) {
  const PreparedJob job = read_prepared(job_folder);
  const Profile profile = read_prepared_profile(job_folder);
  const DeliveryWay& way = way_of(profile);
  if (way.hands_over)
    throw Error(Fault::kUsage, "The " + profile.name + " takes no job over a cable",
                "Hand it over in a folder: packmerger send DIR --to FOLDER.");
  if (tray < 1 || tray > job.trays)
    throw Error(Fault::kNoInput, fmt::format("The job has no tray {}", tray),
                fmt::format("It has {}; name one of them with --tray.", job.trays));
  const fs::path file = tray_to_send(job_folder, profile, tray);
  const bool is_document = !profile.is_sliced();
  // a program is hashed as it is sent, a document just before: that is read piece by piece
  std::string program = is_document ? "" : read_file(file, kMaxProgramBytes);
  check_hash(is_document ? sha256_hex_of_file(file) : sha256_hex(program), tray_files, tray, file);
  StreamOptions options = stream_options(profile, job, tray);
  ProgressFile told(told_file);
  bool is_begun = false;
  options.on_acknowledged = [&](std::size_t done, std::size_t total) {
    if (!is_begun) return;
    try {
      told.acknowledged(done, total);
    } catch (const Error&) {
      // A print that goes on is worth more than the note of how far it is. The next one is tried.
      if (done == 0) throw;
    }
  };
  // Before the first byte is sent: where the record is missing, nothing was.
  const PrintListener begins = [&](const PrintReport& report) {
    if (!is_begun && has_begun(report)) {
      told.acknowledged(report.done, report.total);
      is_begun = true;
    }
    listener(report);
  };
  way.give({job_folder,
            profile,
            job.trays,
            tray_files,
            port,
            {},
            file,
            std::move(program),
            std::move(options)},
           begins, control);
}

fs::path hand_over(const fs::path& job_folder, const fs::path& to, const std::string& name,
                   const std::string& tray_files) {
  const PreparedJob job = read_prepared(job_folder);
  const Profile profile = read_prepared_profile(job_folder);
  const DeliveryWay& way = way_of(profile);
  if (!way.hands_over)
    throw Error(Fault::kUsage, "The " + profile.name + " is sent its jobs over a cable",
                "Leave --to away, and name its port with --port.");
  PrintControl control;
  way.give(
      {job_folder, profile, job.trays, tray_files, to.string(), name}, [](const PrintReport&) {},
      control);
  return to / name;
}

}  // namespace packmerger
