#include "job/store/sqlite.h"

#include <fcntl.h>
#include <unistd.h>

#include "base/error.h"

namespace packmerger::sqlite {

void fail(sqlite3* connection, int code) {
  const char* file = connection != nullptr ? sqlite3_db_filename(connection, "main") : nullptr;
  const std::string where = file != nullptr ? file : "the jobs' database";
  const std::string why = connection != nullptr ? sqlite3_errmsg(connection) : sqlite3_errstr(code);
  switch (code & 0xff) {
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      throw Error(Fault::kCannotWrite, "Cannot write " + where + ": " + why,
                  "Check that its disk has free space and that the folder may be written to.");
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      throw Error(Fault::kIo, where + " is damaged: " + why,
                  "Move it away, together with the files beside it that begin with its name; "
                  "the history is then empty, models and job folders stay.");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw Error(Fault::kBusy, where + " is in use: " + why,
                  "End the other program that has it open.");
    default:
      throw Error(Fault::kInternal, where + ": " + why, "Please report this as a bug.");
  }
}

Connection::Connection(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd >= 0) ::close(fd);  // made here for its mode; SQLite tells what is wrong
  sqlite3* raw = nullptr;
  const int code =
      sqlite3_open_v2(file.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr);
  connection_.reset(raw);
  if (code != SQLITE_OK) fail(raw, code);
  sqlite3_extended_result_codes(raw, 1);
  sqlite3_busy_timeout(raw, 2000);
}

void Connection::run(const char* sql) {
  const int code = sqlite3_exec(get(), sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(get(), code);
}

Prepared Connection::lend(std::string_view sql) const {
  const auto found = idle_.find(std::string(sql));
  if (found != idle_.end() && found->second) return std::move(found->second);
  sqlite3_stmt* raw = nullptr;
  const int code = sqlite3_prepare_v3(get(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
  Prepared statement(raw);
  if (code != SQLITE_OK) fail(get(), code);
  return statement;
}

void Connection::give_back(Prepared statement) const {
  sqlite3_reset(statement.get());  // its code repeats what step() told
  sqlite3_clear_bindings(statement.get());
  idle_[sqlite3_sql(statement.get())] = std::move(statement);
}

Statement::Statement(const Connection& connection, std::string_view sql)
    : connection_(connection), statement_(connection.lend(sql)) {}

Statement::~Statement() { connection_.give_back(std::move(statement_)); }

Statement& Statement::bind(std::int64_t value) {
  const int code = sqlite3_bind_int64(statement_.get(), ++bound_, value);
  if (code != SQLITE_OK) fail(code);
  return *this;
}

Statement& Statement::bind(double value) {
  const int code = sqlite3_bind_double(statement_.get(), ++bound_, value);
  if (code != SQLITE_OK) fail(code);
  return *this;
}

Statement& Statement::bind(std::string_view value) {
  const char* bytes = value.empty() ? "" : value.data();  // a null pointer would bind NULL
  const int code = sqlite3_bind_text64(statement_.get(), ++bound_, bytes, value.size(),
                                       SQLITE_TRANSIENT, SQLITE_UTF8);
  if (code != SQLITE_OK) fail(code);
  return *this;
}

bool Statement::step() {
  column_ = 0;
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) fail(code);
  return false;
}

std::int64_t Statement::integer() { return sqlite3_column_int64(statement_.get(), column_++); }

double Statement::real() { return sqlite3_column_double(statement_.get(), column_++); }

std::string Statement::text() {
  const auto* bytes = sqlite3_column_text(statement_.get(), column_);
  const int count = sqlite3_column_bytes(statement_.get(), column_++);
  if (bytes == nullptr) return {};
  return {reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count)};
}

Transaction::Transaction(Connection& connection) : connection_(connection) {
  connection_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (open_) sqlite3_exec(connection_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  connection_.run("COMMIT");
  open_ = false;
}

}  // namespace packmerger::sqlite
