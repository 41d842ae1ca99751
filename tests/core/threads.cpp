// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Parallel loops: every task runs once, errors reach the caller, and the number of threads changes no bit.
#include "equidem/core/threads.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// Sets the number of threads and restores it.
class WithThreads {
 public:
  explicit WithThreads(int count) : before_(thread_count()) { set_thread_count(count); }
  ~WithThreads() { set_thread_count(before_); }
  WithThreads(const WithThreads&) = delete;
  WithThreads& operator=(const WithThreads&) = delete;

 private:
  int before_;
};

}  // namespace

TEST_CASE("each_task_runs_exactly_once") {
  const int threads = GENERATE(1, 2, 3, 8);
  const std::size_t tasks = GENERATE(0u, 1u, 2u, 7u, 1000u);
  const WithThreads with(threads);
  CAPTURE(threads, tasks);
  std::vector<std::atomic<int>> runs(tasks);
  std::atomic<bool> worker_in_range{true};
  parallel_tasks(tasks, [&](std::size_t task, int worker) {
    ++runs.at(task);
    if (worker < 0 || worker >= threads) worker_in_range = false;
  });
  CHECK(worker_in_range);
  CHECK(std::all_of(runs.begin(), runs.end(), [](const auto& n) { return n == 1; }));
}

TEST_CASE("ranges_cover_every_index_once_in_pieces_of_the_grain") {
  const WithThreads with(GENERATE(1, 3));
  const std::size_t count = GENERATE(0u, 1u, 10u, 1001u);
  const std::size_t grain = GENERATE(0u, 1u, 3u, 5000u);
  CAPTURE(thread_count(), count, grain);
  std::vector<std::atomic<int>> runs(count);
  std::atomic<std::size_t> largest{0};
  parallel_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) ++runs.at(k);
    std::size_t seen = largest;
    while (end - begin > seen && !largest.compare_exchange_weak(seen, end - begin)) {
    }
  });
  CHECK(largest <= std::max<std::size_t>(grain, 1));
  CHECK(std::all_of(runs.begin(), runs.end(), [](const auto& n) { return n == 1; }));
}

TEST_CASE("work_is_shared_between_threads") {
  const WithThreads with(2);
  // Each of two tasks waits for the other: only two threads at once can finish them.
  std::atomic<int> arrived{0};
  parallel_tasks(2, [&](std::size_t, int) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  CHECK(arrived == 2);
}

TEST_CASE("an_exception_of_a_task_travels_to_the_caller") {
  const WithThreads with(GENERATE(1, 2, 8));
  CAPTURE(thread_count());
  const auto failing = [](std::size_t task, int) {
    if (task == 37) bad_input("task 37 fails", "it was told to", "");
  };
  CHECK_THROWS_AS(parallel_tasks(100, failing), Error);
  CHECK_THROWS_WITH(parallel_tasks(100, failing), "task 37 fails (it was told to).");
  CHECK_THROWS_AS(parallel_tasks(100, [](std::size_t, int) { throw std::runtime_error("all fail"); }),
                  std::runtime_error);
  std::atomic<int> runs{0};
  parallel_tasks(100, [&](std::size_t, int) { ++runs; });
  CHECK(runs == 100);  // the pool still works
}

TEST_CASE("members_of_a_team_do_their_rounds_together") {
  const int threads = GENERATE(1, 2, 5);
  const WithThreads with(threads);
  for (int round = 0; round < 20; ++round) {
    std::vector<int> done(static_cast<std::size_t>(threads), 0);
    int behind = 0;
    std::atomic<bool> together{true};
    run_together(100, [&](int member, Team& team) {
      for (int k = 1; k <= 50; ++k) {
        done[static_cast<std::size_t>(member)] = k;
        if (!team.wait()) together = false;
        if (member == 0) behind += static_cast<int>(std::ranges::count_if(done, [&](int other) { return other < k; }));
        if (!team.wait()) together = false;
      }
    });
    CHECK(together);
    CHECK(behind == 0);
    CHECK(std::ranges::count(done, 50) == threads);
  }
}

TEST_CASE("an_exception_of_a_member_ends_the_work_of_its_team_and_travels_to_the_caller") {
  const int threads = GENERATE(1, 2, 5);
  const WithThreads with(threads);
  const int thrower = GENERATE(0, 1, 4);
  if (thrower >= threads) return;
  for (int round = 0; round < 20; ++round) {
    const auto work = [&](int member, Team& team) {
      for (int k = 0; k < 1000; ++k) {
        if (member == thrower && k == 17 * (round % 3)) throw std::runtime_error("member");
        if (!team.wait()) return;
      }
    };
    CHECK_THROWS_WITH(run_together(threads, work), "member");
  }
}

TEST_CASE("a_loop_inside_a_task_runs_serially_and_completely") {
  const WithThreads with(GENERATE(1, 2, 3));
  std::vector<int> sums(20);
  std::atomic<bool> stayed{true};
  parallel_tasks(sums.size(), [&](std::size_t outer, int) {
    const auto thread = std::this_thread::get_id();
    parallel_tasks(50, [&](std::size_t inner, int) {
      if (thread_count() > 1 && std::this_thread::get_id() != thread) stayed = false;
      sums[outer] += static_cast<int>(inner);
    });
  });
  CHECK(stayed);
  CHECK(std::all_of(sums.begin(), sums.end(), [](int s) { return s == 1225; }));
}

TEST_CASE("the_number_of_threads_changes_no_bit_of_a_result") {
  std::vector<double> numbers(100003);
  Random random(1);
  for (double& x : numbers) x = random.uniform(-1, 1) * std::exp(random.uniform(-20, 20));
  const auto sum_of_pieces = [&] {
    const std::size_t grain = 1000;
    std::vector<double> partial((numbers.size() + grain - 1) / grain);
    parallel_ranges(numbers.size(), grain, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += std::sin(numbers[k]) * numbers[k];
      partial[begin / grain] = sum;
    });
    double sum = 0;
    for (const double p : partial) sum += p;
    return sum;
  };
  double serial = 0;
  {
    const WithThreads with(1);
    serial = sum_of_pieces();
  }
  for (const int threads : {2, 3, 8}) {
    const WithThreads with(threads);
    CAPTURE(threads);
    CHECK(sum_of_pieces() == serial);
  }
}

