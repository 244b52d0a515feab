#include "agents/experiment/intervals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "agents/evaluator.h"

namespace gusset {
namespace {

// Abramowitz and Stegun, table 26.10, and closed forms for one and two degrees of freedom.
TEST(Intervals, StudentsTIsThatOfTheTables) {
  EXPECT_NEAR(StudentT975(1), std::tan(0.475 * M_PI), 1e-8);
  EXPECT_NEAR(StudentT975(2), 0.95 * std::sqrt(2 / (1 - 0.95 * 0.95)), 1e-8);
  EXPECT_NEAR(StudentT975(3), 3.182446, 1e-6);
  EXPECT_NEAR(StudentT975(4), 2.776445, 1e-6);
  EXPECT_NEAR(StudentT975(9), 2.262157, 1e-6);
  EXPECT_NEAR(StudentT975(30), 2.042272, 1e-6);
  EXPECT_NEAR(StudentT975(100000), 1.959963985, 3e-5);
}

TEST(Intervals, AMeansIntervalIsCentredAndScalesWithItsValues) {
  const auto ci = MeanInterval({1, 2, 3, 4, 5});  // s = sqrt(2.5), standard error sqrt(0.5)
  ASSERT_TRUE(ci);
  EXPECT_NEAR((*ci)[0], 3 - 2.776445 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR((*ci)[1], 3 + 2.776445 * std::sqrt(0.5), 1e-6);
  EXPECT_FALSE(MeanInterval({1}));
  EXPECT_FALSE(MeanInterval({}));
  const auto same = MeanInterval({0.5, 0.5, 0.5});
  EXPECT_EQ((*same)[0], 0.5);
  EXPECT_EQ((*same)[1], 0.5);
}

// Agresti and Coull 1998 and Newcombe 1998 give these to four digits.
TEST(Intervals, WilsonsIntervalIsThatOfTheLiterature) {
  const auto near = [](int successes, int trials, double low, double high) {
    const auto ci = WilsonInterval(successes, trials);
    EXPECT_NEAR(ci[0], low, 5e-5) << successes << " of " << trials;
    EXPECT_NEAR(ci[1], high, 5e-5) << successes << " of " << trials;
  };
  near(81, 263, 0.2553, 0.3662);
  near(15, 148, 0.0624, 0.1605);
  near(0, 20, 0.0000, 0.1611);
  near(1, 29, 0.0061, 0.1718);
}

}  // namespace
}  // namespace gusset
