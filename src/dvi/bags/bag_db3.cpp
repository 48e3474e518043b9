#include <map>
#include <memory>
#include <mutex>

#include <fmt/format.h>

#include "dvi/bags/bag.h"
#include "dvi/bags/bag_bytes.h"
#include "dvi/bags/db3_address.h"
#include "dvi/core/error.h"

#ifdef DVI_SQLITE3
#include <sqlite3.h>
#endif

namespace dvi::bags {

std::string make_database_address(const fs::path& path) {
  std::error_code error;
  const fs::path log = path.string() + "-wal";
  const bool has_log = fs::exists(log) && fs::file_size(log, error) > 0;
  std::string address = "file:";
  for (const char c : fs::absolute(path).string())
    address += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02X}", static_cast<unsigned char>(c)) : std::string(1, c);
  return address + (has_log ? "" : "?immutable=1");
}

#ifdef DVI_SQLITE3
namespace {

// A database that is opened for reading only.
class Db3 {
 public:
  explicit Db3(fs::path path) : path_(std::move(path)) {
    require_bag_file(path_);
    sqlite3* database = nullptr;
    const int result =
        sqlite3_open_v2(make_database_address(path_).c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(database);
    if (result != SQLITE_OK) fail("cannot be opened");
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxBagRecordBytes));
  }

  /// Calls `take` for each row of a query. `id` is the value of its parameter ?1, if there is one.
  void for_each(const char* query, std::int64_t id, const std::function<void(sqlite3_stmt*)>& take) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &statement, nullptr) != SQLITE_OK) fail("is not a ROS 2 bag");
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> owner(statement, sqlite3_finalize);
    if (sqlite3_bind_parameter_count(statement) > 0) sqlite3_bind_int64(statement, 1, id);
    int result = sqlite3_step(statement);
    for (; result == SQLITE_ROW; result = sqlite3_step(statement)) take(statement);
    if (result == SQLITE_TOOBIG)
      throw InputError(path_, fmt::format("holds a message larger than the limit of {} bytes", kMaxBagRecordBytes),
                       "record it again without the topic");
    if (result != SQLITE_DONE) fail("is damaged");
  }

  std::string read(std::int64_t id) const {
    const std::scoped_lock lock(mutex_);
    std::string out;
    for_each("SELECT data FROM messages WHERE id = ?1", id, [&](sqlite3_stmt* row) {
      const auto* bytes = static_cast<const char*>(sqlite3_column_blob(row, 0));
      out.assign(bytes, static_cast<std::size_t>(bytes == nullptr ? 0 : sqlite3_column_bytes(row, 0)));
    });
    return out;
  }

  const fs::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(const char* problem) const {
    throw InputError(path_, fmt::format("{} ({})", problem, database_ ? sqlite3_errmsg(database_.get()) : "no memory"),
                     "the recording is truncated or damaged; repair it (sqlite3 FILE .recover) or record it again");
  }

  fs::path path_;
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database_{nullptr, sqlite3_close};
  mutable std::mutex mutex_;
};

std::string read_text(sqlite3_stmt* row, int column) {
  const unsigned char* text = sqlite3_column_text(row, column);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

}  // namespace

Bag open_db3(const fs::path& path) {
  const auto database = std::make_shared<Db3>(path);
  std::map<std::int64_t, BagTopic> topics;
  database->for_each("SELECT id, name, type, serialization_format FROM topics", 0, [&](sqlite3_stmt* row) {
    topics[sqlite3_column_int64(row, 0)] = {read_text(row, 1), read_text(row, 2),
                                            read_text(row, 3) == "cdr" ? BagEncoding::cdr : BagEncoding::other};
  });
  database->for_each("SELECT id, topic_id, timestamp FROM messages", 0, [&](sqlite3_stmt* row) {
    const auto topic = topics.find(sqlite3_column_int64(row, 1));
    if (topic == topics.end())
      throw InputError(path, fmt::format("message {} is of topic {}, which does not exist", sqlite3_column_int64(row, 0),
                                         sqlite3_column_int64(row, 1)));
    topic->second.messages.push_back(
        {sqlite3_column_int64(row, 2), 0, 0, static_cast<std::uint64_t>(sqlite3_column_int64(row, 0))});
  });
  Bag out;
  out.files = {path};
  for (auto& [id, topic] : topics) out.topics.push_back(std::move(topic));
  out.read = [database](const BagEntry& entry) { return database->read(static_cast<std::int64_t>(entry.offset)); };
  return out;
}
#else
Bag open_db3(const fs::path& path) {
  throw InputError(path, "is an SQLite database, which this build of dvi does not support", "build dvi with libsqlite3-dev");
}
#endif

}  // namespace dvi::bags
