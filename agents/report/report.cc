#include "agents/report/report.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>

#include "agents/experiment/intervals.h"
#include "agents/plots.h"
#include "agents/report/curves.h"
#include "agents/report/footage.h"
#include "agents/report/html_page.h"
#include "agents/report/results_csv.h"
#include "agents/report/run_data.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kPicture_px = 340;  // the region of interest
// A longer video would make the page too large to be sent around; it is named instead.
constexpr std::size_t kMostVideoBytes = 12u << 20;

ordered_json Rate(int successes, int n) {
  const auto ci = WilsonInterval(successes, n);
  return {{"successes", successes}, {"n", n}, {"low", ci[0]}, {"high", ci[1]}};
}

ordered_json BandJson(const Band& band) {
  return {{"mean", band.mean}, {"low", band.low}, {"high", band.high}};
}

// Of Estimate or PublishedCell.
template <class Value>
ordered_json EstimateJson(const std::optional<Value>& estimate) {
  if (!estimate) return nullptr;
  ordered_json json = {{"value", estimate->value}, {"low", nullptr}, {"high", nullptr}};
  if (estimate->low) json["low"] = *estimate->low;
  if (estimate->high) json["high"] = *estimate->high;
  return json;
}

// The row of the thesis's tables that a training is a repetition of; empty if of none.
std::string ThesisRow(const TrainConfig& train) {
  if (train.bag != "bag1" || !train.affordances || train.protocol != TrainConfig().protocol) {
    return "";
  }
  if (train.agent == "pi") return "pi" + std::to_string(train.steps);
  return train.steps == 100 ? train.agent : "";
}

ordered_json EvaluationJson(const EvaluationData& data, const TrainConfig& train,
                            const Published& published) {
  // Table 5.7 has the policy of Bag 1 on other bags.
  const std::string row = ThesisRow(train);
  const bool own_bag = data.bag == train.bag;
  const bool known = data.pose == "near" && (own_bag || row == "pi100") && !data.random &&
                     data.repeats == EvaluationConfig().max_repeats && data.overrides.empty();
  const std::string table = !known ? "" : own_bag ? "5.6" : "5.7";
  const std::string of = own_bag ? row : data.bag;
  ordered_json steps = ordered_json::array();
  for (const StateTally& tally : data.per_step) {
    steps.push_back(Rate(tally.successes, tally.attempts));
  }
  return {{"bag", data.bag},
          {"start", data.start},
          {"pose", data.pose},
          {"random", data.random},
          {"repeats", data.repeats},
          {"overrides", data.overrides},
          {"success", Rate(data.true_successes, data.episodes)},
          {"perceived_successes", data.perceived_successes},
          {"per_step", steps},
          {"published_success", EstimateJson(published.Find(table, of, data.start))}};
}

ordered_json MapsJson(const RunData& run) {
  ordered_json maps = ordered_json::array();
  for (int s = 0; s < kActingStates; ++s) {
    const fs::path file = run.folder / ("reward_map_s" + std::to_string(s) + ".png");
    if (!Exists(file)) continue;
    maps.push_back(
        {{"seed", run.train.seed}, {"state", s}, {"src", PictureUri(file, kPicture_px)}});
  }
  return maps;
}

// The same run twice is no second seed; it may be one of another build, though.
void WarnOfDoubles(const RunGroup& group) {
  for (std::size_t i = 1; i < group.runs.size(); ++i) {
    if (group.runs[i]->train.seed != group.runs[i - 1]->train.seed) continue;
    spdlog::warn("{} and {} have one config and seed {}; they count as two seeds",
                 group.runs[i - 1]->folder.string(), group.runs[i]->folder.string(),
                 group.runs[i]->train.seed);
  }
}

ordered_json GroupJson(const RunGroup& group, const Published& published) {
  ordered_json json = {{"label", group.label},
                       {"protocol", group.runs[0]->train.protocol},
                       {"seeds", ordered_json::array()},
                       {"folders", ordered_json::array()},
                       {"curves", ordered_json::array()},
                       {"rewards", ordered_json::array()},
                       {"training", ordered_json::array()},
                       {"evaluations", ordered_json::array()},
                       {"maps", ordered_json::array()}};
  const TrainConfig& train = group.runs[0]->train;
  for (int s = 1; s <= kActingStates; ++s) {
    const auto cell = published.Find("5.5", ThesisRow(train), "step" + std::to_string(s));
    json["published_rewards"].push_back(EstimateJson(cell));
  }
  int actions = 0;
  double sim_s = 0;
  for (const RunData* run : group.runs) {
    json["seeds"].push_back(run->train.seed);
    json["folders"].push_back(run->folder.string());
    for (ordered_json& map : MapsJson(*run)) json["maps"].push_back(std::move(map));
    actions += run->actions;
    sim_s += run->sim_s;
  }
  json["actions"] = actions;
  json["sim_hours"] = sim_s / 3600;
  for (int s = 0; s < kActingStates; ++s) {
    json["curves"].push_back(BandJson(LearningCurve(group, s)));
    std::vector<std::vector<double>> means;
    for (const RunData* run : group.runs) {
      const std::vector<double>& rewards = run->rewards[static_cast<std::size_t>(s)];
      if (!rewards.empty()) {
        means.push_back({Mean(rewards)});
      }
    }
    json["rewards"].push_back(BandJson(BandOver(means)));
    const StateTally tally = TrainingTally(group, s);
    json["training"].push_back(Rate(tally.successes, tally.attempts));
  }
  for (const EvaluationData& data : PooledEvaluations(group)) {
    json["evaluations"].push_back(EvaluationJson(data, train, published));
  }
  return json;
}

