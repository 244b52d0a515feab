// The page that `gusset report` writes, in the browser that people have: headless Chromium.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "agents/image_file.h"
#include "agents/report/contact_sheet.h"
#include "agents/trainer.h"
#include "base/config.h"
#include "base/files.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kHostile = "<img src=x onerror=alert(1)></script><b>& \"quoted\"";

// Added to the page: notes in attributes of <body> what only a browser can tell.
constexpr const char* kProbe = R"(<script>
// Pixels in the full colour of the first line (#0072b2).
const painted = canvas => {
  const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    count += data[i] === 0 && data[i + 1] === 0x72 && data[i + 2] === 0xb2 && data[i + 3] === 255;
  }
  return count;
};
document.body.dataset.charts =
    [...document.querySelectorAll('canvas')].filter(c => painted(c) > 50).length;
document.body.dataset.wide = document.documentElement.scrollWidth > innerWidth;
for (const video of document.querySelectorAll('video')) {
  const note = () => { document.body.dataset.video = `${video.videoWidth}x${video.videoHeight}`; };
  video.readyState >= 2 ? note() : video.addEventListener('loadeddata', note);
}
</script>)";

class ReportPage : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium >/dev/null") != 0) {
      GTEST_SKIP() << "chromium is not installed";
    }
  }

  // A run of `seed`, with a learning curve that rises, an evaluation and reward maps.
  void WriteRun(const std::string& name, int seed) {
    const fs::path run = dir_ / name;
    fs::create_directories(run);
    std::string toml;
    AppendToml("train", TrainConfig{.bag = kHostile, .steps = 30, .seed = seed}, toml);
    WriteFileAtomic(run / "config.toml", toml);
    std::string steps;
    for (int i = 0; i < 120; ++i) {
      steps += json{{"step", i},
                    {"kind", "train"},
                    {"state", i / 30},
                    {"point", 0},
                    {"reward", 0.02 * (i % 30) + 0.1 * (seed * i % 3)},
                    {"next_state", 4},
                    {"done", false},
                    {"success", true},
                    {"sim_s", 60}}
                   .dump() +
               "\n";
    }
    WriteFileAtomic(run / "steps.jsonl", steps);
    const json tally = {{"attempts", 20}, {"successes", 9 + seed}};
    WriteFileAtomic(run / "evaluation_folded.json", json{{"policy", "p"},
                                                         {"repeats", 5},
                                                         {"bag", kHostile},
                                                         {"start", "folded"},
                                                         {"pose", "near"},
                                                         {"episodes", 20},
                                                         {"true_successes", 12},
                                                         {"perceived_successes", 13},
                                                         {"per_step", {tally, tally, tally, tally}}}
                                                        .dump());
    for (const char* map : {"reward_map_s0.png", "reward_map_s3.png"}) {
      WriteImage(run / map, cv::Mat(340, 340, CV_8UC3, cv::Scalar(30, 30, 22)));
    }
  }

  // A filmed episode, as `play` leaves it.
  void WriteFilm(const fs::path& folder) {
    fs::create_directories(folder);
    cv::VideoWriter video((folder / "episode.mp4").string(),
                          cv::VideoWriter::fourcc('a', 'v', 'c', '1'), 15, {160, 120});
    ASSERT_TRUE(video.isOpened());
    for (int i = 0; i < 30; ++i) video.write(cv::Mat(120, 160, CV_8UC3, cv::Scalar(0, 8 * i, 0)));
    video.release();
    WriteFileAtomic(folder / "episode.json",
                    R"({"true_success": true, "perceived_success": true, "steps":
                        [{"state": 3, "action": 1, "next_state": 4}]})");
  }

  // Loads a page without a network. @param what --dump-dom or --screenshot=FILE.
  // @returns what the browser printed: the page's elements, and separately its complaints.
  std::pair<std::string, std::string> Browse(const fs::path& page, const std::string& what,
                                             int width) const {
    const std::string command =
        "timeout 100 chromium --headless --no-sandbox --disable-gpu --hide-scrollbars "
        "--user-data-dir=" +
        (dir_ / "profile").string() +
        " --host-resolver-rules='MAP * ~NOTFOUND' --enable-logging=stderr "
        "--virtual-time-budget=8000 --window-size=" +
        std::to_string(width) + ",2600 " + what + " file://" + page.string() + " >" +
        (dir_ / "dom").string() + " 2>" + (dir_ / "err").string();
    EXPECT_EQ(std::system(command.c_str()), 0) << ReadFile(dir_ / "err");
    return {ReadFile(dir_ / "dom"), ReadFile(dir_ / "err")};
  }

  TemporaryFolder folder_;
  fs::path dir_ = folder_.path();
};

