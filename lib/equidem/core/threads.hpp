// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Threads. Every parallel loop of the library gives each index the same work whichever thread runs it, and combines
/// results in a fixed order: the bits of an answer do not depend on the number of threads.
#pragma once

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

/// Call body(begin, end) for pieces of [0, count) of at most `grain` indices.
void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace equidem
