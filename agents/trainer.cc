#include "agents/trainer.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "agents/json_fields.h"
#include "agents/outcome_fields.h"
#include "base/error.h"
#include "base/files.h"
#include "base/random.h"
#include "base/stop.h"

namespace gusset {
namespace {

using Clock = std::chrono::steady_clock;

double Seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

// A bag of the pool may look different under another noise; so often another one is taken.
constexpr int kAttempts = 64;
// What protocol "chain" has as its plan's state: any.
constexpr int kAnyState = -1;

// One action to be done: everything random about it derives from these numbers.
struct Plan {
  int state = 0;       // in which the camera must see the bag
  bool extra = false;  // greedy, nothing is learnt
  int index = 0;       // among the actions of its kind
  int pool_size = 0;   // how much of the pool may be drawn from (state > 0)

  std::uint64_t SeedIndex(int attempt) const {
    const auto kind = static_cast<std::uint64_t>((state + 1) * 2 + (extra ? 1 : 0));
    return (static_cast<std::uint64_t>(index) * 16 + kind) * kAttempts +
           static_cast<std::uint64_t>(attempt);
  }
};

// One action done.
struct Trial {
  nlohmann::ordered_json from;  // what the world was made from, for replays
  std::uint64_t sensor_seed = 0;
  std::uint64_t agent_seed = 0;
  Percept percept;
  Mode mode = Mode::kExplore;
  Decision decision;
  Outcome outcome;
  FrameWriter frames;        // only if they are to be kept
  double wall_s = 0;         // from the snapshot on: world, looks, physics
  bool looked = false;       // percept is known
  std::exception_ptr error;  // why there is no outcome
};

// All that changes while a run goes on, but for the agent.
struct Progress {
  int actions = 0;
  int extra = 0;
  std::vector<int> learnt;              // steps per state
  std::vector<int> extra_for;           // extra actions that filled each state's pool
  std::vector<std::vector<int>> pools;  // snapshot ids by the state seen
  std::vector<int> source_size;         // of the pool before, when filling began; -1: not yet
  std::vector<int> frozen_size;         // of the pool, when its state's training began; -1: not yet
  int episode = 0;                      // "chain" only, as all below
  int episode_actions = 0;
  int current = -1;      // snapshot id; -1: a new start is due
  int last_learnt = -1;  // number of the last action that was learnt from; both protocols
  double sim_s = 0;
  std::uint64_t steps_bytes = 0;
  std::uint64_t progress_bytes = 0;
  std::vector<double> recent;  // the last rewards

  explicit Progress(std::size_t states)
      : learnt(states),
        extra_for(states),
        pools(states),
        source_size(states, -1),
        frozen_size(states, -1) {}

  nlohmann::json Save() const {
    return {{"actions", actions},
            {"extra", extra},
            {"learnt", learnt},
            {"extra_for", extra_for},
            {"pools", pools},
            {"source_size", source_size},
            {"frozen_size", frozen_size},
            {"episode", episode},
            {"current", current},
            {"last_learnt", last_learnt},
            {"episode_actions", episode_actions},
            {"sim_s", sim_s},
            {"steps_bytes", steps_bytes},
            {"progress_bytes", progress_bytes},
            {"recent", recent}};
  }

  void Load(const nlohmann::json& saved) {
    // Through JsonField, which names what is missing and refuses numbers that do not fit.
    const auto get = [&](const char* key, auto& value) { value = Field(value, saved, key); };
    const std::size_t states = learnt.size();
    get("actions", actions);
    get("extra", extra);
    get("learnt", learnt);
    get("extra_for", extra_for);
    get("pools", pools);
    get("source_size", source_size);
    get("frozen_size", frozen_size);
    get("episode", episode);
    get("episode_actions", episode_actions);
    get("current", current);
    get("last_learnt", last_learnt);
    get("sim_s", sim_s);
    get("steps_bytes", steps_bytes);
    get("progress_bytes", progress_bytes);
    get("recent", recent);
    for (const std::size_t size :
         {learnt.size(), extra_for.size(), pools.size(), source_size.size(), frozen_size.size()}) {
      if (size != states) throw InputError("is for another number of states");
    }
    CheckBounds();
  }

