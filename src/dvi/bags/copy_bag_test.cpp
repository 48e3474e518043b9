#include "dvi/bags/copy_bag.h"

#include <libdeflate.h>
#include <cstring>
#include <map>
#include <vector>

#include "dvi/bags/bag.h"
#include "dvi/bags/bag_bytes.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/image_folder.h"

namespace dvi::bags {
namespace {

using testing::HasSubstr;

// Bags of all kinds with the same drive, written by the formats' own writers (tests/layouts).
const fs::path kBags = DVI_TEST_BAGS;

/// A message: topic, type, time, and bytes.
using Message = std::tuple<std::string, std::string, std::int64_t, std::string>;

std::vector<Message> read_messages(const Bag& bag) {
  std::vector<Message> out;
  for (const BagTopic& topic : bag.topics)
    for (const BagEntry& entry : topic.messages) out.emplace_back(topic.name, topic.type, entry.time_ns, bag.read(entry));
  return out;
}

/// Copies a bag and appends `more` to every second message of every topic.
std::vector<Message> copy_and_extend(const fs::path& from, const fs::path& to, const std::string& more) {
  const Bag bag = open_bag(from);
  std::vector<Message> expected;
  ReplacedMessages replaced;
  for (const BagTopic& topic : bag.topics)
    for (std::size_t i = 0; i < topic.messages.size(); ++i) {
      const BagEntry& entry = topic.messages[i];
      if (i % 2 == 0) replaced.numbers[entry.chunk][entry.offset] = expected.size();
      expected.emplace_back(topic.name, topic.type, entry.time_ns, bag.read(entry) + (i % 2 == 0 ? more : ""));
    }
  replaced.replace = [&](std::size_t number, std::string_view message) {
    EXPECT_EQ(std::get<3>(expected[number]), std::string(message) + more);
    return std::string(message) + more;
  };
  copy_bag_file(from, to, replaced);
  return expected;
}

class CopyBag : public testing::TestWithParam<const char*> {};

TEST_P(CopyBag, ReplacesSomeMessagesAndKeepsTheOthers) {
  const TempFolder folder;
  const fs::path to = folder.path / ("copy" + fs::path(GetParam()).extension().string());
  const std::vector<Message> expected = copy_and_extend(kBags / GetParam(), to, std::string(1000, 'x'));
  EXPECT_EQ(read_messages(open_bag(to)), expected);
}

TEST_P(CopyBag, KeepsAllBytesIfNoMessageChanges) {
  const TempFolder folder;
  const fs::path to = folder.path / ("copy" + fs::path(GetParam()).extension().string());
  const std::vector<Message> expected = copy_and_extend(kBags / GetParam(), to, "");
  EXPECT_EQ(read_messages(open_bag(to)), expected);
  const bool is_database = to.extension() == ".db3";
  EXPECT_TRUE(is_database || read_file(to) == read_file(kBags / GetParam()));
}

TEST_P(CopyBag, RestoresTheOriginal) {
  const TempFolder folder;
  const fs::path ending = fs::path(GetParam()).extension(), longer = folder.path / ("a" + ending.string()),
                 restored = folder.path / ("b" + ending.string());
  copy_and_extend(kBags / GetParam(), longer, "more");
  const Bag bag = open_bag(longer);
  ReplacedMessages replaced;
  for (const BagTopic& topic : bag.topics)
    for (std::size_t i = 0; i < topic.messages.size(); i += 2)
      replaced.numbers[topic.messages[i].chunk][topic.messages[i].offset] = i;
  replaced.replace = [](std::size_t, std::string_view message) { return std::string(message.substr(0, message.size() - 4)); };
  copy_bag_file(longer, restored, replaced);
  EXPECT_EQ(read_messages(open_bag(restored)), read_messages(open_bag(kBags / GetParam())));
  const bool is_packed_alike = std::string(GetParam()) == "without_chunks.mcap" || std::string(GetParam()) == "bz2.bag";
  EXPECT_TRUE(!is_packed_alike || read_file(restored) == read_file(kBags / GetParam())) << "indices and checksums, too";
}

INSTANTIATE_TEST_SUITE_P(Kinds, CopyBag,
                         testing::Values("zstd.mcap", "lz4_without_index.mcap", "without_chunks.mcap", "lz4.bag", "bz2.bag",
                                         "rgbd.bag", "sqlite.db3"));

// Bags that other programs wrote: with chunks that are not in order of time, several connections per topic, and without
// summaries.
class CopyForeignBag : public testing::TestWithParam<const char*> {};

TEST_P(CopyForeignBag, ReplacesSomeMessagesAndKeepsTheOthers) {
  const fs::path from = find_recording("foreign_files/bags") / GetParam();
  DVI_SKIP_WITHOUT(from);
  const TempFolder folder;
  const fs::path to = folder.path / ("copy" + from.extension().string());
  const std::vector<Message> expected = copy_and_extend(from, to, std::string(50, 'x'));
  EXPECT_EQ(read_messages(open_bag(to)), expected);
}

INSTANTIATE_TEST_SUITE_P(Files, CopyForeignBag,
                         testing::Values("example.bag", "example-bz2.bag", "example-lz4.bag", "example-unsorted-chunks.bag",
                                         "t265.bag", "talker.db3", "talker.mcap", "wrong_rmw_test_0.mcap"));

TEST(CopyBagErrors, NameTruncatedFiles) {
  const TempFolder folder;
  for (const char* name : {"zstd.mcap", "lz4.bag"}) {
    const std::string bytes = read_file(kBags / name);
    const fs::path from = folder.write(name, bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT(input_error([&] { copy_bag_file(from, folder.path / "to", {}); }), HasSubstr("the file ends")) << name;
  }
}

template <class T>
std::string to_bytes(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}
std::string sized(const std::string& bytes) { return to_bytes(static_cast<std::uint32_t>(bytes.size())) + bytes; }
std::string record(int opcode, const std::string& content) {
  return static_cast<char>(opcode) + to_bytes(std::uint64_t{content.size()}) + content;
}
std::uint32_t checksum(const std::string& bytes) { return libdeflate_crc32(0, bytes.data(), bytes.size()); }

/// The records of an MCAP file outside of chunks, by their position.
std::map<std::uint64_t, std::pair<int, std::string>> split_mcap(const std::string& file) {
  std::map<std::uint64_t, std::pair<int, std::string>> out;
  for (std::uint64_t at = 8; at + 8 < file.size();) {
    std::uint64_t size = 0;
    std::memcpy(&size, file.data() + at + 1, 8);
    out[at] = {file[at], file.substr(at + 9, size)};
    at += 9 + size;
  }
  return out;
}

/// An MCAP file as the specification describes it: a chunk with its index, an attachment, metadata, and a summary.
struct SmallMcap {
  explicit SmallMcap(bool counts_magic) {
    const std::string magic("\x89MCAP0\r\n", 8);
    file = magic + record(1, sized("ros2") + sized("test"));
    const std::string schema = record(3, to_bytes(std::uint16_t{1}) + sized("a/msg/B") + sized("ros2msg") + sized("int32 a"));
    const std::string channel =
        record(4, to_bytes(std::uint16_t{0}) + to_bytes(std::uint16_t{1}) + sized("/a") + sized("cdr") + sized(""));
    std::string records = schema + channel, index;
    for (std::uint64_t i = 0; i < 3; ++i) {
      index += to_bytes(100 + i) + to_bytes(std::uint64_t{records.size()});
      records += record(5, to_bytes(std::uint16_t{0}) + to_bytes(std::uint32_t{7}) + to_bytes(100 + i) + to_bytes(90 + i) +
                               std::string(4, static_cast<char>('a' + i)));
    }
    const std::uint64_t chunk_at = file.size();
    const std::string times = to_bytes(std::uint64_t{100}) + to_bytes(std::uint64_t{102}),
                      size = to_bytes(std::uint64_t{records.size()});
    file += record(6, times + size + to_bytes(checksum(records)) + sized("") + size + records);
    const std::uint64_t index_at = file.size();
    file += record(7, to_bytes(std::uint16_t{0}) + sized(index));
    const std::uint64_t attachment_at = file.size();
    file += record(9, "an attachment");
    const std::uint64_t metadata_at = file.size();
    file += record(12, sized("name") + sized(""));
    file += record(15, to_bytes(checksum(counts_magic ? file : file.substr(8))));
    const std::uint64_t summary_at = file.size();
    const std::string map = sized(to_bytes(std::uint16_t{0}) + to_bytes(index_at));
    file += schema + channel;
    file += record(8, times + to_bytes(chunk_at) + to_bytes(index_at - chunk_at) + map + to_bytes(attachment_at - index_at) +
                          sized("") + size + size);
    file += record(10, to_bytes(attachment_at) + "rest");
    file += record(13, to_bytes(metadata_at) + "rest");
    const std::uint64_t offsets_at = file.size();
    file += record(14, to_bytes(std::uint8_t{3}) + to_bytes(summary_at) + to_bytes(std::uint64_t{schema.size()}));
    const std::string footer = to_bytes(summary_at) + to_bytes(offsets_at);
    const std::string summed = file.substr(summary_at) + record(2, footer + "1234").substr(0, 25);
    file += record(2, footer + to_bytes(checksum(summed))) + magic;
  }
  std::string file;
};

class CopyMcap : public testing::TestWithParam<bool> {};

// Every position and checksum is that of the specification.
TEST_P(CopyMcap, AdaptsIndicesAndChecksums) {
  const TempFolder folder;
  const fs::path from = folder.write("from.mcap", SmallMcap(GetParam()).file), to = folder.path / "to.mcap";
  const std::vector<Message> expected = copy_and_extend(from, to, "123456");
  EXPECT_EQ(read_messages(open_bag(to)), expected);
  const std::string file = read_file(to);
  const auto records = split_mcap(file);
  std::map<int, std::uint64_t> at;  // by opcode, of its first record
  for (const auto& [position, content] : records) at.try_emplace(content.first, position);
  const auto number = [&](int opcode, std::size_t offset) {
    std::uint64_t value = 0;
    std::memcpy(&value, records.at(at.at(opcode)).second.data() + offset, 8);
    return value;
  };
  EXPECT_EQ(number(8, 16), at.at(6));
  EXPECT_EQ(number(8, 24), at.at(7) - at.at(6));
  EXPECT_EQ(number(8, 38), at.at(7));
  EXPECT_EQ(number(8, 46), at.at(9) - at.at(7));
  EXPECT_EQ(number(8, 58), number(6, 16)) << "compressed size";
  EXPECT_EQ(number(8, 66), number(6, 16)) << "size";
  EXPECT_EQ(number(10, 0), at.at(9));
  EXPECT_EQ(number(13, 0), at.at(12));
  EXPECT_EQ(records.at(at.at(9)).second, "an attachment");
  const std::uint64_t summary = at.at(15) + 9 + 4;
  EXPECT_EQ(number(14, 1), summary);
  EXPECT_EQ(number(2, 0), summary);
  EXPECT_EQ(number(2, 8), at.at(14));
  const std::string chunk = records.at(at.at(6)).second;
  EXPECT_EQ(chunk.substr(24, 4), to_bytes(checksum(chunk.substr(40))));
  EXPECT_EQ(records.at(at.at(15)).second,
            to_bytes(checksum(file.substr(GetParam() ? 0 : 8, at.at(15) - (GetParam() ? 0 : 8)))));
  EXPECT_EQ(records.at(at.at(2)).second.substr(16), to_bytes(checksum(file.substr(summary, at.at(2) + 25 - summary))));
}

INSTANTIATE_TEST_SUITE_P(DataChecksum, CopyMcap, testing::Bool());

TEST(CopyMcapErrors, NameDamagedIndices) {
  const TempFolder folder;
  const std::string good = SmallMcap(true).file;
  std::string bad = good;
  const auto records = split_mcap(good);
  for (const auto& [position, content] : records)
    if (content.first == 8) bad[position + 9 + 16] = static_cast<char>(bad[position + 9 + 16] + 1);
  const fs::path from = folder.write("from.mcap", bad);
  EXPECT_THAT(input_error([&] { copy_and_extend(from, folder.path / "to.mcap", "x"); }),
              HasSubstr("the index does not refer to a record"));
}

TEST(PackMessage, CompressesOnlyWhatWasCompressed) {
  const std::string message(1000, 'm'), packed = pack("zstd", message, "");
  EXPECT_LT(packed.size(), 100U);
  EXPECT_EQ(unpack_message(packed), message);
  EXPECT_EQ(pack_message("new", message), "new");
  EXPECT_EQ(unpack_message(pack_message("new", packed)), "new");
}

}  // namespace
}  // namespace dvi::bags
