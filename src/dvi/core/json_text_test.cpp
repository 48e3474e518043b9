#include "dvi/core/json_text.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/core/json_file.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

TEST(JsonText, EncodesStringsThatAreNotUtf8) {
  const nlohmann::json document = {{"path",
                                    "Stra\xDF"
                                    "e"},
                                   {"list",
                                    {"\xFF",
                                     "Stra\xC3\x9F"
                                     "e",
                                     1}}};
  const std::string text = json_text(document);
  EXPECT_EQ(text,
            "{\n \"list\": [\n  \"file:%FF\",\n  \"Stra\xC3\x9F"
            "e\",\n  1\n ],\n \"path\": \"file:Stra%DFe\"\n}");
  const TempFolder folder;
  EXPECT_EQ(read_json(folder.write("a.json", text)), document);
  EXPECT_TRUE(read_json(folder.write("b.json", "{"), DamagedJson::is_discarded).is_discarded());
  EXPECT_THROW(read_json(folder.path / "b.json"), nlohmann::json::parse_error);
  EXPECT_EQ(json_text({{"\xFF", 1}}, -1), "{\"\xEF\xBF\xBD\":1}") << "keys are replaced";
}

TEST(WholeNumber, IsRefusedOutsideItsBounds) {
  const auto read = [](const char* text) { return to_whole_number(nlohmann::json::parse(text), "version", -1, 100); };
  EXPECT_EQ(read("7"), 7);
  EXPECT_EQ(read("-1"), -1);
  EXPECT_EQ(read("100"), 100);
  for (const char* text :
       {"101", "-2", "7.5", "1e30", "18446744073709551615", "99999999999999999999999", "\"7\"", "null", "[7]"})
    EXPECT_THROW(read(text), std::invalid_argument) << text;
}

}  // namespace
}  // namespace dvi
