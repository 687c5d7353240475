// The owner of all jobs: decides what happens next, writes it into the database, and only then
// gives the order for it. Runs on the loop's thread alone; it never waits for geometry, for a
// printer or for another disk.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "base/trouble.h"
#include "daemon/intake/folder_worker.h"
#include "daemon/jobs/choose_printer.h"
#include "daemon/jobs/cleaner.h"
#include "daemon/jobs/job_steps.h"
#include "daemon/orders/messages.h"
#include "daemon/settings/config.h"
#include "job/store/job_store.h"

namespace packmerger {

// The queues through which the other threads get their orders. The workers share one, and are given
// no more than they begin at once. Programs have a worker of their own: they are checked in
// seconds, and do not wait behind an hour of packing.
struct WorkQueues {
  Queue<PrepareOrder> workers;
  Queue<PrepareOrder> checker;
  std::map<std::filesystem::path, FolderQueue>
      folders;  // watched ones, those jobs came from, and that of the jobs
  std::map<std::string, Queue<SendOrder>> senders;  // by printer
  std::map<std::string, Pulse> handing_over;        // by printer: its sender at another disk

  explicit WorkQueues(const DaemonConfig& config) {
    for (const PrinterConfig& printer : config.printers) senders[printer.name];
  }
};

// What is known of a job beyond its record, while the daemon runs.
struct LiveJob {
  std::shared_ptr<std::atomic<bool>> cancel_prepare;  // while it is with the worker
  std::shared_ptr<PrintControl> control;              // while it is with a sender
  bool with_folder_worker = false;                    // while a folder worker takes or files it
  std::string stage;                                  // of preparing
  double fraction = 0;  // of that stage, or of the tray that is printed
  PrintReport print;
  bool ended_by_stop = false;  // its print was cancelled by the daemon's end, and by nobody before
  int failures = 0;            // to start this tray, or to file the model
  double retry_s = 0;          // not before, on the clock of advance()
  double next_s = 0;           // the same as Unix time
  std::string trouble;         // why its file could not be taken or filed so far; empty: nothing
  double trouble_since_s = 0;  // Unix time
  std::set<std::string> told;  // why its tray could not be begun, as far as that was told
};

// Who has a job: one of the workers, or the one for programs.
enum class Preparer { kWorker, kChecker };

class JobManager {
 public:
  using Log = std::function<void(const std::string&)>;

  JobManager(const DaemonConfig& config, JobStore& store, WorkQueues& queues, Log log);

  // Once, at the start: finishes or forgets half-done claims, fails half-sent prints, sends
  // half-prepared jobs back to be prepared, and those of which nothing was sent yet back to wait,
  // unless the daemon died at the same job again and again; lets no order of before start a print.
  void recover();

  // The one door for files that do not lie in a watched folder: takes upload.file, which is
  // elsewhere in the state folder, as if it had been put into the printer's folder under its name.
  // Throws Error{kNoInput} for a printer that is not there, Error{kBadInput} for a name that
  // job_file_name() refuses or a program that the printer cannot be sent (the file is then left
  // where it is), Error{kBusy} where it cannot be taken now.
  JobRecord uploaded(const UploadedJob& upload);

  // Throws Error when the database cannot be written; the event then has to be given again.
  // Whatever else goes wrong fails the event's job.
  void handle(const Event& event);

  // Starts whatever can be started. now_s: a clock that never goes back.
  void advance(double now_s);

  // Has old jobs' folders deleted. Needs no write to the disk: one that is full is cleared first.
  void clean(double now_s);

  // No further work is started, what runs is told to end. Prints end as failed.
  void stop();

