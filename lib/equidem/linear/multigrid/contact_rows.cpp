// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/linear/multigrid/contact_rows.hpp"

#include <algorithm>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multigrid/kernels/contact_kernel.hpp"

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

void add_square(double k, const std::array<double, 3>& g, Block& block) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) block[3 * r + c] += k * g[r] * g[c];
  }
}

}  // namespace

ContactRows::ContactRows(const SpringNetwork& network, std::span<const std::int32_t> order,
                         std::span<const std::int32_t> first_row, double unit)
    : kind_{.rotation = network.unknowns.per_disc == 3,
            .offsets = network.unknowns.per_disc == 3 && any_offset(network.assembly),
            .own_springs = !network.springs.uniform()},
      functions_(&row_functions(kind_)) {
  if (!kind_.own_springs) {
    const SpringConstants k = network.springs[0];
    kN_ = static_cast<float>(k.kN / unit);
    kT_ = static_cast<float>(k.kT / unit);
  }
  lay_out(network, order, first_row);
  std::vector<std::int32_t> row_of(order.size());
  for (std::size_t row = 0; row < order.size(); ++row) row_of[order[row]] = static_cast<std::int32_t>(row);
  parallel_ranges(first_row_.size() - 1, groups_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t group = begin; group < end; ++group) fill(network, order, row_of, group, unit);
  });
}

void ContactRows::lay_out(const SpringNetwork& network, std::span<const std::int32_t> order,
                          std::span<const std::int32_t> first_row) {
  const auto b = static_cast<std::size_t>(network.unknowns.per_disc);
  const auto& held = network.unknowns.held;
  first_row_.push_back(0);
  first_slot_.push_back(0);
  for (std::size_t chunk = 0; chunk + 1 < first_row.size(); ++chunk) {
    for (std::int32_t row = first_row[chunk]; row < first_row[chunk + 1];) {
      const std::int32_t end = std::min<std::int32_t>(row + static_cast<std::int32_t>(lanes), first_row[chunk + 1]);
      std::size_t slots = 0;
      bool any_held = false;
      for (; row < end; ++row) {
        const auto disc = static_cast<std::size_t>(order[row]);
        slots = std::max(slots, slots_of(network.graph, disc));
        for (std::size_t e = 0; e < b; ++e) any_held = any_held || held[disc * b + e] != 0;
      }
      first_row_.push_back(row);
      first_slot_.push_back(first_slot_.back() + static_cast<std::int64_t>(slots));
      free_.push_back(any_held ? static_cast<std::int32_t>(masks_.size() / (3 * lanes)) : -1);
      if (any_held) masks_.resize(masks_.size() + 3 * lanes, 1.0F);
    }
  }
  const auto slots = static_cast<std::size_t>(first_slot_.back());
  other_.resize(slots * lanes);
  geometry_.resize(slots * lanes * static_cast<std::size_t>(kind_.fields()));
  inverse_.resize(free_.size() * 6 * lanes);
}

void ContactRows::fill(const SpringNetwork& network, std::span<const std::int32_t> order,
                       const std::vector<std::int32_t>& row_of, std::size_t group, double unit) {
  const auto b = static_cast<std::size_t>(network.unknowns.per_disc);
  const auto fields = static_cast<std::size_t>(kind_.fields());
  const auto first_slot = static_cast<std::size_t>(first_slot_[group]), end = static_cast<std::size_t>(first_slot_[group + 1]);
  const auto first_row = static_cast<std::size_t>(first_row_[group]);
  const std::size_t rows = static_cast<std::size_t>(first_row_[group + 1]) - first_row;
  std::fill(&other_[first_slot * lanes], &other_[first_slot * lanes] + (end - first_slot) * lanes,
            static_cast<std::int32_t>(first_row));
  std::fill_n(geometry_.begin() + static_cast<std::ptrdiff_t>(first_slot * lanes * fields),
              (end - first_slot) * lanes * fields, 0.0F);
  float* inverse = &inverse_[group * 6 * lanes];
  std::fill(inverse, inverse + 6 * lanes, 0.0F);
  for (std::size_t lane = 0; lane < rows; ++lane) {
    const auto disc = static_cast<std::size_t>(order[first_row + lane]);
    std::size_t slot = first_slot;
    Block diagonal{};
    for (const auto& edge : network.graph.of(disc)) {
      const auto contact = static_cast<std::size_t>(edge.contact);
      const Contact& c = network.assembly.contacts[contact];
      const SpringConstants k = network.springs[contact];
      const DeformationGradient g =
          deformation_gradient(frame_of(network.assembly, contact), network.unknowns.rotation_scale);
      std::array<double, 3> normal{}, tangential{};
      for (const bool from_i : {true, false}) {
        if (static_cast<std::size_t>(from_i ? c.i : c.j) != disc) continue;
        fill_slot(network, contact, from_i, slot, lane, unit);
        other_[slot * lanes + lane] = row_of[edge.other];
        ++slot;
        for (std::size_t e = 0; e < 3; ++e) {
          normal[e] += (from_i ? g.normal_i : g.normal_j)[e];
          tangential[e] += (from_i ? g.tangential_i : g.tangential_j)[e];
        }
      }
      add_square(k.kN / unit, normal, diagonal);
      add_square(k.kT / unit, tangential, diagonal);
    }
    for (std::size_t e = 0; e < 3; ++e) {
      const bool is_held = e < b && network.unknowns.held[disc * b + e] != 0;
      if (is_held) masks_[static_cast<std::size_t>(free_[group]) * 3 * lanes + e * lanes + lane] = 0;
      if (e < b && !is_held) continue;
      for (std::size_t f = 0; f < 3; ++f) diagonal[3 * e + f] = diagonal[3 * f + e] = 0;
    }
    const Block of_disc = inverse_or_zero(diagonal);
    constexpr int lower[] = {0, 3, 4, 6, 7, 8};
    for (std::size_t e = 0; e < 6; ++e) inverse[e * lanes + lane] = static_cast<float>(of_disc[lower[e]]);
  }
}

