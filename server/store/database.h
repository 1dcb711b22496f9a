// SQLite as this house uses it: one connection, values bound by position, failures as exceptions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

struct sqlite3;
struct sqlite3_stmt;

namespace standin {

/// A statement that is prepared once, and lent to one Query at a time.
struct PreparedStatement {
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::unique_ptr<sqlite3_stmt, Finalize> statement;
  bool lent = false;
};

/// A prepared statement at work: bind values in the order of its question marks, then step() through the rows.
class Query {
 public:
  Query(sqlite3* database, PreparedStatement& prepared) : database_(database), prepared_(&prepared) { prepared.lent = true; }

  Query& bind(std::int64_t value);
  Query& bind(double value);
  Query& bind(std::string_view text);
  Query& bind(const std::optional<std::int64_t>& value);
  Query& bind(const std::optional<double>& value);
  Query& bind_null();

  /// True: there is a row, whose columns are counted from 0.
  bool step();
  /// Runs it to its end.
  void run();
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] bool is_null(int column) const;

 private:
  struct GiveBack {
    void operator()(PreparedStatement* prepared) const;
  };
  void check(int code) const;
  [[nodiscard]] sqlite3_stmt* statement() const { return prepared_->statement.get(); }

  sqlite3* database_;
  std::unique_ptr<PreparedStatement, GiveBack> prepared_;
  int bound_ = 0;
};

/// Not to be used by two threads at a time.
class Database {
 public:
  /// Opens or creates the file, in WAL mode: what is committed survives the process, and the machine.
  explicit Database(const std::filesystem::path& file);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const std::string& sql);
  /// `sql` with one question mark for each of `values`.
  template <class... Values>
  Query query(const std::string& sql, const Values&... values) {
    Query query(database_, prepared(sql));
    (query.bind(values), ...);
    return query;
  }
  template <class... Values>
  void run(const std::string& sql, const Values&... values) {
    query(sql, values...).run();
  }
  /// Rows that the last statement changed.
  [[nodiscard]] int changes() const;

 private:
  PreparedStatement& prepared(const std::string& sql);

  sqlite3* database_ = nullptr;
  std::multimap<std::string, PreparedStatement> statements_;  // by their SQL; several where one is lent while it is asked for again
};

/// All or nothing: rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) { database_.execute("BEGIN IMMEDIATE"); }
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace standin