 private:
  template <class T>
  static T Field(const T&, const nlohmann::json& object, const std::string& key) {
    return JsonField<T>(object, key);
  }
  template <class T>
  static std::vector<T> Field(const std::vector<T>&, const nlohmann::json& object,
                              const std::string& key) {
    std::vector<T> values;
    for (const nlohmann::json& element : JsonField<nlohmann::json::array_t>(object, key)) {
      const std::string name = key + "[" + std::to_string(values.size()) + "]";
      values.push_back(Field(T(), {{name, element}}, name));
    }
    return values;
  }

  // Of what is used as an index or a count.
  void CheckBounds() const {
    const auto within = [](const std::string& name, int value, int lo, int hi) {
      if (value >= lo && value <= hi) return;
      throw InputError(name + " = " + std::to_string(value) + " is not within [" +
                       std::to_string(lo) + ", " + std::to_string(hi) + "]");
    };
    constexpr int kMost = std::numeric_limits<int>::max();
    within("actions", actions, 0, kMost);
    if (sim_s < 0) throw InputError("sim_s is below 0");
    within("extra", extra, 0, actions);
    within("episode", episode, 0, actions);
    within("episode_actions", episode_actions, 0, actions);
    within("current", current, -1, actions - 1);
    within("last_learnt", last_learnt, -1, actions - 1);
    for (std::size_t s = 0; s < learnt.size(); ++s) {
      const std::string at = "[" + std::to_string(s) + "]";
      const int size = static_cast<int>(pools[s].size());
      within("learnt" + at, learnt[s], 0, actions);
      within("extra_for" + at, extra_for[s], 0, extra);
      for (const int id : pools[s]) within("pools" + at, id, 0, actions - 1);
      within("source_size" + at, source_size[s], -1,
             s == 0 ? -1 : static_cast<int>(pools[s - 1].size()));
      if (frozen_size[s] != -1) within("frozen_size" + at, frozen_size[s], 1, size);
    }
  }
};

class Trainer {
 public:
  Trainer(Workers& workers, Agent& agent, const TrainConfig& config, const RunFolder& folder,
          const std::function<bool()>& stop)
      : workers_(workers),
        agent_(agent),
        config_(config),
        folder_(folder),
        stop_(stop),
        n_actions_(ActionCounts(workers)),
        progress_(n_actions_.size()) {
    Resume();
    steps_.emplace(folder.steps(), progress_.steps_bytes);
    csv_.emplace(folder.progress(), progress_.progress_bytes);
    if (csv_->bytes() == 0) {
      csv_->Append(
          "global_step,state,state_step,epsilon,reward,reward_mean_20,extra_actions,"
          "sim_seconds,actions_per_second");
    }
  }

  TrainSummary Run() {
    try {
      config_.protocol == "pools" ? RunPools() : RunChain();
    } catch (const Interrupted&) {
      CheckStop();
      throw;
    }
    return {progress_.actions, progress_.extra, progress_.sim_s};
  }

 private:
  static std::vector<int> ActionCounts(Workers& workers) {
    std::vector<int> counts;
    workers.Run({[&](Environment& environment) { counts = environment.ActionCounts(); }});
    return counts;
  }

  // Takes up the checkpoint, if there is one.
  void Resume() {
    const std::optional<nlohmann::json> checkpoint = folder_.ReadCheckpoint();
    if (!checkpoint) return CheckThatNothingIsLost();
    try {
      progress_.Load(checkpoint->at("progress"));
      agent_.Load(checkpoint->at("agent"));
    } catch (const std::exception& e) {
      throw InputError(folder_.root().string() + "/checkpoint/state.json: " + e.what());
    }
    CheckLines(folder_.steps(), progress_.steps_bytes, progress_.actions);
    CheckLines(folder_.progress(), progress_.progress_bytes, progress_.actions + 1);
    spdlog::info("continuing after {} actions", progress_.actions);
  }

