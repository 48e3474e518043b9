#include "dvi/result/archive.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <Eigen/Geometry>
#include <opencv2/core/matx.hpp>

#include "dvi/core/scratch.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::result {
namespace {

using testing::HasSubstr;

enum class Color : std::uint8_t { red = 3 };

struct Inner {
  char letter = 0;  // padding follows
  double number = 0;
};
constexpr auto fields_of(Of<Inner>) { return std::tuple{&Inner::letter, &Inner::number}; }

struct Outer {
  std::vector<Inner> inner;
  std::optional<Inner> maybe, none;
  std::string text;
  Color color = Color::red;
  bool yes = false;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::AlignedBox3f box;
  cv::Vec3f pixel;
  ScratchVector<float> floats;
};
constexpr auto fields_of(Of<Outer>) {
  return std::tuple{&Outer::inner, &Outer::maybe,  &Outer::none, &Outer::text,  &Outer::color,
                    &Outer::yes,   &Outer::matrix, &Outer::box,  &Outer::pixel, &Outer::floats};
}

static_assert(takes_values<Inner, 2>() && !takes_values<Inner, 3>(), "an incomplete fields_of() is detected");

class Archive : public testing::Test {
 protected:
  void write(const Outer& value) const {
    ArchiveWriter out(file, "test/1");
    out << value;
    out.finish();
  }
  Outer read(const std::string& schema = "test/1", Outer value = {}) const {
    ArchiveReader in(file, schema);
    in >> value;
    in.finish();
    return value;
  }
  static Outer example() {
    Outer value{{{'a', 0.1}, {'b', -0.0}},
                Inner{'c', std::numeric_limits<double>::denorm_min()},
                {},
                "t\0u",
                Color::red,
                true,
                {},
                {},
                {},
                {}};
    value.text = std::string("t\0u", 3);
    value.matrix << 1, 2, 3, 4, 5, 6, 7, 8, 1.0 / 3;
    value.box.extend(Eigen::Vector3f(1, 2, 3));
    value.pixel = {0.1F, 0.2F, 0.3F};
    value.floats = {std::numeric_limits<float>::quiet_NaN(), 1e-42F};
    return value;
  }
  TempFolder folder;
  const fs::path file = folder.path / "value.bin";
};

TEST_F(Archive, PreservesEveryBit) {
  write(example());
  const Outer value = read();
  EXPECT_EQ(value.inner[1].letter, 'b');
  EXPECT_TRUE(std::signbit(value.inner[1].number));
  EXPECT_EQ(value.maybe->number, std::numeric_limits<double>::denorm_min());
  EXPECT_FALSE(value.none);
  EXPECT_EQ(value.text, std::string("t\0u", 3));
  EXPECT_EQ(value.matrix, example().matrix);
  EXPECT_TRUE(std::isnan(value.floats[0]));
  EXPECT_EQ(value.floats[1], 1e-42F);
  const std::string bytes = read_file(file);
  write(value);
  EXPECT_EQ(read_file(file), bytes);
  EXPECT_EQ(bytes.size(), (8 + 6) + (8 + 2 * 9) + (1 + 9) + 1 + (8 + 3) + 1 + 1 + 72 + 24 + 12 + (8 + 8)) << "no padding";
}

TEST_F(Archive, ReplacesTheValueAndKeepsItsAllocator) {
  write(example());
  Outer value = example();
  value.none = Inner{};
  value.floats = ScratchVector<float>(std::make_shared<Scratch>(0, folder.path));
  const auto scratch = value.floats.get_allocator().scratch;
  value = read("test/1", std::move(value));
  EXPECT_EQ(value.inner.size(), 2U);
  EXPECT_FALSE(value.none);
  EXPECT_EQ(value.floats.get_allocator().scratch, scratch);
}

TEST_F(Archive, RefusesFilesThatAreTruncatedLongerOrOfAnotherSchema) {
  write(example());
  const std::string bytes = read_file(file);
  EXPECT_THAT(input_error([&] { read("test/2"); }), HasSubstr("does not have the schema test/2"));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    write_file(file, bytes.substr(0, length));
    EXPECT_THAT(input_error([&] { read(); }), HasSubstr("is truncated")) << length;
  }
  write_file(file, bytes + "x");
  EXPECT_THAT(input_error([&] { read(); }), HasSubstr("longer"));
  write_file(file, std::string(64, '\xff'));
  EXPECT_THAT(input_error([&] { read(); }), HasSubstr("is truncated"))
      << "a count beyond the end of the file allocates no memory";
}

TEST_F(Archive, RemovesAnUnfinishedFile) {
  {
    ArchiveWriter(file, "test/1") << example();
  }
  EXPECT_TRUE(fs::is_empty(folder.path));
}

}  // namespace
}  // namespace dvi::result
