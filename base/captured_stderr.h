#pragma once

#include <string>

namespace gusset {

/// Holds back what is written to stderr while it lives, by any library: some say only there what
/// they had to make up. Of the whole process, so no other thread should write there meanwhile.
class CapturedStderr {
 public:
  CapturedStderr();
  ~CapturedStderr();
  CapturedStderr(const CapturedStderr&) = delete;
  CapturedStderr& operator=(const CapturedStderr&) = delete;

  /// What was written, its first 4096 bytes; ends the capture.
  std::string Text();

 private:
  void Restore();
  int saved_, file_;
};

}  // namespace gusset
