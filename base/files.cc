#include "base/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace gusset {
namespace {

std::string Reason(const std::filesystem::path& path, const char* what, int error) {
  return path.string() + ": " + what + ": " + std::strerror(error);
}

// Closes on every way out.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// @returns 0, or the error that kept a part from being written.
int WriteAll(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

// Where WriteFileAtomic writes before it renames.
std::filesystem::path Beside(std::filesystem::path target) { return target += ".tmp"; }

// A device or a pipe, which takes what is written to it and must not be replaced by a file.
bool IsDevice(const std::filesystem::path& path) {
  struct stat is {};
  return ::stat(path.c_str(), &is) == 0 && !S_ISREG(is.st_mode) && !S_ISDIR(is.st_mode);
}

// The stream of ours that is redirected to this file (1, 2), as /dev/stdout names it; else -1.
int OwnStream(const std::filesystem::path& path) {
  struct stat is {
  }, ours{};
  if (::stat(path.c_str(), &is) != 0) return -1;
  for (const int fd : {STDOUT_FILENO, STDERR_FILENO}) {
    if (::fstat(fd, &ours) == 0 && ours.st_dev == is.st_dev && ours.st_ino == is.st_ino) return fd;
  }
  return -1;
}

void WriteThrough(const std::filesystem::path& path, std::string_view contents) {
  const int own = OwnStream(path);
  const Descriptor file(own >= 0 ? ::dup(own) : ::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0) throw InputError(Reason(path, "cannot write", errno));
  if (const int error = WriteAll(file.get(), contents)) {
    throw RunError(Reason(path, "cannot write", error));
  }
}

// What a link, or a link to a link, points at, there or not: it is replaced, and the link stays.
std::filesystem::path BehindLinks(std::filesystem::path path) {
  std::error_code none;
  for (int links = 0; std::filesystem::is_symlink(path, none); ++links) {
    constexpr int kMostLinks = 40;  // as Linux follows, path_resolution(7)
    if (links == kMostLinks) throw InputError(Reason(path, "cannot write", ELOOP));
    path = path.parent_path() / std::filesystem::read_symlink(path, none);
  }
  return path;
}

}  // namespace

bool Exists(const std::filesystem::path& path) {
  std::error_code none;
  return std::filesystem::exists(path, none);
}

bool IsFolder(const std::filesystem::path& path) {
  std::error_code none;
  return std::filesystem::is_directory(path, none);
}

bool WritesThrough(const std::filesystem::path& path) {
  return IsDevice(path) || OwnStream(path) >= 0;
}

std::string ReadFile(const std::filesystem::path& path, std::size_t max_bytes) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) throw InputError(Reason(path, "cannot be read", errno));
  std::string contents;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t n = ::read(file.get(), buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw InputError(Reason(path, "cannot be read", errno));
    if (n == 0) return contents;
    contents.append(buffer, static_cast<std::size_t>(n));
    if (contents.size() > max_bytes) {
      throw InputError(path.string() + ": larger than " + std::to_string(max_bytes) + " bytes");
    }
  }
}

