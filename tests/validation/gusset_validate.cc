// Long measurements of the cloth at work: one experiment per subcommand, results as tables for
// docs/physics.md. The test suite holds bounds; this says how far from them the cloth is.

#include <iostream>

#include "base/error.h"
#include "tests/validation/experiment.h"

namespace gusset {
namespace {

int Complain(const char* what, int code) {
  std::cerr << "gusset_validate: " << what << std::endl;
  return code;
}

int Validate(int argc, char** argv) {
  try {
    CLI::App app("Measures the cloth at work.", "gusset_validate");
    app.require_subcommand(1);
    std::string command = "gusset_validate";
    for (int i = 1; i < argc; ++i) command += " " + std::string(argv[i]);
    std::vector<std::unique_ptr<Command>> experiments;
    experiments.push_back(MakeCrossingsExperiment(command));
    experiments.push_back(MakeGraspExperiment(command));
    experiments.push_back(MakeRefinementExperiment(command));
    experiments.push_back(MakePairsExperiment(command));
    for (const auto& e : experiments) e->Declare(*app.add_subcommand(e->name(), e->summary()));
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      if (e.get_exit_code() == 0) return app.exit(e);  // --help
      return Complain(e.what(), 2);
    }
    for (const auto& e : experiments) {
      if (app.got_subcommand(e->name())) e->Run();
    }
    return 0;
  } catch (const InputError& e) {
    return Complain(e.what(), 2);
  } catch (const std::exception& e) {
    return Complain(e.what(), 1);
  }
}

}  // namespace
}  // namespace gusset

int main(int argc, char** argv) { return gusset::Validate(argc, argv); }
