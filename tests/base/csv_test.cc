#include "base/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"

namespace gusset {
namespace {

using ::testing::ElementsAre;

TEST(ParseCsv, KeepsWhatIsQuoted) {
  const auto records = ParseCsv("a,\"b,\"\"c\"\"\nd\",\r\n,\"\"\nlast", "x.csv");
  ASSERT_EQ(records.size(), 3u);
  EXPECT_THAT(records[0].fields, ElementsAre("a", "b,\"c\"\nd", ""));
  EXPECT_THAT(records[1].fields, ElementsAre("", ""));
  EXPECT_EQ(records[1].line, 3) << "a quoted newline counts";
  EXPECT_THAT(records[2].fields, ElementsAre("last"));
  EXPECT_TRUE(ParseCsv("", "x.csv").empty());
  EXPECT_THROW((void)ParseCsv("a\n\"b", "x.csv"), InputError);
  EXPECT_THROW((void)ParseCsv("a\"b\"", "x.csv"), InputError);
}

TEST(CsvLine, IsReadBackAsItWas) {
  const std::vector<std::string> fields = {"", "a", "b,c", "\"d\"", "e\r\nf", " g "};
  const std::string line = CsvLine(fields);
  const auto records = ParseCsv(line + line, "x.csv");
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].fields, fields);
  EXPECT_EQ(records[1].fields, fields);
  EXPECT_EQ(CsvLine({"a", "b"}), "a,b\n") << "no quotes where none are needed";
}

}  // namespace
}  // namespace gusset