  // What people ask for. Each returns the job or printer as it is afterwards. Throws
  // Error{kNoInput} when there is none of that name, Error{kUsage} when it makes no sense in its
  // state.
  JobRecord approve(std::int64_t id);  // also ends a hold
  JobRecord hold(std::int64_t id);
  JobRecord put_first(std::int64_t id);  // before all others that wait
  JobRecord cancel(std::int64_t id);
  // A new job from an ended one: its stored program, which counts as approved where that job was,
  // or its filed model, prepared anew.
  JobRecord again(std::int64_t id);
  // Has a model prepared in another way (packed, hollow, solid, cheapest): a job of which nothing
  // is printed yet, which loses its approval, or a new one from an ended one.
  JobRecord prepare(std::int64_t id, const std::string& variant);
  JobRecord remove(std::int64_t id);  // the folder of one that ended; it stays in the history
  PrinterRecord clear(const std::string& printer);
  // Pauses the print that runs there and lets no other start; or the contrary.
  PrinterRecord pause(const std::string& printer, bool paused);
  // Answers what the printer asks its user: the index of one of its choices, 0 to go on.
  PrinterRecord answer(const std::string& printer, int choice);
  // Stops the print that runs there at once; it fails.
  PrinterRecord stop_at_once(const std::string& printer);

  const DaemonConfig& config() const { return config_; }
  const JobStore& store() const { return store_; }
  const Cleaner& cleaner() const { return cleaner_; }
  JobSteps& steps() { return steps_; }
  const LiveJob* live(std::int64_t id) const;
  // What keeps a job from being taken, begun or filed, although it is tried; nothing: nothing does.
  std::optional<Trouble> trouble_of(const JobRecord& job) const;
  // Whether a print that could not be begun is being tried again, and has not begun.
  static bool is_tried_again(const JobRecord& job);
  // The jobs with the workers.
  const std::map<std::int64_t, Preparer>& preparing() const { return preparing_; }
  // Whether an ended job's program is still there to be printed again.
  bool has_program(const JobRecord& ended) const;
  // The job that again() makes of such a one, before it is stored: ready or approved.
  JobRecord again_of(const JobRecord& ended) const;
  // Whether the settings, or whoever sent it, approve a job that is ready.
  bool is_approved_by_itself(const JobRecord& ready) const;
  // Of jobs that could be gone on with, that with the least comes first: one of which trays are
  // printed already, then the one that was put first last, then the one that came first.
  static std::tuple<bool, std::int64_t, std::int64_t> turn_of(const JobRecord& job);
  // The job that is with the printer's sender; 0: none.
  std::int64_t sending_at(const std::string& printer) const;
  // How much longer the printer takes than estimates of this source predict, as its finished prints
  // taught; nothing while they are too few.
  const std::optional<Correction>& correction(const std::string& printer,
                                              const std::string& source) const;
  // Whether the printer is there, as far as that is told without disturbing it: of one behind a
  // serial server its last job tells. Nothing: not known, or it is handed its jobs.
  std::optional<bool> connected(const PrinterConfig& printer) const;
  // Of the printer itself (printer) and its folders (folder, handoff_folder), by these names.
  Troubles troubles_at(const PrinterConfig& printer) const;
  // Of neither a job nor a printer, by what has them.
  Troubles troubles() const;
  // All that a part of the daemon has now, which is named by `of`.
  void note_troubles(const std::string& of, Troubles troubles);

 private:
  std::filesystem::path job_path(std::int64_t id) const;
  std::filesystem::path told_file(const JobRecord& job) const;
  void note_told(JobRecord& job) const;
  std::string with_told(const JobRecord& job, const std::string& reason) const;
  JobRecord get(std::int64_t id) const;
  const PrinterConfig& get_printer(const std::string& name) const;
  void drop_order(JobRecord& job);
  LiveJob* printing_at(const std::string& printer);
  LiveJob& get_printing(const std::string& printer);
  void say(const JobRecord& job, const std::string& text) const;
  void end(JobRecord& job, JobEventKind event, const std::string& reason, const std::string& hint,
           const std::string& note = {}, const PrinterRecord* printer = nullptr);

  void recover(JobRecord& job);
  void recover_sending(JobRecord& job);
  void tried_to_death(JobRecord& job, const char* what);
  bool try_for(std::int64_t job, const std::function<void()>& work);
  void fail(std::int64_t job, const std::string& why, const std::string& hint);
  void let_worker_go(std::int64_t job);
  void let_sender_go(std::int64_t job);

