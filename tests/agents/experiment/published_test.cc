#include "agents/experiment/published.h"

#include <gmock/gmock.h>

#include <fstream>

#include "base/config.h"
#include "base/files.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

const std::filesystem::path kFile =
    std::filesystem::path(GUSSET_SOURCE_DIR) / "assets" / "published" / "thesis.toml";

TEST(Published, RatesOfTenCarryTheirInterval) {
  const Published published = Published::Load(kFile);
  // 6 of 10: (p + z^2/2n +- z sqrt(p(1-p)/n + z^2/4n^2)) / (1 + z^2/n) with z = 1.96.
  const auto cell = published.Find("5.6", "pi100", "folded");
  ASSERT_TRUE(cell);
  EXPECT_DOUBLE_EQ(cell->value, 0.6);
  EXPECT_NEAR(*cell->low, 0.3127, 1e-4);
  EXPECT_NEAR(*cell->high, 0.8318, 1e-4);
  const auto all = published.Find("5.7", "bag2", "step3");
  EXPECT_DOUBLE_EQ(all->value, 1);
  EXPECT_NEAR(*all->low, 0.7225, 1e-4);
  EXPECT_DOUBLE_EQ(*all->high, 1);
}

TEST(Published, MeansHaveNoIntervalAndUnpublishedCellsAreAbsent) {
  const Published published = Published::Load(kFile);
  const auto reward = published.Find("5.5", "a2c", "step4");
  ASSERT_TRUE(reward);
  EXPECT_DOUBLE_EQ(reward->value, 0.009);
  EXPECT_FALSE(reward->low || reward->high);
  EXPECT_FALSE(published.Find("5.6", "dqn_ls50", "step1"));
  EXPECT_FALSE(published.Find("5.7", "any_pose", "folded"));
  EXPECT_FALSE(published.Find("5.4", "pi100", "extra_actions"));
}

// The thesis contradicts itself in two rows (docs/loop.md); elsewhere Table 5.4 is the sum of 5.5.
TEST(Published, TheRewardsAddUpWhereTheThesisAddedThemUp) {
  const Published published = Published::Load(kFile);
  const auto total = [&](const char* row) { return published.Find("5.4", row, "total_reward"); };
  const auto sum = [&](const char* row) { return published.Find("5.4", row, "sum_of_5.5"); };
  for (const char* row : {"pi100", "pi50", "dqn", "a2c"}) {
    EXPECT_NEAR(total(row)->value, sum(row)->value, 6e-4) << row;
  }
  EXPECT_NEAR(sum("pi30")->value, 1.288, 1e-9);
  EXPECT_NEAR(total("pi30")->value, sum("pi10")->value, 1e-9);
  EXPECT_NEAR(total("pi10")->value, sum("pi10")->value / 4, 1e-9);
}

class PublishedFile : public FolderTest {
 protected:
  std::string Error(const std::string& from, const std::string& to) {
    std::string text = ReadFile(kFile);
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    std::ofstream(dir_ / "p.toml") << text;
    try {
      (void)Published::Load(dir_ / "p.toml");
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
};

TEST_F(PublishedFile, MistakesAreRefusedInOneLine) {
  using testing::HasSubstr;
  EXPECT_THAT(Error("pi50 = [7, 7", "pi50 = [7, 11"), HasSubstr("table_5_6.pi50[1] = 11"));
  EXPECT_THAT(Error("bag2 = [4, 6", "bag9 = [4, 6"), HasSubstr("table_5_7.bag2 is missing"));
  EXPECT_THAT(Error("# The same of", "pi40 = [1]\n# The same of"), HasSubstr("table_5_6.pi40"));
  EXPECT_THAT(Error("0.5, 0.241, ", "0.5, "), HasSubstr("must have 4 numbers"));
}

}  // namespace
}  // namespace gusset
