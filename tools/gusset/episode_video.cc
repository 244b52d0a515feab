#include "tools/gusset/episode_video.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "base/captured_stderr.h"
#include "base/error.h"
#include "base/files.h"
#include "perception/overlay.h"

namespace gusset {
namespace {

constexpr double kFramesPerSecond = 15;
constexpr int kInset = 340;  // the region of interest as perception sees it
constexpr int kHeight = 480;
constexpr int kWidth = 640;
constexpr int kMargin = 10;  // beside the caption
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;

}  // namespace

EpisodeVideo::EpisodeVideo(const std::filesystem::path& file, TestbedEnv& environment)
    : file_(file.string()), environment_(environment) {
  CheckWritable(file);
  const CapturedStderr held;  // lines of each of OpenCV's backends
  if (!writer_.open(file_, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), kFramesPerSecond,
                    {kWidth + kInset, kHeight})) {
    throw InputError(file_ + ": cannot write this video");
  }
  environment_.testbed().Watch(1 / kFramesPerSecond, [this] { AddFrame(); });
}

EpisodeVideo::~EpisodeVideo() { environment_.testbed().Watch(1, {}); }

void EpisodeVideo::Finish() {
  environment_.testbed().Watch(1, {});
  const CapturedStderr held;
  writer_.release();
  // The writer does not tell what became of its frames.
  cv::VideoCapture film(file_);
  const int there = film.isOpened() ? cvRound(film.get(cv::CAP_PROP_FRAME_COUNT)) : 0;
  if (there >= frames_) return;
  throw RunError(file_ + ": of " + std::to_string(frames_) + " frames " + std::to_string(there) +
                 " are there; is the disk full?");
}

void EpisodeVideo::AddFrame() {
  cv::Mat image(kHeight, kWidth + kInset, CV_8UC3, cv::Scalar::all(255));
  environment_.testbed().ObliqueLook().color.copyTo(image(cv::Rect(0, 0, kWidth, kHeight)));
  const RgbdFrame& seen = environment_.bagging().frame_before();
  if (!seen.color.empty()) {
    cv::Mat overlay;
    cv::resize(DrawOverlay(seen, environment_.bagging().before()), overlay, {kInset, kInset});
    overlay.copyTo(image(cv::Rect(kWidth, 0, kInset, kInset)));
  }
  const int width = cv::getTextSize(caption_, kFont, kFontScale, 1, nullptr).width;
  const double fitting = kFontScale * std::min(1.0, (kInset - 2.0 * kMargin) / std::max(1, width));
  cv::putText(image, caption_, {kWidth + kMargin, kInset + 40}, kFont, fitting, cv::Scalar::all(30),
              1, cv::LINE_AA);
  writer_.write(image);
  ++frames_;
}

}  // namespace gusset
