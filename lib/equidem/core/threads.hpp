// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Threads. Every parallel loop of the library gives each index the same work whichever thread runs it, and combines
/// results in a fixed order: the bits of an answer do not depend on the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace equidem {

/// Number of threads that parallel loops use; the number of processors until set.
int thread_count();
/// \throws Error where count < 1
void set_thread_count(int count);

/// Call body(task, worker) for every task in [0, tasks), each once, in any order; worker in [0, thread_count())
/// identifies which thread runs it. The calling thread takes part. An exception thrown by a task is thrown again here
/// once all running tasks have ended. Inside a running task it runs serially, with worker = 0.
void parallel_tasks(std::size_t tasks, const std::function<void(std::size_t task, int worker)>& body);

/// As parallel_tasks, but every thread begins with a share of the tasks that are next to one another, the same in every
/// call with as many: what it wrote for them in the call before is in the cache of its processor. It takes the last
/// task of its share first, then the others in ascending order, and then tasks of shares that others are late with.
void parallel_shares(std::size_t tasks, const std::function<void(std::size_t task, int worker)>& body);

/// Call body(begin, end) for pieces of [0, count) of at most `grain` indices.
void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Run work(), a call of a library that asks for no signal, on a thread of its own; where the user asks to stop before
/// it has returned, the thread is left behind: work owns all that it touches. What it throws is thrown here.
/// \throws Error of kind interrupted where the user asked to stop
void run_aside(std::function<void()> work);

/// Wait until `value` is another than `old`; whoever changes it notifies.
///
/// It spins for some ten microseconds, longer than threads that work together wait for one another, and then sleeps:
/// where others have the processor, spinning would take it from the thread that is waited for.
inline void wait_while_equal(const std::atomic<int>& value, int old) {
  constexpr int spins = 2000;
  for (int k = 0; k < spins; ++k) {
    if (value.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  value.wait(old, std::memory_order_acquire);
}

/// Threads that do the rounds of a job together.
class Team {
 public:
  explicit Team(int size) : size_(size) {}
  ~Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  [[nodiscard]] int size() const { return size_; }
  /// Wait until all members have called it as often. \return false if one of them has thrown: the others return, too
  [[nodiscard]] bool wait();
  /// A member has thrown: nobody waits for it.
  void fail();

 private:
  int size_;
  std::atomic<bool> failed_{false};
  alignas(64) std::atomic<int> arrived_{0};
  alignas(64) std::atomic<int> round_{0};
};

/// Call body(member, team) for every member of a team, all at the same time; there are at most `most` and
/// thread_count(), inside a running task one. An exception of a member is thrown again here.
void run_together(int most, const std::function<void(int member, Team& team)>& body);

}  // namespace equidem
