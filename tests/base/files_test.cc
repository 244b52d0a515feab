#include "base/files.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "base/error.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path dir_ = folder_.path();
};

// As a full disk does, a file size limit lets a write fall short and the next one fail.
class DiskFullAt {
 public:
  explicit DiskFullAt(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~DiskFullAt() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(Files, AtomicWriteReplacesTheWholeFile) {
  WriteFileAtomic(dir_ / "a", "long contents");
  WriteFileAtomic(dir_ / "a", "short");
  EXPECT_EQ(ReadFile(dir_ / "a"), "short");
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_), {}), 1) << "a temporary file was left";
}

TEST_F(Files, AFailedAtomicWriteLeavesTheOldContents) {
  WriteFileAtomic(dir_ / "a", "old");
  {
    const DiskFullAt limit(10);
    EXPECT_THROW(WriteFileAtomic(dir_ / "a", std::string(100, 'x')), RunError);
  }
  EXPECT_EQ(ReadFile(dir_ / "a"), "old");
  EXPECT_FALSE(fs::exists(dir_ / "a.tmp"));
}

TEST_F(Files, AnUnwritablePlaceIsBadInput) {
  EXPECT_THROW(WriteFileAtomic(dir_ / "no" / "such" / "folder", "x"), InputError);
  EXPECT_THROW(MakeFolder("/proc/gusset"), InputError);
  WriteFileAtomic(dir_ / "file", "x");
  EXPECT_THROW(MakeFolder(dir_ / "file" / "sub"), InputError);
  EXPECT_THROW(LineLog(dir_ / "no" / "log"), InputError);
  EXPECT_THROW((void)ReadFile(dir_), InputError);
}

TEST_F(Files, WhatCannotBeWrittenIsKnownBeforeItIs) {
  EXPECT_NO_THROW(CheckWritable(dir_ / "new"));
  EXPECT_FALSE(fs::exists(dir_ / "new"));
  EXPECT_NO_THROW(CheckWritable("beside.json"));
  WriteFileAtomic(dir_ / "file", "x");
  EXPECT_NO_THROW(CheckWritable(dir_ / "file"));
  for (const fs::path& path : {fs::path(), dir_, dir_ / "no" / "file", dir_ / "file" / "below"}) {
    EXPECT_THROW(CheckWritable(path), InputError) << path;
    EXPECT_ANY_THROW(WriteFileAtomic(path, "x")) << path;
  }
}

TEST_F(Files, ANameThatCannotTakeItsTemporaryFileIsRefusedBeforehand) {
  const fs::path longest = dir_ / std::string(255, 'x');  // NAME_MAX; with .tmp it is too long
  EXPECT_THROW(CheckWritable(longest), InputError);
  MakeFolder(dir_ / "taken.tmp");
  EXPECT_THROW(CheckWritable(dir_ / "taken"), InputError);
  EXPECT_THROW(WriteFileAtomic(dir_ / "taken", "x"), InputError);
}

TEST_F(Files, ALinkStaysALinkAndADeviceADevice) {
  WriteFileAtomic(dir_ / "target", "old");
  fs::create_symlink("target", dir_ / "link");
  fs::create_symlink("link", dir_ / "again");
  CheckWritable(dir_ / "again");
  WriteFileAtomic(dir_ / "again", "new");
  EXPECT_TRUE(fs::is_symlink(dir_ / "again"));
  EXPECT_TRUE(fs::is_symlink(dir_ / "link"));
  EXPECT_EQ(ReadFile(dir_ / "target"), "new");
  fs::create_symlink("later", dir_ / "dangling");
  WriteFileAtomic(dir_ / "dangling", "made");
  EXPECT_EQ(ReadFile(dir_ / "later"), "made");
  fs::create_symlink("circle", dir_ / "circle");
  EXPECT_THROW(CheckWritable(dir_ / "circle"), InputError);
  EXPECT_THROW(WriteFileAtomic(dir_ / "circle", "x"), InputError);

  const fs::path null = dir_ / "null";  // behind a link, so that a mistake costs no device
  fs::create_symlink("/dev/null", null);
  CheckWritable(null);
  WriteFileAtomic(null, "x");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(WriteFileAtomic("/dev/full", "x"), RunError);
}

