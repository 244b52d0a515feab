#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "agents/image_file.h"
#include "agents/json_fields.h"
#include "base/error.h"
#include "base/files.h"
#include "perception/calibrate.h"
#include "perception/overlay.h"
#include "perception/perceive.h"
#include "perception/view.h"
#include "tools/gusset/command.h"
#include "tools/gusset/corpus.h"
#include "tools/gusset/corpus_score.h"
#include "tools/gusset/image_input.h"
#include "tools/gusset/photograph.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/toml_edit.h"

namespace gusset {
namespace {

/// FrameTruth::surface as a picture for people: labels green, else a colour per Shown.
cv::Mat PaintTruth(const cv::Mat& surface) {
  cv::Mat image(surface.size(), CV_8UC3);
  for (int y = 0; y < surface.rows; ++y) {
    for (int x = 0; x < surface.cols; ++x) {
      const auto& pixel = surface.at<cv::Vec3b>(y, x);
      static const cv::Vec3b kColors[] = {{40, 40, 40},    {190, 200, 200}, {220, 215, 200},
                                          {150, 110, 110}, {110, 110, 150}, {40, 40, 220}};
      image.at<cv::Vec3b>(y, x) =
          pixel[2] != 0 ? cv::Vec3b(60, 200, 90) : kColors[std::min<int>(pixel[0], 5)];
    }
  }
  return image;
}

cv::Rect ParseCrop(const std::string& text) {
  cv::Rect crop;
  char comma[3] = {}, more = 0;
  std::istringstream in(text);
  in >> crop.x >> comma[0] >> crop.y >> comma[1] >> crop.width >> comma[2] >> crop.height;
  if (!in || std::string_view(comma, 3) != ",,," || in >> more) {
    throw InputError("--crop: '" + text + "' is not x,y,width,height in whole px");
  }
  return crop;
}

class ClassifyCommand final : public Command {
 public:
  const char* name() const override { return "classify"; }
  const char* summary() const override { return "State, areas and piece of photographs or frames"; }

  void Declare(CLI::App& app) override {
    app.add_option("images", images_, "Colour images")->type_name("IMAGE");
    app.add_option("--depth", depth_, "16-bit depth image (mm) of the one colour image");
    app.add_option("--corpus", corpora_,
                   "Folder with labels.jsonl, as render writes it (repeatable)")
        ->type_name("DIR");
    app.add_option("--out", out_,
                   "Folder for overlays; with --corpus for report.json and pictures of failures")
        ->type_name("DIR");
    app.add_option("--crop", crop_, "Part of the images to look at: x,y,width,height in px")
        ->type_name("X,Y,W,H");
    app.add_option("--px-per-m", px_per_m_, "Scale of the images at the table, px per metre")
        ->check(CLI::Range(10.0, 20000.0))
        ->type_name("P");
    app.add_option("--camera", camera_,
                   "Calibration of the images: a camera.json as render writes it")
        ->type_name("FILE");
    app.add_flag(
        "--calibrate", calibrate_,
        "Derive the bag's thresholds from frames of it laid flat and write them to its file");
    app.add_option("--bag", bag_,
                   "Bag: a name in assets/bags or a TOML file [the corpus's, else bag1]");
    app.add_flag("--json", json_, "Print one JSON document");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    if (images_.empty() == corpora_.empty()) {
      throw InputError("classify needs either images or --corpus");
    }
    if (!depth_.empty() && images_.size() != 1) {
      throw InputError("--depth: goes with one image, not " + std::to_string(images_.size()));
    }
    if (!corpora_.empty() && (!crop_.empty() || px_per_m_ || !camera_.empty())) {
      throw InputError("--crop, --px-per-m and --camera go with images, not with --corpus");
    }
    if (px_per_m_ && !camera_.empty()) throw InputError("--px-per-m: is in --camera already");
    if (calibrate_ && !bag_) throw InputError("--calibrate: needs --bag, whose file is written");
    if (calibrate_) return Calibrate();
    corpora_.empty() ? ClassifyImages() : ClassifyCorpora();
  }

 private:
  // Photographs need no world, so the bag's file is read for its thresholds alone; the other
  // sections are read to find mistakes. (A corpus's own config may be an older version's.)
  BaggingConfig LoadPerception() const {
    ConfigTree tree;
    tree.Load(BagFile(bag_.value_or("bag1")));
    common_.ReadInto(tree);
    RefuseUnknownKeys(tree);
    BaggingConfig config;
    config.Read(tree);
    return config;
  }

  // A corpus knows its bag, but how to look is this program's: its own [perception] is what the one
  // that rendered it had.
  BaggingConfig LoadFor(const std::filesystem::path& corpus) const {
    BaggingConfig config = LoadPerception();
    const std::filesystem::path file = corpus / "config.toml";
    if (bag_ || !Exists(file)) return config;
    ConfigTree tree;
    tree.Load(file);
    common_.ReadInto(tree);
    BaggingConfig of_corpus;
    of_corpus.Read(tree);
    of_corpus.perception = config.perception;
    return of_corpus;
  }

