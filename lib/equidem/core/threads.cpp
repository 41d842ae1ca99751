// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/threads.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <pthread.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

thread_local bool inside_task = false;

/// One loop handed to the pool.
struct Job {
  std::size_t tasks = 0;
  const std::function<void(std::size_t, int)>* body = nullptr;
  alignas(64) std::atomic<std::size_t> next{0};
  std::mutex failure_mutex;
  std::exception_ptr failure;

  void work(int worker) {
    inside_task = true;
    for (std::size_t task = next++; task < tasks; task = next++) {
      try {
        (*body)(task, worker);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next = tasks;
      }
    }
    inside_task = false;
  }
};

/// Threads that wait for jobs; they live until the process ends. A job does not wait for those that come too late for
/// it, because others have their processors.
class Pool {
 public:
  Pool() = default;
  ~Pool() { resize(0); }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  void run(Job& job, int threads) {
    const std::lock_guard one_job_at_a_time(run_mutex_);
    if (helpers_.size() != static_cast<std::size_t>(threads - 1)) resize(threads - 1);
    job_ = &job;
    begin_round();
    job.work(0);
    job_ = nullptr;
    // whoever has counted itself from now on finds no job
    for (int busy = busy_; busy != 0; busy = busy_) wait_while_equal(busy_, busy);
  }

 private:
  void begin_round() {
    ++round_;
    round_.notify_all();
  }

  void resize(int count) {
    stop_ = true;
    begin_round();
    for (auto& helper : helpers_) helper.join();
    helpers_.clear();
    stop_ = false;
    for (int worker = 1; worker <= count; ++worker) {
      helpers_.emplace_back([this, worker, seen = round_.load()] { serve(worker, seen); });
    }
  }

  void serve(int worker, int seen) {
    while (true) {
      wait_while_equal(round_, seen);
      seen = round_;
      if (stop_) return;
      ++busy_;
      if (Job* job = job_) job->work(worker);
      if (--busy_ == 0) busy_.notify_one();
    }
  }

  std::mutex run_mutex_;
  std::vector<std::thread> helpers_;
  // on lines of their own: threads that wait read them all the time
  alignas(64) std::atomic<int> round_{0};
  alignas(64) std::atomic<int> busy_{0};  ///< helpers that may hold the job
  alignas(64) std::atomic<Job*> job_{nullptr};
  std::atomic<bool> stop_{false};
};

std::atomic<int> requested_threads{0};

/// A process that is forked has none of the threads of its parent, and locks as they were: it gets a pool of its own.
Pool& pool() {
  static std::unique_ptr<Pool> instance = [] {
    pthread_atfork(nullptr, nullptr, [] {
      static_cast<void>(instance.release());
      instance = std::make_unique<Pool>();
    });
    return std::make_unique<Pool>();
  }();
  return *instance;
}

}  // namespace

int thread_count() {
  static const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int requested = requested_threads;
  return requested > 0 ? requested : cores;
}

void set_thread_count(int count) {
  if (count < 1) {
    bad_input(fmt::format("the number of threads is {}", count), "at least one thread is needed", "Ask for 1 or more");
  }
  requested_threads = count;
}

void parallel_tasks(std::size_t tasks, const std::function<void(std::size_t, int)>& body) {
  const int threads = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(thread_count()), tasks));
  if (threads <= 1 || inside_task) {
    for (std::size_t task = 0; task < tasks; ++task) body(task, 0);
    return;
  }
  Job job;
  job.tasks = tasks;
  job.body = &body;
  pool().run(job, thread_count());
  if (job.failure) std::rethrow_exception(job.failure);
}

void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  parallel_tasks((count + grain - 1) / grain,
                 [&](std::size_t task, int) { body(task * grain, std::min(count, (task + 1) * grain)); });
}

}  // namespace equidem
