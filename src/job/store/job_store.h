// The daemon's memory: every job and every printer's bed, in one SQLite file. WAL mode,
// synchronous=FULL: when a call has returned, what it wrote survives a power cut; when the program
// dies within a call, it is written whole or not at all.
//
// One thread owns a JobStore. Every call throws Error: kCannotWrite (disk full, read-only), kIo
// (not a database, damaged), kBusy (another program holds it), kInternal (a step that
// job_state.h forbids).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "job/store/correction.h"
#include "job/store/job_state.h"

namespace packmerger {

struct JobRecord {
  std::int64_t id = 0;         // from 1, never used again
  std::string printer;         // the configured printer's name
  std::string chosen_by;       // the entry that proposed this printer; empty: a person named it
  std::string choice;          // how the printers were compared for that, JSON text; may be empty
  std::string name;            // the file's name as it arrived
  std::string origin;          // the path it arrived at; empty for a job printed again
  std::string input;           // the path of the job's own copy; empty once it was filed
  bool by_copy = false;        // claimed by copying, so that its original is removed last
  bool with_settings = false;  // a settings file came with it, and lies beside it
  std::string sha256;          // of its bytes; empty until they were hashed
  JobState state = JobState::kClaiming;
  bool held = false;       // not sent until somebody approves it
  int attempt = 0;         // how often preparing began
  std::string folder;      // the prepared job folder; empty until preparing began
  int trays = 0;           // 0 until prepared
  int next_tray = 1;       // the tray that is sent now or next, from 1
  std::string profile;     // the id of the profile it was prepared with
  std::int64_t seed = 0;   // of its random choices; a program has none
  std::string tray_files;  // what the printer is given of each tray, and the SHA-256 of its bytes
                           // when it was prepared, JSON text; empty: not known
  std::string wanted;      // the variant that somebody asked for; empty: as the settings say
  std::int64_t turn = 0;   // those with more go first, 0: in the order in which they came
  std::string variant;     // what was prepared: packed, hollow, solid, or program: as it came
  bool pays = false;       // nothing speaks against printing what was prepared
  std::string doubt;       // what speaks against it; one sentence
  bool approved = false;   // what was prepared was approved once, by somebody or by the settings
  bool at_once = false;    // an order: whoever sent it, or asked for it again, wants it printed as
                           // soon as it can be. It does not outlive the daemon that took it
  std::string estimates;   // job.json's "estimates", JSON text; empty until prepared
  std::string reason;      // why it failed, was cancelled or asks; one sentence
  std::string hint;        // what to do next; may be empty
  std::string filed;       // where the file ended, below done/ or failed/; empty until chosen
  bool filing_done = false;   // the file and the note beside it are there
  std::int64_t again_of = 0;  // the job whose program or file this one uses again; 0: none
  std::int64_t told = 0;      // of the tray sent last: lines or bytes that the printer acknowledged
  std::int64_t told_total = 0;  // of so many; 0: not known
  double predicted_s = 0;       // by the estimate of what was prepared; 0: none
  std::string predicted_by;     // that estimate's source, as job.json has it
  double printed_s = 0;         // by the trays that are printed, pauses left out; 0: not known
  double paused_s = 0;
  double received_s = 0;   // Unix time
  double sending_s = 0;    // when the first tray began; 0: not yet
  double ended_s = 0;      // 0: not yet
  double deleted_s = 0;    // when its folder was deleted; 0: it was not
  bool to_delete = false;  // somebody wants its folder deleted, and it is not yet
  int cut_short = 0;       // how often in a row the daemon died while it was being prepared or its
                           // print begun
  std::string trouble;     // why the next tray could not be begun at the last try; empty: it was
                           // not tried in vain
  double trouble_since_s = 0;  // Unix time of the first such try
  int tries = 0;               // in vain since then
  std::uint64_t edition = 0;   // which one this is of what the store has at hand: every write makes
                               // another, so that what is made of a record need not be made again.
                               // 0: read from the database, which does not keep it
};

// So many of the jobs that have ended are at hand in memory, the one that ended last first.
inline constexpr std::size_t kLastEnded = 100;
using EndedJobs =
    std::map<std::pair<double, std::int64_t>, JobRecord, std::greater<>>;  // by ended_s and id

struct PrinterRecord {
  std::string name;
  bool bed_clear = false;  // somebody said so, and nothing was printed since
  bool paused = false;     // no new print starts
};

struct JobEvent {
  double at_s = 0;  // Unix time
  JobState state = JobState::kClaiming;
  std::string note;  // may be empty
};

class JobStore {
 public:
  // Opens or makes the file. A file written by a newer PackMerger is refused.
  explicit JobStore(const std::filesystem::path& file);
  JobStore(JobStore&&) noexcept;
  JobStore& operator=(JobStore&&) = delete;
  ~JobStore();

