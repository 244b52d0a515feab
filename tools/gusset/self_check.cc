#include <spdlog/spdlog.h>

#include <iostream>

#include "base/error.h"
#include "tools/gusset/command.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/testbed_env.h"

namespace gusset {
namespace {

class SelfCheckCommand final : public Command {
 public:
  const char* name() const override { return "self-check"; }
  const char* summary() const override {
    return "Versions, GL renderer, one frame and one second of physics";
  }

  void Declare(CLI::App& app) override {
    app.add_flag("--json", json_, "Print one JSON document");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    Settings settings = LoadSettings(common_, {});
    const std::unique_ptr<Testbed> testbed = MakeTestbed(settings.tree);
    testbed->scene().Reset(StartKind::kUnfolded, 1);
    testbed->scene().Restore(testbed->scene().Save(), 1);
    const double before_s = testbed->scene().time_s();
    testbed->robot().Wait(1);
    const double passed_s = testbed->scene().time_s() - before_s;
    if (std::abs(passed_s - 1) > 0.05) {
      throw RunError("asked for one second of physics, got " + std::to_string(passed_s));
    }
    const Observation seen =
        Perceive(testbed->camera().Look(), testbed->camera().model(), settings.bagging.perception,
                 settings.bagging.chosen_thresholds());
    if (!seen.bag_seen) throw RunError("the rendered frame shows no bag");

    nlohmann::ordered_json document = Versions();
    document["renderer"] = testbed->renderer();
    document["state"] = StateName(seen.state);
    document["A_bag"] = seen.A_bag;
    if (json_) return PrintJson(document);
    for (const auto& [key, value] : document.items()) {
      std::cout << key << ": " << (value.is_string() ? value.get<std::string>() : value.dump())
                << "\n";
    }
    std::cout << "this machine can run Gusset" << std::endl;
  }

 private:
  CommonOptions common_;
  bool json_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeSelfCheckCommand() { return std::make_unique<SelfCheckCommand>(); }

}  // namespace gusset
