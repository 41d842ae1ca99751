// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/threads.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <pthread.h>

#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

thread_local bool inside_task = false;

/// Tasks begin .. end of a job, on a cache line of its own.
struct alignas(64) Share {
  std::size_t begin = 0, end = 0;
  bool last_first = false;  ///< the last task comes first
  std::atomic<std::size_t> taken{0};

  [[nodiscard]] std::size_t task(std::size_t k) const {
    if (!last_first) return begin + k;
    return k == 0 ? end - 1 : begin + k - 1;
  }
};

/// One loop handed to the pool.
struct Job {
  const std::function<void(std::size_t, int)>* body = nullptr;
  std::vector<Share> shares;  ///< one for all threads, or one for each
  std::mutex failure_mutex;
  std::exception_ptr failure;
  bool stops_held_back = StopsHeldBack::any();

  Job(std::size_t tasks, std::size_t parts, const std::function<void(std::size_t, int)>& work)
      : body(&work), shares(parts) {
    for (std::size_t k = 0; k < parts; ++k) {
      shares[k].begin = tasks * k / parts;
      shares[k].end = tasks * (k + 1) / parts;
      shares[k].last_first = parts > 1;
    }
  }

  void work(int worker) {
    inside_task = true;
    const StopsHeldBack held_back(stops_held_back);
    for (std::size_t k = 0; k < shares.size(); ++k)
      work(shares[(static_cast<std::size_t>(worker) + k) % shares.size()], worker);
    inside_task = false;
  }

 private:
  void work(Share& share, int worker) {
    const std::size_t tasks = share.end - share.begin;
    for (std::size_t k = share.taken++; k < tasks; k = share.taken++) {
      try {
        (*body)(share.task(k), worker);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        for (Share& other : shares) other.taken = other.end;
      }
    }
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
    try {
      for (int worker = 1; worker <= count; ++worker)
        helpers_.emplace_back([this, worker, seen = round_.load()] { serve(worker, seen); });
    } catch (const std::system_error& error) {
      resize(0);
      computation_failed(fmt::format("{} threads cannot be started", count + 1), error.code().message(),
                         "Give fewer threads, or raise the limits of memory and processes (ulimit -v, -u)");
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

namespace {

/// \param each one share for each thread, not one for all
void share_out(std::size_t tasks, bool each, const std::function<void(std::size_t, int)>& body) {
  const int threads = thread_count();
  if (threads <= 1 || tasks <= 1 || inside_task) {
    for (std::size_t task = 0; task < tasks; ++task) body(task, 0);
    return;
  }
  Job job(tasks, each ? static_cast<std::size_t>(threads) : 1, body);
  pool().run(job, threads);
  if (job.failure) std::rethrow_exception(job.failure);
}

}  // namespace

void parallel_tasks(std::size_t tasks, const std::function<void(std::size_t, int)>& body) {
  share_out(tasks, false, body);
}

void parallel_shares(std::size_t tasks, const std::function<void(std::size_t, int)>& body) {
  share_out(tasks, true, body);
}

void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  parallel_tasks((count + grain - 1) / grain,
                 [&](std::size_t task, int) { body(task * grain, std::min(count, (task + 1) * grain)); });
}

void run_aside(std::function<void()> work) {
  std::packaged_task<void()> task(std::move(work));
  std::future<void> done = task.get_future();
  std::thread aside(std::move(task));
  try {
    while (done.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) stop_if_interrupted();
  } catch (...) {
    aside.detach();
    throw;
  }
  aside.join();
  done.get();
}

bool Team::wait() {
  if (size_ == 1) return true;
  const int round = round_.load(std::memory_order_acquire);
  if (failed_.load(std::memory_order_acquire)) return false;
  if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == size_) {
    arrived_.store(0, std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
  } else {
    wait_while_equal(round_, round);
  }
  return !failed_.load(std::memory_order_acquire);
}

void Team::fail() {
  failed_.store(true, std::memory_order_release);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
}

void run_together(int most, const std::function<void(int, Team&)>& body) {
  Team team(inside_task ? 1 : std::clamp(most, 1, thread_count()));
  // a thread that waits for the others of the team takes no second task: each member has a thread
  parallel_shares(static_cast<std::size_t>(team.size()), [&](std::size_t member, int) {
    try {
      body(static_cast<int>(member), team);
    } catch (...) {
      team.fail();
      throw;
    }
  });
}

}  // namespace equidem
