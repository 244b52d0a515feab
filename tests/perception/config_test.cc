#include "perception/config.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace gusset {
namespace {

TEST(PerceptionConfig, DefaultsAreWithinTheirBounds) {
  EXPECT_NO_THROW(ValidateOrThrow("perception", PerceptionConfig()));
  EXPECT_NO_THROW(ValidateOrThrow("thresholds", BagThresholds()));
}

TEST(PerceptionConfig, AColourHasThreeChannels) {
  ConfigTree tree;
  tree.Parse("[perception]\nlabel_hsv_min = [28, 75]", "bag.toml");
  PerceptionConfig config;
  EXPECT_THROW(tree.Read("perception", config), InputError);
}

TEST(BagThresholds, ReadsBothOfABagsTables) {
  ConfigTree tree;
  tree.Parse("[thresholds]\nA_oth = 700\n[thresholds_published]\nA_oth = 150\n", "bag1.toml");
  BagThresholds used;
  BagThresholds published;
  tree.Read("thresholds", used);
  tree.Read("thresholds_published", published);
  EXPECT_EQ(used.A_oth, 700);
  EXPECT_EQ(published.A_oth, 150);
  EXPECT_NO_THROW(tree.RefuseUnknown());
}

TEST(BagThresholds, NegativeAreasAreRefused) {
  ConfigTree tree;
  tree.Parse("[thresholds]\nA_th = -1", "bag1.toml");
  BagThresholds thresholds;
  EXPECT_THROW(tree.Read("thresholds", thresholds), InputError);
}

}  // namespace
}  // namespace gusset