TEST_CASE("a_thousand_jobs_in_a_row_all_end") {
  std::atomic<long> runs{0};
  for (int job = 0; job < 1000; ++job) {
    const WithThreads with(1 + job % 4);
    parallel_tasks(10, [&](std::size_t, int) { ++runs; });
  }
  CHECK(runs == 10000);
}

TEST_CASE("jobs_of_two_threads_of_the_user_do_not_mix") {
  const WithThreads with(3);
  std::vector<std::atomic<int>> a(2000);
  std::vector<std::atomic<int>> b(2000);
  std::thread other([&] {
    for (int k = 0; k < 50; ++k) parallel_tasks(b.size(), [&](std::size_t t, int) { ++b[t]; });
  });
  for (int k = 0; k < 50; ++k) parallel_tasks(a.size(), [&](std::size_t t, int) { ++a[t]; });
  other.join();
  CHECK(std::all_of(a.begin(), a.end(), [](const auto& n) { return n == 50; }));
  CHECK(std::all_of(b.begin(), b.end(), [](const auto& n) { return n == 50; }));
}

TEST_CASE("fewer_than_one_thread_is_refused") {
  const int count = GENERATE(0, -3);
  const int before = thread_count();
  CHECK_THROWS_WITH(set_thread_count(count), Catch::Contains("number of threads is " + std::to_string(count)));
  CHECK(thread_count() == before);
  CHECK(before >= 1);
}

TEST_CASE("a_library_that_asks_for_no_signal_is_left_behind_where_the_user_interrupts") {
  const InterruptCatcher catcher;
  const auto released = std::make_shared<std::atomic<bool>>(false);
  const auto ended = std::make_shared<std::atomic<bool>>(false);
  try {
    run_aside([released, ended] {
      std::raise(SIGINT);
      while (!*released) std::this_thread::yield();
      *ended = true;
    });
    FAIL("it waited");
  } catch (const Error& error) {
    CAPTURE(error.what());
    CHECK(error.kind() == ErrorKind::interrupted);
  }
  CHECK(!*ended);
  *released = true;
  while (!*ended) std::this_thread::yield();
}

TEST_CASE("an_exception_of_a_library_set_aside_travels_to_the_caller") {
  CHECK_THROWS_AS(run_aside([] { throw std::out_of_range("x"); }), std::out_of_range);
  int done = 0;
  run_aside([&] { done = 1; });
  CHECK(done == 1);
}
