#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "agents/environment.h"

namespace gusset {

/// What --dump may be: whose frames are kept.
inline const std::vector<std::string>& DumpChoices() {
  static const std::vector<std::string> choices = {"all", "failures", "none"};
  return choices;
}

/// A training action has failed if the camera saw no later state follow (in s3: no success), or if
/// camera and truth judge what followed differently.
bool ActionFailed(int state, const Outcome& outcome);

/// The frames of one episode's actions, kept until it is known whether the episode failed.
class EpisodeFrames {
 public:
  /// @param dump    one of DumpChoices.
  /// @param prefix  of the files: PREFIX00, PREFIX01, ... for its actions.
  EpisodeFrames(std::string dump, std::filesystem::path prefix)
      : dump_(std::move(dump)), prefix_(std::move(prefix)) {}

  /// Adds an action. @param writer is asked for only if frames may be kept.
  void Add(const std::function<FrameWriter()>& writer, nlohmann::ordered_json about);
  /// Writes what is to be kept. An episode has failed if by ground truth it was no success.
  /// @throws InputError or RunError if it cannot be written; what was written stays.
  void Finish(bool true_success);

 private:
  std::string dump_;
  std::filesystem::path prefix_;
  std::vector<std::pair<FrameWriter, nlohmann::ordered_json>> actions_;
};

}  // namespace gusset
