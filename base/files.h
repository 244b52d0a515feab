#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace gusset {

/// True if there is a file or folder of this name, behind links. What cannot be looked at (a name
/// too long, links in a circle) is not there, as whoever opens it then says why.
bool Exists(const std::filesystem::path& path);
/// True if it is a folder; as Exists.
bool IsFolder(const std::filesystem::path& path);

/// True for a device or a pipe, and for what is our own stdout or stderr: what is written there
/// goes through it rather than into a file of its own.
bool WritesThrough(const std::filesystem::path& path);

/// Whole contents of a file. @throws InputError (`path: why`) if it cannot be read, is a folder or
/// is larger than `max_bytes`.
std::string ReadFile(const std::filesystem::path& path,
                     std::size_t max_bytes = std::size_t{1} << 30);

/// Replaces a file so that a crash at any moment leaves the old contents or the new ones, never a
/// part: written beside it, synced, renamed. (After a power cut it may be the old ones still.) A
/// link stays one; what is written to a device or a pipe goes through it.
/// @throws InputError if the place cannot be written at all, RunError if writing fails (disk full).
void WriteFileAtomic(const std::filesystem::path& path, std::string_view contents);

/// For before long work whose result goes there with WriteFileAtomic, whose first step is tried.
/// @throws InputError (`path: why`) if no file can be put at `path`: it is a folder, what should
/// hold it is none or may not be written to, its name is too long.
void CheckWritable(const std::filesystem::path& path);

/// Makes a folder and its parents; one that exists is fine. @throws InputError.
void MakeFolder(const std::filesystem::path& path);

/// Renames `path` to path.1, path.2, ... (the first free one) if it exists.
/// @returns the new name, or an empty path if there was nothing to move. @throws InputError.
std::filesystem::path MoveAside(const std::filesystem::path& path);

/// Keeps other processes from working in a folder at the same time, by a lock (flock(2)) on its
/// file `.lock`, which a process that is killed leaves free. Where the file system has no locks it
/// keeps nobody out.
class FolderLock {
 public:
  /// @throws InputError if another process has it, or the file cannot be written.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_ = -1;
};

/// A text file that only grows by whole lines, such as a JSONL log. Every line reaches the
/// operating system before Append returns, so a killed process loses none; Sync brings them to the
/// disk.
class LineLog {
 public:
  /// Opens or creates the file and cuts it to `keep_bytes`, what a checkpoint knows of; lines after
  /// that belong to work that will be done again. @throws InputError if it cannot be written or is
  /// shorter than keep_bytes.
  explicit LineLog(std::filesystem::path path, std::uint64_t keep_bytes = 0);
  ~LineLog();
  LineLog(const LineLog&) = delete;
  LineLog& operator=(const LineLog&) = delete;

  /// Appends `line` and a newline. @throws RunError if it does not fit; the file is then cut back
  /// to the last whole line.
  void Append(std::string_view line);
  /// @throws RunError.
  void Sync();
  std::uint64_t bytes() const { return bytes_; }

 private:
  std::filesystem::path path_;
  int fd_ = -1;
  std::uint64_t bytes_ = 0;
};

}  // namespace gusset
