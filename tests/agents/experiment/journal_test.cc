#include "agents/experiment/journal.h"

#include <gmock/gmock.h>

#include "agents/experiment/runner.h"
#include "base/files.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

class Journal : public FolderTest {
 protected:
  JournalEnvironment Opened(const std::string& versions = "1") {
    return {std::make_unique<CountingEnvironment>(std::make_unique<TableWorld>(), acted_),
            dir_ / "journal", versions};
  }
  // Three actions, each in what the one before left. @returns all that came of them.
  static std::string Episode(Environment& environment, std::uint64_t noise = 5) {
    std::string all;
    Snapshot world = environment.Start(StartKind::kFolded, 1);
    for (int i = 0; i < 3; ++i) {
      environment.Begin(world, noise + static_cast<std::uint64_t>(i));
      Outcome outcome = environment.Act(i);
      all += nlohmann::json({outcome.next.state, outcome.next.features, outcome.reward,
                             outcome.done, outcome.success, outcome.true_success, outcome.sim_s,
                             outcome.truth.state, outcome.truth.held_clear_s})
                 .dump() +
             outcome.log.dump() + outcome.after;
      world = std::move(outcome.after);
    }
    return all;
  }
  std::atomic<int> acted_ = 0;
};

TEST_F(Journal, WhatWasDoneIsAnsweredAndNotDoneAgain) {
  TableWorld plain;
  const std::string expected = Episode(plain);
  JournalEnvironment first = Opened();
  EXPECT_EQ(Episode(first), expected);
  EXPECT_EQ(acted_, 3);
  JournalEnvironment second = Opened();
  EXPECT_EQ(Episode(second), expected);
  EXPECT_EQ(acted_, 3);
}

TEST_F(Journal, OtherNoiseAndOtherVersionsAreNotWhatWasDone) {
  JournalEnvironment first = Opened();
  Episode(first);
  Episode(first, 100);
  EXPECT_EQ(acted_, 6);
  JournalEnvironment other = Opened("2");
  Episode(other);
  EXPECT_EQ(acted_, 9);
}

TEST_F(Journal, ABrokenFileIsNamed) {
  JournalEnvironment first = Opened();
  Episode(first);
  for (const auto& one : fs::directory_iterator(dir_ / "journal")) {
    WriteFileAtomic(one.path(), "{\"next_state\": \"x\"}\n");
  }
  JournalEnvironment second = Opened();
  try {
    Episode(second);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr(".action: next_state = \"x\" has the wrong type"));
  }
}

}  // namespace
}  // namespace gusset
