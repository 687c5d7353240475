#include "job/store/job_rows.h"

#include <chrono>

#include "base/error.h"

namespace packmerger::sqlite {
namespace {

constexpr std::string_view kColumns =
    "printer, name, origin, input, by_copy, sha256, state, held, attempt, folder, trays, "
    "next_tray, pays, "
    "estimates, reason, hint, filed, filing_done, again_of, received_s, sending_s, ended_s, "
    "told, told_total, variant, at_once, with_settings, predicted_s, "
    "predicted_by, printed_s, paused_s, chosen_by, choice, "
    "profile, seed, tray_files, approved, doubt, deleted_s, "
    "wanted, turn, trouble, trouble_since_s, tries, to_delete, cut_short";

// As many as there are columns.
std::string placeholders() {
  std::string text = "?";
  for (const char c : kColumns)
    if (c == ',') text += ",?";
  return text;
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
  statement.bind(std::int64_t{job.tries})
      .bind(flag(job.to_delete))
      .bind(std::int64_t{job.cut_short});
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
  job.to_delete = row.flag();
  job.cut_short = static_cast<int>(row.integer());
  return job;
}

}  // namespace

std::string select_jobs(std::string_view condition) {
  return "SELECT id, " + std::string(kColumns) + " FROM job " + std::string(condition);
}

std::vector<JobRecord> read_jobs(Statement& rows) {
  std::vector<JobRecord> jobs;
  while (rows.step()) jobs.push_back(read_job(rows));
  return jobs;
}

std::int64_t insert_job(const Connection& connection, const JobRecord& job) {
  Statement statement(connection, "INSERT INTO job (" + std::string(kColumns) + ") VALUES (" +
                                      placeholders() + ")");
  bind_job(statement, job);
  statement.finish();
  return sqlite3_last_insert_rowid(connection.get());
}

void update_job(const Connection& connection, const JobRecord& job) {
  Statement statement(connection, "UPDATE job SET (" + std::string(kColumns) + ") = (" +
                                      placeholders() + ") WHERE id = ?");
  bind_job(statement, job);
  statement.bind(job.id).finish();
}

void write_event(const Connection& connection, const JobRecord& job, std::string_view note) {
  Statement statement(connection, "INSERT INTO event (job, at_s, state, note) VALUES (?, ?, ?, ?)");
  statement.bind(job.id).bind(now_s()).bind(state_name(job.state)).bind(note).finish();
}

std::vector<JobEvent> read_events(const Connection& connection, std::int64_t job) {
  Statement rows(connection, "SELECT at_s, state, note FROM event WHERE job = ? ORDER BY rowid");
  rows.bind(job);
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

}  // namespace packmerger::sqlite
