// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/grouped_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multigrid/kernels/row_kernel.hpp"

namespace equidem::multigrid {
namespace {

constexpr std::size_t groups_at_once = 1 << 9;

bool any_offset(const Assembly& assembly) {
  return std::any_of(assembly.contact_arms.begin(), assembly.contact_arms.end(),
                     [](const ContactArms& arms) { return arms.offset_i != 0 || arms.offset_j != 0; });
}

/// Slots of the contacts of a disc: one of the disc with its own image has both of its ends there.
std::size_t slots_of(const ContactGraph& graph, std::size_t disc) {
  std::size_t slots = 0;
  for (const auto& edge : graph.of(disc)) slots += static_cast<std::size_t>(edge.other) == disc ? 2 : 1;
  return slots;
}

}  // namespace

GroupedRows::GroupedRows(const SpringNetwork& network, std::span<const std::int32_t> order,
                         std::span<const std::int32_t> first_row, double unit)
    : kind_{.rotation = network.unknowns.per_disc == 3,
            .offsets = network.unknowns.per_disc == 3 && any_offset(network.assembly),
            .own_springs = !network.springs.uniform(),
            .bending = network.unknowns.per_disc == 3 && network.springs.bends()},
      functions_(&row_functions(kind_)) {
  if (!kind_.own_springs) {
    const SpringConstants k = network.springs[0];
    kN_ = static_cast<float>(k.kN / unit);
    kT_ = static_cast<float>(k.kT / unit);
  }
  const auto b = static_cast<std::ptrdiff_t>(network.unknowns.per_disc);
  lay_out(
      first_row, [&](std::size_t row) { return slots_of(network.graph, static_cast<std::size_t>(order[row])); },
      [&](std::size_t row) {
        const auto held = network.unknowns.held.begin() + b * order[row];
        return std::any_of(held, held + b, [](std::uint8_t h) { return h != 0; });
      });
  std::vector<std::int32_t> row_of(order.size());
  for (std::size_t row = 0; row < order.size(); ++row) row_of[order[row]] = static_cast<std::int32_t>(row);
  parallel_ranges(free_.size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t group = begin; group < end; ++group) fill(network, order, row_of, group, unit);
  });
}

GroupedRows::GroupedRows(const BlockMatrix& matrix, std::span<const std::int32_t> first_row)
    : kind_{.blocks = true}, functions_(&row_functions(kind_)) {
  lay_out(
      first_row, [&](std::size_t row) { return static_cast<std::size_t>(matrix.first[row + 1] - matrix.first[row]); },
      [](std::size_t) { return false; });
  parallel_ranges(free_.size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t number = begin; number < end; ++number) {
      clear(number);
      const Group here = group(number);
      for (std::size_t lane = 0; lane < here.rows; ++lane) {
        const std::size_t row = here.first_row + lane;
        auto slot = static_cast<std::size_t>(first_slot_[number]);
        for (std::int64_t e = matrix.first[row]; e < matrix.first[row + 1]; ++e, ++slot) {
          other_[slot * lanes + lane] = matrix.columns[e];
          for (std::size_t k = 0; k < 9; ++k) {
            geometry_[(slot * 9 + k) * lanes + lane] = matrix.blocks[9 * e + 3 * (k % 3) + k / 3];
          }
        }
        set_inverse(number, lane, [&](std::size_t k) { return matrix.inverse[9 * row + k]; });
      }
    }
  });
}

template <typename Slots, typename Held>
void GroupedRows::lay_out(std::span<const std::int32_t> first_row, const Slots& slots_of, const Held& any_held) {
  for (std::size_t chunk = 0; chunk + 1 < first_row.size(); ++chunk) {
    for (std::int32_t row = first_row[chunk]; row < first_row[chunk + 1]; row += static_cast<std::int32_t>(lanes)) {
      first_row_.push_back(row);
    }
  }
  free_.resize(first_row_.size());
  first_slot_.resize(first_row_.size() + 1, 0);
  first_row_.push_back(first_row.back());
  parallel_ranges(free_.size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t group = begin; group < end; ++group) {
      std::size_t slots = 0;
      bool held = false;
      for (std::int32_t row = first_row_[group]; row < first_row_[group + 1]; ++row) {
        slots = std::max(slots, slots_of(static_cast<std::size_t>(row)));
        held = held || any_held(static_cast<std::size_t>(row));
      }
      first_slot_[group + 1] = static_cast<std::int64_t>(slots);
      free_[group] = held ? 0 : -1;
    }
  });
  std::int32_t masks = 0;
  for (std::size_t group = 0; group < free_.size(); ++group) {
    first_slot_[group + 1] += first_slot_[group];
    if (free_[group] >= 0) free_[group] = masks++;
  }
  masks_.resize(static_cast<std::size_t>(masks) * 3 * lanes, 1.0F);
  const auto slots = static_cast<std::size_t>(first_slot_.back());
  other_.resize(slots * lanes);
  geometry_.resize(slots * lanes * static_cast<std::size_t>(kind_.fields()));
  inverse_.resize(free_.size() * 6 * lanes);
}

