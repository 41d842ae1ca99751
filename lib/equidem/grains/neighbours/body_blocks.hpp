// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Division of the bodies into blocks, on which threads work at the same time.
///
/// A pair belongs to the block of its first body. Its impulse on the other one, where that is of a later block, waits
/// in a place of its own until all blocks have been through their pairs: no two blocks write to one body, and every
/// body adds its impulses in one order, whichever thread is first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "equidem/core/threads.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Impulse on a body by its contacts in one step.
struct alignas(32) BodyImpulse {
  Vec2 impulse;       ///< N s
  double torque = 0;  ///< angular impulse, N m s
  double rim = 0;  ///< tangential impulse on the rim of a disc by near pairs, N s; turn_rims() converts it to a torque
};

/// Ranges of bodies in the order of grain_order.cpp. Their number does not depend on that of threads.
class BodyBlocks {
 public:
  BodyBlocks() = default;
  /// \param per_block bodies of a block; 0: one block of few bodies, which one thread steps sooner than several
  explicit BodyBlocks(std::size_t bodies, std::size_t per_block = 0);

  [[nodiscard]] std::size_t count() const { return (bodies_ + per_block_ - 1) / per_block_; }
  [[nodiscard]] std::size_t begin(std::size_t block) const { return block * per_block_; }
  [[nodiscard]] std::size_t end(std::size_t block) const { return std::min(bodies_, (block + 1) * per_block_); }
  [[nodiscard]] std::size_t of(std::size_t body) const { return body / per_block_; }

  /// Call work(block) for each block, on all threads.
  template <class Work>
  void each(const Work& work) const {
    parallel_shares(count(), [&](std::size_t block, int) { work(block); });
  }

  /// Sums of part(block), two numbers each, over all blocks in their order.
  template <class Part>
  [[nodiscard]] std::pair<double, double> sum(const Part& part) const {
    std::vector<std::pair<double, double>> parts(count());
    each([&](std::size_t block) { parts[block] = part(block); });
    std::pair<double, double> sums{};
    for (const auto& [first, second] : parts) {
      sums.first += first;
      sums.second += second;
    }
    return sums;
  }

  /// Call work(begin, end) for pieces of [0, count) as long as blocks, on all threads; count: of some of the bodies.
  template <class Work>
  void each_piece(std::size_t count, const Work& work) const {
    parallel_shares((count + per_block_ - 1) / per_block_, [&](std::size_t piece, int) {
      work(piece * per_block_, std::min(count, (piece + 1) * per_block_));
    });
  }

  /// Call first(block), then second(block) for each block, on all threads: the second once the first has returned for
  /// the blocks from earliest[block] to this one. What the first wrote is mostly in the cache of the processor then.
  void each_in_turn(const std::vector<std::size_t>& earliest, const std::function<void(std::size_t block)>& first,
                    const std::function<void(std::size_t block)>& second) const;

 private:
  std::size_t bodies_ = 0, per_block_ = 1;
};

/// An impulse on a body by a pair of an earlier block.
struct InwardImpulse {
  std::int32_t body = 0;
  const BodyImpulse* impulse = nullptr;
};

/// Impulses by the pairs of a block on bodies of later blocks, in the order of the pairs.
struct OutwardImpulses {
  std::vector<std::int32_t> bodies;
  std::vector<BodyImpulse> impulses;

  void clear() {
    bodies.clear();
    impulses.clear();
  }
  void add(std::int32_t body) {
    bodies.push_back(body);
    impulses.emplace_back();
  }
  /// With the same impulses as the other blocks see them.
  [[nodiscard]] std::size_t bytes() const {
    return bodies.capacity() * (sizeof(std::int32_t) + sizeof(BodyImpulse) + sizeof(InwardImpulse));
  }
};

}  // namespace equidem
