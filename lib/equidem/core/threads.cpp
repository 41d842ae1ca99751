// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/threads.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
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
  std::atomic<std::size_t> next{0};
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

/// Threads that wait for jobs; they live until the process ends.
class Pool {
 public:
  Pool() = default;
  ~Pool() { resize(0); }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  void run(Job& job, int threads) {
    const std::lock_guard one_job_at_a_time(run_mutex_);
    if (helpers_.size() != static_cast<std::size_t>(threads - 1)) resize(threads - 1);
    {
      const std::lock_guard lock(mutex_);
      job_ = &job;
      busy_ = static_cast<int>(helpers_.size());
      ++round_;
    }
    wake_.notify_all();
    job.work(0);
    std::unique_lock lock(mutex_);
    done_.wait(lock, [&] { return busy_ == 0; });
    job_ = nullptr;
  }

 private:
  void resize(int count) {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (auto& helper : helpers_) helper.join();
    helpers_.clear();
    stop_ = false;
    for (int worker = 1; worker <= count; ++worker) {
      helpers_.emplace_back([this, worker, seen = round_] { serve(worker, seen); });
    }
  }

  void serve(int worker, std::uint64_t seen) {
    while (true) {
      Job* job = nullptr;
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [&] { return stop_ || round_ != seen; });
        if (stop_) return;
        seen = round_;
        job = job_;
      }
      job->work(worker);
      {
        const std::lock_guard lock(mutex_);
        --busy_;
      }
      done_.notify_one();
    }
  }

  std::mutex run_mutex_, mutex_;
  std::condition_variable wake_, done_;
  std::vector<std::thread> helpers_;
  Job* job_ = nullptr;
  std::uint64_t round_ = 0;
  int busy_ = 0;
  bool stop_ = false;
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