TEST_F(ReportPage, DrawsChartsTablesAndVideosWithoutNetworkOrComplaint) {
  for (const int seed : {1, 2, 3}) WriteRun("exp/runs/seed" + std::to_string(seed), seed);
  WriteFilm(dir_ / "exp/runs/seed1/frames/episode");
  std::string csv =
      "table,row,column,seed,n,successes,value,low,high,published,published_low,published_high,"
      "unit,seconds_wall,seconds_sim,command,versions\n"
      "5.6,<i>pi100</i>,step1,pooled,100,55,0.55,0.45,0.64,0.7,0.4,0.89,rate,1,2,c,v\n";
  for (const char* step : {"10", "20", "30"}) {
    csv += "fig5.6,pi100,step1@" + std::string(step) + ",pooled,,,0.3,0.2,0.4,,,,reward,1,2,c,v\n";
  }
  WriteFileAtomic(dir_ / "exp/results.csv", csv);

  const fs::path page = dir_ / "report.html";
  const std::string command = std::string(GUSSET_BINARY) + " report " + (dir_ / "exp").string() +
                              " --out " + page.string() + " >" + (dir_ / "out").string();
  ASSERT_EQ(std::system(command.c_str()), 0);

  const std::string html = ReadFile(page);
  const std::size_t end = html.rfind("</body>");
  ASSERT_NE(end, std::string::npos);
  WriteFileAtomic(dir_ / "probed.html", html.substr(0, end) + kProbe + html.substr(end));
  const auto [dom, complaints] = Browse(dir_ / "probed.html", "--dump-dom", 1200);
  EXPECT_THAT(complaints, Not(HasSubstr("CONSOLE"))) << "no error, no address that it asked for";
  EXPECT_THAT(dom, HasSubstr("data-charts=\"5\"")) << "four learning curves and a figure";
  EXPECT_THAT(dom, HasSubstr("data-video=\"160x120\""));
  EXPECT_THAT(dom, HasSubstr("data-wide=\"false\"")) << "nothing sticks out of the page";
  // Three seeds are one group: 36 of 60 episodes, 33 of 60 steps.
  EXPECT_THAT(dom, HasSubstr("1, 2, 3"));
  for (const char* shown : {">60 % (47 to 71)<", ">36 of 60<", ">55 % (42 to 67)<", ">33 of 60<"}) {
    EXPECT_THAT(dom, HasSubstr(shown));
  }
  // Ours and the thesis's, in one cell.
  for (const char* shown : {">55 % (45 to 64)<", ">55 of 100<", ">thesis 70 % (40 to 89)<"}) {
    EXPECT_THAT(dom, HasSubstr(shown));
  }
  // What files hold is text: no element was made of it.
  EXPECT_THAT(dom, HasSubstr("&lt;img src=x onerror=alert(1)&gt;"));
  EXPECT_THAT(dom, HasSubstr("&lt;i&gt;pi100&lt;/i&gt;"));
  EXPECT_THAT(dom, Not(HasSubstr("<img src=\"x\"")));

  // For people to look at; kept beside the test. That it is not blank is all a test can say.
  const fs::path picture = fs::path(GUSSET_BINARY).parent_path() / "report_page.png";
  fs::remove(picture);
  Browse(page, "--screenshot=" + picture.string(), 1200);
  const cv::Mat shot = cv::imread(picture.string());
  ASSERT_FALSE(shot.empty());
  cv::Scalar mean, spread;
  cv::meanStdDev(shot, mean, spread);
  EXPECT_GT(spread[0], 10);

  const auto [narrow, narrow_complaints] = Browse(dir_ / "probed.html", "--dump-dom", 500);
  EXPECT_THAT(narrow, HasSubstr("data-wide=\"false\"")) << "at the width of a telephone either";
}

TEST_F(ReportPage, TheContactSheetShowsItsPictures) {
  const fs::path frames = dir_ / "frames";
  fs::create_directory(frames);
  for (const char* when : {"before", "after"}) {
    WriteImage(frames / ("step 1%_" + std::string(when) + "_overlay.png"),
               cv::Mat(34, 34, CV_8UC3, cv::Scalar(0, 0, 255)));
  }
  WriteFileAtomic(frames / "step 1%.json", json{{"step", 1},
                                                {"state", 1},
                                                {"action", 5},
                                                {"reward", 0.25},
                                                {"next_state", 1},
                                                {"next_state_true", 2},
                                                {"done", false},
                                                {"success", false},
                                                {"success_true", false},
                                                {"note", kHostile},
                                                {"before", nullptr},
                                                {"after", nullptr}}
                                               .dump());
  WriteContactSheet(frames);
  const std::string html = ReadFile(frames / "contact_sheet.html");
  WriteFileAtomic(frames / "probed.html", html + R"(<script>addEventListener('load', () => {
      document.body.dataset.pictures =
          [...document.images].filter(image => image.naturalWidth === 34).length; });</script>)");
  const auto [dom, complaints] = Browse(frames / "probed.html", "--dump-dom", 1200);
  EXPECT_THAT(complaints, Not(HasSubstr("CONSOLE")));
  EXPECT_THAT(dom, HasSubstr("data-pictures=\"2\""));
  EXPECT_THAT(dom, HasSubstr("1 of 1 actions"));
  EXPECT_THAT(dom, HasSubstr("(in truth s2 open)"));
  EXPECT_THAT(dom, HasSubstr("&lt;img src=x onerror=alert(1)&gt;"));
}

}  // namespace
}  // namespace gusset