  // Adds a job (its id is ignored) and returns it with its id. state must satisfy may_begin().
  JobRecord add(JobRecord job);

  // Writes a job back, with a line for its history when the state changed or note is not empty.
  // With printer, both are written in one step.
  void save(const JobRecord& job, std::string_view note = {},
            const PrinterRecord* printer = nullptr);

  // The same without a line, although the state may have changed: what is tried again and again
  // is one line of its history.
  void save_untold(const JobRecord& job, const PrinterRecord* printer = nullptr);

  // Called after every line that was written into a history, with the job as it is then. It must
  // not write to the store.
  using Listener = std::function<void(const JobRecord& job, std::string_view note)>;
  void listen(Listener listener);

  // Forgets a job that is still being claimed: its file never left the watched folder.
  void forget(std::int64_t id);

  std::optional<JobRecord> find(std::int64_t id) const;
  // Jobs that have not ended, and ended ones whose file is not yet filed, by id. They are at hand
  // in memory, as the database has them; a write changes them.
  const std::map<std::int64_t, JobRecord>& open_jobs() const;
  // Those that ended last, kLastEnded at most, in the same way.
  const EndedJobs& ended_jobs() const;
  // At most `limit` jobs that have ended, the one that ended last first; with `before` only those
  // that ended before that job, or, where it has not ended, have lower ids.
  std::vector<JobRecord> newest_ended(int limit, std::int64_t before = kFromTheLast) const;
  static constexpr std::int64_t kFromTheLast = std::numeric_limits<std::int64_t>::max();
  // Ended and filed jobs whose folders are still there and that ended at until_s or before, with
  // every job that shares their folder; the one that ended first comes first.
  std::vector<JobRecord> deletable(double until_s, int limit) const;
  std::int64_t count_deletable(double until_s) const;
  // When the job ended that comes after the `kept` that ended last and whose folders are still
  // there; 0: there is none.
  double ended_beyond(int kept) const;
  // Those whose folders somebody wants deleted.
  std::vector<std::int64_t> to_delete() const;
  // Those that use the same job folder, this one too.
  std::vector<JobRecord> sharing(const JobRecord& job) const;
  // Whether there never was a job.
  bool is_empty() const;
  // The newest other job with the same bytes for any printer; 0: none.
  std::int64_t same_bytes(const JobRecord& job) const;
  // The newest such job that came before this one; 0: none. Of a job at hand in memory it is looked
  // up once, and again only where bytes of jobs changed.
  std::int64_t same_bytes_before(const JobRecord& job) const;
  std::vector<JobEvent> history(std::int64_t id) const;
  // At most `limit` prints that teach how long this printer takes, newest first: done, predicted by
  // this source, and paused for less than an hour.
  std::vector<FinishedPrint> finished_prints(const std::string& printer, std::string_view source,
                                             int limit) const;

  // A figure that the daemon keeps over restarts, by its name; nothing: never kept.
  std::optional<double> remembered(std::string_view name) const;
  void remember(std::string_view name, double value);

  // A printer never seen before: its bed is not clear, and it is not paused.
  PrinterRecord printer(const std::string& name) const;
  void save(const PrinterRecord& printer);

 private:
  struct Database;
  void write(const JobRecord& job, bool may_tell, std::string_view note,
             const PrinterRecord* printer);
  std::unique_ptr<Database> database_;
};

}  // namespace packmerger
