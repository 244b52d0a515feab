#include "agents/trainer.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>

#include "agents/json_fields.h"
#include "agents/outcome_fields.h"
#include "agents/training_progress.h"
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

// What plan comes so many after the one whose turn it is; none if there are no more.
using NextPlan = std::function<std::optional<Plan>(int ahead)>;

// Where an action begins. Nothing that the agent learns changes it.
struct Situation {
  nlohmann::ordered_json from;  // what the world was made from, for replays
  Snapshot snapshot;            // that world
  std::uint64_t sensor_seed = 0;
  std::uint64_t agent_seed = 0;
  Percept percept;
};

// What the agent, as it was, did there.
struct Result {
  std::optional<Decision> decision;
  Outcome outcome;
  FrameWriter frames;        // only if they are to be kept
  double wall_s = 0;         // from the snapshot on: world, looks, physics
  std::exception_ptr error;  // why there is no outcome
};

struct Trial {
  Mode mode = Mode::kExplore;
  Situation at;
  bool seen = false;  // the bag is in the plan's state there
  Result result;
};

// Plans that workers perform together, each in its turn, and what they have tried before its turn.
struct LookAhead {
  struct Item {
    enum class Stage { kWaiting, kRunning, kDone } stage = Stage::kWaiting;
    Plan plan;
    Trial trial;
  };
  NextPlan next;
  std::map<int, Item> items = {};  // by their plans' indices
  bool over = false;
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
        progress_(n_actions_.size()),
        furthest_(workers.jobs() > 1 ? 2 * workers.jobs() : 1) {
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
      // What may not be needed is tried only where a worker would have nothing else to do.
      if (missing <= 0 || ahead >= std::max(missing, workers_.jobs())) return std::nullopt;
      if (progress_.extra + ahead >= config_.max_extra_actions) return std::nullopt;
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
  // plans after it are tried too, with the agent as it is then. A try counts if the agent, when its
  // turn comes, decides the same; else it is made anew, from the same situation.
  void Perform(NextPlan next) {
    if (!next(0)) return;
    LookAhead look_ahead{std::move(next)};
    workers_.Run(std::vector<Workers::Task>(
        At(workers_.jobs()), [&](Environment& environment) { Work(environment, look_ahead); }));
  }

  // What each worker does: commits what has been done, and then does what nobody does yet. Under
  // the lock, but for what happens in its world.
  void Work(Environment& environment, LookAhead& look_ahead) {
    std::unique_lock lock(mutex_);
    try {
      while (!look_ahead.over && !workers_.failed()) {
        CommitDone(look_ahead);
        look_ahead.over = !look_ahead.next(0);
        if (look_ahead.over) break;
        CheckStop();
        LookAhead::Item* const mine = FirstWaiting(look_ahead);
        if (mine == nullptr) {
          changed_.wait(lock);
          continue;
        }
        mine->stage = LookAhead::Item::Stage::kRunning;
        lock.unlock();
        try {
          TryPlan(environment, mine->plan, mine->trial);
        } catch (...) {
          mine->trial.result.error = std::current_exception();
        }
        lock.lock();
        mine->stage = LookAhead::Item::Stage::kDone;
      }
    } catch (...) {
      look_ahead.over = true;
      changed_.notify_all();
      throw;
    }
    changed_.notify_all();
  }

  // Commits what has been tried, in turn, up to the first that has not or has to be tried again.
  void CommitDone(LookAhead& look_ahead) {
    while (const std::optional<Plan> plan = look_ahead.next(0)) {
      const auto it = look_ahead.items.find(plan->index);
      if (it == look_ahead.items.end()) return;
      LookAhead::Item& item = it->second;
      if (item.stage != LookAhead::Item::Stage::kDone) return;
      CheckStop();
      if (Holds(item.trial)) {
        Commit(*plan, item.trial);
        look_ahead.items.erase(it);
      } else {
        item.trial.result = {};
        item.stage = LookAhead::Item::Stage::kWaiting;
      }
      changed_.notify_all();
    }
  }

  // Of the plans whose turn comes next the first that nobody has tried.
  LookAhead::Item* FirstWaiting(LookAhead& look_ahead) const {
    for (int ahead = 0; ahead < furthest_; ++ahead) {
      const std::optional<Plan> plan = look_ahead.next(ahead);
      if (!plan) return nullptr;
      const auto [it, is_new] = look_ahead.items.try_emplace(plan->index);
      LookAhead::Item& item = it->second;
      if (is_new) item.plan = *plan;  // what runs is read without the lock
      if (item.stage == LookAhead::Item::Stage::kWaiting) return &item;
    }
    return nullptr;
  }

  // True if the agent, as it is now, decides as it did when the trial was made.
  bool Holds(Trial& trial) const {
    if (trial.result.decision) {
      const Decision now = Decide(trial);
      if (now.action != trial.result.decision->action) return false;
      trial.result.decision = now;  // epsilon may differ
    }
    if (trial.result.error) Fail(trial);
    return true;
  }

  // Leaves what is needed to see a failed action again, and passes the failure on.
  [[noreturn]] void Fail(const Trial& trial) const {
    const std::filesystem::path file = folder_.root() / "failed_step.json";
    if (!trial.result.decision) std::rethrow_exception(trial.result.error);  // none was tried
    try {
      std::rethrow_exception(trial.result.error);
    } catch (const RunError& e) {
      const nlohmann::ordered_json line = {{"step", progress_.actions},
                                           {"state", trial.at.percept.state},
                                           {"action", trial.result.decision->action},
                                           {"from", trial.at.from},
                                           {"sensor_seed", trial.at.sensor_seed},
                                           {"error", e.what()}};
      WriteFileAtomic(file, JsonText(line));
      throw RunError(std::string(e.what()) + "; see it again with: gusset play --run " +
                     folder_.root().string() + " --step " + std::to_string(progress_.actions));
    }
  }

  // Which bag of its pool an action is done to. Each is taken once, in random order, before any is
  // taken again (but for bags that noise shows in another state): with few bags and few tries of an
  // action, its reward is luck enough.
  std::size_t PlaceInPool(const Plan& plan, int attempt) const {
    if (attempt > 0) return At(Rng(Seed("pool", plan.SeedIndex(attempt))).Below(plan.pool_size));
    Plan round = plan;
    round.index = plan.index / plan.pool_size;
    Rng rng(Seed("pool order", round.SeedIndex(0)));
    std::vector<int> order(At(plan.pool_size));
    std::iota(order.begin(), order.end(), 0);
    rng.Shuffle(order);
    return At(order[At(plan.index % plan.pool_size)]);
  }

  // The step that left it.
  int FromPool(const Plan& plan, int attempt) const {
    const std::size_t place = PlaceInPool(plan, attempt);
    const std::lock_guard lock(mutex_);
    return progress_.pools[At(plan.state)][place];
  }

  void TryPlan(Environment& environment, const Plan& plan, Trial& trial) const {
    if (trial.seen) {
      const Clock::time_point start = Clock::now();
      Begin(environment, trial.at);
      Act(environment, trial, start);
      return;
    }
    trial.mode = plan.extra ? Mode::kGreedy : Mode::kExplore;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint64_t index = plan.SeedIndex(attempt);
      const Clock::time_point start =
          Look(environment, index, plan.state == 0 ? -1 : FromPool(plan, attempt), trial.at);
      spdlog::debug("step {} of s{}, attempt {}: seen as s{}", plan.index, plan.state, attempt,
                    trial.at.percept.state);
      if (trial.at.percept.state != plan.state) continue;
      trial.seen = true;
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
          trial.result.error = std::current_exception();
        }
      }});
      if (trial.result.error) Fail(trial);
      const int before = progress_.current;
      const int state = trial.at.percept.state;
      const bool extra = progress_.learnt[At(state)] >= config_.steps;
      ++progress_.episode_actions;
      const bool over =
          trial.result.outcome.done || progress_.episode_actions >= config_.max_actions;
      progress_.current = over ? -1 : progress_.actions;
      if (over) {
        ++progress_.episode;
        progress_.episode_actions = 0;
      }
      Commit({kAnyState, extra, progress_.actions, 0}, trial);
      if (before >= 0) folder_.RemoveSnapshot(before);
    }
  }

  void TryChained(Environment& environment, Trial& trial) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint64_t index = Plan{kAnyState, false, progress_.actions, 0}.SeedIndex(attempt);
      const Clock::time_point start = Look(environment, index, progress_.current, trial.at);
      if (trial.at.percept.state >= states()) continue;
      const bool full = progress_.learnt[At(trial.at.percept.state)] >= config_.steps;
      trial.mode = full ? Mode::kGreedy : Mode::kExplore;
      Act(environment, trial, start);
      return;
    }
    throw RunError("no bag is seen on the table at " + std::to_string(kAttempts) + " looks");
  }

  // ---- both

  // At the world that an earlier step left; -1: at a new start. Returns when it began to be built.
  Clock::time_point Look(Environment& environment, std::uint64_t index, int step,
                         Situation& at) const {
    if (step < 0) {
      const std::uint64_t seed = Seed("start", index);
      at.from = {{"start", "folded"}, {"seed", seed}};
      at.snapshot = environment.Start(StartKind::kFolded, seed);
    } else {
      at.from = {{"step", step}};
      at.snapshot = folder_.ReadSnapshot(step);
    }
    at.sensor_seed = Seed("sensor", index);
    at.agent_seed = Seed("agent", index);
    const Clock::time_point start = Clock::now();
    at.percept = Begin(environment, at);
    return start;
  }

  // A damaged snapshot is named by its file.
  Percept Begin(Environment& environment, const Situation& at) const {
    try {
      return environment.Begin(at.snapshot, at.sensor_seed);
    } catch (const InputError& e) {
      if (!at.from.contains("step")) throw;
      throw InputError(folder_.SnapshotFile(at.from["step"]).string() + ": " + e.what());
    }
  }

  Decision Decide(const Trial& trial) const {
    Rng rng(trial.at.agent_seed);
    return agent_.Act(trial.at.percept.state, trial.at.percept.features,
                      n_actions_[At(trial.at.percept.state)], trial.mode, rng);
  }

  void Act(Environment& environment, Trial& trial, Clock::time_point start) const {
    const Clock::time_point looked = Clock::now();
    std::unique_lock lock(mutex_);
    trial.result.decision = Decide(trial);
    lock.unlock();
    const Clock::time_point decided = Clock::now();
    trial.result.outcome = environment.Act(trial.result.decision->action);
    trial.result.wall_s = Seconds(Clock::now() - decided + (looked - start));
    if (config_.dump == "all" || (config_.dump == "failures" &&
                                  ActionFailed(trial.at.percept.state, trial.result.outcome))) {
      trial.result.frames = environment.Frames();
    }
  }

  void Commit(const Plan& plan, const Trial& trial) {
    const int state = trial.at.percept.state;
    const Outcome& outcome = trial.result.outcome;
    const int state_step = plan.extra ? progress_.extra : progress_.learnt[At(state)];
    const nlohmann::ordered_json line = LogLine(plan, trial, state_step);
    // First: if there is no room for them, nothing of this action has happened yet, and --resume
    // does it again.
    if (trial.result.frames) {
      trial.result.frames(folder_.frames() / ("step" + std::to_string(progress_.actions)), line);
    }
    if (!plan.extra) {
      const int last = progress_.last_learnt;
      const bool follows = last >= 0 && trial.at.from.value("step", -1) == last;
      agent_.Learn({state, trial.at.percept.features, trial.result.decision->action,
                    n_actions_[At(state)], outcome.reward, outcome.next.state,
                    outcome.next.features, outcome.done, follows});
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
    const Outcome& outcome = trial.result.outcome;
    nlohmann::ordered_json line = {{"step", progress_.actions},
                                   {"kind", plan.extra ? "extra" : "train"},
                                   {"state", trial.at.percept.state},
                                   {"state_step", state_step},
                                   {"action", trial.result.decision->action},
                                   {"explored", trial.result.decision->explored},
                                   {"epsilon", trial.result.decision->epsilon}};
    line.update(OutcomeFields(outcome));
    line["from"] = trial.at.from;
    line["sensor_seed"] = trial.at.sensor_seed;
    line["sim_s"] = outcome.sim_s;
    line["wall_s"] = trial.result.wall_s;
    return line;
  }

  void LogProgress(const Trial& trial, int state_step) {
    const Outcome& outcome = trial.result.outcome;
    std::vector<double>& recent = progress_.recent;
    recent.push_back(outcome.reward);
    if (recent.size() > 20) recent.erase(recent.begin());
    const double mean =
        std::accumulate(recent.begin(), recent.end(), 0.0) / static_cast<double>(recent.size());
    const double rate = (done_here_ + 1) / std::max(1e-9, Seconds(Clock::now() - begun_));
    csv_->Append(fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{},{:.6g},{:.4g}", progress_.actions,
                             trial.at.percept.state, state_step, trial.result.decision->epsilon,
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
  TrainingProgress progress_;
  std::optional<LineLog> steps_;
  std::optional<LineLog> csv_;
  int done_here_ = 0;
  const Clock::time_point begun_ = Clock::now();
  Clock::time_point reported_ = begun_;

  // How many plans are looked ahead, the one whose turn it is included. Twice as many as there are
  // workers, since some tries take ten times as long as others.
  const int furthest_;
  mutable std::mutex mutex_;  // of the agent, the progress, the logs and what is looked ahead
  std::condition_variable changed_;
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