void WriteFileAtomic(const std::filesystem::path& path, std::string_view contents) {
  if (WritesThrough(path)) return WriteThrough(path, contents);
  const std::filesystem::path target = BehindLinks(path);
  const std::filesystem::path beside = Beside(target);
  const auto give_up = [&](const char* what, int error) {
    ::unlink(beside.c_str());
    throw RunError(Reason(path, what, error));
  };
  {
    const Descriptor file(::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
    if (file.get() < 0) {
      const int error = errno;
      if (error == ENOSPC || error == EDQUOT) throw RunError(Reason(path, "cannot write", error));
      throw InputError(Reason(error == EISDIR ? beside : path, "cannot write", error));
    }
    if (const int error = WriteAll(file.get(), contents)) give_up("cannot write", error);
    if (::fsync(file.get()) != 0) give_up("cannot write", errno);
  }
  if (::rename(beside.c_str(), target.c_str()) != 0) give_up("cannot replace", errno);
}

void CheckWritable(const std::filesystem::path& path) {
  const auto refuse = [&](const std::filesystem::path& what, int error) {
    throw InputError(Reason(what, "cannot write", error));
  };
  if (path.empty()) refuse(path, ENOENT);
  if (IsFolder(path)) refuse(path, EISDIR);
  struct stat is {};
  if (WritesThrough(path)) {  // not opened: a pipe's reader would take that for the end
    if (::access(path.c_str(), W_OK) != 0) refuse(path, errno);
    if (::stat(path.c_str(), &is) == 0 && S_ISSOCK(is.st_mode)) refuse(path, ENXIO);
    return;
  }
  const std::filesystem::path tried = Beside(BehindLinks(path));
  const bool there = ::lstat(tried.c_str(), &is) == 0;
  const Descriptor file(::open(tried.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0644));
  if (file.get() < 0) refuse(there ? tried : path, errno);
  if (!there) ::unlink(tried.c_str());
}

void MakeFolder(const std::filesystem::path& path) {
  if (path.empty()) throw InputError("a folder's name is empty");
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw InputError(path.string() + ": cannot make this folder: " + error.message());
}

std::filesystem::path MoveAside(const std::filesystem::path& path) {
  std::error_code error;
  // "out/run/" and "out/run" are the same folder; only the latter can take a suffix.
  const std::filesystem::path plain = path.has_filename() ? path : path.parent_path();
  if (!std::filesystem::exists(std::filesystem::symlink_status(plain, error))) return {};
  for (int i = 1;; ++i) {
    std::filesystem::path aside = plain;
    aside += "." + std::to_string(i);
    if (std::filesystem::exists(std::filesystem::symlink_status(aside, error))) continue;
    std::filesystem::rename(plain, aside, error);
    if (error) throw InputError(plain.string() + ": cannot move it aside: " + error.message());
    return aside;
  }
}

FolderLock::FolderLock(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / ".lock";
  fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) throw InputError(Reason(file, "cannot write", errno));
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(fd_);
  throw InputError(folder.string() + ": another process is working there");
}

FolderLock::~FolderLock() { ::close(fd_); }

LineLog::LineLog(std::filesystem::path path, std::uint64_t keep_bytes)
    : path_(std::move(path)), bytes_(keep_bytes) {
  fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) throw InputError(Reason(path_, "cannot write", errno));
  struct stat info = {};
  std::string problem;
  if (::fstat(fd_, &info) != 0) {
    problem = Reason(path_, "cannot write", errno);
  } else if (static_cast<std::uint64_t>(info.st_size) < keep_bytes) {
    problem = path_.string() + ": has " + std::to_string(info.st_size) +
              " bytes, its checkpoint knows of " + std::to_string(keep_bytes);
  } else if (char last = '\n';
             keep_bytes > 0 &&
             (::pread(fd_, &last, 1, static_cast<off_t>(keep_bytes) - 1) != 1 || last != '\n')) {
    problem = path_.string() + ": no line ends at byte " + std::to_string(keep_bytes) +
              ", up to which its checkpoint knows of it";
  } else if (::ftruncate(fd_, static_cast<off_t>(keep_bytes)) != 0 ||
             ::lseek(fd_, 0, SEEK_END) < 0) {
    problem = Reason(path_, "cannot write", errno);
  }
  if (!problem.empty()) {
    ::close(fd_);
    throw InputError(problem);
  }
}

LineLog::~LineLog() { ::close(fd_); }

void LineLog::Append(std::string_view line) {
  std::string whole(line);
  whole += '\n';
  if (const int error = WriteAll(fd_, whole)) {
    // Half a line would be read as a broken record; if even cutting fails, resume cuts it.
    [[maybe_unused]] const int cut = ::ftruncate(fd_, static_cast<off_t>(bytes_));
    ::lseek(fd_, static_cast<off_t>(bytes_), SEEK_SET);
    throw RunError(Reason(path_, "cannot write", error));
  }
  bytes_ += whole.size();
}

void LineLog::Sync() {
  if (::fsync(fd_) != 0) throw RunError(Reason(path_, "cannot write", errno));
}

}  // namespace gusset
