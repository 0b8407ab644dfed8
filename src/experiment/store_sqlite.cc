#include "experiment/store_sqlite.h"

#include <sqlite3.h>

#include <utility>

#include "base/error.h"

namespace springgrasp {

Database::Database(const std::string& path, Mode mode) : path_(path) {
  const int flags =
      mode == Mode::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  if (sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr) != SQLITE_OK) {
    const std::string message = sqlite3_errmsg(handle_);
    sqlite3_close(handle_);
    Fail("{}: {}", path, message);
  }
  sqlite3_busy_timeout(handle_, 10000);
}

Database::~Database() { sqlite3_close(handle_); }

void Database::FailHere() const { Fail("{}: {}", path_, sqlite3_errmsg(handle_)); }

void Database::Execute(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) FailHere();
}

Statement Database::Prepare(const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(handle_, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) FailHere();
  return Statement(*this, statement);
}

Statement::Statement(const Database& database, sqlite3_stmt* handle)
    : database_(&database), handle_(handle) {}
Statement::Statement(Statement&& other) noexcept
    : database_(other.database_), handle_(std::exchange(other.handle_, nullptr)) {}
Statement::~Statement() { sqlite3_finalize(handle_); }

Statement& Statement::Bind(int parameter, const std::string& value) {
  if (sqlite3_bind_text(handle_, parameter + 1, value.data(), static_cast<int>(value.size()),
                        SQLITE_TRANSIENT) != SQLITE_OK) {
    database_->FailHere();
  }
  return *this;
}

Statement& Statement::Bind(int parameter, std::int64_t value) {
  if (sqlite3_bind_int64(handle_, parameter + 1, value) != SQLITE_OK) database_->FailHere();
  return *this;
}

Statement& Statement::Bind(int parameter, double value) {
  if (sqlite3_bind_double(handle_, parameter + 1, value) != SQLITE_OK) database_->FailHere();
  return *this;
}

bool Statement::Step() {
  const int code = sqlite3_step(handle_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_->FailHere();
  return false;
}

void Statement::Run() {
  while (Step()) {
  }
  sqlite3_reset(handle_);
}

std::string Statement::Text(int column) const {
  const unsigned char* text = sqlite3_column_text(handle_, column);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}
std::int64_t Statement::Integer(int column) const { return sqlite3_column_int64(handle_, column); }
double Statement::Real(int column) const { return sqlite3_column_double(handle_, column); }
bool Statement::IsNull(int column) const {
  return sqlite3_column_type(handle_, column) == SQLITE_NULL;
}

Transaction::Transaction(Database& database) : database_(database) {
  database_.Execute("BEGIN IMMEDIATE");
}
Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.Execute("ROLLBACK");
  } catch (const Error&) {
    // SQLite has already rolled back, for example on a full disk.
  }
}
void Transaction::Commit() {
  database_.Execute("COMMIT");
  open_ = false;
}

}  // namespace springgrasp
