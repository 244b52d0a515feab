#include "tools/gusset/episode_video.h"

#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "perception/overlay.h"

namespace gusset {
namespace {

constexpr double kFramesPerSecond = 15;
constexpr int kInset = 340;  // the region of interest as perception sees it
constexpr int kHeight = 480;
constexpr int kWidth = 640;

}  // namespace

EpisodeVideo::EpisodeVideo(const std::filesystem::path& file, TestbedEnv& environment)
    : environment_(environment),
      writer_(file.string(), cv::VideoWriter::fourcc('a', 'v', 'c', '1'), kFramesPerSecond,
              {kWidth + kInset, kHeight}) {
  if (!writer_.isOpened()) throw InputError(file.string() + ": cannot write this video");
  environment_.testbed().Watch(1 / kFramesPerSecond, [this] { AddFrame(); });
}

EpisodeVideo::~EpisodeVideo() { environment_.testbed().Watch(1, {}); }

void EpisodeVideo::AddFrame() {
  cv::Mat image(kHeight, kWidth + kInset, CV_8UC3, cv::Scalar::all(255));
  environment_.testbed().ObliqueLook().color.copyTo(image(cv::Rect(0, 0, kWidth, kHeight)));
  const RgbdFrame& seen = environment_.bagging().frame_before();
  if (!seen.color.empty()) {
    cv::Mat overlay;
    cv::resize(DrawOverlay(seen, environment_.bagging().before()), overlay, {kInset, kInset});
    overlay.copyTo(image(cv::Rect(kWidth, 0, kInset, kInset)));
  }
  cv::putText(image, caption_, {kWidth + 10, kInset + 40}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar::all(30), 1, cv::LINE_AA);
  writer_.write(image);
}

}  // namespace gusset
