#include "agents/json_fields.h"

#include <gtest/gtest.h>

namespace gusset {
namespace {

TEST(JsonFields, WholeNumbersThatDoNotFitAreRefused) {
  const nlohmann::json object =
      ParseJson(R"({"most": 2147483647, "more": 2147483648, "wraps": 4294967377, "minus": -1})");
  EXPECT_EQ(JsonField<int>(object, "most"), 2147483647);
  EXPECT_THROW((void)JsonField<int>(object, "more"), InputError);
  EXPECT_THROW((void)JsonField<int>(object, "wraps", 0, 100), InputError);
  EXPECT_THROW((void)JsonField<std::uint64_t>(object, "minus"), InputError);
  EXPECT_EQ(JsonField<std::uint64_t>(object, "wraps"), 4294967377u);
}

TEST(JsonFields, TextNestedTooDeepIsRefused) {
  const auto nested = [](int levels) {
    const auto count = static_cast<std::size_t>(levels);
    return std::string(count, '[') + std::string(count, ']');
  };
  EXPECT_NO_THROW((void)ParseJson(nested(kMostJsonDepth)));
  for (const int levels : {kMostJsonDepth + 2, 1000000}) {
    EXPECT_THROW((void)ParseJson(nested(levels)), InputError) << levels;
  }
}

}  // namespace
}  // namespace gusset