  static Observation Look(const RgbdFrame& frame, const std::filesystem::path& color,
                          const CameraModel& camera, const BaggingConfig& config) {
    try {
      return Perceive(frame, camera, config.perception, config.chosen_thresholds());
    } catch (const InputError& e) {
      throw InputError(color.string() + ": " + e.what());
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

  // One image as perception is to see it.
  Photograph Prepare(const std::string& image, const BaggingConfig& config) const {
    PhotographOptions options;
    if (!crop_.empty()) options.crop = ParseCrop(crop_);
    options.px_per_m = px_per_m_;
    if (!camera_.empty()) options.camera = ReadCamera(camera_);
    try {
      return PreparePhotograph(ReadFrame(image, depth_), options, config.perception);
    } catch (const InputError& e) {
      const std::string what = e.what();
      const bool named = what.starts_with(image) || (!depth_.empty() && what.starts_with(depth_));
      throw InputError(named ? what : image + ": " + what);
    }
  }

  static std::string OverlayName(const std::filesystem::path& image) {
    return image.stem().string() + "_overlay.png";
  }

  void RefuseSameOverlays() const {
    std::map<std::string, std::string> images;
    for (const std::string& image : images_) {
      const auto [other, is_new] = images.emplace(OverlayName(image), image);
      if (is_new) continue;
      throw InputError("--out: " + image + " and " + other->second + " would both become " +
                       OverlayName(image));
    }
  }

  void ClassifyImages() const {
    const BaggingConfig config = LoadPerception();
    if (!out_.empty()) {
      RefuseSameOverlays();
      MakeFolder(out_);
    }
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const std::string& image : images_) {
      const Photograph photograph = Prepare(image, config);
      Observation seen = Look(photograph.frame, image, photograph.camera, config);
      seen.warnings.insert(seen.warnings.end(), photograph.warnings.begin(),
                           photograph.warnings.end());
      list.push_back(Json(image, seen));
      if (out_.empty()) continue;
      const std::filesystem::path overlay = std::filesystem::path(out_) / OverlayName(image);
      WriteImage(overlay, DrawOverlay(photograph.frame, seen));
      list.back()["overlay"] = overlay.string();
    }
    Print(list);
  }

  static std::size_t HashOfFile(const std::filesystem::path& file) {
    return std::hash<std::string>()(ReadFile(file));
  }

  void Calibrate() const {
    const BaggingConfig config = LoadPerception();
    std::vector<Observation> looks;
    std::set<std::size_t> pictures;  // a copy of one says nothing new
    for (const std::string& image : images_) {
      if (!pictures.insert(HashOfFile(image)).second) continue;
      const Photograph photograph = Prepare(image, config);
      looks.push_back(Look(photograph.frame, image, photograph.camera, config));
    }
    for (const std::string& corpus : corpora_) {
      const std::filesystem::path folder = corpus;
      const CameraModel camera = CameraOf(folder);
      for (const LabelledFrame& frame : ReadLabels(folder)) {
        if (!pictures.insert(HashOfFile(frame.color)).second) continue;
        looks.push_back(Look(ReadFrame(frame.color, frame.depth), frame.color, camera, config));
      }
    }
    const std::filesystem::path file = BagFile(*bag_);
    const int labels = config.thresholds.gusset.labels_per_layer;
    const Calibration found = CalibrateThresholds(looks, labels);
    const BagThresholds& t = found.thresholds;
    if (found.labels_seen != labels) {
      std::fprintf(stderr, "the flat bag shows %d labels, %s says %d per layer\n",
                   found.labels_seen, file.c_str(), labels);
    }
    const std::vector<std::pair<std::string, double>> values = {{"A_th", t.A_th},
                                                                {"A_oth", t.A_oth},
                                                                {"A_bmax", t.A_bmax},
                                                                {"A_omax", t.A_omax},
                                                                {"A_flat", t.A_flat}};
    std::vector<std::pair<std::string, std::string>> lines;
    nlohmann::ordered_json document = {{"bag", file.string()}, {"flat_frames", found.flat_looks}};
    for (const auto& [key, value] : values) {
      lines.emplace_back(key, std::to_string(std::lround(value)));
      document[key] = value;
    }
    const std::string text = ReplaceTomlValues(ReadFile(file), "thresholds", lines);
    // What is written is read again first: a table that the editing does not know stays untouched.
    ConfigTree tree;
    tree.Parse(text, file.string());
    BagThresholds read;
    ThresholdChoice choice;
    tree.Read("thresholds", choice);
    read = choice.gusset;
    if (read.A_th != t.A_th || read.A_oth != t.A_oth || read.A_bmax != t.A_bmax ||
        read.A_omax != t.A_omax || read.A_flat != t.A_flat) {
      throw InputError(file.string() + ": [thresholds] must be a table with one key per line");
    }
    WriteFileAtomic(file, text);
    if (json_) return PrintJson(document);
    for (const auto& [key, value] : values) std::printf("%s = %.0f\n", key.c_str(), value);
    std::printf("from %d frames of the bag laid flat, written to %s\n", found.flat_looks,
                file.c_str());
  }

  static CameraModel CameraOf(const std::filesystem::path& corpus) {
    const std::filesystem::path file = corpus / "camera.json";
    return Exists(file) ? ReadCamera(file) : OverheadCamera({}, kNominalHeight_m);
  }

  // Without the pictures of an earlier score, which is replaced.
  static void MakeFailuresFolder(const std::filesystem::path& folder) {
    static const std::regex kPicture("[0-9]{5,}_s[0-5]_seen_as_s[0-5]\\.png");
    MakeFolder(folder);
    std::vector<std::filesystem::path> old;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (std::regex_match(entry.path().filename().string(), kPicture)) old.push_back(entry.path());
    }
    for (const std::filesystem::path& picture : old) std::filesystem::remove(picture);
  }

