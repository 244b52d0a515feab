#include "agents/experiment/runner.h"

#include <gmock/gmock.h>

#include <map>
#include <set>
#include <sstream>

#include "agents/pi_learning.h"
#include "agents/run_folder.h"
#include "agents/trainer.h"
#include "base/files.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

using testing::HasSubstr;

// Trains Pi-learning in TableWorld whatever the plan says, and tries its policies there.
class TableRig final : public ExperimentRig {
 public:
  explicit TableRig(int crash_at = -1, int stop_at = -1) : crash_at_(crash_at), stop_at_(stop_at) {}

  void Train(const TrainingPlan& plan, int seed, const std::filesystem::path& folder,
             std::atomic<int>& count, const Stop& stop) override {
    ++trained;
    if (plan.name == never && seed >= never_from) throw RunError("no bag has reached s1");
    const RunFolder run = std::filesystem::exists(folder / "config.toml")
                              ? RunFolder::Open(folder)
                              : RunFolder::Create(folder, "", {{"versions", {{"table", "1"}}}});
    Workers workers(1, [&] {
      return std::make_unique<CountingEnvironment>(
          std::make_unique<TableWorld>(crash_at_, stop_at_), count);
    });
    PiLearning agent = NewAgent(plan);
    // Small pools: each action is synced to the disk.
    gusset::Train(workers, agent, {.steps = plan.steps, .seed = seed, .pool_min = 4}, run, {},
                  stop);
  }
  bool HasTrained(const TrainingPlan&, int, const std::filesystem::path& folder) override {
    if (!Exists(folder / "policy.json")) return false;
    ++checked;
    return true;
  }
  Subject Open(const TrainingPlan& plan, const CellPlan&,
               const std::filesystem::path& folder) override {
    ++opened;
    auto agent = std::make_unique<PiLearning>(NewAgent(plan));
    LoadPolicy(PolicyFile(folder), *agent);
    return {std::move(agent),
            [this] {
              return std::make_unique<CountingEnvironment>(
                  std::make_unique<TableWorld>(crash_at_, stop_at_), tried);
            },
            {{"table", "1"}},
            "table 1"};
  }

  std::string never;   // a training that cannot be finished ...
  int never_from = 0;  // ... with seeds from this one on
  std::atomic<int> trained = 0, checked = 0, opened = 0;
  std::atomic<int> tried = 0;  // actions of trials

 private:
  static PiLearning NewAgent(const TrainingPlan& plan) {
    return PiLearning({.steps_per_state = plan.steps}, TableWorld().ActionCounts());
  }
  int crash_at_;
  int stop_at_;
};

using Line = std::map<std::string, std::string>;

// The fields of a CSV whose quoted fields hold no line ends.
std::vector<std::string> Fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '"') {
      fields.back() += c;
    }
  }
  return fields;
}

std::vector<Line> ReadCsv(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> head = Fields(line);
  std::vector<Line> rows;
  while (std::getline(lines, line)) {
    const std::vector<std::string> fields = Fields(line);
    EXPECT_EQ(fields.size(), head.size()) << line;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (i == 0) rows.emplace_back();
      rows.back()[head[i]] = fields[i];
    }
  }
  return rows;
}

class ExperimentTest : public FolderTest {
 protected:
  static std::string Slurp(const std::filesystem::path& out) {
    return ReadFile(out / "results.csv");
  }
  // results.csv without what differs between two runs of the same: wall times and the folder.
  static std::string Comparable(const std::filesystem::path& out) {
    std::string text;
    for (Line row : ReadCsv(Slurp(out))) {
      row.erase("seconds_wall");
      for (const auto& [key, value] : row) {
        std::string field = value;
        if (const auto at = field.find(out.string()); at != std::string::npos) {
          field.replace(at, out.string().size(), "OUT");
        }
        text += key + "=" + field + ";";
      }
      text += "\n";
    }
    return text;
  }
  ExperimentResult Run(
      const std::filesystem::path& out, ExperimentRig& rig, int jobs = 1,
      const std::function<bool()>& stop = [] { return false; }) {
    const ExperimentPlan plan = ThesisPlan(options_);
    return RunExperiment(plan, options_, published_, {out.string(), ""}, rig, jobs, stop,
                         [&](const ExperimentProgress& progress) { progress_ = progress; });
  }

