// What cannot be used now: folders, printers, and what other parts of the daemon tell.
#include "base/names.h"
#include "daemon/jobs/job_manager.h"

namespace packmerger {
namespace {

constexpr double kNoAnswer_s = 10;  // after which a folder's disk is said to hang
constexpr const char* kFolder = "folder";
constexpr const char* kHandOver = "handoff_folder";
constexpr const char* kPrinter = "printer";

}  // namespace

// A folder worker may not know yet that the printer has another folder now.
void JobManager::on(const FolderTold& event) {
  const PrinterConfig* printer = config_.printer(event.printer);
  if (printer != nullptr && printer->folder == event.folder) folders_told_[event.printer] = event;
}

// One that hangs says nothing else any more.
Troubles JobManager::folder_troubles(const PrinterConfig& printer) const {
  Troubles troubles;
  const auto hangs = [&](const char* which, const Pulse& pulse, const std::string& text) {
    if (const std::optional<double> since_s = pulse.hangs_since(kNoAnswer_s))
      troubles[which] = {text, *since_s, 0, 0};
  };
  if (const auto queue = queues_.folders.find(printer.folder); queue != queues_.folders.end())
    hangs(kFolder, queue->second.pulse,
          "its folder does not answer: " + printable(printer.folder.string()));
  if (const auto sender = queues_.handing_over.find(printer.name);
      sender != queues_.handing_over.end())
    hangs(kHandOver, sender->second,
          "its hand-over folder does not answer: " + printable(printer.handoff_folder.string()));
  const auto told = folders_told_.find(printer.name);
  if (told != folders_told_.end() && told->second.trouble)
    troubles.emplace(kFolder, *told->second.trouble);
  return troubles;
}

// With those of the job that waits longest for it.
Troubles JobManager::troubles_at(const PrinterConfig& printer) const {
  Troubles troubles = folder_troubles(printer);
  const auto told = folders_told_.find(printer.name);
  if (told != folders_told_.end() && told->second.others > 0 && troubles.contains(kFolder) &&
      troubles.at(kFolder).tries > 0)
    troubles.at(kFolder).what += " (and " + std::to_string(told->second.others) + " more)";
  std::optional<Trouble> longest;
  for (const auto& [id, job] : store_.open_jobs()) {
    if (job.tries == 0 || job.printer != printer.name) continue;
    const std::optional<Trouble> trouble = trouble_of(job);
    if (trouble && (!longest || trouble->since_s < longest->since_s)) longest = trouble;
  }
  if (longest) troubles.emplace(printer.hands_over() ? kHandOver : kPrinter, *longest);
  return troubles;
}

// One line when it begins, and one when it is over. How many files it is changes often.
void JobManager::notice_folders() {
  for (const PrinterConfig& printer : config_.printers) {
    const Troubles troubles = folder_troubles(printer);
    for (const char* which : {kFolder, kHandOver}) {
      const auto found = troubles.find(which);
      const std::string trouble = found == troubles.end() ? "" : found->second.what;
      std::string& logged = folders_logged_[printer.name + " " + which];
      if (trouble == logged) continue;
      const std::string usable =
          which == kFolder ? "its folder is usable again" : "its hand-over folder answers again";
      log_("printer " + printer.name + ": " + (trouble.empty() ? usable : trouble));
      logged = trouble;
    }
  }
}

void JobManager::note_troubles(const std::string& of, Troubles troubles) {
  troubles_[of] = std::move(troubles);
}

Troubles JobManager::troubles() const {
  Troubles all;
  for (const auto& [of, troubles] : troubles_) all.insert(troubles.begin(), troubles.end());
  if (const std::optional<Trouble>& trouble = cleaner_.trouble())
    all.emplace("deleting old jobs", *trouble);
  return all;
}

}  // namespace packmerger
