// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/cycle.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multigrid/transfer.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

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

namespace {

Grid grid_of_discs(const Assembly& assembly, double a, double spacing) {
  double sum = 0;
  for (const Contact& contact : assembly.contacts) sum += norm(assembly.branch(contact));
  const bool periodic = assembly.periodic();
  Vec2 low = periodic ? Vec2{} : assembly.centres.front(), high = periodic ? *assembly.period : low;
  for (const Vec2 x : assembly.centres) {
    if (periodic) break;
    low = {std::min(low.x, x.x), std::min(low.y, x.y)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y)};
  }
  return grid_over({.low = low,
                    .high = high,
                    .periodic = periodic,
                    .discs = static_cast<double>(assembly.size()),
                    .distance = sum / static_cast<double>(assembly.contacts.size()),
                    .unit = a},
                   spacing);
}

/// The matrix of few discs, for elimination.
BlockMatrix matrix_of(const SpringNetwork& network, double unit) {
  const auto& [assembly, graph, springs, unknowns] = network;
  const StiffnessMatrix k = assemble_stiffness(assembly, graph, springs, unknowns);
  const int b = k.block;
  const auto scaled = [&](const double* block, bool transposed) {
    Block result{};
    for (int r = 0; r < b; ++r) {
      for (int c = 0; c < b; ++c) result[3 * r + c] = (transposed ? block[c * b + r] : block[r * b + c]) / unit;
    }
    return result;
  };
  BlockMatrix result;
  result.first.push_back(0);
  for (std::size_t d = 0; d < graph.size(); ++d) {
    result.first.push_back(result.first.back() + 1 + static_cast<std::int64_t>(graph.of(d).size()));
  }
  result.resize();
  for (std::size_t d = 0; d < graph.size(); ++d) {
    std::int64_t entry = result.first[d];
    Block diagonal = scaled(k.diagonal_block(d), false);
    for (int e = 0; e < b; ++e) {
      if (unknowns.held[d * static_cast<std::size_t>(b) + static_cast<std::size_t>(e)] != 0) diagonal[4 * e] = 0;
    }
    result.set(entry++, d, diagonal);
    for (const auto& edge : graph.of(d)) {
      const bool transposed = static_cast<std::size_t>(assembly.contacts[edge.contact].i) != d;
      result.set(entry++, static_cast<std::size_t>(edge.other), scaled(k.coupling_block(edge.contact), transposed));
    }
  }
  return result;
}

std::vector<std::int32_t> numbers_up_to(std::size_t n) {
  std::vector<std::int32_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

}  // namespace

Cycle::Cycle(const SpringNetwork& network, const CycleOptions& options) : unit_(network.springs.largest()) {
  const std::size_t discs = network.assembly.size();
  if (discs < static_cast<std::size_t>(options.direct_below)) {
    order_ = numbers_up_to(discs);
    coarsest_ = EnvelopeCholesky(matrix_of(network, unit_));
    const std::int32_t one_chunk[] = {0, static_cast<std::int32_t>(discs)};
    levels_.emplace_back();
    levels_[0].matrix = std::make_unique<GroupedRows>(network, order_, one_chunk, unit_);
    levels_[0].rows = discs;
  } else {
    build_grids(network, options);
  }
  for (Level& level : levels_) {
    for (QuadVector* vector : {&level.b, &level.x}) vector->assign(level.rows, Quad{});
    if (!level.transfer) break;
    level.other.assign(level.rows, Quad{});
    level.cells.resize(4 * level.transfer->cells());
    level.wavefront = Wavefront(level.transfer->first_points(), *level.matrix);
  }
}