  // 2 trainings and 5 cells with 3 trials each, for two seeds: 34 units.
  static constexpr int kAllUnits = 34;
  ExperimentOptions all_{
      .agents = {"pi100", "pi10"}, .seeds = 2, .episodes = 4, .attempts = 5, .max_steps = 12};
  // A part of it, since every action of a training is synced to the disk.
  ExperimentOptions options_{.tables = {"5.4", "5.6"},
                             .agents = {"pi30", "pi10"},
                             .seeds = 2,
                             .episodes = 4,
                             .attempts = 5,
                             .max_steps = 4};
  Published published_ = Published::Load(std::filesystem::path(GUSSET_SOURCE_DIR) / "assets" /
                                         "published" / "thesis.toml");
  ExperimentProgress progress_;
};

// In a training and, where each of those has fewer actions, in a trial.
TEST_F(ExperimentTest, StoppedInTheMidstOfAnActionItGoesOnToTheSameEnd) {
  TableRig unbroken;
  Run(dir_ / "unbroken", unbroken);
  for (const int stop_at : {7, 25}) {
    const std::filesystem::path out = dir_ / std::to_string(stop_at);
    int stops = 0;
    for (bool over = false; !over;) {
      TableRig rig(-1, stops == 0 ? stop_at : -1);
      try {
        EXPECT_TRUE(Run(out, rig, 1, StopRequested).failed.empty());
        over = true;
      } catch (const RunError& e) {
        EXPECT_THAT(e.what(), HasSubstr("interrupted after "));
        ++stops;
      }
      ForgetStop();
    }
    EXPECT_EQ(stops, 1);
    EXPECT_EQ(Comparable(out), Comparable(dir_ / "unbroken"));
  }
}

TEST_F(ExperimentTest, TheResultSetHasALineForEverySeedAndAPooledOne) {
  TableRig rig;
  options_ = all_;
  const ExperimentResult result = Run(dir_ / "out", rig);
  EXPECT_EQ(rig.trained, 2 * 2);
  EXPECT_EQ(progress_.units_done, kAllUnits);
  EXPECT_EQ(progress_.units, kAllUnits);
  const std::string text = Slurp(dir_ / "out");
  EXPECT_THAT(text, testing::StartsWith(
                        "table,row,column,seed,n,successes,value,low,high,published,published_low,"
                        "published_high,unit,seconds_wall,seconds_sim,command,versions\n"));
  std::map<std::string, int> lines;
  std::set<std::string> keys;
  for (const Line& row : ReadCsv(text)) {
    ++lines[row.at("table")];
    EXPECT_TRUE(
        keys.insert(row.at("table") + row.at("row") + row.at("column") + row.at("seed")).second);
    EXPECT_THAT(row.at("command"), testing::StartsWith("gusset "));
    EXPECT_EQ(row.at("versions"), "table 1");
    EXPECT_NE(row.at("unit"), "");
    EXPECT_NE(row.at("seconds_sim"), "0.0");
  }
  EXPECT_EQ(lines["5.4"], 2 * 5 * 3);  // rows, columns, two seeds and pooled
  EXPECT_EQ(lines["5.5"], 2 * 4 * 3);
  EXPECT_EQ(lines["5.6"], 2 * 6 * 3);
  EXPECT_EQ(lines["5.7"], 4 * 6 * 3);
  EXPECT_EQ(lines["fig5.6"], 2 * 4 * 10);  // pooled only

  const std::string tables = ResultText(result.rows);
  EXPECT_THAT(tables, HasSubstr("Table 5.4"));
  EXPECT_THAT(tables, HasSubstr("Table 5.7"));
  EXPECT_THAT(tables, HasSubstr("60% 31-83"));  // the thesis's 6 of 10
  EXPECT_THAT(tables, HasSubstr("1.961"));
  EXPECT_THAT(tables, testing::Not(HasSubstr("nan")));
  const nlohmann::ordered_json json = ResultJson(result.rows);
  EXPECT_EQ(json.size(), result.rows.size());
  EXPECT_TRUE(json[0]["n"].is_null());
}

