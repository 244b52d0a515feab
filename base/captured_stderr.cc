#include "base/captured_stderr.h"

#include <sys/mman.h>
#include <unistd.h>

namespace gusset {

CapturedStderr::CapturedStderr()
    : saved_(::dup(STDERR_FILENO)), file_(::memfd_create("stderr", MFD_CLOEXEC)) {
  if (saved_ >= 0 && file_ >= 0) ::dup2(file_, STDERR_FILENO);
}

CapturedStderr::~CapturedStderr() {
  Restore();
  if (file_ >= 0) ::close(file_);
}

std::string CapturedStderr::Text() {
  Restore();
  std::string text(4096, '\0');
  const ssize_t n = file_ < 0 ? 0 : ::pread(file_, text.data(), text.size(), 0);
  text.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
  return text;
}

void CapturedStderr::Restore() {
  if (saved_ < 0) return;
  ::dup2(saved_, STDERR_FILENO);
  ::close(saved_);
  saved_ = -1;
}

}  // namespace gusset
