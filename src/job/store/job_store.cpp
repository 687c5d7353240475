#include "job/store/job_store.h"

#include <utility>

#include "base/error.h"
#include "job/store/deletable_jobs.h"
#include "job/store/job_rows.h"
#include "job/store/job_schema.h"
#include "job/store/jobs_at_hand.h"
#include "job/store/sqlite.h"

namespace packmerger {

using sqlite::Connection;
using sqlite::read_jobs;
using sqlite::select_jobs;
using sqlite::Statement;
using sqlite::Transaction;

struct JobStore::Database {
  Connection connection;
  Listener listener;
  JobsAtHand jobs;
  std::map<std::string, PrinterRecord> printers;
  explicit Database(const std::filesystem::path& file) : connection(file) {}
};

namespace {

// The newest job with the bytes of this one among those whose id fits; 0: none.
std::int64_t newest_alike(const Connection& connection, const JobRecord& job,
                          const std::string& id_fits) {
  Statement row(connection, "SELECT id FROM job WHERE sha256 = ? AND sha256 <> '' AND " + id_fits +
                                " ORDER BY id DESC LIMIT 1");
  row.bind(job.sha256).bind(job.id);
  return row.step() ? row.integer() : 0;
}

void write_printer(const Connection& connection, const PrinterRecord& printer) {
  Statement statement(connection,
                      "REPLACE INTO printer (name, bed_clear, paused) VALUES (?, ?, ?)");
  statement.bind(printer.name).bind(std::int64_t{printer.bed_clear});
  statement.bind(std::int64_t{printer.paused}).finish();
}

[[noreturn]] void forbidden(const JobRecord& job, std::string_view from) {
  throw Error(Fault::kInternal,
              "Job " + std::to_string(job.id) + " cannot step from " + std::string(from) + " to " +
                  std::string(state_name(job.state)),
              "Please report this as a bug.");
}

}  // namespace

JobStore::JobStore(const std::filesystem::path& file)
    : database_(std::make_unique<Database>(file)) {
  Connection& connection = database_->connection;
  connection.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  bring_up_to_date(connection, file);
  const auto take = [&](Statement& rows) {
    for (const JobRecord& job : read_jobs(rows)) database_->jobs.written(job, job.sha256);
  };
  Statement open(connection, select_jobs("WHERE ended_s = 0 OR filing_done = 0"));
  take(open);
  Statement ended(connection,
                  select_jobs("WHERE ended_s > 0 ORDER BY ended_s DESC, id DESC LIMIT ?"));
  ended.bind(static_cast<std::int64_t>(kLastEnded));
  take(ended);
  Statement printers(connection, "SELECT name, bed_clear, paused FROM printer");
  while (printers.step()) {
    PrinterRecord printer{printers.text()};
    printer.bed_clear = printers.flag();
    printer.paused = printers.flag();
    database_->printers.insert_or_assign(printer.name, printer);
  }
}

JobStore::JobStore(JobStore&&) noexcept = default;
JobStore::~JobStore() = default;

JobRecord JobStore::add(JobRecord job) {
  if (!may_begin(job.state)) forbidden(job, "nothing");
  Connection& connection = database_->connection;
  Transaction transaction(connection);
  job.id = sqlite::insert_job(connection, job);
  write_event(connection, job, "");
  transaction.commit();
  database_->jobs.written(job, "");
  if (database_->listener) database_->listener(job, "");
  return job;
}

void JobStore::save(const JobRecord& job, std::string_view note, const PrinterRecord* printer) {
  write(job, true, note, printer);
}

void JobStore::save_untold(const JobRecord& job, const PrinterRecord* printer) {
  write(job, false, "", printer);
}

void JobStore::write(const JobRecord& job, bool may_tell, std::string_view note,
                     const PrinterRecord* printer) {
  Connection& connection = database_->connection;
  Transaction transaction(connection);
  const std::optional<JobRecord> before = find(job.id);
  const bool stays_ended = before && before->state == job.state && has_ended(job.state);
  if (!before || (!stays_ended && !may_follow(before->state, job.state)))
    forbidden(job, before ? state_name(before->state) : "nothing");
  sqlite::update_job(connection, job);
  const bool is_told = may_tell && (before->state != job.state || !note.empty());
  if (is_told) write_event(connection, job, note);
  if (printer != nullptr) write_printer(connection, *printer);
  transaction.commit();
  database_->jobs.written(job, before->sha256);
  if (printer != nullptr) database_->printers.insert_or_assign(printer->name, *printer);
  if (is_told && database_->listener) database_->listener(job, note);
}

void JobStore::listen(Listener listener) { database_->listener = std::move(listener); }

void JobStore::forget(std::int64_t id) {
  Connection& connection = database_->connection;
  Transaction transaction(connection);
  const std::optional<JobRecord> job = find(id);
  Statement statement(connection, "DELETE FROM job WHERE id = ? AND state = 'claiming'");
  statement.bind(id).finish();
  const bool forgotten = sqlite3_changes(connection.get()) > 0;
  transaction.commit();
  if (forgotten && job) database_->jobs.forgotten(*job);
}

std::optional<JobRecord> JobStore::find(std::int64_t id) const {
  Statement row(database_->connection, select_jobs("WHERE id = ?"));
  row.bind(id);
  std::vector<JobRecord> jobs = read_jobs(row);
  if (jobs.empty()) return std::nullopt;
  return std::move(jobs.front());
}

const std::map<std::int64_t, JobRecord>& JobStore::open_jobs() const {
  return database_->jobs.open();
}

const EndedJobs& JobStore::ended_jobs() const { return database_->jobs.ended(); }

std::vector<JobRecord> JobStore::newest_ended(int limit, std::int64_t before) const {
  const EndedJobs& at_hand = ended_jobs();
  if (before == kFromTheLast && limit <= static_cast<int>(kLastEnded)) {
    std::vector<JobRecord> jobs;
    for (auto job = at_hand.begin(); job != at_hand.end() && limit > 0; ++job, --limit)
      jobs.push_back(job->second);
    return jobs;
  }
  const std::optional<JobRecord> last = find(before);
  const bool is_ended = last && last->ended_s > 0;
  Statement rows(database_->connection,
                 select_jobs("WHERE ended_s > 0 AND " +
                             std::string(is_ended ? "(ended_s, id) < (?, ?)" : "id < ?") +
                             " ORDER BY ended_s DESC, id DESC LIMIT ?"));
  if (is_ended) rows.bind(last->ended_s);
  rows.bind(before).bind(std::int64_t{limit});
  return read_jobs(rows);
}

std::vector<JobRecord> JobStore::deletable(double until_s, int limit) const {
  return sqlite::deletable(database_->connection, until_s, limit);
}

std::int64_t JobStore::count_deletable(double until_s) const {
  return sqlite::count_deletable(database_->connection, until_s);
}

double JobStore::ended_beyond(int kept) const {
  return sqlite::ended_beyond(database_->connection, kept);
}

std::vector<JobRecord> JobStore::sharing(const JobRecord& job) const {
  return sqlite::sharing(database_->connection, job);
}

std::vector<std::int64_t> JobStore::to_delete() const {
  return sqlite::to_delete(database_->connection);
}

bool JobStore::is_empty() const {
  Statement row(database_->connection, "SELECT 1 FROM job LIMIT 1");
  return !row.step();
}

std::optional<double> JobStore::remembered(std::string_view name) const {
  Statement row(database_->connection, "SELECT value FROM memory WHERE name = ?");
  return row.bind(name).step() ? std::optional(row.real()) : std::nullopt;
}

void JobStore::remember(std::string_view name, double value) {
  Transaction transaction(database_->connection);
  Statement statement(database_->connection, "REPLACE INTO memory (name, value) VALUES (?, ?)");
  statement.bind(name).bind(value).finish();
  transaction.commit();
}

std::int64_t JobStore::same_bytes(const JobRecord& job) const {
  return newest_alike(database_->connection, job, "id <> ?");
}

std::int64_t JobStore::same_bytes_before(const JobRecord& job) const {
  JobsAtHand& jobs = database_->jobs;
  if (const std::optional<std::int64_t> known = jobs.same_before(job)) return *known;
  const std::int64_t same = newest_alike(database_->connection, job, "id < ?");
  if (jobs.has(job)) jobs.remember(job, same);
  return same;
}

std::vector<JobEvent> JobStore::history(std::int64_t id) const {
  return sqlite::read_events(database_->connection, id);
}

std::vector<FinishedPrint> JobStore::finished_prints(const std::string& printer,
                                                     std::string_view source, int limit) const {
  Statement rows(database_->connection,
                 "SELECT predicted_s, printed_s FROM job WHERE printer = ? AND predicted_by = ? "
                 "AND state = 'done' AND printed_s > 0 AND predicted_s > 0 AND paused_s < ? "
                 "ORDER BY id DESC LIMIT ?");
  rows.bind(printer).bind(source).bind(kLongPause_s).bind(std::int64_t{limit});
  std::vector<FinishedPrint> prints;
  while (rows.step()) {
    FinishedPrint print;
    print.predicted_s = rows.real();
    print.printed_s = rows.real();
    prints.push_back(print);
  }
  return prints;
}

PrinterRecord JobStore::printer(const std::string& name) const {
  const auto found = database_->printers.find(name);
  return found == database_->printers.end() ? PrinterRecord{name} : found->second;
}

void JobStore::save(const PrinterRecord& printer) {
  Transaction transaction(database_->connection);
  write_printer(database_->connection, printer);
  transaction.commit();
  database_->printers.insert_or_assign(printer.name, printer);
}

}  // namespace packmerger
