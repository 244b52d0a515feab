#include "agents/report/results_csv.h"

#include <gmock/gmock.h>

#include "tests/agents/table_world.h"

namespace gusset {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHead =
    "table,row,column,seed,n,successes,value,low,high,published,published_low,published_high,"
    "unit,seconds_wall,seconds_sim,command,versions\n";

class ResultsCsv : public FolderTest {
 protected:
  std::vector<ResultCell> Read(const std::string& text) {
    WriteFileAtomic(dir_ / "results.csv", text);
    return ReadResults(dir_ / "results.csv");
  }
  std::string Refusal(const std::string& text) {
    try {
      Read(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  }
};

TEST_F(ResultsCsv, OneCellHoldsItsSeedsThePooledLineAndThePublishedFigure) {
  std::string csv = kHead;
  csv +=
      "5.6,pi100,step1,1,20,15,0.75,0.53,0.89,0.7,0.4,0.89,rate,1,2,c1,v\n"
      "5.6,pi100,step1,2,20,16,0.8,0.58,0.92,0.7,0.4,0.89,rate,1,2,c2,v\n"
      "5.6,pi100,step1,pooled,40,31,0.775,0.62,0.88,0.7,0.4,0.89,rate,2,4,\"gusset, all\",v\n"
      "5.5,dqn,step1,1,,,0.4,,,,,,reward,1,2,c,v\n";
  const auto cells = Read(csv);
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].successes, 31);
  EXPECT_EQ(cells[0].n, 40);
  EXPECT_EQ(cells[0].ours->value, 0.775);
  EXPECT_EQ(cells[0].published->high, 0.89);
  EXPECT_EQ(cells[0].command, "gusset, all");
  EXPECT_THAT(cells[0].seed_texts, ElementsAre("seed 1: 0.75 of 20", "seed 2: 0.8 of 20"));
  EXPECT_FALSE(cells[1].ours) << "not all its seeds have finished";
  EXPECT_FALSE(cells[1].published);
}

TEST_F(ResultsCsv, WhatIsBrokenIsNamedWithLineAndColumn) {
  EXPECT_THAT(Refusal(""), HasSubstr("results.csv: is empty"));
  EXPECT_THAT(Refusal("table,row\n"), HasSubstr("results.csv:1: column column is missing"));
  const auto line = [&](const std::string& text) { return Refusal(kHead + text + "\n"); };
  EXPECT_THAT(line("5.6,pi"), HasSubstr("results.csv:2: has 2 fields, not 17"));
  EXPECT_THAT(line("5.6,pi,c,1,20,21,0.5,,,,,,rate,1,2,c,v"),
              HasSubstr(":2: successes = 21 must be a whole number within [0, 20]"));
  EXPECT_THAT(line("5.6,pi,c,1,20,2.5,0.5,,,,,,rate,1,2,c,v"), HasSubstr("successes = 2.5"));
  EXPECT_THAT(line("5.6,pi,c,1,20,2,1.5,,,,,,rate,1,2,c,v"),
              HasSubstr("value = 1.5 is not within [0, 1]"));
  EXPECT_THAT(line("5.6,pi,c,1,,,nan,,,,,,reward,1,2,c,v"), HasSubstr("value = nan must be"));
  EXPECT_THAT(line("5.6,pi,c,1,,,1x,,,,,,reward,1,2,c,v"), HasSubstr("value = 1x must be"));
  EXPECT_THAT(line("5.6,pi,c,1,,,1,2,1,,,,reward,1,2,c,v"), HasSubstr("low = 2 is above high = 1"));
  EXPECT_THAT(line("5.6,pi,c,1,20,2,0.5,,,,,,rate,1,2,c,v"),
              HasSubstr(":2: value = 0.5 is not successes / n = 2 / 20"));
  const std::string first = "5.6,pi,c,1,20,2,0.1,,,,,,rate,1,2,c,v\n";
  EXPECT_THAT(line(first + "5.6,pi,c,1,20,3,0.15,,,,,,rate,1,2,c,v"),
              HasSubstr(":3: seed = 1 stands in an earlier line"));
  EXPECT_THAT(line(first + "5.6,pi,c,2,,,3,,,,,,reward,1,2,c,v"),
              HasSubstr(":3: unit = reward was rate before"));
}

}  // namespace
}  // namespace gusset
