#include "tools/gusset/cli.h"

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/stop.h"
#include "tools/gusset/command.h"

namespace gusset {
namespace {

int Complain(const std::string& what, int code) {
  std::string line = what;
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::cerr << "gusset: " << line << std::endl;
  return code;
}

// "--out ''" is a slip, as of a variable that is not set, and not the same as no --out.
void RefuseEmptyValues(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& value : option->results()) {
      if (value.empty()) throw InputError(option->get_name() + ": its value is empty");
    }
  }
  for (const CLI::App* command : app.get_subcommands()) RefuseEmptyValues(*command);
}

}  // namespace

int RunCommandLine(int argc, char** argv) {
  try {
    CLI::App app("A headless testbed in which a robot learns to bag.", "gusset");
    app.set_version_flag("--version", GUSSET_VERSION);
    app.require_subcommand(1);
    std::vector<std::unique_ptr<Command>> commands;
    commands.push_back(MakeTrainCommand());
    commands.push_back(MakeEvaluateCommand());
    commands.push_back(MakePlayCommand());
    commands.push_back(MakeExperimentCommand());
    commands.push_back(MakeRenderCommand());
    commands.push_back(MakeClassifyCommand());
    commands.push_back(MakeBenchCommand());
    commands.push_back(MakeReportCommand());
    commands.push_back(MakeSelfCheckCommand());
    for (const auto& command : commands) {
      command->Declare(*app.add_subcommand(command->name(), command->summary()));
    }
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      if (e.get_exit_code() != 0) {
        // CLI11 would rather say that a subcommand is required than what it took for none.
        const std::vector<std::string> rest = app.remaining(true);
        const std::string what =
            rest.empty() ? e.what() : "The following argument was not expected: " + rest[0];
        return Complain(what + " (see --help)", 2);
      }
      app.exit(e);  // --help, --version
      commands.clear();
    }
    RefuseEmptyValues(app);
    for (const auto& command : commands) {
      if (app.got_subcommand(command->name())) command->Run();
    }
    // What a command prints is its result: lost, it has failed.
    const bool printed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    if (!std::cout.flush() || !printed) throw RunError("cannot write to standard output");
    return 0;
  } catch (const InputError& e) {
    return Complain(e.what(), 2);
  } catch (const RunError& e) {
    return Complain(e.what(), 1);
  } catch (const Interrupted& e) {
    return Complain(e.what(), 1);
  } catch (const std::filesystem::filesystem_error& e) {
    return Complain(e.path1().string() + ": " + e.code().message(), 2);
  } catch (const std::exception& e) {
    return Complain(std::string("internal error: ") + e.what(), 1);
  }
}

}  // namespace gusset
