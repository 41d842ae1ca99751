// SPDX-License-Identifier: GPL-3.0-or-later
#include "dead_ranks.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <string>
#include <vector>

#include <unistd.h>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

struct RankHere {
  pid_t process = 0;
  std::string sentence;  // of its death: a handler of signals can make none
};
std::vector<RankHere> ranks_here;  // in their order
int sentences_to = STDERR_FILENO;
struct sigaction told_before = {};
bool telling_is_on = false;

bool is_gone(const RankHere& rank) {
  return kill(rank.process, 0) != 0 && errno == ESRCH;
}

void when_told_to_end(int signal_number) {
  const int kept = errno;
  const pid_t own = getpid();
  const auto left = std::ranges::find_if_not(ranks_here, is_gone);
  if (left != ranks_here.end() && left->process == own) {
    for (const RankHere& rank : ranks_here) {
      if (is_gone(rank)) static_cast<void>(!write(sentences_to, rank.sentence.data(), rank.sentence.size()));
    }
  }
  errno = kept;
  told_before.sa_handler(signal_number);
}

}  // namespace

void tell_of_dead_ranks(const petsc::Ranks& ranks, int descriptor) {
  if (!ranks_here.empty()) return;
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(ranks.communicator(), MPI_COMM_TYPE_SHARED, ranks.rank(), MPI_INFO_NULL, &here);
  int count = 0;
  MPI_Comm_size(here, &count);
  const int own[] = {ranks.rank(), getpid()};
  std::vector<int> all(2 * static_cast<std::size_t>(count));
  MPI_Allgather(own, 2, MPI_INT, all.data(), 2, MPI_INT, here);
  MPI_Comm_free(&here);
  for (std::size_t k = 0; k < all.size(); k += 2) {
    ranks_here.push_back(
        {all[k + 1], fmt::format("equidem-mpi: rank {} of {} died (its process was killed, for lack of memory or from "
                                 "outside, or crashed), and the others end with it. Where memory was short, use fewer "
                                 "discs or more machines.\n",
                                 all[k], ranks.count())});
  }
  sentences_to = descriptor;
  struct sigaction telling = {};
  telling.sa_handler = when_told_to_end;
  if (sigaction(SIGTERM, nullptr, &told_before) != 0 || (told_before.sa_flags & SA_SIGINFO) != 0 ||
      told_before.sa_handler == SIG_DFL || told_before.sa_handler == SIG_IGN)
    return;
  sigaction(SIGTERM, &telling, nullptr);
  telling_is_on = true;
}

void stop_telling_of_dead_ranks() {
  if (telling_is_on) sigaction(SIGTERM, &told_before, nullptr);
  telling_is_on = false;
}

}  // namespace equidem