  // What a checkpoint knows of a log is a line for each of its actions, else the rest would be cut
  // off, or numbered wrongly.
  static void CheckLines(const std::filesystem::path& file, std::uint64_t bytes, int lines) {
    const std::string log = ReadFile(file);
    const auto kept = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(bytes, log.size()));
    const auto there = std::count(log.begin(), log.begin() + kept, '\n');
    if (there == lines) return;
    throw InputError(file.string() + ": has " + std::to_string(there) + " lines in the " +
                     std::to_string(bytes) + " bytes that its checkpoint knows of, not " +
                     std::to_string(lines));
  }

  // Without a checkpoint training begins anew. A run that was killed before its first one has a
  // line in its log at most.
  void CheckThatNothingIsLost() const {
    if (!Exists(folder_.steps())) return;
    const std::string log = ReadFile(folder_.steps());
    const auto lines = std::ranges::count(log, '\n');
    if (lines <= 1) return;
    throw InputError(folder_.root().string() +
                     "/checkpoint/state.json: is missing, but steps.jsonl has " +
                     std::to_string(lines) + " actions, which training anew would overwrite");
  }

  int states() const { return static_cast<int>(n_actions_.size()); }
  static std::size_t At(int state) { return static_cast<std::size_t>(state); }
  std::uint64_t Seed(const char* purpose, std::uint64_t index) const {
    return DeriveSeed(static_cast<std::uint64_t>(config_.seed), purpose, index);
  }

  // ---- protocol "pools"

  void RunPools() {
    for (int s = 0; s < states(); ++s) {
      if (s > 0 && progress_.frozen_size[At(s)] < 0) FillPool(s);
      const int base = s > 0 ? progress_.frozen_size[At(s)] : 0;
      Perform([&](int ahead) -> std::optional<Plan> {
        const int index = progress_.learnt[At(s)] + ahead;
        if (index >= config_.steps) return std::nullopt;
        return Plan{s, false, index, base};
      });
    }
  }

  void FillPool(int s) {
    const std::vector<int>& pool = progress_.pools[At(s)];
    int& source_size = progress_.source_size[At(s)];
    if (source_size < 0) source_size = static_cast<int>(progress_.pools[At(s - 1)].size());
    Perform([&](int ahead) -> std::optional<Plan> {
      const int missing = config_.pool_min - static_cast<int>(pool.size());
      if (missing <= 0 || progress_.extra + ahead >= config_.max_extra_actions) return std::nullopt;
      return Plan{s - 1, true, progress_.extra_for[At(s)] + ahead, source_size};
    });
    if (pool.empty()) {
      throw RunError("after " + std::to_string(progress_.extra) +
                     " extra actions no bag has reached s" + std::to_string(s) +
                     "; see train.max_extra_actions");
    }
    if (static_cast<int>(pool.size()) < config_.pool_min) {
      spdlog::warn("s{} starts from {} bags only; the extra actions are used up", s, pool.size());
    }
    progress_.frozen_size[At(s)] = static_cast<int>(pool.size());
  }

  // Performs the plans that next(0) gives, one after the other, until it gives none. Meanwhile the
  // plans after it are tried too, with the agent as it is now; a try counts if the agent, when its
  // turn comes, decides the same.
  void Perform(const std::function<std::optional<Plan>(int ahead)>& next) {
    std::map<int, Trial> tried;  // by index
    while (const std::optional<Plan> plan = next(0)) {
      CheckStop();
      if (const auto it = tried.find(plan->index); it != tried.end()) {
        if (Holds(it->second)) Commit(*plan, it->second);
        tried.erase(it);
        continue;
      }
      // Twice as many as workers, since some take ten times as long as others.
      const int ahead = workers_.jobs() > 1 ? 2 * workers_.jobs() : 1;
      std::vector<Workers::Task> tasks;
      for (int i = 0; static_cast<int>(tasks.size()) < ahead && i < 2 * ahead; ++i) {
        const std::optional<Plan> later = next(i);
        if (!later) break;
        if (tried.contains(later->index)) continue;
        Trial& trial = tried[later->index];
        tasks.push_back([this, plan = *later, &trial](Environment& environment) {
          try {
            Try(environment, plan, trial);
          } catch (...) {
            trial.error = std::current_exception();
          }
        });
      }
      workers_.Run(tasks);
    }
  }