TEST_F(ExperimentTest, PartsThatAreAddedLaterStandBesideThoseThatWereThere) {
  const auto sorted = [](const std::string& text) {
    std::multiset<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.insert(line);
    return lines;
  };
  TableRig rig;
  Run(dir_ / "whole", rig);
  const std::filesystem::path parts = dir_ / "parts";
  for (const char* agent : {"pi30", "pi10"}) {
    options_.agents = {agent};
    Run(parts, rig);
  }
  EXPECT_EQ(sorted(Comparable(parts)), sorted(Comparable(dir_ / "whole")));

  // Asked for again with one seed, a row is of that seed; the others stay.
  const auto seeds = [&](const std::string& name) {
    std::set<std::string> found;
    for (const Line& row : ReadCsv(Slurp(parts))) {
      if (row.at("row") == name) found.insert(row.at("seed"));
    }
    return found;
  };
  options_.seeds = 1;
  Run(parts, rig);
  EXPECT_THAT(seeds("pi10"), testing::ElementsAre("1", "pooled"));

  // What was there goes when the new stands, not before.
  options_.first_seed = 3;
  EXPECT_THROW(Run(parts, rig, 1, [] { return true; }), RunError);
  EXPECT_THAT(seeds("pi10"), testing::ElementsAre("1", "pooled"));
  for (int interruptions = 0; !seeds("pi10").contains("3"); ++interruptions) {
    ASSERT_LT(interruptions, 100);
    int asked = 0;
    ASSERT_THROW(Run(parts, rig, 1, [&] { return ++asked > 40; }), RunError);
    EXPECT_TRUE(seeds("pi10").contains("1"));
  }
  Run(parts, rig);
  EXPECT_THAT(seeds("pi10"), testing::ElementsAre("3", "pooled"));
  EXPECT_THAT(seeds("pi30"), testing::ElementsAre("1", "2", "pooled"));

  WriteFileAtomic(parts / "results.csv", "table,row\n");
  EXPECT_THROW(Run(parts, rig), InputError) << "somebody else's file is not written over";
  EXPECT_EQ(Slurp(parts), "table,row\n");
}

