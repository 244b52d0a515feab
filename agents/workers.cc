#include "agents/workers.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace gusset {

struct Workers::Shared {
  std::mutex mutex;
  std::condition_variable wake, all_done;
  const std::vector<Task>* tasks = nullptr;
  std::vector<std::exception_ptr> errors;
  std::size_t next = 0;
  std::size_t open = 0;
  std::atomic<bool> failed = false;
  bool stop = false;
  std::vector<std::thread> threads;

  void Loop(const Factory& make) {
    std::unique_ptr<Environment> environment;
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [&] { return stop || (tasks != nullptr && next < tasks->size()); });
      if (stop) return;
      const std::size_t mine = next++;
      const Task& task = (*tasks)[mine];
      lock.unlock();
      std::exception_ptr error;
      try {
        if (!environment) environment = make();
        task(*environment);
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      errors[mine] = error;
      if (error) {
        failed = true;
        open -= tasks->size() - next;
        next = tasks->size();
      }
      if (--open == 0) all_done.notify_one();
    }
  }
};

Workers::Workers(int jobs, Factory make) : jobs_(jobs), make_(std::move(make)) {
  if (jobs_ <= 1) return;
  shared_ = std::make_unique<Shared>();
  for (int i = 0; i < jobs_; ++i) shared_->threads.emplace_back([this] { shared_->Loop(make_); });
}

Workers::~Workers() {
  if (!shared_) return;
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->stop = true;
  }
  shared_->wake.notify_all();
  for (std::thread& thread : shared_->threads) thread.join();
}

void Workers::Run(const std::vector<Task>& tasks) {
  if (tasks.empty()) return;
  if (!shared_) {
    if (!own_) own_ = make_();
    for (const Task& task : tasks) task(*own_);
    return;
  }
  std::unique_lock lock(shared_->mutex);
  shared_->errors.assign(tasks.size(), nullptr);
  shared_->next = 0;
  shared_->failed = false;
  shared_->open = tasks.size();
  shared_->tasks = &tasks;
  shared_->wake.notify_all();
  shared_->all_done.wait(lock, [&] { return shared_->open == 0; });
  shared_->tasks = nullptr;
  for (const std::exception_ptr& error : shared_->errors) {
    if (error) std::rethrow_exception(error);
  }
}

bool Workers::failed() const { return shared_ && shared_->failed; }

}  // namespace gusset