ordered_json TableJson(const fs::path& file) {
  ordered_json tables = ordered_json::array();
  for (const ResultCell& cell : ReadResults(file)) {
    auto table = std::ranges::find_if(
        tables, [&](const ordered_json& one) { return one["name"] == cell.table; });
    if (table == tables.end()) {
      tables.push_back({{"name", cell.table}, {"file", file.string()}});
      tables.back()["cells"] = ordered_json::array();
      table = tables.end() - 1;
    }
    ordered_json json = {{"row", cell.row},
                         {"column", cell.column},
                         {"unit", cell.unit},
                         {"ours", EstimateJson(cell.ours)},
                         {"published", EstimateJson(cell.published)},
                         {"seeds", cell.seed_texts},
                         {"command", cell.command}};
    if (cell.n) json["n"] = *cell.n;
    if (cell.successes) json["successes"] = *cell.successes;
    (*table)["cells"].push_back(std::move(json));
  }
  return tables;
}

ordered_json FilmJson(const Film& film) {
  ordered_json json = {{"kind", film.kind},
                       {"success", film.success},
                       {"source", film.source.string()},
                       {"frames", ordered_json::array()}};
  for (const Film::Frame& frame : film.frames) {
    json["frames"].push_back(
        {{"src", PictureUri(frame.picture, kPicture_px)}, {"caption", frame.caption}});
  }
  if (film.video.empty()) return json;
  if (fs::file_size(film.video) > kMostVideoBytes) {
    json["video_left_out"] = film.video.string();
  } else {
    json["video"] = DataUri("video/mp4", ReadFile(film.video));
  }
  return json;
}

// `folder` itself and the folders in it and in those.
std::vector<fs::path> WithSubfolders(const fs::path& folder) {
  std::vector<fs::path> folders = {folder};
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::end(it); ++it) {
    if (it.depth() == 1) it.disable_recursion_pending();
    if (it->is_directory()) folders.push_back(it->path());
  }
  std::ranges::sort(folders);
  return folders;
}

}  // namespace

ordered_json CollectReport(const std::vector<fs::path>& folders, const Published& published) {
  std::vector<RunData> runs;
  std::vector<Film> films;
  ordered_json tables = ordered_json::array();
  std::set<fs::path> given;
  for (const fs::path& folder : folders) {
    if (!IsFolder(folder)) throw InputError(folder.string() + ": is not a folder");
    if (!given.insert(fs::canonical(folder)).second) {
      throw InputError(folder.string() + ": is given twice");
    }
    const std::size_t before = runs.size() + films.size() + tables.size();
    const bool experiment = Exists(folder / "results.csv");
    if (experiment) {
      for (ordered_json& table : TableJson(folder / "results.csv")) {
        tables.push_back(std::move(table));
      }
    }
    for (const fs::path& one : experiment ? WithSubfolders(folder) : std::vector{folder}) {
      const bool run = IsRunFolder(one);
      if (run) runs.push_back(ReadRun(one));
      if (!run && one != folder) continue;
      for (Film& film : FindFilms(one)) films.push_back(std::move(film));
    }
    if (runs.size() + films.size() + tables.size() == before && !experiment) {
      throw InputError(folder.string() +
                       ": holds neither a run (config.toml and steps.jsonl), nor results.csv, nor "
                       "an episode with pictures");
    }
  }
  ordered_json report = {
      {"groups", ordered_json::array()}, {"tables", tables}, {"films", ordered_json::array()}};
  for (const RunGroup& group : GroupRuns(runs)) {
    WarnOfDoubles(group);
    report["groups"].push_back(GroupJson(group, published));
  }
  for (const Film& film : OneOfEachKind(std::move(films))) {
    report["films"].push_back(FilmJson(film));
  }
  return report;
}

}  // namespace gusset
