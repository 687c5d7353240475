#include "job/job_store.h"

#include <chrono>
#include <utility>

#include "base/error.h"
#include "job/job_schema.h"
#include "job/jobs_at_hand.h"
#include "job/sqlite.h"

namespace packmerger {

using sqlite::Connection;
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

constexpr std::string_view kColumns =
    "printer, name, origin, input, by_copy, sha256, state, held, attempt, folder, trays, "
    "next_tray, pays, "
    "estimates, reason, hint, filed, filing_done, again_of, received_s, sending_s, ended_s, "
    "told, told_total, variant, at_once, with_settings, predicted_s, "
    "predicted_by, printed_s, paused_s, chosen_by, choice, "
    "profile, seed, tray_files, approved, doubt, deleted_s, "
    "wanted, turn, trouble, trouble_since_s, tries";

// As many as there are columns.
std::string placeholders() {
  std::string text = "?";
  for (const char c : kColumns)
    if (c == ',') text += ",?";
  return text;
}

std::string select(std::string_view condition) {
  return "SELECT id, " + std::string(kColumns) + " FROM job " + std::string(condition);
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

void bind_job(Statement& statement, const JobRecord& job) {
  const auto flag = [](bool value) { return static_cast<std::int64_t>(value); };
  statement.bind(job.printer).bind(job.name).bind(job.origin).bind(job.input);
  statement.bind(flag(job.by_copy)).bind(job.sha256);
  statement.bind(state_name(job.state)).bind(flag(job.held)).bind(std::int64_t{job.attempt});
  statement.bind(job.folder).bind(std::int64_t{job.trays}).bind(std::int64_t{job.next_tray});
  statement.bind(flag(job.pays)).bind(job.estimates).bind(job.reason).bind(job.hint);
  statement.bind(job.filed).bind(flag(job.filing_done)).bind(job.again_of);
  statement.bind(job.received_s).bind(job.sending_s).bind(job.ended_s);
  statement.bind(job.told).bind(job.told_total).bind(job.variant).bind(flag(job.at_once));
  statement.bind(flag(job.with_settings)).bind(job.predicted_s).bind(job.predicted_by);
  statement.bind(job.printed_s).bind(job.paused_s).bind(job.chosen_by).bind(job.choice);
  statement.bind(job.profile).bind(job.seed).bind(job.tray_files);
  statement.bind(flag(job.approved)).bind(job.doubt).bind(job.deleted_s);
  statement.bind(job.wanted).bind(job.turn).bind(job.trouble).bind(job.trouble_since_s);
  statement.bind(std::int64_t{job.tries});
}

JobState read_state(Statement& row) {
  const std::string name = row.text();
  if (const std::optional<JobState> state = state_named(name)) return *state;
  throw Error(Fault::kIo, "The jobs' database holds the unknown state \"" + name + "\"",
              "It was changed by another program; restore it or move it away.");
}

JobRecord read_job(Statement& row) {
  JobRecord job;
  job.id = row.integer();
  job.printer = row.text();
  job.name = row.text();
  job.origin = row.text();
  job.input = row.text();
  job.by_copy = row.flag();
  job.sha256 = row.text();
  job.state = read_state(row);
  job.held = row.flag();
  job.attempt = static_cast<int>(row.integer());
  job.folder = row.text();
  job.trays = static_cast<int>(row.integer());
  job.next_tray = static_cast<int>(row.integer());
  job.pays = row.flag();
  job.estimates = row.text();
  job.reason = row.text();
  job.hint = row.text();
  job.filed = row.text();
  job.filing_done = row.flag();
  job.again_of = row.integer();
  job.received_s = row.real();
  job.sending_s = row.real();
  job.ended_s = row.real();
  job.told = row.integer();
  job.told_total = row.integer();
  job.variant = row.text();
  job.at_once = row.flag();
  job.with_settings = row.flag();
  job.predicted_s = row.real();
  job.predicted_by = row.text();
  job.printed_s = row.real();
  job.paused_s = row.real();
  job.chosen_by = row.text();
  job.choice = row.text();
  job.profile = row.text();
  job.seed = row.integer();
  job.tray_files = row.text();
  job.approved = row.flag();
  job.doubt = row.text();
  job.deleted_s = row.real();
  job.wanted = row.text();
  job.turn = row.integer();
  job.trouble = row.text();
  job.trouble_since_s = row.real();
  job.tries = static_cast<int>(row.integer());
  return job;
}

std::vector<JobRecord> read_jobs(Statement& rows) {
  std::vector<JobRecord> jobs;
  while (rows.step()) jobs.push_back(read_job(rows));
  return jobs;
}

void write_event(const Connection& connection, const JobRecord& job, std::string_view note) {
  Statement statement(connection, "INSERT INTO event (job, at_s, state, note) VALUES (?, ?, ?, ?)");
  statement.bind(job.id).bind(now_s()).bind(state_name(job.state)).bind(note).finish();
}

// The newest job with the bytes of this one among those whose id fits; 0: none.
std::int64_t newest_alike(const Connection& connection, const JobRecord& job,
                          const std::string& id_fits) {
  Statement row(connection, "SELECT id FROM job WHERE sha256 = ? AND sha256 <> '' AND " + id_fits +
                                " ORDER BY id DESC LIMIT 1");
  row.bind(job.sha256).bind(job.id);
  return row.step() ? row.integer() : 0;
}

// Of two jobs in one folder neither is deleted before the other.
constexpr std::string_view kDeletable =
    "WHERE ended_s > 0 AND ended_s <= ? AND filing_done = 1 AND deleted_s = 0 AND NOT EXISTS "
    "(SELECT 1 FROM job AS other WHERE other.folder = job.folder AND other.folder <> '' AND "
    "(other.ended_s = 0 OR other.ended_s > ? OR other.filing_done = 0))";

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
  Statement open(connection, select("WHERE ended_s = 0 OR filing_done = 0"));
  take(open);
  Statement ended(connection, select("WHERE ended_s > 0 ORDER BY ended_s DESC, id DESC LIMIT ?"));
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
  Statement statement(connection, "INSERT INTO job (" + std::string(kColumns) + ") VALUES (" +
                                      placeholders() + ")");
  bind_job(statement, job);
  statement.finish();
  job.id = sqlite3_last_insert_rowid(connection.get());
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
  Statement statement(connection, "UPDATE job SET (" + std::string(kColumns) + ") = (" +
                                      placeholders() + ") WHERE id = ?");
  bind_job(statement, job);
  statement.bind(job.id).finish();
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
  Statement row(database_->connection, select("WHERE id = ?"));
  if (!row.bind(id).step()) return std::nullopt;
  return read_job(row);
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
                 select("WHERE ended_s > 0 AND " +
                        std::string(is_ended ? "(ended_s, id) < (?, ?)" : "id < ?") +
                        " ORDER BY ended_s DESC, id DESC LIMIT ?"));
  if (is_ended) rows.bind(last->ended_s);
  rows.bind(before).bind(std::int64_t{limit});
  return read_jobs(rows);
}