void Cycle::build_grids(const SpringNetwork& network, const CycleOptions& options) {
  const auto& [assembly, graph, springs, unknowns] = network;
  const double a = unknowns.rotation_scale;
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  auto grid = std::make_unique<Grid>(grid_of_discs(assembly, a, options.spacing));
  std::vector<Place> places(assembly.size());
  std::vector<double> masses(places.size());
  constexpr std::size_t discs_at_once = 1 << 13;
  parallel_ranges(places.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      places[d] = grid->place((1 / a) * network.assembly.centres[d]);
      const auto held = network.unknowns.held.begin() + static_cast<std::ptrdiff_t>(d * b);
      masses[d] = std::all_of(held, held + 2, [](std::uint8_t h) { return h != 0; }) ? 0 : 1;
    }
  });
  masses = node_masses(*grid, places, masses);
  grid->keep_nodes(masses);
  CellStiffness cells = stiffness_of_contacts(*grid, network, unit_);
  auto transfer = std::make_unique<Transfer>(*grid, places);
  order_ = transfer->order();
  // (q_i + q_j)² <= 2 q_i² + 2 q_j² in the energy of every contact: no eigenvalue of D^-1 K exceeds 2.
  double largest = 2;
  auto matrix = std::make_unique<GroupedRows>(network, order_, transfer->first_points(), unit_);
  while (transfer) {
    stop_if_interrupted();
    Level& level = levels_.emplace_back();
    level.rows = matrix->rows();
    level.matrix = std::move(matrix);
    level.grid = std::exchange(grid, nullptr);
    level.transfer = std::exchange(transfer, nullptr);
    level.before = chebyshev_steps(options.degree, largest, options.range, true);
    level.after = chebyshev_steps(options.degree, largest, options.range, false);
    const Grid& here = *level.grid;
    CellStiffness coarser_cells;
    if (here.divisible()) {
      grid = std::make_unique<Grid>(here.coarser());
      places.clear();
      std::vector<double> masses_of_kept;
      for (std::size_t node = 0; node < here.nodes(); ++node) {
        if (!here.kept(node)) continue;
        places.push_back(grid->place(here.position(node)));
        masses_of_kept.push_back(masses[node]);
      }
      masses = node_masses(*grid, places, masses_of_kept);
      grid->keep_nodes(masses);
      transfer = std::make_unique<Transfer>(*grid, places);
      coarser_cells = stiffness_on_coarser(*grid, here, cells);
    }
    level.transfer->number_nodes(transfer ? transfer->order() : order_along(here));
    const BlockMatrix of_nodes = assemble_cells(*level.transfer, cells);
    cells = std::move(coarser_cells);
    if (transfer) {
      constexpr int iterations = 10;
      constexpr double margin = 1.1;  // power iteration approaches from below
      matrix = std::make_unique<GroupedRows>(of_nodes, transfer->first_points());
      largest = margin * largest_eigenvalue(*matrix, iterations);
    } else {
      coarsest_ = EnvelopeCholesky(of_nodes);
      levels_.emplace_back().rows = of_nodes.rows();
    }
  }
}

void Cycle::correct(std::size_t number) {
  Level& level = levels_[number];
  if (number + 1 == levels_.size()) {
    coarsest_.solve(level.b, level.x);
    return;
  }
  Level& above = levels_[number + 1];
  const int degree = static_cast<int>(level.before.size());
  Quad* const vectors[] = {level.x.data(), level.other.data()};  // step s writes into vectors[s % 2]
  level.wavefront.run(degree + 1, [&](int step, std::size_t chunk) {
    const RowRange rows = level.wavefront.rows(chunk);
    Quad *const from = vectors[(step + 1) % 2], *const to = vectors[step % 2];
    if (step == 0) {
      level.matrix->start(rows, level.before[0].add, level.b.data(), to);
    } else if (step < degree) {
      level.matrix->advance(rows, level.before[step], level.b.data(), from, to);
    } else {
      level.matrix->residual(rows, level.b.data(), from, to);
      level.transfer->restrict_chunk(chunk, to, level.cells);
    }
  });
  level.transfer->add_up_corners(level.cells, above.b);
  correct(number + 1);
  if (degree % 2 == 0) std::swap(level.x, level.other);
  Quad* const following[] = {level.x.data(), level.other.data()};
  level.wavefront.run(degree + 1, [&](int step, std::size_t chunk) {
    Quad *const from = following[(step + 1) % 2], *const to = following[step % 2];
    const RowRange rows = level.wavefront.rows(chunk);
    if (step == 0) {
      level.transfer->add_motions(chunk, above.x, to);
      level.matrix->hold(rows, to);
    } else {
      level.matrix->advance(rows, level.after[step - 1], level.b.data(), from, to);
    }
  });
  if (degree % 2 == 1) std::swap(level.x, level.other);
}

const Quad* Cycle::solve() {
  correct(0);
  return levels_[0].x.data();
}

double Cycle::multiply(const double* p, double* q) const {
  const Wavefront& wavefront = levels_[0].wavefront;
  if (wavefront.chunks() == 0) return levels_[0].matrix->multiply({0, levels_[0].matrix->rows()}, p, q);
  std::vector<double> sums(wavefront.chunks());
  parallel_tasks(sums.size(), [&](std::size_t chunk, int) {
    sums[chunk] = levels_[0].matrix->multiply(wavefront.rows(chunk), p, q);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double Cycle::bytes() const {
  double sum = coarsest_.bytes() + 4.0 * static_cast<double>(order_.size());
  for (const Level& level : levels_) {
    if (level.matrix) sum += level.matrix->bytes();
    sum += 16.0 * static_cast<double>(3 * level.x.size() + level.cells.size());
    if (level.transfer) sum += level.transfer->bytes();
  }
  return sum;
}

}  // namespace equidem::multigrid
