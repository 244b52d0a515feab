#include "agents/workers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>

#include "base/error.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

class WorkersByJobs : public testing::TestWithParam<int> {};

TEST_P(WorkersByJobs, RunEveryTaskOnce) {
  Workers workers(GetParam(), [] { return std::make_unique<TableWorld>(); });
  std::vector<int> runs(50, 0);
  std::vector<Workers::Task> tasks;
  for (int& count : runs) tasks.push_back([&count](Environment&) { ++count; });
  workers.Run(tasks);
  EXPECT_EQ(runs, std::vector<int>(50, 1));
}

// An error that ends a long evaluation must not be told hours later.
TEST_P(WorkersByJobs, BeginNothingMoreAfterAnErrorAndRethrowTheEarliest) {
  Workers workers(GetParam(), [] { return std::make_unique<TableWorld>(); });
  std::atomic<int> begun = 0;
  std::vector<Workers::Task> tasks;
  for (int i = 0; i < 1000; ++i) {
    tasks.push_back([&, i](Environment&) {
      ++begun;
      if (i >= 20) throw RunError(std::to_string(i));
    });
  }
  try {
    workers.Run(tasks);
    FAIL() << "nothing was thrown";
  } catch (const RunError& e) {
    EXPECT_STREQ(e.what(), "20");
  }
  EXPECT_GE(begun, 21);
  EXPECT_LE(begun, 20 + GetParam()) << "each thread may have begun one before it could know";
  workers.Run({[&](Environment&) { begun = -1; }});
  EXPECT_EQ(begun, -1) << "later tasks run as ever";
}

// Tasks that go on for as long as there is work, as the trainer's do.
TEST(Workers, TellTasksThatOneHasFailed) {
  Workers workers(3, [] { return std::make_unique<TableWorld>(); });
  const Workers::Task go_on = [&](Environment&) {
    while (!workers.failed()) std::this_thread::yield();
  };
  EXPECT_THROW(workers.Run({go_on, go_on, [](Environment&) { throw RunError("no"); }}), RunError);
  workers.Run({[&](Environment&) { EXPECT_FALSE(workers.failed()); }});
}

INSTANTIATE_TEST_SUITE_P(Jobs, WorkersByJobs, testing::Values(1, 3));

}  // namespace
}  // namespace gusset
