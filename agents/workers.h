#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "agents/environment.h"

namespace gusset {

/// Threads that own one environment each, made and used on that thread alone (a renderer's context
/// belongs to its thread). One job needs no thread: it runs on the caller's.
class Workers {
 public:
  using Factory = std::function<std::unique_ptr<Environment>()>;
  using Task = std::function<void(Environment&)>;

  /// @param jobs at least 1.
  Workers(int jobs, Factory make);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Runs every task once, begun in their order, and returns when all have ended. Which environment
  /// runs which task is left open; tasks must not depend on it. Once one has thrown, none is begun
  /// any more; rethrows the exception of the earliest that threw, which is the same with any number
  /// of jobs, for all before it have run.
  void Run(const std::vector<Task>& tasks);
  int jobs() const { return jobs_; }
  /// Whether a task of the present Run has thrown, for tasks that go on until they are told to end.
  bool failed() const;

 private:
  struct Shared;
  int jobs_;
  Factory make_;
  std::unique_ptr<Environment> own_;  // with one job
  std::unique_ptr<Shared> shared_;    // with several
};

}  // namespace gusset
