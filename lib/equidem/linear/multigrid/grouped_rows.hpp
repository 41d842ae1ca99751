// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Symmetric matrices as products with them read them: rows in groups whose members are lanes of a vector.
///
/// The matrix of the discs is not stored. Each of its rows sums the forces of its contacts, f_i = sum kN dn g + kT ds
/// h, with the derivatives g of stretch and h of slip in single precision. As stretch and slip come from differences of
/// motions, rounding of g and h changes the energy of every motion by a factor near 1, whatever the condition of the
/// matrix.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/contact/frame.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multigrid/block_matrix.hpp"

namespace equidem::multigrid {

/// A slot of a row holds a block, or a contact with those components of the contact law that the assembly needs.
struct RowKind {
  bool blocks = false;
  bool rotation = false;     ///< discs turn
  bool offsets = false;      ///< contacts lie off the lines of centres
  bool own_springs = false;  ///< springs differ from contact to contact
  bool bending = false;      ///< contacts resist the relative rotation of their discs

  /// Numbers of a slot and lane: the block by rows; or the normal, levers, offsets, springs, the bending spring.
  [[nodiscard]] constexpr int fields() const {
    if (blocks) return 9;
    return 2 + (rotation ? 2 : 0) + (offsets ? 2 : 0) + (own_springs ? 2 : 0) + (bending ? 1 : 0);
  }
  bool operator==(const RowKind&) const = default;
};

/// A group has as many slots as its longest row has entries; lanes without an entry there have zeros.
class GroupedRows {
 public:
  static constexpr std::size_t lanes = 8;

  /// The stiffness matrix of discs.
  /// \param order the disc of each row
  /// \param first_row of each chunk, and their number at the end: no group crosses from one chunk into the next
  /// \param unit Pa, by which stiffnesses are divided
  GroupedRows(const SpringNetwork& network, std::span<const std::int32_t> order,
              std::span<const std::int32_t> first_row, double unit);
  GroupedRows(const BlockMatrix& matrix, std::span<const std::int32_t> first_row);

  [[nodiscard]] std::size_t rows() const { return static_cast<std::size_t>(first_row_.back()); }
  [[nodiscard]] std::size_t groups() const { return free_.size(); }
  [[nodiscard]] RowRange rows_of(std::size_t first_group, std::size_t last_group) const {
    return {static_cast<std::size_t>(first_row_[first_group]), static_cast<std::size_t>(first_row_[last_group])};
  }

  // The following write the rows of a range of whole groups.

  /// The smallest range that holds the columns of these rows and the rows themselves.
  [[nodiscard]] RowRange reach(RowRange rows) const;
  /// x = factor D^-1 b, D the diagonal blocks.
  void start(RowRange rows, float factor, const Quad* b, Quad* x) const;
  void advance(RowRange rows, const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) const;
  /// x = 0 where it is held.
  void hold(RowRange rows, Quad* x) const;
  /// r = b - A x.
  void residual(RowRange rows, const Quad* b, const Quad* x, Quad* r) const;
  [[nodiscard]] double bytes() const;
  /// q = A p in double precision, rows x 3; returns p.q over these rows.
  /// \param p has one number more behind the last row
  double multiply(RowRange rows, const double* p, double* q) const;

  /// Data of a group as kernels read them.
  struct Group {
    std::size_t first_row, rows;  ///< rows <= lanes
    std::size_t slots;
    const std::int32_t* other;  ///< slots x lanes: the row at the other end
    const float* geometry;      ///< slots x fields x lanes: n_x, n_y[, lever, lever of the other][, offset, offset
                            ///< of the other][, kN, kT][, kM], or a block by rows; lengths over the scale of rotations,
                            ///< kM over its square
    const float* inverse;  ///< 6 x lanes: lower triangle of the inverse of the diagonal block
    const float* free;     ///< 3 x lanes: 1 where the component is not held, else 0; null: all are free
  };
  [[nodiscard]] Group group(std::size_t number) const {
    const auto row = static_cast<std::size_t>(first_row_[number]), slot = static_cast<std::size_t>(first_slot_[number]);
    return {.first_row = row,
            .rows = static_cast<std::size_t>(first_row_[number + 1]) - row,
            .slots = static_cast<std::size_t>(first_slot_[number + 1]) - slot,
            .other = other_.data() + slot * lanes,
            .geometry = geometry_.data() + slot * lanes * static_cast<std::size_t>(kind_.fields()),
            .inverse = inverse_.data() + number * 6 * lanes,
            .free = free_[number] < 0 ? nullptr : masks_.data() + static_cast<std::size_t>(free_[number]) * 3 * lanes};
  }
  [[nodiscard]] float normal_spring() const { return kN_; }
  [[nodiscard]] float tangential_spring() const { return kT_; }

 private:
  struct Groups {
    std::size_t first, last;
  };
  [[nodiscard]] Groups groups_of(RowRange rows) const;
  template <typename Slots, typename Held>
  void lay_out(std::span<const std::int32_t> first_row, const Slots& slots_of, const Held& any_held);
  void clear(std::size_t number);
  template <typename Entry>
  void set_inverse(std::size_t number, std::size_t lane, const Entry& entry);
  void fill(const SpringNetwork& network, std::span<const std::int32_t> order, const std::vector<std::int32_t>& row_of,
            std::size_t group, double unit);
  void fill_slot(const ContactFrame& frame, const ContactStiffness& k, bool from_i, std::size_t slot, std::size_t lane);

  RowKind kind_;
  float kN_ = 0, kT_ = 0;                 // over the unit, where all contacts have the same
  std::vector<std::int32_t> first_row_;   // groups + 1
  std::vector<std::int64_t> first_slot_;  // groups + 1
  std::vector<std::int32_t> free_;        // per group: into masks_, or -1
  LargeVector<std::int32_t> other_;
  LargeVector<float> geometry_, inverse_;
  std::vector<float> masks_;
  const struct RowFunctions* functions_;
};

/// r = b - A x over all rows.
void residual(const GroupedRows& a, const QuadVector& b, const QuadVector& x, QuadVector& r);

/// The largest eigenvalue of D^-1 A, D the diagonal blocks, by power iteration: a few per cent too small.
double largest_eigenvalue(const GroupedRows& a, int iterations);

}  // namespace equidem::multigrid
