#include "delivery/send.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/move_file.h"
#include "delivery/find_port.h"
#include "delivery/job_folder.h"
#include "delivery/progress_file.h"
#include "firmware_io/gcode/gcode_link.h"
#include "firmware_io/ports/port.h"
#include "firmware_io/s3g/s3g_link.h"
#include "firmware_io/usb/usb_link.h"

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

// A tray's file, which must be there.
fs::path tray_to_send(const fs::path& folder, const Profile& profile, int tray) {
  const fs::path file = folder / tray_file(profile, tray);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored))
    throw Error(Fault::kNoInput,
                fmt::format("The file of tray {}, {}, is not there any more", tray,
                            file.filename().string()),
                kPrepareAnew);
  return file;
}

void check_hash(const std::string& sha256, const std::string& tray_files, int tray,
                const fs::path& file) {
  const std::string recorded = hash_of_tray(tray_files, tray);
  if (!recorded.empty() && sha256 != recorded)
    throw Error(Fault::kBadInput,
                fmt::format("The file of tray {}, {}, is not what was prepared (its bytes were "
                            "changed)",
                            tray, file.filename().string()),
                kPrepareAnew);
}

// Of those that lie in the folder: somebody may have taken others out of it already.
void check_documents(const fs::path& folder, const Profile& profile, int trays,
                     const std::string& tray_files) {
  std::error_code ignored;
  for (int tray = 1; tray <= trays && !tray_files.empty(); ++tray) {
    const fs::path file = folder / tray_file(profile, tray);
    if (fs::exists(file, ignored)) check_hash(sha256_hex_of_file(file), tray_files, tray, file);
  }
}

bool holds_same_report(const fs::path& folder, const fs::path& job_folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "job.json", ignored) &&
         sha256_hex_of_file(folder / "job.json") == sha256_hex_of_file(job_folder / "job.json");
}

}  // namespace

void send_tray(const fs::path& job_folder, int tray, const std::string& port,
               const fs::path& told_file, const PrintListener& listener, PrintControl& control,
               const std::string& tray_files) {
  const PreparedJob job = read_prepared(job_folder);
  const Profile profile = read_prepared_profile(job_folder);
  if (profile.dialect == Dialect::kHandoff)
    throw Error(Fault::kUsage, "The " + profile.name + " takes no job over a cable",
                "Hand it over in a folder: packmerger send DIR --to FOLDER.");
  if (tray < 1 || tray > job.trays)
    throw Error(Fault::kNoInput, fmt::format("The job has no tray {}", tray),
                fmt::format("It has {}; name one of them with --tray.", job.trays));
  const fs::path file = tray_to_send(job_folder, profile, tray);
  const bool is_document = profile.dialect == Dialect::kUsb;
  // a program is hashed as it is sent, a document just before: that is read piece by piece
  const std::string program = is_document ? "" : read_file(file, kMaxProgramBytes);
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
  if (is_document) {
    const UsbDevice device = find_usb_printer(connected_devices().usb, port, profile.link.usb_ids);
    return print_usb(*open_usb_port(device, port), file, options, begins, control);
  }
  const bool is_gcode = profile.dialect == Dialect::kGcode;
  is_gcode ? check_gcode(program) : check_x3g(program);
  const std::string at =
      is_tcp(port) ? port : find_port(connected_serial_ports(), port, profile.link.usb_ids);
  const std::unique_ptr<Port> channel = open_port(at, profile.link.baud);
  const auto print = is_gcode ? print_gcode : print_x3g;
  print(*channel, program, options, begins, control);
}

fs::path hand_over(const fs::path& job_folder, const fs::path& to, const std::string& name,
                   const std::string& tray_files) {
  const PreparedJob job = read_prepared(job_folder);
  const Profile profile = read_prepared_profile(job_folder);
  if (profile.dialect != Dialect::kHandoff)
    throw Error(Fault::kUsage, "The " + profile.name + " is sent its jobs over a cable",
                "Leave --to away, and name its port with --port.");
  const fs::path target = to / name;
  if (holds_same_report(target, job_folder)) {
    check_documents(target, profile, job.trays, tray_files);
    return target;
  }
  std::error_code ignored;
  if (!fs::is_directory(to, ignored))
    throw Error(Fault::kCannotWrite, to.string() + " is no folder that can be written to",
                "Make the folder, or connect the share it lies on.");
  TemporaryFolder folder = TemporaryFolder::beside(target);
  const std::string made = folder.path().string();
  try {
    for (int tray = 1; tray <= job.trays; ++tray)
      copy_file_whole(tray_to_send(job_folder, profile, tray),
                      folder.path() / tray_file(profile, tray));
    check_documents(folder.path(), profile, job.trays, tray_files);  // the very copies
    for (const char* file : {"job.json", "preview.png"})
      copy_file_whole(job_folder / file, folder.path() / file);
    // Whoever takes it from there is another program or person, whatever the umask here.
    fs::permissions(folder.path(), fs::perms{0755}, ignored);
    folder.publish(target);
  } catch (const Error& error) {
    // The same at every attempt: nobody knows the folder for a moment that the copies lie in.
    std::string what = error.what();
    for (auto at = what.find(made); at != std::string::npos; at = what.find(made))
      what.replace(at, made.size(), target.string());
    throw Error(error.fault(), what, error.hint());
  }
  return target;
}

}  // namespace packmerger
