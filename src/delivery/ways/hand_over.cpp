#include "delivery/ways/hand_over.h"

#include "base/error.h"
#include "base/storage/move_file.h"
#include "delivery/job_folder.h"
#include "delivery/tray_to_send.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

std::optional<std::string> fault_of_settings(const std::string& port,
                                             const fs::path& handoff_folder) {
  if (handoff_folder.empty())
    return "needs the key handoff_folder: this printer takes no job by wire";
  if (!port.empty()) return "cannot have a port: this printer takes no job by wire";
  return std::nullopt;
}

void refuse_programs(const Profile& profile, FileKind) {
  throw Error(Fault::kBadInput, "The " + profile.name + " takes no program over a cable",
              "Drop the model itself: it is prepared, and handed over as a document.");
}

std::string no_port(const Profile&) { return {}; }

std::optional<bool> never_known(const std::string&, const std::optional<Devices>&) {
  return std::nullopt;
}

// Of those that lie in the folder: somebody may have taken others out of it already.
void check_documents(const fs::path& folder, const Delivery& delivery) {
  std::error_code ignored;
  for (int tray = 1; tray <= delivery.trays && !delivery.tray_files.empty(); ++tray) {
    const fs::path file = folder / tray_file(delivery.profile, tray);
    if (fs::exists(file, ignored))
      check_hash(sha256_hex_of_file(file), delivery.tray_files, tray, file);
  }
}

bool holds_same_report(const fs::path& folder, const fs::path& job_folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / kReportFile, ignored) &&
         sha256_hex_of_file(folder / kReportFile) == sha256_hex_of_file(job_folder / kReportFile);
}

void give(const Delivery& delivery, const PrintListener&, PrintControl&) {
  const fs::path to = delivery.to;
  const fs::path target = to / delivery.name;
  if (holds_same_report(target, delivery.folder)) return check_documents(target, delivery);
  std::error_code ignored;
  if (!fs::is_directory(to, ignored))
    throw Error(Fault::kCannotWrite, to.string() + " is no folder that can be written to",
                "Make the folder, or connect the share it lies on.");
  TemporaryFolder folder = TemporaryFolder::beside(target);
  const std::string made = folder.path().string();
  try {
    for (int tray = 1; tray <= delivery.trays; ++tray)
      copy_file_whole(tray_to_send(delivery.folder, delivery.profile, tray),
                      folder.path() / tray_file(delivery.profile, tray));
    check_documents(folder.path(), delivery);  // the very copies
    for (const char* file : {kReportFile, kPictureFile})
      copy_file_whole(delivery.folder / file, folder.path() / file);
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
}

}  // namespace

constinit const DeliveryWay kHandOver = {
    .hands_over = true,
    .has_bed = false,
    .tells_end = false,
    .unit = "byte",
    .simulated = {},
    .fault_of_settings = fault_of_settings,
    .check_program = refuse_programs,
    .find_printer = no_port,
    .is_connected = never_known,
    .give = give,
};

}  // namespace packmerger
