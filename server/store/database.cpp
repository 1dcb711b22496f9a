#include "server/store/database.h"

#include <sqlite3.h>

#include "render/base/error.h"

namespace standin {
namespace {

[[noreturn]] void fail(sqlite3* database) {
  throw Failure(ErrorWord::kInternal, std::string("job store: ") + sqlite3_errmsg(database));
}

constexpr int kWait_ms = 5000;  // for another process, such as a backup

}  // namespace

void PreparedStatement::Finalize::operator()(sqlite3_stmt* finished) const {
  sqlite3_finalize(finished);
}

void Query::GiveBack::operator()(PreparedStatement* prepared) const {
  sqlite3_reset(prepared->statement.get());
  sqlite3_clear_bindings(prepared->statement.get());
  prepared->lent = false;
}

void Query::check(int code) const {
  if (code != SQLITE_OK) fail(database_);
}

Query& Query::bind(std::int64_t value) {
  check(sqlite3_bind_int64(statement(), ++bound_, value));
  return *this;
}

Query& Query::bind(double value) {
  check(sqlite3_bind_double(statement(), ++bound_, value));
  return *this;
}

Query& Query::bind(std::string_view text) {
  check(sqlite3_bind_text64(statement(), ++bound_, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Query& Query::bind(const std::optional<std::int64_t>& value) {
  return value.has_value() ? bind(*value) : bind_null();
}

Query& Query::bind(const std::optional<double>& value) {
  return value.has_value() ? bind(*value) : bind_null();
}

Query& Query::bind_null() {
  check(sqlite3_bind_null(statement(), ++bound_));
  return *this;
}

bool Query::step() {
  const int code = sqlite3_step(statement());
  if (code != SQLITE_ROW && code != SQLITE_DONE) fail(database_);
  return code == SQLITE_ROW;
}

void Query::run() {
  while (step()) {
  }
}

std::int64_t Query::integer(int column) const {
  return sqlite3_column_int64(statement(), column);
}

double Query::real(int column) const {
  return sqlite3_column_double(statement(), column);
}

std::string Query::text(int column) const {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement(), column));
  return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement(), column)));
}

bool Query::is_null(int column) const {
  return sqlite3_column_type(statement(), column) == SQLITE_NULL;
}

Database::Database(const std::filesystem::path& file) {
  if (sqlite3_open(file.c_str(), &database_) != SQLITE_OK) {
    const std::string reason = sqlite3_errmsg(database_);
    sqlite3_close(database_);
    throw Failure(ErrorWord::kFileMissing, "job store " + file.string() + ": " + reason);
  }
  sqlite3_busy_timeout(database_, kWait_ms);
  execute("PRAGMA journal_mode = WAL");
  execute("PRAGMA synchronous = FULL");
  execute("PRAGMA foreign_keys = ON");
}

Database::~Database() {
  statements_.clear();
  sqlite3_close(database_);
}

PreparedStatement& Database::prepared(const std::string& sql) {
  const auto [first, last] = statements_.equal_range(sql);
  for (auto known = first; known != last; ++known)
    if (!known->second.lent) return known->second;
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_, sql.c_str(), static_cast<int>(sql.size()), &statement, nullptr) != SQLITE_OK) fail(database_);
  PreparedStatement& made = statements_.emplace(sql, PreparedStatement{})->second;
  made.statement.reset(statement);
  return made;
}

void Database::execute(const std::string& sql) {
  if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail(database_);
}

int Database::changes() const {
  return sqlite3_changes(database_);
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.execute("ROLLBACK");
  } catch (const Failure&) {  // SQLite rolls back by itself where it can go no further
  }
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace standin
