#include <memory>

#include <fmt/format.h>

#include "dvi/bags/bag_bytes.h"
#include "dvi/bags/copy_bag.h"
#include "dvi/bags/db3_address.h"
#include "dvi/core/error.h"
#include "dvi/core/interrupt.h"

#ifdef DVI_SQLITE3
#include <sqlite3.h>
#endif

namespace dvi::bags {

#ifdef DVI_SQLITE3
namespace {

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

[[noreturn]] void fail(const fs::path& file, const char* problem, sqlite3* database) {
  throw InputError(file, fmt::format("{} ({})", problem, database == nullptr ? "no memory" : sqlite3_errmsg(database)),
                   "the recording may be damaged, or the disk full");
}

Database open_database(const fs::path& file, const std::string& address, int flags) {
  sqlite3* database = nullptr;
  const int result = sqlite3_open_v2(address.c_str(), &database, flags, nullptr);
  Database out(database, sqlite3_close);
  if (result != SQLITE_OK) fail(file, "cannot be opened", database);
  return out;
}

// The copy of a database, whose messages can be replaced.
class Db3Copy {
 public:
  explicit Db3Copy(const fs::path& file)
      : file_(file), database_(open_database(file, file.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE)) {}

  // Copies all pages, those in a write-ahead log included.
  void fill(const fs::path& from) {
    constexpr int kPagesPerStep = 1024;
    const Database source = open_database(from, make_database_address(from), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    std::unique_ptr<sqlite3_backup, decltype(&sqlite3_backup_finish)> backup(
        sqlite3_backup_init(database_.get(), "main", source.get(), "main"), sqlite3_backup_finish);
    if (!backup) fail(file_, "cannot be written", database_.get());
    int result = SQLITE_OK;
    while (result == SQLITE_OK) {
      result = sqlite3_backup_step(backup.get(), kPagesPerStep);
      throw_if_interrupted();
    }
    backup.reset();
    if (result != SQLITE_DONE) fail(file_, "cannot be written as a copy of the recording", database_.get());
    // An unfinished copy is removed, so that it needs no journal.
    execute("PRAGMA journal_mode=OFF");
    execute("PRAGMA synchronous=OFF");
    execute("BEGIN");
  }

  void replace(std::int64_t id, const ReplacedMessages& replaced, std::size_t number) {
    const Statement row = prepare("SELECT data FROM messages WHERE id = ?1", id, 1);
    if (sqlite3_step(row.get()) != SQLITE_ROW) fail(file_, "lacks a message", database_.get());
    const auto* const data = static_cast<const char*>(sqlite3_column_blob(row.get(), 0));
    const std::string_view message(data, static_cast<std::size_t>(data == nullptr ? 0 : sqlite3_column_bytes(row.get(), 0)));
    const std::string changed = replaced.replace(number, message);
    if (changed == message) return;
    const Statement update = prepare("UPDATE messages SET data = ?1 WHERE id = ?2", id, 2);
    sqlite3_bind_blob64(update.get(), 1, changed.data(), changed.size(), SQLITE_STATIC);
    if (sqlite3_step(update.get()) != SQLITE_DONE) fail(file_, "cannot be written", database_.get());
  }

  void finish() {
    execute("COMMIT");
    sqlite3* const database = database_.release();
    if (sqlite3_close(database) != SQLITE_OK) fail(file_, "cannot be written", database);
  }

 private:
  void execute(const char* command) const {
    if (sqlite3_exec(database_.get(), command, nullptr, nullptr, nullptr) != SQLITE_OK)
      fail(file_, "cannot be written", database_.get());
  }

  Statement prepare(const char* command, std::int64_t id, int parameter) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), command, -1, &statement, nullptr) != SQLITE_OK)
      fail(file_, "cannot be written", database_.get());
    sqlite3_bind_int64(statement, parameter, id);
    return {statement, sqlite3_finalize};
  }

  fs::path file_;
  Database database_;
};

}  // namespace

void copy_db3(const fs::path& from, const fs::path& to, const ReplacedMessages& replaced) {
  Db3Copy copy(to);
  copy.fill(from);
  for (const auto& [chunk, numbers] : replaced.numbers)
    for (const auto& [id, number] : numbers) copy.replace(static_cast<std::int64_t>(id), replaced, number);
  copy.finish();
}
#else
void copy_db3(const fs::path& from, const fs::path&, const ReplacedMessages&) {
  throw InputError(from, "is an SQLite database, which this build of dvi does not support", "build dvi with libsqlite3-dev");
}
#endif

}  // namespace dvi::bags