std::vector<JobRecord> JobStore::deletable(double until_s, int limit) const {
  Statement rows(database_->connection,
                 select(std::string(kDeletable) + " ORDER BY ended_s, id LIMIT ?"));
  rows.bind(until_s).bind(until_s).bind(std::int64_t{limit});
  return read_jobs(rows);
}

std::int64_t JobStore::count_deletable(double until_s) const {
  Statement row(database_->connection, "SELECT COUNT(*) FROM job " + std::string(kDeletable));
  row.bind(until_s).bind(until_s);
  return row.step() ? row.integer() : 0;
}

double JobStore::ended_beyond(int kept) const {
  Statement row(database_->connection,
                "SELECT ended_s FROM job WHERE ended_s > 0 AND deleted_s = 0 "
                "ORDER BY ended_s DESC LIMIT 1 OFFSET ?");
  row.bind(std::int64_t{kept});
  return row.step() ? row.real() : 0;
}

std::vector<JobRecord> JobStore::sharing(const JobRecord& job) const {
  Statement rows(database_->connection,
                 select("WHERE id = ? OR (folder = ? AND folder <> '') ORDER BY id"));
  rows.bind(job.id).bind(job.folder);
  return read_jobs(rows);
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
  Statement rows(database_->connection,
                 "SELECT at_s, state, note FROM event WHERE job = ? ORDER BY rowid");
  rows.bind(id);
  std::vector<JobEvent> events;
  while (rows.step()) {
    JobEvent event;
    event.at_s = rows.real();
    event.state = read_state(rows);
    event.note = rows.text();
    events.push_back(std::move(event));
  }
  return events;
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
