// Folders are layers: no include may point where the layer must not look. The table below is the
// build's own check of the truth boundary (perception, agents and primitives never see the world).

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace gusset {
namespace {

namespace fs = std::filesystem;

struct Layer {
  std::string folder;
  std::vector<std::string> own;        // allowed "quoted" include prefixes
  std::vector<std::string> libraries;  // allowed <angle> include prefixes besides the standard's
};

// base/ (errors, config, random numbers, files) is below every layer and may be included by all.
// Frames are cv::Mat and poses Eigen, so both go wherever perception's types go. A file obeys the
// first row whose folder holds it.
const std::vector<Layer>& Layers() {
  static const std::vector<Layer> layers = {
      {"base/", {"base/"}, {"toml++/", "POSIX"}},
      {"perception/", {"perception/", "base/"}, {"opencv2/", "Eigen/", "toml++/"}},
      {"agents/ports/",
       {"agents/ports/", "perception/rgbd_frame.h", "perception/camera_model.h", "base/"},
       {"opencv2/", "Eigen/"}},
      {"agents/deep/",
       {"agents/deep/", "agents/agent.h", "agents/json_fields.h", "base/"},
       {"Eigen/", "nlohmann/", "ATen/", "torch/", "POSIX"}},
      {"agents/",
       {"agents/", "perception/", "base/"},
       {"opencv2/", "Eigen/", "toml++/", "nlohmann/", "spdlog/"}},
      {"sim/",
       {"sim/", "agents/ports/", "perception/rgbd_frame.h", "perception/camera_model.h", "base/"},
       {"opencv2/", "Eigen/", "toml++/", "bullet/", "Bullet", "LinearMath/", "btBullet",
        "urdf_model/", "urdf_parser/", "urdf_world/", "console_bridge/", "assimp/", "GL/", "kdl/",
        "POSIX"}},
  };
  return layers;
}

bool IsPosix(const std::string& header) {
  static const std::regex posix("(unistd|fcntl|signal|dirent|dlfcn|sys/.*|(i|e|x)mmintrin)(\\.h)?");
  return std::regex_match(header, posix);
}

// The C++ library's headers have neither folder nor suffix.
bool IsStandard(const std::string& header) {
  return header.find('/') == std::string::npos && header.find('.') == std::string::npos;
}

bool StartsWithAny(const std::string& text, const std::vector<std::string>& prefixes) {
  for (const std::string& prefix : prefixes) {
    if (text.starts_with(prefix)) return true;
  }
  return false;
}

bool Allowed(const Layer& layer, const std::string& header, bool quoted) {
  if (quoted) return StartsWithAny(header, layer.own);
  if (IsStandard(header) || StartsWithAny(header, layer.libraries)) return true;
  return IsPosix(header) && StartsWithAny("POSIX", layer.libraries);
}

const Layer* LayerOf(const std::string& path) {
  for (const Layer& layer : Layers()) {
    if (path.starts_with(layer.folder)) return &layer;
  }
  return nullptr;
}

// Every offending line of a file, as "path:line: header".
std::vector<std::string> Offences(const std::string& path, std::istream& text) {
  static const std::regex include("\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  const Layer* layer = LayerOf(path);
  std::vector<std::string> offences;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    std::smatch match;
    if (!std::regex_match(line, match, include)) continue;
    if (!Allowed(*layer, match[2], match[1] == "\"")) {
      offences.push_back(path + ":" + std::to_string(number) + ": " + match[2].str());
    }
  }
  return offences;
}

TEST(Layers, NoIncludeLeavesTheTable) {
  const fs::path root = GUSSET_SOURCE_DIR;
  int files = 0;
  for (const char* top : {"base", "perception", "agents", "sim"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string suffix = entry.path().extension().string();
      if (suffix != ".h" && suffix != ".cc" && suffix != ".inc") continue;
      ++files;
      std::ifstream text(entry.path());
      for (const std::string& offence :
           Offences(entry.path().lexically_relative(root).generic_string(), text)) {
        ADD_FAILURE() << offence << " is outside its layer";
      }
    }
  }
  EXPECT_GT(files, 10) << "the sources were not found";
}

TEST(Layers, AnAgentThatLooksAtTheWorldIsCaught) {
  std::istringstream text(
      "#include <vector>\n#include \"sim/world.h\"\n#include <btBulletDynamicsCommon.h>\n"
      "#include \"perception/perceive.h\"\n");
  const std::vector<std::string> offences = Offences("agents/cheat.cc", text);
  ASSERT_EQ(offences.size(), 2u);
  EXPECT_EQ(offences[0], "agents/cheat.cc:2: sim/world.h");
}

TEST(Layers, LibtorchStaysInItsOwnTarget) {
  std::istringstream agents("#include <ATen/core/Tensor.h>\n#include \"agents/agent.h\"\n");
  EXPECT_EQ(Offences("agents/pi_learning.cc", agents).size(), 1u);
  std::istringstream deep(
      "#include <ATen/core/Tensor.h>\n#include \"agents/agent.h\"\n"
      "#include \"agents/trainer.h\"\n#include \"perception/state.h\"\n");
  EXPECT_EQ(Offences("agents/deep/dqn.cc", deep).size(), 2u);
}

TEST(Layers, TheWorldDoesNotKnowAgentsOrHowImagesAreRead) {
  std::istringstream text(
      "#include \"agents/agent.h\"\n#include \"perception/segment.h\"\n"
      "#include \"agents/ports/referee.h\"\n#include \"perception/rgbd_frame.h\"\n");
  EXPECT_EQ(Offences("sim/world.cc", text).size(), 2u);
}

TEST(Layers, HeadersStayShortAndAreIncludedOnce) {
  const fs::path root = GUSSET_SOURCE_DIR;
  for (const char* top : {"base", "perception", "agents", "sim", "tools"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream text(entry.path());
      std::string line;
      int lines = 0;
      bool once = false;
      while (std::getline(text, line)) {
        ++lines;
        once = once || line == "#pragma once";
      }
      EXPECT_LE(lines, 150) << entry.path();
      EXPECT_TRUE(once) << entry.path();
    }
  }
}

}  // namespace
}  // namespace gusset