  // True if the agent, as it is now, decides as it did when the trial was made.
  bool Holds(Trial& trial) const {
    if (trial.looked) {
      const Decision now = Decide(trial);
      if (now.action != trial.decision.action) return false;
      trial.decision = now;  // epsilon may differ
    }
    if (trial.error) Fail(trial);
    return true;
  }

  // Leaves what is needed to see a failed action again, and passes the failure on.
  [[noreturn]] void Fail(const Trial& trial) const {
    const std::filesystem::path file = folder_.root() / "failed_step.json";
    if (!trial.looked) std::rethrow_exception(trial.error);  // none was tried
    try {
      std::rethrow_exception(trial.error);
    } catch (const RunError& e) {
      const nlohmann::ordered_json line = {
          {"step", progress_.actions},        {"state", trial.percept.state},
          {"action", trial.decision.action},  {"from", trial.from},
          {"sensor_seed", trial.sensor_seed}, {"error", e.what()}};
      WriteFileAtomic(file, JsonText(line));
      throw RunError(std::string(e.what()) + "; see it again with: gusset play --run " +
                     folder_.root().string() + " --step " + std::to_string(progress_.actions));
    }
  }

  // Which bag of its pool an action is done to. Each is taken once, in random order, before any is
  // taken again (but for bags that noise shows in another state): with few bags and few tries of an
  // action, its reward is luck enough.
  int Drawn(const Plan& plan, int attempt) const {
    if (attempt > 0) return Rng(Seed("pool", plan.SeedIndex(attempt))).Below(plan.pool_size);
    Plan round = plan;
    round.index = plan.index / plan.pool_size;
    Rng rng(Seed("pool order", round.SeedIndex(0)));
    std::vector<int> order(At(plan.pool_size));
    std::iota(order.begin(), order.end(), 0);
    rng.Shuffle(order);
    return order[At(plan.index % plan.pool_size)];
  }

  void Try(Environment& environment, const Plan& plan, Trial& trial) const {
    trial.mode = plan.extra ? Mode::kGreedy : Mode::kExplore;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint64_t index = plan.SeedIndex(attempt);
      Snapshot snapshot;
      if (plan.state == 0) {
        const std::uint64_t seed = Seed("start", index);
        trial.from = {{"start", "folded"}, {"seed", seed}};
        snapshot = environment.Start(StartKind::kFolded, seed);
      } else {
        const int id = progress_.pools[At(plan.state)][At(Drawn(plan, attempt))];
        trial.from = {{"step", id}};
        snapshot = folder_.ReadSnapshot(id);
      }
      trial.sensor_seed = Seed("sensor", index);
      trial.agent_seed = Seed("agent", index);
      const Clock::time_point start = Clock::now();
      trial.percept = Begin(environment, snapshot, trial);
      spdlog::debug("step {} of s{}, attempt {}: seen as s{}", plan.index, plan.state, attempt,
                    trial.percept.state);
      if (trial.percept.state != plan.state) continue;
      Act(environment, trial, start);
      return;
    }
    throw RunError("none of " + std::to_string(kAttempts) + " bags that should be in s" +
                   std::to_string(plan.state) + " is seen to be");
  }

  // ---- protocol "chain"

  void RunChain() {
    while (std::ranges::min(progress_.learnt) < config_.steps) {
      CheckStop();
      if (progress_.extra >= config_.max_extra_actions) {
        throw RunError("after " + std::to_string(progress_.extra) +
                       " extra actions some state still lacks steps; see train.max_extra_actions");
      }
      Trial trial;
      workers_.Run({[&](Environment& environment) {
        try {
          TryChained(environment, trial);
        } catch (...) {
          trial.error = std::current_exception();
        }
      }});
      if (trial.error) Fail(trial);
      const int before = progress_.current;
      const int state = trial.percept.state;
      const bool extra = progress_.learnt[At(state)] >= config_.steps;
      ++progress_.episode_actions;
      const bool over = trial.outcome.done || progress_.episode_actions >= config_.max_actions;
      progress_.current = over ? -1 : progress_.actions;
      if (over) {
        ++progress_.episode;
        progress_.episode_actions = 0;
      }
      Commit({kAnyState, extra, progress_.actions, 0}, trial);
      if (before >= 0) folder_.RemoveSnapshot(before);
    }
  }

