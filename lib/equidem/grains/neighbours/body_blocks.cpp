// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/neighbours/body_blocks.hpp"

#include <atomic>

namespace equidem {
namespace {

/// With fewer bodies threads wait for one another longer than they work.
constexpr std::size_t fewest_bodies_of_threads = 2048;
/// Larger blocks have fewer pairs with bodies of others; of many blocks threads get equal shares.
constexpr std::size_t usual_bodies_of_block = 1024, fewest_blocks = 4, most_blocks = 128;

std::size_t share(std::size_t bodies, std::size_t blocks) {
  return (bodies + blocks - 1) / blocks;
}

}  // namespace

BodyBlocks::BodyBlocks(std::size_t bodies, std::size_t per_block) : bodies_(bodies), per_block_(per_block) {
  if (per_block_ > 0) return;
  per_block_ =
      bodies < fewest_bodies_of_threads
          ? std::max<std::size_t>(bodies, 1)
          : std::max(std::min(usual_bodies_of_block, share(bodies, fewest_blocks)), share(bodies, most_blocks));
}

void BodyBlocks::each_in_turn(const std::vector<std::size_t>& earliest, const std::function<void(std::size_t)>& first,
                              const std::function<void(std::size_t)>& second) const {
  if (thread_count() == 1 || count() == 1) {
    for (std::size_t block = 0; block < count(); ++block) {
      first(block);
      second(block);
    }
    return;
  }
  std::vector<std::atomic<char>> done(count());
  const auto may_follow = [&](std::size_t block) {
    for (std::size_t k = earliest[block]; k <= block; ++k)
      if (done[k].load(std::memory_order_acquire) == 0) return false;
    return true;
  };
  struct alignas(64) Waiting {
    std::vector<std::size_t> blocks;
  };
  std::vector<Waiting> waiting(static_cast<std::size_t>(thread_count()));
  parallel_shares(count(), [&](std::size_t block, int worker) {
    first(block);
    done[block].store(1, std::memory_order_release);
    std::vector<std::size_t>& mine = waiting[worker].blocks;
    mine.push_back(block);
    std::erase_if(mine, [&](std::size_t other) {
      if (!may_follow(other)) return false;
      second(other);
      return true;
    });
  });
  std::vector<std::size_t> left;
  for (const Waiting& blocks : waiting) left.insert(left.end(), blocks.blocks.begin(), blocks.blocks.end());
  parallel_tasks(left.size(), [&](std::size_t k, int) { second(left[k]); });
}

}  // namespace equidem