void GroupedRows::clear(std::size_t number) {
  const auto slot = static_cast<std::ptrdiff_t>(first_slot_[number] * static_cast<std::int64_t>(lanes));
  const std::size_t entries = static_cast<std::size_t>(first_slot_[number + 1] - first_slot_[number]) * lanes;
  std::fill_n(other_.begin() + slot, entries, first_row_[number]);
  std::fill_n(geometry_.begin() + slot * kind_.fields(), entries * static_cast<std::size_t>(kind_.fields()), 0.0F);
  std::fill_n(inverse_.begin() + static_cast<std::ptrdiff_t>(number * 6 * lanes), 6 * lanes, 0.0F);
}

template <typename Entry>
void GroupedRows::set_inverse(std::size_t number, std::size_t lane, const Entry& entry) {
  constexpr std::size_t lower[] = {0, 3, 4, 6, 7, 8};
  for (std::size_t e = 0; e < 6; ++e) {
    inverse_[(number * 6 + e) * lanes + lane] = static_cast<float>(entry(lower[e]));
  }
}

void GroupedRows::fill(const SpringNetwork& network, std::span<const std::int32_t> order,
                       const std::vector<std::int32_t>& row_of, std::size_t group, double unit) {
  const auto b = static_cast<std::size_t>(network.unknowns.per_disc);
  const auto first_slot = static_cast<std::size_t>(first_slot_[group]);
  const auto first_row = static_cast<std::size_t>(first_row_[group]);
  const std::size_t rows = static_cast<std::size_t>(first_row_[group + 1]) - first_row;
  clear(group);
  for (std::size_t lane = 0; lane < rows; ++lane) {
    const auto disc = static_cast<std::size_t>(order[first_row + lane]);
    std::size_t slot = first_slot;
    Block diagonal{};
    for (const auto& edge : network.graph.of(disc)) {
      const auto contact = static_cast<std::size_t>(edge.contact);
      const Contact& c = network.assembly.contacts[contact];
      const double scale = network.unknowns.rotation_scale;
      const ContactFrame frame = frame_of(network.assembly, contact);
      ContactStiffness k = contact_stiffness(network.springs, contact, frame, scale);
      k.divide(unit);
      for (const bool from_i : {true, false}) {
        if (static_cast<std::size_t>(from_i ? c.i : c.j) != disc) continue;
        fill_slot(frame, k, from_i, slot, lane);
        other_[slot * lanes + lane] = row_of[edge.other];
        ++slot;
      }
      const auto add = [&](const EndGradient& end) { k.add<3>(end, end, diagonal.data()); };
      if (c.i == c.j) {
        add(k.ends.as_one(1));
      } else {
        add(static_cast<std::size_t>(c.i) == disc ? k.ends.i : k.ends.j);
      }
    }
    for (std::size_t e = 0; e < 3; ++e) {
      const bool is_held = e < b && network.unknowns.held[disc * b + e] != 0;
      if (is_held) masks_[static_cast<std::size_t>(free_[group]) * 3 * lanes + e * lanes + lane] = 0;
      if (e < b && !is_held) continue;
      for (std::size_t f = 0; f < 3; ++f) diagonal[3 * e + f] = diagonal[3 * f + e] = 0;
    }
    const Block of_disc = inverse_or_zero(diagonal);
    set_inverse(group, lane, [&](std::size_t e) { return of_disc[e]; });
  }
}

void GroupedRows::fill_slot(const ContactFrame& frame, const ContactStiffness& k, bool from_i, std::size_t slot,
                            std::size_t lane) {
  const double scale = k.rotation_scale;
  float* place = &geometry_[slot * lanes * static_cast<std::size_t>(kind_.fields()) + lane];
  const auto put = [&](double value) {
    *place = static_cast<float>(value);
    place += lanes;
  };
  put(from_i ? frame.normal.x : -frame.normal.x);
  put(from_i ? frame.normal.y : -frame.normal.y);
  if (kind_.rotation) {
    put((from_i ? frame.lever_i : frame.lever_j) / scale);
    put((from_i ? frame.lever_j : frame.lever_i) / scale);
  }
  if (kind_.offsets) {
    put((from_i ? frame.offset_i : frame.offset_j) / scale);
    put((from_i ? frame.offset_j : frame.offset_i) / scale);
  }
  if (kind_.own_springs) {
    put(k.kN);
    put(k.kT);
  }
  if (kind_.bending) put(k.kM);
}