  // A damaged snapshot is named by its file.
  Percept Begin(Environment& environment, const Snapshot& snapshot, const Trial& trial) const {
    try {
      return environment.Begin(snapshot, trial.sensor_seed);
    } catch (const InputError& e) {
      if (!trial.from.contains("step")) throw;
      throw InputError(folder_.SnapshotFile(trial.from["step"]).string() + ": " + e.what());
    }
  }

  void TryChained(Environment& environment, Trial& trial) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint64_t index = Plan{kAnyState, false, progress_.actions, 0}.SeedIndex(attempt);
      Snapshot snapshot;
      if (progress_.current < 0) {
        const std::uint64_t seed = Seed("start", index);
        trial.from = {{"start", "folded"}, {"seed", seed}};
        snapshot = environment.Start(StartKind::kFolded, seed);
      } else {
        trial.from = {{"step", progress_.current}};
        snapshot = folder_.ReadSnapshot(progress_.current);
      }
      trial.sensor_seed = Seed("sensor", index);
      trial.agent_seed = Seed("agent", index);
      const Clock::time_point start = Clock::now();
      trial.percept = Begin(environment, snapshot, trial);
      if (trial.percept.state >= states()) continue;
      const bool full = progress_.learnt[At(trial.percept.state)] >= config_.steps;
      trial.mode = full ? Mode::kGreedy : Mode::kExplore;
      Act(environment, trial, start);
      return;
    }
    throw RunError("no bag is seen on the table at " + std::to_string(kAttempts) + " looks");
  }

  // ---- both

  Decision Decide(const Trial& trial) const {
    Rng rng(trial.agent_seed);
    return agent_.Act(trial.percept.state, trial.percept.features,
                      n_actions_[At(trial.percept.state)], trial.mode, rng);
  }

  void Act(Environment& environment, Trial& trial, Clock::time_point start) const {
    trial.looked = true;
    trial.decision = Decide(trial);
    trial.outcome = environment.Act(trial.decision.action);
    trial.wall_s = Seconds(Clock::now() - start);
    if (config_.dump == "all" ||
        (config_.dump == "failures" && ActionFailed(trial.percept.state, trial.outcome))) {
      trial.frames = environment.Frames();
    }
  }

  void Commit(const Plan& plan, const Trial& trial) {
    const int state = trial.percept.state;
    const Outcome& outcome = trial.outcome;
    const int state_step = plan.extra ? progress_.extra : progress_.learnt[At(state)];
    const nlohmann::ordered_json line = LogLine(plan, trial, state_step);
    // First: if there is no room for them, nothing of this action has happened yet, and --resume
    // does it again.
    if (trial.frames) {
      trial.frames(folder_.frames() / ("step" + std::to_string(progress_.actions)), line);
    }
    if (!plan.extra) {
      const int last = progress_.last_learnt;
      const bool follows = last >= 0 && trial.from.value("step", -1) == last;
      agent_.Learn({state, trial.percept.features, trial.decision.action, n_actions_[At(state)],
                    outcome.reward, outcome.next.state, outcome.next.features, outcome.done,
                    follows});
      progress_.last_learnt = progress_.actions;
    }
    steps_->Append(line.dump());
    LogProgress(trial, state_step);
    Keep(plan, outcome);
    if (plan.extra) {
      ++progress_.extra;
      if (plan.state != kAnyState) ++progress_.extra_for[At(plan.state + 1)];
    } else {
      ++progress_.learnt[At(state)];
    }
    ++progress_.actions;
    progress_.sim_s += outcome.sim_s;
    Checkpoint();
    Report(state);
  }

  // Keeps the world that a step left, if later steps may start from it.
  void Keep(const Plan& plan, const Outcome& outcome) {
    const int id = progress_.actions;
    if (plan.state == kAnyState) {
      if (progress_.current == id) folder_.WriteSnapshot(id, outcome.after);
    } else if (!outcome.done && outcome.next.state > 0 && outcome.next.state < states() &&
               outcome.next.state >= plan.state) {
      folder_.WriteSnapshot(id, outcome.after);
      progress_.pools[At(outcome.next.state)].push_back(id);
    }
  }

  nlohmann::ordered_json LogLine(const Plan& plan, const Trial& trial, int state_step) const {
    const Outcome& outcome = trial.outcome;
    nlohmann::ordered_json line = {
        {"step", progress_.actions},        {"kind", plan.extra ? "extra" : "train"},
        {"state", trial.percept.state},     {"state_step", state_step},
        {"action", trial.decision.action},  {"explored", trial.decision.explored},
        {"epsilon", trial.decision.epsilon}};
    line.update(OutcomeFields(outcome));
    line["from"] = trial.from;
    line["sensor_seed"] = trial.sensor_seed;
    line["sim_s"] = outcome.sim_s;
    line["wall_s"] = trial.wall_s;
    return line;
  }

  void LogProgress(const Trial& trial, int state_step) {
    const Outcome& outcome = trial.outcome;
    std::vector<double>& recent = progress_.recent;
    recent.push_back(outcome.reward);
    if (recent.size() > 20) recent.erase(recent.begin());
    const double mean =
        std::accumulate(recent.begin(), recent.end(), 0.0) / static_cast<double>(recent.size());
    const double rate = (done_here_ + 1) / std::max(1e-9, Seconds(Clock::now() - begun_));
    csv_->Append(fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{},{:.6g},{:.4g}", progress_.actions,
                             trial.percept.state, state_step, trial.decision.epsilon,
                             outcome.reward, mean, progress_.extra, progress_.sim_s + outcome.sim_s,
                             rate));
  }

  void Checkpoint() {
    // Logs must be on the disk before a checkpoint that counts on them.
    steps_->Sync();
    csv_->Sync();
    progress_.steps_bytes = steps_->bytes();
    progress_.progress_bytes = csv_->bytes();
    folder_.WriteCheckpoint({{"progress", progress_.Save()}, {"agent", agent_.Save()}});
  }

  void Report(int state) {
    ++done_here_;
    const Clock::time_point now = Clock::now();
    if (Seconds(now - reported_) < 5) return;
    reported_ = now;
    const double each_s = Seconds(now - begun_) / done_here_;
    const int learnt = std::accumulate(progress_.learnt.begin(), progress_.learnt.end(), 0);
    const int left = config_.steps * states() - learnt;
    spdlog::info("s{}: {} of {} steps, {} extra; {:.2f} s per action, about {:.0f} s left", state,
                 learnt, config_.steps * states(), progress_.extra, each_s, left * each_s);
  }

  void CheckStop() const {
    if (!stop_()) return;
    throw RunError("interrupted after " + std::to_string(progress_.actions) + " actions; " +
                   folder_.root().string() + " can be continued with --resume");
  }

  Workers& workers_;
  Agent& agent_;
  const TrainConfig& config_;
  const RunFolder& folder_;
  const std::function<bool()>& stop_;
  std::vector<int> n_actions_;
  Progress progress_;
  std::optional<LineLog> steps_;
  std::optional<LineLog> csv_;
  int done_here_ = 0;
  const Clock::time_point begun_ = Clock::now();
  Clock::time_point reported_ = begun_;
};

}  // namespace

TrainSummary Train(Workers& workers, Agent& agent, const TrainConfig& config,
                   const RunFolder& folder, const nlohmann::ordered_json& about,
                   const std::function<bool()>& stop) {
  ValidateOrThrow("train", config);
  const TrainSummary summary = Trainer(workers, agent, config, folder, stop).Run();
  WriteFileAtomic(folder.policy(), JsonText(PolicyJson(agent, about)));
  return summary;
}

}  // namespace gusset
