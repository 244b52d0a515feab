#include <array>
#include <cstdio>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "agents/json_fields.h"
#include "base/error.h"
#include "base/files.h"
#include "perception/perceive.h"
#include "tools/gusset/command.h"
#include "tools/gusset/settings.h"

namespace gusset {
namespace {

constexpr std::size_t kMaxImageBytes = std::size_t{256} << 20;

cv::Mat ReadImage(const std::filesystem::path& file, int flags) {
  const std::string bytes = ReadFile(file, kMaxImageBytes);
  cv::Mat image;
  if (!bytes.empty()) {
    try {
      image = cv::imdecode(
          cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data())),
          flags);
    } catch (const cv::Exception&) {  // what is wrong with it does not matter to the user
    }
  }
  if (image.empty()) throw InputError(file.string() + ": is not an image that can be read");
  return image;
}

RgbdFrame ReadFrame(const std::filesystem::path& color, const std::filesystem::path& depth) {
  RgbdFrame frame;
  frame.color = ReadImage(color, cv::IMREAD_COLOR);
  if (!depth.empty()) frame.depth_mm = ReadImage(depth, cv::IMREAD_UNCHANGED);
  return frame;
}

class ClassifyCommand final : public Command {
 public:
  const char* name() const override { return "classify"; }
  const char* summary() const override { return "State, areas and piece of photographs or frames"; }

  void Declare(CLI::App& app) override {
    app.add_option("images", images_, "Colour images")->type_name("IMAGE");
    app.add_option("--depth", depth_, "16-bit depth image (mm) of the one colour image");
    app.add_option("--corpus", corpus_, "Folder with labels.jsonl, as render writes it")
        ->type_name("DIR");
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file [bag1]");
    app.add_flag("--json", json_, "Print one JSON document");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    if (images_.empty() == corpus_.empty()) {
      throw InputError("classify needs either images or --corpus");
    }
    if (!depth_.empty() && images_.size() != 1) {
      throw InputError("--depth: goes with one image, not " + std::to_string(images_.size()));
    }
    config_ = LoadPerception();
    corpus_.empty() ? ClassifyImages() : ClassifyCorpus();
  }

 private:
  // Photographs need no world, so the bag's file is read for its thresholds alone.
  BaggingConfig LoadPerception() const {
    ConfigTree tree;
    tree.Load(BagFile(bag_));
    for (const std::string& file : common_.config_files) tree.Load(file);
    for (const std::string& assignment : common_.assignments) tree.Set(assignment);
    BaggingConfig config;
    config.Read(tree);
    return config;
  }

  Observation Look(const std::filesystem::path& color, const std::filesystem::path& depth) const {
    try {
      return Perceive(ReadFrame(color, depth), OverheadCamera({}, kCameraHeight_m),
                      config_.perception, config_.chosen_thresholds());
    } catch (const InputError& e) {
      const std::string what = e.what();
      throw InputError(what.starts_with(color.string()) || what.starts_with(depth.string())
                           ? what
                           : color.string() + ": " + what);
    }
  }

  static nlohmann::ordered_json Json(const std::string& file, const Observation& seen) {
    return {{"file", file},
            {"state", StateName(seen.state)},
            {"A_bag", seen.A_bag},
            {"A_o", seen.A_o},
            {"piece", seen.piece},
            {"cube_hidden", seen.cube_hidden},
            {"warnings", seen.warnings}};
  }

  void Print(const nlohmann::ordered_json& list) const {
    if (json_) return PrintJson(list);
    for (const auto& entry : list) {
      std::printf("%s  %s  A_bag %.0f  A_o %.0f  piece %s",
                  entry["state"].get<std::string>().c_str(),
                  entry["file"].get<std::string>().c_str(), entry["A_bag"].get<double>(),
                  entry["A_o"].get<double>(), entry["piece"].get<bool>() ? "yes" : "no");
      for (const auto& warning : entry["warnings"]) {
        std::printf("; %s", warning.get<std::string>().c_str());
      }
      std::printf("\n");
    }
  }

  void ClassifyImages() const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const std::string& image : images_) list.push_back(Json(image, Look(image, depth_)));
    Print(list);
  }

  void ClassifyCorpus() const {
    const std::filesystem::path folder = corpus_;
    const std::filesystem::path labels = folder / "labels.jsonl";
    std::istringstream lines(ReadFile(labels));
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    int right = 0;
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      std::string file, depth, state;
      try {
        const nlohmann::json label = nlohmann::json::parse(line);
        file = JsonField<std::string>(label, "file");
        state = JsonField<std::string>(label, "state");
        if (label.contains("depth")) depth = JsonField<std::string>(label, "depth");
      } catch (const std::exception& e) {
        throw InputError(labels.string() + ":" + std::to_string(number) + ": " + e.what());
      }
      const Observation seen = Look(folder / file, depth.empty() ? "" : folder / depth);
      list.push_back(Json(file, seen));
      list.back()["state_true"] = state;
      right += StateName(seen.state) == state;
    }
    Print(list);
    std::cerr << right << " of " << number << " as labelled" << std::endl;
  }

  static constexpr double kCameraHeight_m = 1.066;

  CommonOptions common_;
  std::vector<std::string> images_;
  std::string depth_;
  std::string corpus_;
  std::string bag_ = "bag1";
  bool json_ = false;
  BaggingConfig config_;
};

}  // namespace

std::unique_ptr<Command> MakeClassifyCommand() { return std::make_unique<ClassifyCommand>(); }

}  // namespace gusset
