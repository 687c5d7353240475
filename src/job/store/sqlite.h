// SQLite in RAII, its codes turned into Error. For job_store.cpp only.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

namespace packmerger::sqlite {

// Throws the Error that fits SQLite's result code.
[[noreturn]] void fail(sqlite3* connection, int code);

struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Prepared = std::unique_ptr<sqlite3_stmt, Finalize>;

class Connection {
 public:
  // Made when absent, readable by its owner alone.
  explicit Connection(const std::filesystem::path& file);

  sqlite3* get() const { return connection_.get(); }
  void run(const char* sql);  // statements without results, no parameters

  // A prepared statement for this text: parsing takes longer than most statements run. The one that
  // is given back is lent again.
  Prepared lend(std::string_view sql) const;
  void give_back(Prepared statement) const;

 private:
  struct Close {
    void operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }
  };
  std::unique_ptr<sqlite3, Close> connection_;
  mutable std::unordered_map<std::string, Prepared> idle_;  // by text
};

// One statement: bind in order, then step() until it is false. The connection outlives it.
class Statement {
 public:
  Statement(const Connection& connection, std::string_view sql);
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  ~Statement();

  Statement& bind(std::int64_t value);
  Statement& bind(double value);
  Statement& bind(std::string_view value);

  bool step();  // true: a row can be read
  void finish() {
    while (step()) {
    }
  }

  // The next column of the row.
  std::int64_t integer();
  double real();
  std::string text();
  bool flag() { return integer() != 0; }

 private:
  [[noreturn]] void fail(int code) const { sqlite::fail(connection_.get(), code); }

  const Connection& connection_;
  Prepared statement_;
  int bound_ = 0;
  int column_ = 0;
};

// Rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(Connection& connection);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();
  void commit();

 private:
  Connection& connection_;
  bool open_ = true;
};

}  // namespace packmerger::sqlite
