#pragma once

#include <filesystem>
#include <opencv2/videoio.hpp>
#include <string>

#include "tools/gusset/testbed_env.h"

namespace gusset {

/// Films a testbed: the oblique view, and beside it what perception last saw and what is being
/// done.
class EpisodeVideo {
 public:
  /// Starts filming; `environment` must outlive the video. @throws InputError if `file` cannot be
  /// written.
  EpisodeVideo(const std::filesystem::path& file, TestbedEnv& environment);
  ~EpisodeVideo();
  EpisodeVideo(const EpisodeVideo&) = delete;
  EpisodeVideo& operator=(const EpisodeVideo&) = delete;

  /// Ends the video. @throws RunError if a part of it could not be written.
  void Finish();

  /// Caption from now on.
  void Say(std::string caption) { caption_ = std::move(caption); }

 private:
  void AddFrame();

  const std::string file_;
  TestbedEnv& environment_;
  cv::VideoWriter writer_;
  std::string caption_;
  int frames_ = 0;  // written
};

}  // namespace gusset
