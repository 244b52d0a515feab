#include "tools/gusset/toml_edit.h"

#include <gtest/gtest.h>

namespace gusset {
namespace {

TEST(TomlEdit, ReplacesValuesAndKeepsEveryOtherByte) {
  EXPECT_EQ(
      ReplaceTomlValues(
          "# a bag\n[bag]\nA = 1 # mine\n\n[t]  # thresholds\n  A = 2   # two\nB=3\n[u]\nA = 4",
          "t", {{"A", "20"}, {"B", "30"}}),
      "# a bag\n[bag]\nA = 1 # mine\n\n[t]  # thresholds\n  A = 20  # two\nB= 30\n[u]\nA = 4\n");
}

TEST(TomlEdit, AddsKeysAtTheEndOfTheirTable) {
  EXPECT_EQ(ReplaceTomlValues("[t]\nA = 1\n\n# of u\n[u]\n", "t", {{"A", "2"}, {"B", "3"}}),
            "[t]\nA = 2\nB = 3\n\n# of u\n[u]\n");
  EXPECT_EQ(ReplaceTomlValues("[t]\n", "t", {{"A", "2"}}), "[t]\nA = 2\n");
}

TEST(TomlEdit, AddsATableThatIsMissing) {
  EXPECT_EQ(ReplaceTomlValues("[u]\nA = 1\n", "t", {{"A", "2"}}), "[u]\nA = 1\n\n[t]\nA = 2\n");
  EXPECT_EQ(ReplaceTomlValues("", "t", {{"A", "2"}}), "[t]\nA = 2\n");
}

// A longer key that begins or ends alike, and the same table under another, are others.
TEST(TomlEdit, ConfusesNoNames) {
  EXPECT_EQ(ReplaceTomlValues("[t.u]\nA = 1\n[t]\nA_th = 5\nth = 6\n", "t", {{"A", "2"}}),
            "[t.u]\nA = 1\n[t]\nA_th = 5\nth = 6\nA = 2\n");
}

}  // namespace
}  // namespace gusset
