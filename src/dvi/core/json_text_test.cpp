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

}  // namespace
}  // namespace dvi
