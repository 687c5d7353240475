// What the daemon's threads tell each other, as values through base/queue.h. The loop's thread
// alone owns jobs and the database; the others get orders and answer with events.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "base/queue.h"
#include "base/trouble.h"
#include "daemon/settings/config.h"
#include "firmware_io/ports/devices.h"
#include "firmware_io/print_state.h"

namespace packmerger {

struct Failure {
  Fault fault = Fault::kInternal;
  std::string what;
  std::string hint;
};

// To the workers, each of which prepares one job after the other.
struct CompareOrder {
  std::string printer;
  std::vector<std::string> argv;  // of the child process
  std::string variant;            // what would be prepared there
};
struct PrepareOrder {
  std::int64_t job = 0;
  std::filesystem::path input;
  std::filesystem::path out;          // the job folder to be made
  std::vector<std::string> argv;      // of the child process
  std::vector<CompareOrder> compare;  // instead: only the figures, for each of these printers
  PrepareConfig limits;
  std::shared_ptr<std::atomic<bool>> cancel;
};

// To the worker of a folder (folder_worker.h), which alone touches what lies there: a disk
// that hangs keeps nobody else waiting.
struct WatchOrder {     // looks for files that arrive, from now on
  std::string printer;  // whose they are; empty: no longer
  WatchConfig rules;
  double retry_s = 30;  // before what failed is tried again
};
// Takes a file that arrived, and the settings beside it, to where its job is. What was taken
// already stays so: a claim that was interrupted is finished by the same order.
struct ClaimOrder {
  std::int64_t job = 0;
  std::filesystem::path from;
  std::filesystem::path to;
  bool with_settings = false;
  bool by_copy = false;  // it was copied, and the originals may still be there
};
struct FetchOrder {  // copies a file that cannot be renamed to where it belongs
  std::int64_t job = 0;
  std::filesystem::path from;
  std::filesystem::path to;
  bool with_settings = false;  // the settings file beside it too, where there is one
  bool keep = false;           // otherwise the originals are removed
};
struct PlaceOrder {  // finds a name that is free for a job's file at its end
  std::int64_t job = 0;
  std::filesystem::path folder;  // done/ or failed/
  std::string name;
};
// Puts a job's file into done/ or failed/, and beside it its settings file, a picture and a note.
struct FileOrder {
  std::int64_t job = 0;
  std::filesystem::path from;
  std::filesystem::path to;
  bool with_settings = false;
  std::filesystem::path picture;  // copied where it is there
  std::filesystem::path note;
  std::string note_text;
};
// Deletes folders with all that is in them; those that are not there are no failure.
struct DeleteOrder {
  std::vector<std::int64_t> jobs;
  std::vector<std::filesystem::path> folders;  // of each
};
using FolderOrder =
    std::variant<WatchOrder, ClaimOrder, FetchOrder, PlaceOrder, FileOrder, DeleteOrder>;

// To a printer's sender.
struct SendOrder {
  std::int64_t job = 0;
  std::filesystem::path folder;  // the prepared job folder
  int tray = 1;
  std::string handoff_name;         // of the folder that is handed over
  std::filesystem::path told_file;  // where it is kept how far the printer was told to go
  std::shared_ptr<PrintControl> control;
  std::string tray_files;  // of the job when it was prepared; empty: not known
};

// A file that came through a door (the page, a program, a slicer) and lies in the state folder;
// whoever takes it moves it away.
struct UploadedJob {
  std::string printer;
  std::string name;  // as its sender calls it; job_file_name() makes a name of it
  std::filesystem::path file;
  bool at_once = false;  // print it as soon as it is ready: its sender approves it
  bool held = false;     // whatever the settings say, print nothing before somebody approves it
};

// To the loop.
struct PrepareProgress {
  std::int64_t job = 0;
  std::string stage;
  double fraction = 0;  // of the stage
};
struct Hashed {
  std::int64_t job = 0;
  std::string sha256;
};
struct Prepared {
  std::int64_t job = 0;
  int trays = 0;
  std::string estimates;  // JSON text
  std::string profile;    // its id
  std::int64_t seed = 0;
  std::string variant;       // what was prepared: packed, hollow, solid or program
  double predicted_s = 0;    // by the estimate of that variant; 0: none
  std::string predicted_by;  // its source
  std::string doubt;         // why somebody should look at it before it is printed; empty: nothing
  std::string tray_files;    // job_folder.h's hash_trays()
};
struct ComparedPrinter {
  std::string printer;
  std::string variant;    // what would be prepared there
  std::string estimates;  // JSON text
  std::string failure;    // why there are none; empty: nothing failed
};
struct Compared {
  std::int64_t job = 0;
  std::vector<ComparedPrinter> printers;
};
struct PrepareFailed {
  std::int64_t job = 0;
  Failure failure;
};
struct Arrived {  // a file in a printer's watched folder is whole
  std::string printer;
  std::filesystem::path file;
  bool with_settings = false;  // and has a settings file beside it
};
struct FileIgnored {  // what lies in a watched folder is never taken
  std::filesystem::path file;
  std::string reason;
};
struct FolderTold {  // when it changed, and of each watch first
  std::string printer;
  std::filesystem::path folder;
  std::optional<Trouble> trouble;  // of its folder, or of a file in it; nothing: all is well
  std::size_t others = 0;          // further files that have one too
};
enum class ClaimOutcome {
  kTaken,
  kGone,             // it is not there any more, or not as it was found
  kOtherFileSystem,  // nothing was done: it has to be copied
  kFailed,
};
struct Claimed {
  std::int64_t job = 0;
  ClaimOutcome outcome = ClaimOutcome::kTaken;
  Failure failure;  // of kFailed
};
struct Fetched {
  std::int64_t job = 0;
  std::optional<Failure> failure;
};
struct Placed {
  std::int64_t job = 0;
  std::filesystem::path to;
  std::optional<Failure> failure;
};
struct Filed {
  std::int64_t job = 0;
  std::optional<Failure> failure;
};
struct Deleted {
  std::vector<std::int64_t> jobs;  // whose folders are gone
  std::vector<std::int64_t> left;  // whose are not
  std::optional<Failure> failure;  // of the first of those
};
struct SendProgress {
  std::int64_t job = 0;
  PrintReport report;
};
enum class SendOutcome { kDone, kCancelled, kFailed, kNotStarted };  // kNotStarted: try again
struct SendEnded {
  std::int64_t job = 0;
  SendOutcome outcome = SendOutcome::kDone;
  Failure failure;       // unless done
  std::string note;      // for the history: where it was handed over to
  double printed_s = 0;  // how long it took, pauses left out; 0: nobody can tell
  double paused_s = 0;
  bool untouched = false;  // nothing of the tray had reached the printer, and it does nothing else
};
struct DevicesSeen {               // whenever something was connected or went
  std::optional<Devices> devices;  // nothing: the system does not tell, and why
  std::optional<Failure> failure;
};
using Event = std::variant<PrepareProgress, Hashed, Compared, Prepared, PrepareFailed, Arrived,
                           FileIgnored, FolderTold, Claimed, Fetched, Placed, Filed, Deleted,
                           SendProgress, SendEnded, DevicesSeen>;

}  // namespace packmerger