TEST_F(ExperimentTest, PooledLinesSumUpTheSeedsAndStandBesideThePublishedOnes) {
  TableRig rig;
  options_ = all_;
  Run(dir_ / "out", rig);
  std::map<std::string, Line> rows;
  for (const Line& row : ReadCsv(Slurp(dir_ / "out"))) {
    rows[row.at("table") + " " + row.at("row") + " " + row.at("column") + " " + row.at("seed")] =
        row;
  }
  const auto number = [&](const std::string& row, const std::string& field) {
    return std::stod(rows.at(row).at(field));
  };
  const auto all = [&](const std::string& row, const std::string& field) {
    return number(row + " 1", field) + number(row + " 2", field);
  };
  EXPECT_EQ(number("5.6 pi100 folded pooled", "n"), 8);
  EXPECT_EQ(number("5.6 pi100 step2 pooled", "n"), 10);
  EXPECT_EQ(number("5.6 pi100 folded pooled", "successes"), all("5.6 pi100 folded", "successes"));
  EXPECT_NEAR(number("5.6 pi100 folded pooled", "value"), all("5.6 pi100 folded", "successes") / 8,
              1e-6);
  EXPECT_EQ(number("5.6 pi100 folded pooled", "published"), 0.6);
  EXPECT_EQ(number("5.7 bag1 folded pooled", "successes"),
            number("5.6 pi100 folded pooled", "successes"));
  EXPECT_EQ(rows.at("5.7 any_pose folded pooled").at("published"), "");

  // Table 5.5 holds what training was paid, Table 5.4 its sum and the steps.
  EXPECT_NEAR(number("5.5 pi10 step1 pooled", "value"), all("5.5 pi10 step1", "value") / 2, 1e-5);
  double sum = 0;
  for (const char* step : {"step1", "step2", "step3", "step4"}) {
    sum += number(std::string("5.5 pi10 ") + step + " 1", "value");
  }
  EXPECT_NEAR(number("5.4 pi10 total_reward 1", "value"), sum, 1e-5);
  EXPECT_EQ(number("5.4 pi10 steps pooled", "value"), 40);
  EXPECT_EQ(number("5.4 pi100 steps pooled", "value"), 48);
  EXPECT_EQ(rows.at("5.4 pi10 total_reward 1").at("low"), "");  // one training has no spread
  EXPECT_NE(rows.at("5.4 pi10 total_reward pooled").at("low"), "");
  EXPECT_EQ(rows.at("5.5 pi10 step1 1").at("n"), "");

  // A curve ends in the mean of its last steps, all of them where there are fewer than 20.
  EXPECT_NEAR(number("fig5.6 pi10 step3@10 pooled", "value"),
              number("5.5 pi10 step3 pooled", "value"), 1e-5);

  EXPECT_EQ(rows.at("5.7 any_pose unfolded 2").at("command"),
            "gusset evaluate --policy " + (dir_ / "out").string() +
                "/trainings/pi100-seed2 --bag bag1 --start unfolded --pose any --episodes 4 "
                "--seed 1002");
  EXPECT_THAT(rows.at("5.5 pi10 step1 2").at("command"),
              HasSubstr("gusset train --agent pi --bag bag1 --steps 10 --seed 2 --out "));
  EXPECT_THAT(rows.at("5.6 pi10 step4 pooled").at("command"),
              HasSubstr("--only 5.6 --agents pi10 --seed 1 --seeds 2 --episodes 4 --attempts 5 "
                        "--steps 12 --out out/again/5.6-pi10"));
}

TEST_F(ExperimentTest, ThePooledCommandRepeatsItsRow) {
  TableRig rig;
  Run(dir_ / "whole", rig);
  options_.tables = {"5.6"};
  options_.agents = {"pi10"};
  options_.first_seed = 2;
  options_.seeds = 1;
  Run(dir_ / "part", rig);
  const auto step = [](const std::filesystem::path& out) {
    for (const Line& row : ReadCsv(Slurp(out))) {
      if (row.at("table") + row.at("row") + row.at("column") + row.at("seed") == "5.6pi10step22") {
        return row.at("successes") + "/" + row.at("n") + "/" + row.at("seconds_sim");
      }
    }
    return std::string();
  };
  EXPECT_NE(step(dir_ / "whole"), "");
  EXPECT_EQ(step(dir_ / "whole"), step(dir_ / "part"));
}

TEST_F(ExperimentTest, TheResultDoesNotDependOnJobs) {
  TableRig rig;
  Run(dir_ / "one", rig);
  for (const int jobs : {2, 3}) {
    const std::filesystem::path out = dir_ / std::to_string(jobs);
    Run(out, rig, jobs);
    EXPECT_EQ(Comparable(dir_ / "one"), Comparable(out)) << jobs;
  }
}

// Stopped again and again, in the midst of trainings and trials.
TEST_F(ExperimentTest, AnInterruptedExperimentEndsLikeAnUnbrokenOne) {
  TableRig unbroken;
  Run(dir_ / "unbroken", unbroken);
  const std::filesystem::path out = dir_ / "broken";
  TableRig rig;
  int interruptions = 0;
  for (int patience = 40;; patience += 25) {
    std::atomic<int> asked = 0;
    try {
      Run(out, rig, 1 + interruptions % 2, [&] { return ++asked > patience; });
      break;
    } catch (const RunError& e) {
      EXPECT_THAT(e.what(), HasSubstr("--resume"));
      ASSERT_LT(++interruptions, 200);
    }
  }
  EXPECT_GT(interruptions, 3);
  EXPECT_EQ(Comparable(dir_ / "unbroken"), Comparable(out));
  EXPECT_EQ(rig.tried, unbroken.tried) << "what a trial has done is not done again";
  for (const auto& one : std::filesystem::recursive_directory_iterator(out / "trials")) {
    EXPECT_NE(one.path().extension(), ".journal") << "of no more use";
  }
}

