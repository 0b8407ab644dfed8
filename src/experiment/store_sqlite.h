// The few SQLite calls that the store needs, with errors as exceptions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace springgrasp {

class Statement;

// An open database file. Throws Error naming the file for everything that SQLite refuses.
class Database {
 public:
  enum class Mode { kReadOnly, kCreate };
  Database(const std::string& path, Mode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void Execute(const std::string& sql);
  Statement Prepare(const std::string& sql);
  [[noreturn]] void FailHere() const;

 private:
  std::string path_;
  sqlite3* handle_ = nullptr;
};

// A prepared statement. Parameters and columns count from 0.
class Statement {
 public:
  Statement(const Database& database, sqlite3_stmt* handle);
  Statement(Statement&&) noexcept;
  ~Statement();

  Statement& Bind(int parameter, const std::string& value);
  Statement& Bind(int parameter, std::int64_t value);
  Statement& Bind(int parameter, double value);
  // True while there is a row.
  bool Step();
  // Runs to the end and makes ready for the next binding.
  void Run();

  std::string Text(int column) const;
  std::int64_t Integer(int column) const;
  double Real(int column) const;
  bool IsNull(int column) const;

 private:
  const Database* database_;
  sqlite3_stmt* handle_;
};

// Begins a transaction; rolls back unless Commit() was called.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  void Commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace springgrasp
