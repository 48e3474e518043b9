#include "dvi/core/json_text.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dvi {
namespace {

TEST(JsonText, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(json_text({{"path",
                        "Stra\xDF"
                        "e"}}),
            "{\n \"path\": \"Stra\xEF\xBF\xBD"
            "e\"\n}");
}

TEST(WholeNumber, IsWithinItsBoundsOrRefused) {
  const auto read = [](const char* text) { return whole_number(nlohmann::json::parse(text), "version", -1, 100); };
  EXPECT_EQ(read("7"), 7);
  EXPECT_EQ(read("-1"), -1);
  EXPECT_EQ(read("100"), 100);
  for (const char* text :
       {"101", "-2", "7.5", "1e30", "18446744073709551615", "99999999999999999999999", "\"7\"", "null", "[7]"})
    EXPECT_THROW(read(text), std::invalid_argument) << text;
}

}  // namespace
}  // namespace dvi