// "--out /dev/stdout >> log": the log is not replaced, and the pipe's reader not told of an end.
TEST_F(Files, AStreamOfOursAndAPipeAreWrittenThrough) {
  WriteFileAtomic(dir_ / "log", "before\n");
  const int saved = ::dup(STDOUT_FILENO);
  const int log = ::open((dir_ / "log").c_str(), O_WRONLY | O_APPEND);
  ::dup2(log, STDOUT_FILENO);
  CheckWritable("/dev/stdout");
  WriteFileAtomic("/dev/stdout", "between\n");
  [[maybe_unused]] const ssize_t n = ::write(STDOUT_FILENO, "after\n", 6);
  ::dup2(saved, STDOUT_FILENO);
  ::close(saved);
  ::close(log);
  EXPECT_EQ(ReadFile(dir_ / "log"), "before\nbetween\nafter\n");

  const fs::path pipe = dir_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  CheckWritable(pipe);
  WriteFileAtomic(pipe, "x");
  char c = 0;
  EXPECT_EQ(::read(reader, &c, 1), 1);
  EXPECT_EQ(c, 'x');
  EXPECT_TRUE(fs::is_fifo(pipe));
  ::close(reader);
}

TEST_F(Files, WhatCannotBeLookedAtIsNotThere) {
  EXPECT_TRUE(Exists(dir_));
  EXPECT_TRUE(IsFolder(dir_));
  const fs::path too_long = dir_ / std::string(5000, 'x');
  EXPECT_FALSE(Exists(too_long));
  EXPECT_FALSE(IsFolder(too_long));
  fs::create_symlink("circle", dir_ / "circle");
  EXPECT_FALSE(Exists(dir_ / "circle"));
}

TEST_F(Files, AFileTooLargeIsRefused) {
  WriteFileAtomic(dir_ / "a", "12345");
  EXPECT_EQ(ReadFile(dir_ / "a", 5), "12345");
  EXPECT_THROW((void)ReadFile(dir_ / "a", 4), InputError);
}

TEST_F(Files, ALineLogCutsWhatItsCheckpointDoesNotKnow) {
  std::uint64_t known = 0;
  {
    LineLog log(dir_ / "log");
    log.Append("one");
    known = log.bytes();
    log.Append("two");
  }
  EXPECT_EQ(ReadFile(dir_ / "log"), "one\ntwo\n");
  {
    LineLog log(dir_ / "log", known);
    log.Append("three");
    log.Sync();
  }
  EXPECT_EQ(ReadFile(dir_ / "log"), "one\nthree\n");
  EXPECT_THROW(LineLog(dir_ / "log", 1000), InputError);
  EXPECT_THROW(LineLog(dir_ / "log", 5), InputError) << "within a line";
  EXPECT_EQ(ReadFile(dir_ / "log"), "one\nthree\n") << "what is refused is left as it is";
}

TEST_F(Files, AFullDiskLeavesOnlyWholeLines) {
  LineLog log(dir_ / "log");
  log.Append("first");
  {
    const DiskFullAt limit(10);
    EXPECT_THROW(log.Append("second line, too long"), RunError);
  }
  EXPECT_EQ(ReadFile(dir_ / "log"), "first\n");
  log.Append("third");
  EXPECT_EQ(ReadFile(dir_ / "log"), "first\nthird\n");
}

TEST_F(Files, AFolderIsLockedOnceUntilItsLockIsGone) {
  {
    const FolderLock lock(dir_);
    EXPECT_THROW(FolderLock again(dir_), InputError);
  }
  EXPECT_NO_THROW(FolderLock again(dir_));
  EXPECT_THROW(FolderLock none(dir_ / "none"), InputError);
}

TEST_F(Files, MoveAsideTakesTheFirstFreeNumber) {
  EXPECT_EQ(MoveAside(dir_ / "run"), fs::path());
  fs::create_directory(dir_ / "run");
  EXPECT_EQ(MoveAside(dir_ / "run"), dir_ / "run.1");
  fs::create_directory(dir_ / "run");
  EXPECT_EQ(MoveAside(dir_ / "run/"), dir_ / "run.2");
  EXPECT_FALSE(fs::exists(dir_ / "run"));
}

}  // namespace
}  // namespace gusset
