#include "tools/gusset/result_file.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/files.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

TEST(ResultFile, OnlyAnEarlierResultMayBeReplaced) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "r.json").string();
  const auto check = [&] { CheckResultFile(file, "per_step"); };
  EXPECT_NO_THROW(check()) << "nothing is there";
  for (const char* ours : {"", R"({"policy": "random", "per_step": []})"}) {
    WriteFileAtomic(file, ours);
    EXPECT_NO_THROW(check()) << ours;
  }
  for (const char* foreign : {"{}", "[1]", "[bag]\ndepth_m = 0.3\n", R"({"learnt": {}})"}) {
    WriteFileAtomic(file, foreign);
    EXPECT_THROW(check(), InputError) << foreign;
    EXPECT_EQ(ReadFile(file), foreign);
  }
  EXPECT_THROW(CheckResultFile(folder.path().string(), "per_step"), InputError);
  EXPECT_NO_THROW(CheckResultFile("/dev/null", "per_step"));
}

}  // namespace
}  // namespace gusset
