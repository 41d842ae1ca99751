// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/wavefront.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "equidem/core/threads.hpp"

namespace equidem::multigrid {

Wavefront::Wavefront(std::vector<std::int32_t> first_row, const GroupedRows& matrix)
    : first_row_(std::move(first_row)), neighbours_(first_row_.size() - 1) {
  const auto chunk_of = [&](std::size_t row) {
    const auto after = std::upper_bound(first_row_.begin(), first_row_.end(), static_cast<std::int32_t>(row));
    return static_cast<std::int32_t>(after - first_row_.begin()) - 1;
  };
  constexpr std::size_t chunks_at_once = 8;
  parallel_ranges(chunks(), chunks_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      const RowRange reach = matrix.reach(rows(chunk));
      neighbours_[chunk] = {chunk_of(reach.begin), chunk_of(reach.end - 1) + 1};
    }
  });
  for (std::size_t chunk = 0; chunk < chunks(); ++chunk) {
    farthest_ = std::max({farthest_, chunk - static_cast<std::size_t>(neighbours_[chunk].first),
                          static_cast<std::size_t>(neighbours_[chunk].last) - 1 - chunk});
  }
}

/// One run. Segments of chunks go ahead side by side as far as they need no chunk of another segment, which leaves the
/// chunks around their ends behind by up to `steps`; these follow in a second round, end by end.
class Wavefront::Run {
 public:
  Run(const Wavefront& wavefront, int steps, const std::function<void(int step, std::size_t chunk)>& body)
      : wavefront_(wavefront), steps_(steps), body_(body), taken_(wavefront.chunks(), 0) {}

  void all() {
    const std::size_t chunks = taken_.size();
    // Half of a segment and more lies beyond the reach of its ends.
    const std::size_t least = 2 * static_cast<std::size_t>(steps_) * (wavefront_.farthest_ + 1) + 2;
    const std::size_t segments = std::clamp<std::size_t>(chunks / least, 1, static_cast<std::size_t>(thread_count()));
    const auto end_of = [&](std::size_t segment) { return segment * chunks / segments; };
    const auto middle_of = [&](std::size_t segment) { return (2 * segment + 1) * chunks / (2 * segments); };
    parallel_tasks(segments, [&](std::size_t segment, int) { advance(end_of(segment), end_of(segment + 1), false); });
    if (segments == 1) return;
    parallel_tasks(segments - 1, [&](std::size_t end, int) { advance(middle_of(end), middle_of(end + 1), true); });
    assert(std::all_of(taken_.begin(), taken_.end(), [&](std::uint8_t taken) { return taken == steps_; }));
  }

 private:
  enum class State { ready, waits, never };

  /// \param across whether chunks outside of [begin, end) have taken all steps, else none
  /// \param before the next chunk to take the step before this one; those before it that have not taken it never will
  [[nodiscard]] State state(std::size_t chunk, int step, std::size_t begin, std::size_t end, bool across,
                            std::size_t before) const {
    const auto low = static_cast<std::size_t>(wavefront_.neighbours_[chunk].first);
    const auto high = static_cast<std::size_t>(wavefront_.neighbours_[chunk].last);
    if (!across && (low < begin || high > end)) return State::never;
    for (std::size_t other = std::max(low, begin); other < std::min(high, end); ++other) {
      if (taken_[other] < step) return other < before ? State::never : State::waits;
    }
    return State::ready;
  }

  void advance(std::size_t begin, std::size_t end, bool across) {
    std::vector<std::size_t> next(steps_, begin);  // chunk, by step
    for (bool moved = true; moved;) {
      moved = false;
      for (int step = steps_; step-- > 0;) {
        while (next[step] < end && !(step == 0 && moved)) {
          const std::size_t chunk = next[step];
          if (taken_[chunk] <= step) {
            const State now = step == 0 ? State::ready : state(chunk, step, begin, end, across, next[step - 1]);
            if (now == State::waits) break;
            if (now == State::ready) {
              body_(step, chunk);
              taken_[chunk] = static_cast<std::uint8_t>(step + 1);
            }
          }
          ++next[step];
          moved = true;
        }
      }
    }
  }

  const Wavefront& wavefront_;
  const int steps_;
  const std::function<void(int step, std::size_t chunk)>& body_;
  std::vector<std::uint8_t> taken_;  // steps of each chunk
};

void Wavefront::run(int steps, const std::function<void(int step, std::size_t chunk)>& body) const {
  Run(*this, steps, body).all();
}

}  // namespace equidem::multigrid
