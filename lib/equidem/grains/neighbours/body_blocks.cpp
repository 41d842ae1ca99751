// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/neighbours/body_blocks.hpp"

namespace equidem {
namespace {

/// With fewer bodies threads wait for one another longer than they work.
constexpr std::size_t fewest_bodies_of_threads = 4096;
/// Larger blocks have fewer pairs with bodies of others; of many blocks threads get equal shares.
constexpr std::size_t fewest_bodies_of_block = 1024, most_blocks = 128;

}  // namespace

BodyBlocks::BodyBlocks(std::size_t bodies, std::size_t per_block) : bodies_(bodies), per_block_(per_block) {
  if (per_block_ > 0) return;
  per_block_ = bodies < fewest_bodies_of_threads
                   ? std::max<std::size_t>(bodies, 1)
                   : std::max(fewest_bodies_of_block, (bodies + most_blocks - 1) / most_blocks);
}

}  // namespace equidem
