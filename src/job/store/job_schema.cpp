#include "job/store/job_schema.h"

#include <array>

#include "base/error.h"

namespace packmerger::sqlite {
namespace {

constexpr const char* kMakeTables = R"(
CREATE TABLE job (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  printer TEXT NOT NULL, name TEXT NOT NULL, origin TEXT NOT NULL, input TEXT NOT NULL,
  by_copy INTEGER NOT NULL,
  sha256 TEXT NOT NULL, state TEXT NOT NULL, held INTEGER NOT NULL, attempt INTEGER NOT NULL,
  folder TEXT NOT NULL, trays INTEGER NOT NULL, next_tray INTEGER NOT NULL, pays INTEGER NOT NULL,
  estimates TEXT NOT NULL, reason TEXT NOT NULL, hint TEXT NOT NULL, filed TEXT NOT NULL,
  filing_done INTEGER NOT NULL, again_of INTEGER NOT NULL, received_s REAL NOT NULL,
  sending_s REAL NOT NULL, ended_s REAL NOT NULL);
CREATE INDEX job_open ON job (id) WHERE ended_s = 0 OR filing_done = 0;
CREATE INDEX job_bytes ON job (sha256);
CREATE TABLE event (
  job INTEGER NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  at_s REAL NOT NULL, state TEXT NOT NULL, note TEXT NOT NULL);
CREATE INDEX event_job ON event (job);
CREATE TABLE printer (
  name TEXT PRIMARY KEY, bed_clear INTEGER NOT NULL, paused INTEGER NOT NULL) WITHOUT ROWID;
PRAGMA user_version = 1;
)";

constexpr const char* kAddTold = R"(
ALTER TABLE job ADD COLUMN told INTEGER NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN told_total INTEGER NOT NULL DEFAULT 0;
PRAGMA user_version = 2;
)";

constexpr const char* kAddPrograms = R"(
ALTER TABLE job ADD COLUMN variant TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN at_once INTEGER NOT NULL DEFAULT 0;
PRAGMA user_version = 3;
)";

constexpr const char* kAddSettings = R"(
ALTER TABLE job ADD COLUMN with_settings INTEGER NOT NULL DEFAULT 0;
PRAGMA user_version = 4;
)";

constexpr const char* kAddTimes = R"(
ALTER TABLE job ADD COLUMN predicted_s REAL NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN predicted_by TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN printed_s REAL NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN paused_s REAL NOT NULL DEFAULT 0;
CREATE INDEX job_printed ON job (printer, predicted_by) WHERE printed_s > 0;
PRAGMA user_version = 5;
)";

constexpr const char* kAddChoice = R"(
ALTER TABLE job ADD COLUMN chosen_by TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN choice TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN profile TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN seed INTEGER NOT NULL DEFAULT 0;
PRAGMA user_version = 6;
)";

constexpr const char* kAddTrayFiles = R"(
ALTER TABLE job ADD COLUMN tray_files TEXT NOT NULL DEFAULT '';
PRAGMA user_version = 7;
)";

// What was approved before shows in its history; that of a job printed again was nobody's approval.
constexpr const char* kAddApproval = R"(
ALTER TABLE job ADD COLUMN approved INTEGER NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN doubt TEXT NOT NULL DEFAULT '';
UPDATE job SET
  approved = EXISTS (SELECT 1 FROM event WHERE event.job = job.id AND event.state = 'approved'
                     AND event.note NOT LIKE 'the program of job % again'),
  doubt = COALESCE((SELECT note FROM event WHERE event.job = job.id AND event.state = 'ready'
                    ORDER BY rowid LIMIT 1), '');
CREATE INDEX job_ended ON job (ended_s) WHERE ended_s > 0;
PRAGMA user_version = 8;
)";

constexpr const char* kAddDeleting = R"(
ALTER TABLE job ADD COLUMN deleted_s REAL NOT NULL DEFAULT 0;
CREATE INDEX job_folder ON job (folder);
CREATE TABLE memory (name TEXT PRIMARY KEY, value REAL NOT NULL) WITHOUT ROWID;
PRAGMA user_version = 9;
)";

constexpr const char* kAddWanted = R"(
ALTER TABLE job ADD COLUMN wanted TEXT NOT NULL DEFAULT '';
PRAGMA user_version = 10;
)";

constexpr const char* kAddTurn = R"(
ALTER TABLE job ADD COLUMN turn INTEGER NOT NULL DEFAULT 0;
PRAGMA user_version = 11;
)";

constexpr const char* kAddTries = R"(
ALTER TABLE job ADD COLUMN trouble TEXT NOT NULL DEFAULT '';
ALTER TABLE job ADD COLUMN trouble_since_s REAL NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN tries INTEGER NOT NULL DEFAULT 0;
PRAGMA user_version = 12;
)";

constexpr const char* kAddWishes = R"(
ALTER TABLE job ADD COLUMN to_delete INTEGER NOT NULL DEFAULT 0;
ALTER TABLE job ADD COLUMN cut_short INTEGER NOT NULL DEFAULT 0;
CREATE INDEX job_to_delete ON job (id) WHERE to_delete = 1;
PRAGMA user_version = 13;
)";

// Each makes the version after the one before it; the first begins with an empty file.
constexpr std::array<const char*, 13> kSteps = {
    kMakeTables,  kAddTold,     kAddPrograms, kAddSettings, kAddTimes, kAddChoice, kAddTrayFiles,
    kAddApproval, kAddDeleting, kAddWanted,   kAddTurn,     kAddTries, kAddWishes};

}  // namespace

void bring_up_to_date(Connection& connection, const std::filesystem::path& file) {
  Transaction transaction(connection);
  Statement version(connection, "PRAGMA user_version");
  const auto found = static_cast<std::size_t>(version.step() ? version.integer() : 0);
  version.finish();
  if (found > kSteps.size())
    throw Error(Fault::kIo, file.string() + " was written by a newer PackMerger",
                "Install that version again, or name another state folder.");
  for (std::size_t step = found; step < kSteps.size(); ++step) connection.run(kSteps.at(step));
  transaction.commit();
}

}  // namespace packmerger::sqlite