  JobRecord begun(JobEventKind event, const PrinterConfig& printer,
                  const std::filesystem::path& origin, bool with_settings);
  Queue<FolderOrder>& folder_queue_of(const JobRecord& job);
  void claim(const JobRecord& job);
  bool take_upload(const JobRecord& job, const std::filesystem::path& file);
  void settle(JobRecord job);
  void forget_trouble(std::int64_t id);
  void forget(JobRecord job);
  void finish_claim(const JobRecord& job);
  void hold_up(const JobRecord& job, const std::string& trouble);
  void retry_later(LiveJob& live) const;
  void wait_on(JobRecord& job, const PrinterRecord* printer = nullptr);
  void started_after_all(std::int64_t id);
  FileOrder file_order(const JobRecord& job) const;
  void notice_folders();
  Troubles folder_troubles(const PrinterConfig& printer) const;

  void on(const PrepareProgress& event);
  void on(const Hashed& event);
  void on(const Compared& event);
  void on(const Prepared& event);
  void on(const PrepareFailed& event);
  void on(const Arrived& event);
  void on(const FileIgnored& event);
  void on(const FolderTold& event);
  void on(const Claimed& event);
  void on(const Fetched& event);
  void on(const Placed& event);
  void on(const Filed& event);
  void on(const Deleted& event) { cleaner_.on(event); }
  void on(const SendProgress& event);
  void on(const SendEnded& event);
  void on(const DevicesSeen& event);
  void note_reached(const JobRecord& job, const SendEnded& event);
  void advise(const PrinterConfig& printer);
  void notice_printers();
  void sent(JobRecord job, const SendEnded& event);
  PrinterRecord with_bed_as_before(const JobRecord& job, Fault why_not_begun) const;
  void not_started(JobRecord job, const SendEnded& event);
  void end_untouched(JobRecord job, const SendEnded& event);

  JobRecord print_again(const JobRecord& old);
  JobRecord prepare_again(const JobRecord& old, const std::string& wanted = {});
  JobRecord with_file(const JobRecord& old) const;

  void drop_idle_live_jobs();
  void step(const JobRecord& job);
  void check_takes(const PrinterConfig& printer, const std::string& name) const;
  ModelOptions model_options(const PrinterConfig& printer, const PrinterConfig* wish,
                             const JobRecord& job) const;
  bool may_step(const JobRecord& job) const;
  bool is_suspect_preparing() const;
  static Preparer preparer_of(const JobRecord& job);
  bool is_free(Preparer preparer) const;
  double busy_for_s(const PrinterConfig& printer, std::int64_t new_job, double like_s) const;
  std::string trouble_at(const PrinterConfig& printer) const;
  void start_comparing(JobRecord job, const PrinterConfig& wish);
  void propose(JobRecord job, const PrinterConfig& wish, const std::vector<PrinterOffer>& offers);
  std::vector<std::string> prepare_command(const PrinterConfig& printer,
                                           const JobRecord& job) const;
  std::filesystem::path compared_before(const JobRecord& job) const;
  void start_preparing(const JobRecord& waiting);
  void approve_by_itself(const JobRecord& ready);
  void start_sending(const JobRecord& approved);
  void file_away(const JobRecord& ended);

  const DaemonConfig& config_;
  JobStore& store_;
  WorkQueues& queues_;
  Log log_;
  JobSteps steps_;
  Cleaner cleaner_;
  std::map<std::int64_t, LiveJob> live_;
  std::map<std::int64_t, Preparer> preparing_;         // the jobs with the workers
  std::map<std::string, std::int64_t> sending_;        // the job with each printer's sender
  std::map<std::string, FolderTold> folders_told_;     // by printer, as their folder workers told
  std::map<std::string, std::string> folders_logged_;  // by printer and folder, what was last
  std::map<std::string, Troubles> troubles_;           // by who noted them
  std::optional<Devices> devices_;                     // as last told
  std::map<std::string, bool> reached_;                // printers behind serial servers, at last
  std::map<std::string, bool> there_;                  // printers, when they were last looked at
  bool looked_ = false;                                // what is connected was told once
  std::map<std::string, std::string> advised_;         // printers, the port each was advised on
  // By printer and source, learned when first asked for and forgotten when a print ends.
  mutable std::map<std::pair<std::string, std::string>, std::optional<Correction>> corrections_;
  double now_s_ = 0;
  bool stopping_ = false;
};

}  // namespace packmerger
