#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gusset {

/// An episode, or one action, that there are pictures of.
struct Film {
  struct Frame {
    std::filesystem::path picture;
    std::string caption;
  };
  /// How it ended: "success", "false success" (only the camera saw one), "not carried" (close +
  /// carry, but no success), "lost", "given up in s1 unfolded"; of a single action "in training: ",
  /// its state and OutcomeName.
  std::string kind;
  bool success = false;          ///< By ground truth.
  std::filesystem::path video;   ///< Empty if there is none.
  std::vector<Frame> frames;     ///< What perception saw before each action and after the last.
  std::filesystem::path source;  ///< The folder it lies in.
};

/// The first film of each kind (but no training action that simply advanced) in `folder`: a folder
/// of `play`, or one that holds, as frames/, X_frames/ or frames/X/, what --dump and `play` wrote.
/// Films with a video come first.
/// @throws InputError naming file and key of what is broken.
std::vector<Film> FindFilms(const std::filesystem::path& folder);

/// Keeps the first of each kind, successes first.
std::vector<Film> OneOfEachKind(std::vector<Film> films);

}  // namespace gusset
