// tools/sweep, with a stand-in for gusset that fails as jobs do: what is asked here is what the
// workflow makes of it. Runs where snakemake is installed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "agents/evaluator.h"
#include "agents/report/results_csv.h"
#include "base/files.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Training: seed 2 breaks off at first and must then be resumed; seed 9 always breaks off. Notes
// every call in RUN/calls. Evaluation: as many successes of 20 as the run's seed.
constexpr const char* kStandIn = R"(#!/usr/bin/env bash
set -eu
command=$1; shift
resume=no
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$2 ;;
    --seed) seed=$2 ;;
    --policy) policy=$2 ;;
    --resume) resume=yes ;;
  esac
  shift
done
case $command in
  train)
    echo "train resume=$resume" >>"$out/calls"
    touch "$out/config.toml"
    [ "$seed" != 9 ] || exit 1
    [ "$seed" != 2 ] || [ $resume = yes ] || exit 1
    touch "$out/policy.json" ;;
  evaluate)
    echo "evaluate" >>"$policy/calls"
    n=${policy##*seed}
    step='{"attempts": 0, "successes": 0}'
    echo "{\"policy\": \"$policy\", \"bag\": \"bag1\", \"pose\": \"near\", \"seed\": 7,
      \"episodes\": 20, \"true_successes\": $n, \"seconds_wall\": 1, \"seconds_sim\": 2,
      \"versions\": {\"gusset\": \"1, or 2\"}, \"per_step\": [$step, $step, $step, $step]}" >"$out" ;;
  report) touch "$out" ;;
esac
)";

class Sweep : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v snakemake >/dev/null") != 0) {
      GTEST_SKIP() << "snakemake is not installed";
    }
    WriteFileAtomic(dir_ / "gusset", kStandIn);
    fs::permissions(dir_ / "gusset", fs::perms::owner_all);
  }

  void Seeds(const std::string& seeds) {
    WriteFileAtomic(dir_ / "s.yaml", "out: out\nseeds: [" + seeds +
                                         "]\ngusset: ./gusset\nretries: 1\nstarts: [folded]\n"
                                         "runs:\n  pi: --agent pi --steps 3\n");
  }
  int Run(const std::string& how) {
    const std::string command = "cd " + dir_.string() + " && " + GUSSET_SOURCE_DIR +
                                "/tools/sweep/run s.yaml " + how + " >log 2>&1";
    return std::system(command.c_str());
  }
  std::string Calls(int seed) const {
    return ReadFile(dir_ / ("out/runs/pi-seed" + std::to_string(seed) + "/calls"));
  }

  TemporaryFolder folder_;
  fs::path dir_ = folder_.path();
};

TEST_F(Sweep, RetriesResumesAndMergesAndDoesNothingTwice) {
  Seeds("1, 2");
  ASSERT_EQ(Run("--cores 2"), 0) << ReadFile(dir_ / "log");
  EXPECT_EQ(Calls(1), "train resume=no\nevaluate\n");
  EXPECT_EQ(Calls(2), "train resume=no\ntrain resume=yes\nevaluate\n");
  // Merged by Python, read by the report: both know what a Wilson interval is.
  const std::vector<ResultCell> cells = ReadResults(dir_ / "out/results.csv");
  const auto cell = std::ranges::find(cells, "folded", &ResultCell::column);
  ASSERT_NE(cell, cells.end());
  EXPECT_EQ(cell->successes, 3);
  EXPECT_EQ(cell->n, 40);
  EXPECT_NEAR(*cell->ours->low, WilsonInterval(3, 40)[0], 1e-6);  // six digits are written
  EXPECT_NEAR(*cell->ours->high, WilsonInterval(3, 40)[1], 1e-6);
  EXPECT_EQ(cells.size(), 5u) << "the whole task and four steps";

  // A new seed is added to what there is.
  Seeds("1, 2, 3");
  ASSERT_EQ(Run("--cores 1"), 0) << ReadFile(dir_ / "log");
  EXPECT_EQ(Calls(1), "train resume=no\nevaluate\n");
  EXPECT_EQ(Calls(3), "train resume=no\nevaluate\n");
  EXPECT_EQ(ReadResults(dir_ / "out/results.csv").at(0).successes, 6);
}

TEST_F(Sweep, ARunThatFailsForGoodKeepsOthersFromNothing) {
  Seeds("9, 1");
  EXPECT_NE(Run("--cores 1"), 0);
  EXPECT_EQ(Calls(9), "train resume=no\ntrain resume=yes\n");
  EXPECT_EQ(Calls(1), "train resume=no\nevaluate\n");
  EXPECT_FALSE(fs::exists(dir_ / "out/results.csv")) << "a merge of some seeds would look whole";
}

}  // namespace
}  // namespace gusset
