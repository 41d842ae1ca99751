// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/stepper.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

/// Threads wait for one another between waves of a few microseconds.
class SpinBarrier {
 public:
  explicit SpinBarrier(int threads) : threads_(threads) {}

  void wait() {
    const int round = round_.load(std::memory_order_acquire);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
      arrived_.store(0, std::memory_order_relaxed);
      round_.fetch_add(1, std::memory_order_release);
      round_.notify_all();
      return;
    }
    wait_while_equal(round_, round);
  }

 private:
  const int threads_;
  alignas(64) std::atomic<int> arrived_{0};
  alignas(64) std::atomic<int> round_{0};
};

/// Run body(thread) on `threads` threads at the same time.
void run_together(int threads, const std::function<void(int)>& body) {
  std::vector<std::thread> others;
  for (int k = 1; k < threads; ++k) others.emplace_back([&body, k] { body(k); });
  body(0);
  for (std::thread& other : others) other.join();
}

}  // namespace

void step_strips(std::int32_t strips, std::int64_t stages, int depth, int threads, const StripWork& work) {
  if (strips == 0 || stages == 0) return;
  threads = std::clamp(threads, 1, thread_count());
  SpinBarrier barrier(threads);
  if (stages < threads) {
    run_together(threads, [&](int thread) {
      const auto begin = static_cast<std::int32_t>(static_cast<std::int64_t>(strips) * thread / threads);
      const auto end = static_cast<std::int32_t>(static_cast<std::int64_t>(strips) * (thread + 1) / threads);
      for (std::int64_t stage = 0; stage < stages; ++stage) {
        for (std::int32_t strip = begin; strip < end; ++strip) work(strip, stage);
        if (threads > 1) barrier.wait();
      }
    });
    return;
  }
  // Stage s visits strip l in wave start(s) + l; a new block of `depth` stages follows when the first stage of the last
  // one is through, so that no thread runs dry between blocks. Each thread has stages of a block that follow one
  // another: strips pass through its own cache before the next thread has them.
  depth = (std::max(depth, 1) + threads - 1) / threads * threads;
  const std::int64_t block = std::max<std::int64_t>(strips, 2L * depth);
  const auto start = [&](std::int64_t stage) { return stage / depth * block + 2 * (stage % depth); };
  const std::int64_t waves = start(stages - 1) + strips;
  std::vector<int> thread_of(static_cast<std::size_t>(depth));
  for (int k = 0; k < depth; ++k) thread_of[k] = static_cast<int>(static_cast<std::int64_t>(k) * threads / depth);
  struct UnderWay {
    std::int64_t stage, start;
    int of_block;
  };
  const auto follow = [&](UnderWay& one) {
    ++one.stage;
    one.start += ++one.of_block < depth ? 2 : block - 2 * (depth - 1);
    if (one.of_block == depth) one.of_block = 0;
  };
  run_together(threads, [&](int thread) {
    UnderWay first{0, 0, 0};
    for (std::int64_t wave = 0; wave < waves; ++wave) {
      while (first.stage < stages && wave - first.start >= strips) follow(first);
      for (UnderWay one = first; one.stage < stages && one.start <= wave; follow(one)) {
        const std::int64_t strip = wave - one.start;
        if (strip < strips && thread_of[one.of_block] == thread) work(static_cast<std::int32_t>(strip), one.stage);
      }
      if (threads > 1) barrier.wait();
    }
  });
}

}  // namespace equidem
