// `gusset experiment thesis` in the real world: the smallest part of the grid that does everything.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/files.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class ExperimentRun : public testing::Test {
 protected:
  // @returns what it printed; the test fails if it does.
  std::string Gusset(const std::string& arguments) const {
    const std::string command = std::string(GUSSET_BINARY) + " " + arguments + " >" +
                                (dir_ / "out").string() + " 2>" + (dir_ / "err").string();
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 0) << ReadFile(dir_ / "err");
    return ReadFile(dir_ / "out");
  }
  static json Find(const json& rows, const std::string& column, const std::string& seed) {
    for (const json& row : rows) {
      if (row["column"] == column && row["seed"] == seed) return row;
    }
    ADD_FAILURE() << column << " " << seed;
    return {};
  }

  TemporaryFolder folder_;
  fs::path dir_ = folder_.path();
};

// Random choice cannot get stuck in one state, whatever the physics, if it may place the cube in
// any mouth: of a pool of one bag the same narrow mouth may be widened in vain a thousand times.
TEST_F(ExperimentRun, ItsRowsAreWhatTheirCommandsGiveAndResumeKeepsThem) {
  const std::string out = (dir_ / "e").string();
  // Seed 1's random walk through the states takes ten times as long.
  const std::string command =
      "experiment thesis --only baselines --agents random --seed 2 --seeds 1 --steps 1 "
      "--episodes 1 --attempts 1 --set train.pool_min=1 --set primitives.pick_place.room_m=0 "
      "--jobs 2 --json "
      "--out " +
      out;
  const json document = json::parse(Gusset(command));
  EXPECT_EQ(document["failed"], json::array());
  EXPECT_THAT(ReadFile(dir_ / "err"), HasSubstr("random seed 2: trained, "));
  EXPECT_THAT(ReadFile(dir_ / "err"), HasSubstr("4 of 4 done"));
  const json& rows = document["rows"];
  EXPECT_EQ(Find(rows, "steps", "pooled")["value"], 4);
  EXPECT_EQ(Find(rows, "step1", "2")["n"], 1);
  // Random choice draws its actions anew in each process, from the seed alone.
  const json unfolded = Find(rows, "unfolded", "2");
  const std::string evaluate = unfolded["command"];
  ASSERT_THAT(evaluate, testing::StartsWith("gusset evaluate --policy " + out));
  const json again = json::parse(Gusset(evaluate.substr(7) + " --json"));
  EXPECT_EQ(again["true_successes"], unfolded["successes"]);
  EXPECT_EQ(again["seconds_sim"], unfolded["seconds_sim"]);

  const std::string csv = ReadFile(fs::path(out) / "results.csv");
  EXPECT_EQ(json::parse(Gusset(command + " --resume"))["rows"], rows);
  EXPECT_EQ(ReadFile(fs::path(out) / "results.csv"), csv);
}

}  // namespace
}  // namespace gusset
