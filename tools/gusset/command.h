#pragma once

#include <CLI/CLI.hpp>
#include <memory>

namespace gusset {

/// One subcommand.
class Command {
 public:
  virtual ~Command() = default;
  virtual const char* name() const = 0;
  virtual const char* summary() const = 0;
  /// Declares its options on `app`, which fills them.
  virtual void Declare(CLI::App& app) = 0;
  /// Does it. @throws InputError (exit 2), RunError (exit 1).
  virtual void Run() = 0;
};

std::unique_ptr<Command> MakeTrainCommand();
std::unique_ptr<Command> MakeEvaluateCommand();
std::unique_ptr<Command> MakePlayCommand();
std::unique_ptr<Command> MakeExperimentCommand();
std::unique_ptr<Command> MakeRenderCommand();
std::unique_ptr<Command> MakeClassifyCommand();
std::unique_ptr<Command> MakeBenchCommand();
std::unique_ptr<Command> MakeReportCommand();
std::unique_ptr<Command> MakeSelfCheckCommand();

}  // namespace gusset