TEST_F(ExperimentTest, WhatIsFinishedIsNotDoneAgain) {
  TableRig first, second;
  Run(dir_ / "out", first);
  const std::string text = Slurp(dir_ / "out");
  Run(dir_ / "out", second);
  EXPECT_EQ(second.trained, 0);
  EXPECT_EQ(second.opened, 0);
  EXPECT_EQ(second.checked, 4);
  EXPECT_EQ(Slurp(dir_ / "out"), text);

  // One more seed costs that seed alone.
  options_.seeds = 3;
  Run(dir_ / "out", second);
  EXPECT_EQ(second.trained, 2);
  EXPECT_EQ(second.opened, 6);
}

TEST_F(ExperimentTest, ATrialOfAnotherExperimentIsRefused) {
  TableRig rig;
  Run(dir_ / "out", rig);
  options_.episodes = 5;
  try {
    Run(dir_ / "out", rig);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("folded.json: count = 4 is not 5, as asked for now"));
  }
  options_.episodes = 4;
  const std::filesystem::path file = dir_ / "out/trials/pi10-seed2/attempts.json";
  for (const char* broken : {"", "[]", "{\"trial\": \"attempts\"}"}) {
    WriteFileAtomic(file, broken);
    try {
      Run(dir_ / "out", rig);
      ADD_FAILURE() << broken;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("attempts.json: "));
      EXPECT_THAT(e.what(), testing::Not(HasSubstr("\n")));
    }
  }
}

TEST_F(ExperimentTest, ATrainingThatCannotBeFinishedLeavesTheOthersAlone) {
  TableRig rig;
  rig.never = "pi10";
  for (const int jobs : {1, 2}) {
    const ExperimentResult result = Run(dir_ / std::to_string(jobs), rig, jobs);
    EXPECT_THAT(result.failed, testing::UnorderedElementsAre("pi10 seed 1: no bag has reached s1",
                                                             "pi10 seed 2: no bag has reached s1"));
    std::set<std::string> names;
    for (const ResultRow& row : result.rows) names.insert(row.row);
    EXPECT_FALSE(names.contains("pi10"));
    EXPECT_TRUE(names.contains("pi30"));
  }
}

TEST_F(ExperimentTest, PooledLinesSumUpTheSeedsThatCouldBeFinished) {
  TableRig rig;
  rig.never = "pi10";
  rig.never_from = 2;
  Run(dir_ / "out", rig, 2);
  int pooled = 0;
  for (const Line& row : ReadCsv(Slurp(dir_ / "out"))) {
    if (row.at("column") != "folded" || row.at("seed") != "pooled") continue;
    ++pooled;
    EXPECT_EQ(row.at("n"), row.at("row") == "pi10" ? "4" : "8");
  }
  EXPECT_EQ(pooled, 2);
}

TEST_F(ExperimentTest, AWorldThatComesApartIsReportedAndTriedAgainOnResume) {
  options_.agents = {"pi10"};
  options_.seeds = 1;
  TableRig fragile(30);
  const ExperimentResult broken = Run(dir_ / "out", fragile);
  ASSERT_EQ(broken.failed.size(), 1u);
  EXPECT_THAT(broken.failed[0], HasSubstr("the world came apart"));
  TableRig sound;
  const ExperimentResult mended = Run(dir_ / "out", sound);
  EXPECT_TRUE(mended.failed.empty());
  Run(dir_ / "unbroken", sound);
  EXPECT_EQ(Comparable(dir_ / "out"), Comparable(dir_ / "unbroken"));
}

}  // namespace
}  // namespace gusset
