#include "dvi/core/toml_text.h"

#include <string>

#include <gtest/gtest.h>

namespace dvi {
namespace {

// The rows are from the table of well-formed sequences in the Unicode standard (table 3-7), with malformed neighbors.
TEST(TomlText, RecognizesUtf8) {
  for (const char* text :
       {"", "a", "\xC3\x9F", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEF\xBF\xBD", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"})
    EXPECT_TRUE(is_utf8(text)) << text;
  for (const char* text : {"\x80", "\xC3", "\xC0\x80", "\xC1\xBF", "\xE0\x9F\x80", "\xED\xA0\x80", "\xE2\x82",
                           "\xF0\x8F\x80\x80", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF",
                           "a\xDF"
                           "b"})
    EXPECT_FALSE(is_utf8(text)) << text;
}

TEST(TomlText, DecodesWhatItEncodes) {
  std::string all;
  for (int byte = 1; byte < 256; ++byte) all += static_cast<char>(byte);
  EXPECT_TRUE(is_utf8(to_toml_text(all)));
  EXPECT_EQ(from_toml_text(to_toml_text(all)), all);
  EXPECT_EQ(to_toml_text("100% plain"), "100% plain");
  EXPECT_EQ(from_toml_text("100%20plain"), "100%20plain");
  EXPECT_EQ(from_toml_text("file:a%4"), "a%4");
  EXPECT_EQ(from_toml_text("file:a%zz"), "a%zz");
}

}  // namespace
}  // namespace dvi