  void ClassifyCorpora() const {
    const std::filesystem::path out = out_;
    if (!out_.empty()) MakeFailuresFolder(out / "failures");
    CorpusScore score;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const std::string& corpus : corpora_) {
      const std::filesystem::path folder = corpus;
      const BaggingConfig config = LoadFor(folder);
      const std::vector<LabelledFrame> frames = ReadLabels(folder);
      const CameraModel camera = CameraOf(folder);
      for (const LabelledFrame& truth : frames) {
        const RgbdFrame frame = ReadFrame(truth.color, truth.depth);
        const Observation seen = Look(frame, truth.color, camera, config);
        const cv::Mat surface =
            truth.surface.empty() ? cv::Mat() : ReadSurface(truth.surface, frame.color.size());
        const BagThresholds& thresholds = config.chosen_thresholds();
        const std::optional<double> margin =
            ThresholdMargin(truth, thresholds, config.perception.label_min_px2);
        const bool right = score.Add(truth, thresholds, margin, seen, surface);
        nlohmann::ordered_json entry = Json(truth.color.string(), seen);
        AddTruth(truth, margin, entry);
        if (!right && !out_.empty()) {
          const std::filesystem::path picture =
              out / "failures" / PictureName(list.size(), truth, seen);
          WriteFailure(picture, frame, seen, surface);
          entry["picture"] = picture.string();
        }
        list.push_back(std::move(entry));
      }
    }
    if (!out_.empty()) WriteFileAtomic(out / "report.json", JsonText(score.Report()));
    if (json_) {
      PrintJson(list);
      return;
    }
    for (const auto& entry : list) {
      if (entry["state"] == entry["state_true"]) continue;
      std::printf("%s is %s, seen as %s%s\n", entry["file"].get<std::string>().c_str(),
                  entry["state_true"].get<std::string>().c_str(),
                  entry["state"].get<std::string>().c_str(),
                  entry.contains("margin") ? " (near a threshold)" : "");
    }
    std::printf("%s", score.Text().c_str());
  }

  static void AddTruth(const LabelledFrame& truth, std::optional<double> margin,
                       nlohmann::ordered_json& entry) {
    entry["state_true"] = StateName(truth.state);
    if (!truth.has_areas) return;
    entry["A_bag_true"] = truth.A_bag;
    entry["A_o_true"] = truth.A_o;
    if (margin) entry["margin"] = *margin;
  }

  static std::string PictureName(std::size_t index, const LabelledFrame& truth,
                                 const Observation& seen) {
    char name[64];
    std::snprintf(name, sizeof name, "%05zu_%s_seen_as_%s.png", index,
                  std::string(StateName(truth.state)).c_str(),
                  std::string(StateName(seen.state)).c_str());
    return name;
  }

  // The frame, what perception made of it and what is there, side by side.
  static void WriteFailure(const std::filesystem::path& path, const RgbdFrame& frame,
                           const Observation& seen, const cv::Mat& surface) {
    cv::Mat view = ScaleToView(frame.color, seen.roi.width);
    std::vector<cv::Mat> parts = {view(seen.roi), DrawOverlay(frame, seen)};
    if (surface.size() == view.size()) parts.push_back(PaintTruth(surface)(seen.roi));
    cv::Mat picture;
    cv::hconcat(parts, picture);
    WriteImage(path, picture);
  }

  CommonOptions common_;
  std::vector<std::string> images_;
  std::string depth_;
  std::vector<std::string> corpora_;
  std::string out_;
  std::optional<std::string> bag_;
  std::string crop_;
  std::optional<double> px_per_m_;
  std::string camera_;
  bool calibrate_ = false;
  bool json_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeClassifyCommand() { return std::make_unique<ClassifyCommand>(); }

}  // namespace gusset