void ContactRows::fill_slot(const SpringNetwork& network, std::size_t contact, bool from_i, std::size_t slot,
                            std::size_t lane, double unit) {
  const ContactFrame frame = frame_of(network.assembly, contact);
  const double a = network.unknowns.rotation_scale;
  float* place = &geometry_[slot * lanes * static_cast<std::size_t>(kind_.fields()) + lane];
  const auto put = [&](double value) {
    *place = static_cast<float>(value);
    place += lanes;
  };
  put(from_i ? frame.normal.x : -frame.normal.x);
  put(from_i ? frame.normal.y : -frame.normal.y);
  if (kind_.rotation) {
    put((from_i ? frame.lever_i : frame.lever_j) / a);
    put((from_i ? frame.lever_j : frame.lever_i) / a);
  }
  if (kind_.offsets) {
    put((from_i ? frame.offset_i : frame.offset_j) / a);
    put((from_i ? frame.offset_j : frame.offset_i) / a);
  }
  if (kind_.own_springs) {
    put(network.springs[contact].kN / unit);
    put(network.springs[contact].kT / unit);
  }
}

ContactRows::Groups ContactRows::groups_of(RowRange rows) const {
  const auto at = [&](std::size_t row) {
    return static_cast<std::size_t>(
        std::lower_bound(first_row_.begin(), first_row_.end(), static_cast<std::int32_t>(row)) - first_row_.begin());
  };
  return {at(rows.begin), at(rows.end)};
}

RowRange ContactRows::reach(RowRange rows) const {
  const auto [first, last] = groups_of(rows);
  RowRange result = rows;
  for (auto k = static_cast<std::size_t>(first_slot_[first]) * lanes;
       k < static_cast<std::size_t>(first_slot_[last]) * lanes; ++k) {
    const auto other = static_cast<std::size_t>(other_[k]);
    result = {std::min(result.begin, other), std::max(result.end, other + 1)};
  }
  return result;
}

void ContactRows::start(RowRange rows, float factor, const Quad* b, Quad* x) const {
  const auto [first, last] = groups_of(rows);
  functions_->start(*this, first, last, factor, b, x);
}

void ContactRows::advance(RowRange rows, const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) const {
  const auto [first, last] = groups_of(rows);
  functions_->advance(*this, first, last, step, b, x, next);
}

void ContactRows::hold(RowRange rows, Quad* x) const {
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

void ContactRows::residual(RowRange rows, const Quad* b, const Quad* x, Quad* r) const {
  const auto [first, last] = groups_of(rows);
  functions_->residual(*this, first, last, b, x, r);
}

double ContactRows::multiply(RowRange rows, const double* p, double* q) const {
  const auto [first, last] = groups_of(rows);
  return functions_->multiply(*this, first, last, p, q);
}

double ContactRows::bytes() const {
  return 4.0 * static_cast<double>(other_.size() + geometry_.size() + inverse_.size() + masks_.size()) +
         16.0 * static_cast<double>(free_.size());
}

}  // namespace equidem::multigrid