GroupedRows::Groups GroupedRows::groups_of(RowRange rows) const {
  const auto at = [&](std::size_t row) {
    return static_cast<std::size_t>(
        std::lower_bound(first_row_.begin(), first_row_.end(), static_cast<std::int32_t>(row)) - first_row_.begin());
  };
  return {at(rows.begin), at(rows.end)};
}

RowRange GroupedRows::reach(RowRange rows) const {
  const auto [first, last] = groups_of(rows);
  RowRange result = rows;
  for (auto k = static_cast<std::size_t>(first_slot_[first]) * lanes;
       k < static_cast<std::size_t>(first_slot_[last]) * lanes; ++k) {
    const auto other = static_cast<std::size_t>(other_[k]);
    result = {std::min(result.begin, other), std::max(result.end, other + 1)};
  }
  return result;
}

void GroupedRows::start(RowRange rows, float factor, const Quad* b, Quad* x) const {
  const auto [first, last] = groups_of(rows);
  functions_->start(*this, first, last, factor, b, x);
}

void GroupedRows::advance(RowRange rows, const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) const {
  const auto [first, last] = groups_of(rows);
  functions_->advance(*this, first, last, step, b, x, next);
}

void GroupedRows::hold(RowRange rows, Quad* x) const {
  const auto [first, last] = groups_of(rows);
  for (std::size_t number = first; number < last; ++number) {
    const Group here = group(number);
    if (here.free == nullptr) continue;
    for (std::size_t lane = 0; lane < here.rows; ++lane) {
      const auto free = [&](std::size_t e) { return here.free[e * lanes + lane]; };
      x[here.first_row + lane] *= Quad{free(0), free(1), free(2), 0};
    }
  }
}

void GroupedRows::residual(RowRange rows, const Quad* b, const Quad* x, Quad* r) const {
  const auto [first, last] = groups_of(rows);
  functions_->residual(*this, first, last, b, x, r);
}

double GroupedRows::multiply(RowRange rows, const double* p, double* q) const {
  const auto [first, last] = groups_of(rows);
  return functions_->multiply(*this, first, last, p, q);
}

double GroupedRows::bytes() const {
  return 4.0 * static_cast<double>(other_.size() + geometry_.size() + inverse_.size() + masks_.size()) +
         16.0 * static_cast<double>(free_.size());
}

void residual(const GroupedRows& a, const QuadVector& b, const QuadVector& x, QuadVector& r) {
  parallel_ranges(a.groups(), groups_at_once, [&](std::size_t first, std::size_t last) {
    a.residual(a.rows_of(first, last), b.data(), x.data(), r.data());
  });
}

double largest_eigenvalue(const GroupedRows& a, int iterations) {
  const std::size_t n = a.rows();
  QuadVector zero(n, Quad{}), x(n), product(n);
  Random random(1);
  for (Quad& row : x) {
    const auto number = [&] { return static_cast<float>(random.uniform() - 0.5); };
    row = Quad{number(), number(), number(), 0};
  }
  constexpr ChebyshevStep subtract{.add = -1};
  double value = 0;
  for (int k = 0; k < iterations; ++k) {
    const auto [before, after] = sums_over<2>(a.groups(), groups_at_once, [&](std::size_t first, std::size_t last) {
      const RowRange rows = a.rows_of(first, last);
      a.advance(rows, subtract, zero.data(), x.data(), product.data());  // x + D^-1 A x
      std::array<double, 2> squares{};
      for (std::size_t row = rows.begin; row < rows.end; ++row) {
        product[row] -= x[row];
        for (int c = 0; c < 3; ++c) {
          squares[0] += static_cast<double>(x[row][c]) * x[row][c];
          squares[1] += static_cast<double>(product[row][c]) * product[row][c];
        }
      }
      return squares;
    });
    if (!(before > 0 && after > 0)) return value;
    value = std::sqrt(after / before);
    const auto scale = static_cast<float>(1 / std::sqrt(after));
    for (std::size_t row = 0; row < n; ++row) x[row] = scale * product[row];
  }
  return value;
}

}  // namespace equidem::multigrid
