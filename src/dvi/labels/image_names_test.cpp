#include "dvi/labels/image_names.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::set<std::string> six_digits(int first, int count) {
  std::set<std::string> names;
  for (int i = first; i < first + count; ++i) names.insert(fmt::format("{:06}", i));
  return names;
}

using Matched = std::vector<std::optional<std::string>>;

TEST(ImageNames, MatchIfEqualWithoutAWarning) {
  const MatchedNames matched = match_names("masks", {"000001", "000007", "000001_mask"}, six_digits(0, 4));
  EXPECT_EQ(matched.images, (Matched{"000001", std::nullopt, std::nullopt})) << "the other names have no image";
  EXPECT_FALSE(matched.warning);
}

TEST(ImageNames, MatchWithoutAdditionsOfTools) {
  for (const char* name : {"000002_mask", "mask_000002", "000002.jpg", "000002-mask", "frame_000002", "000002_gtFine_labelIds",
                           "000002_png.rf.a0f3", "deadbeef-000002", "000002_MASK", "frame_000002.PNG", "000002_mask.jpg"}) {
    const MatchedNames matched = match_names("a/masks", {name}, six_digits(0, 4));
    EXPECT_EQ(matched.images, Matched{"000002"}) << name;
    EXPECT_THAT(matched.warning.value_or(""), AllOf(HasSubstr("masks: names are matched"), HasSubstr("to image 000002")))
        << name;
  }
  const MatchedNames cityscapes =
      match_names("m", {"a_000019_gtFine_instanceIds"}, {"a_000019_leftImg8bit", "a_000020_leftImg8bit"});
  EXPECT_EQ(cityscapes.images, Matched{"a_000019_leftImg8bit"});
}

TEST(ImageNames, MatchByNumberIfAllAreNumbersOfImages) {
  const MatchedNames matched = match_names("masks", {"0", "10", "2"}, six_digits(0, 11));
  EXPECT_EQ(matched.images, (Matched{"000000", "000010", "000002"}));
  EXPECT_THAT(matched.warning.value_or(""), HasSubstr("by number, such as 0 to image 000000"));
  EXPECT_EQ(match_names("masks", {"0", "11"}, six_digits(0, 11)).images, (Matched{std::nullopt, std::nullopt}));
}

TEST(ImageNames, AreRefusedIfTheyCountFromAnotherNumber) {
  const auto error = [](const std::set<std::string>& given, const std::set<std::string>& recorded) {
    return input_error([&] { match_names("masks", {given.begin(), given.end()}, recorded); });
  };
  EXPECT_THAT(error(six_digits(1, 5), six_digits(0, 5)),
              AllOf(HasSubstr("its names are 000001 to 000005, but those of the drive's images are 000000 to 000004"),
                    HasSubstr("count from 1"), HasSubstr("remove 000005")));
  EXPECT_THAT(error({"0", "1", "2"}, six_digits(1, 3)), HasSubstr("remove 0"));
  match_names("masks", {"000002", "000003"}, six_digits(1, 2));  // too few names to decide
  match_names("masks", {"000001", "000003"}, six_digits(0, 4));  // masks of some frames
  EXPECT_THAT(error({"a_mask", "mask_a"}, {"a", "b"}), HasSubstr("a_mask and mask_a both match image a"));
}

TEST(ImageNames, AreDescribedInOrderOfNumbers) {
  EXPECT_EQ(span_of({"9", "10", "8"}), "8 to 10");
  EXPECT_EQ(span_of({"b", "a"}), "a to b");
  EXPECT_EQ(span_of({"a"}), "a");
  EXPECT_EQ(span_of({}), "none");
}

}  // namespace
}  // namespace dvi::labels
