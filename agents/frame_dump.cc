#include "agents/frame_dump.h"

#include <cstdio>

namespace gusset {

bool ActionFailed(int state, const Outcome& outcome) {
  return !Advanced(state, outcome) || outcome.next.state != outcome.truth.state ||
         outcome.success != outcome.true_success;
}

void EpisodeFrames::Add(const std::function<FrameWriter()>& writer, nlohmann::ordered_json about) {
  if (dump_ != "none") actions_.emplace_back(writer(), std::move(about));
}

void EpisodeFrames::Finish(bool true_success) {
  const bool keep = dump_ == "all" || (dump_ == "failures" && !true_success);
  for (std::size_t i = 0; keep && i < actions_.size(); ++i) {
    char number[24];
    std::snprintf(number, sizeof number, "%02zu", i);
    auto& [write, about] = actions_[i];
    about["episode_success_true"] = true_success;
    write(prefix_.string() + number, about);
  }
  actions_.clear();
}

}  // namespace gusset
