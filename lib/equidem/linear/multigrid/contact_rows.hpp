// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The stiffness matrix of an assembly as products with it read it: by discs, from the deformation of each contact.
///
/// Every row sums the forces of its contacts, f_i = sum kN dn g + kT ds h, with the derivatives g of stretch and h of
/// slip in single precision. As stretch and slip come from differences of motions, rounding of g and h changes the
/// energy of every motion by a factor near 1, whatever the condition of the matrix.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "equidem/linear/large_buffer.hpp"
#include "equidem/linear/multigrid/block_matrix.hpp"
#include "equidem/linear/spring_network.hpp"

namespace equidem::multigrid {

/// Components of the contact law that the rows of an assembly need.
struct RowKind {
  bool rotation = true;      ///< discs turn
  bool offsets = false;      ///< contacts lie off the lines of centres
  bool own_springs = false;  ///< springs differ from contact to contact

  /// Numbers of a slot and lane: the normal, levers, offsets, springs.
  [[nodiscard]] constexpr int fields() const {
    return 2 + (rotation ? 2 : 0) + (offsets ? 2 : 0) + (own_springs ? 2 : 0);
  }
  bool operator==(const RowKind&) const = default;
};

/// Rows in groups of up to `lanes`, which are lanes of a vector. A group has as many slots as its longest row has
/// contacts; lanes without a contact there have springs of zero.
class ContactRows final : public SmoothedMatrix {
 public:
  static constexpr std::size_t lanes = 8;

  /// \param order the disc of each row
  /// \param first_row of each chunk, and their number at the end: no group crosses from one chunk into the next
  /// \param unit Pa, by which stiffnesses are divided
  ContactRows(const SpringNetwork& network, std::span<const std::int32_t> order,
              std::span<const std::int32_t> first_row, double unit);

  [[nodiscard]] std::size_t rows() const override { return static_cast<std::size_t>(first_row_.back()); }
  [[nodiscard]] RowRange reach(RowRange rows) const override;
  void start(RowRange rows, float factor, const Quad* b, Quad* x) const override;
  void advance(RowRange rows, const ChebyshevStep& step, const Quad* b, const Quad* x, Quad* next) const override;
  void hold(RowRange rows, Quad* x) const override;
  void residual(RowRange rows, const Quad* b, const Quad* x, Quad* r) const override;
  [[nodiscard]] double bytes() const override;
  /// q = K p over the unit in double precision, rows x 3; returns p.q over these rows.
  /// \param p has one number more behind the last row
  double multiply(RowRange rows, const double* p, double* q) const;

  /// Data of a group as kernels read them.
  struct Group {
    std::size_t first_row, rows;   ///< rows <= lanes
    std::size_t slots;
    const std::int32_t* other;     ///< slots x lanes: the row at the other end
    const float* geometry;         ///< slots x fields x lanes: n_x, n_y[, lever, lever of the other][, offset, offset of
                                   ///< the other][, kN, kT]; lengths over the scale of rotations
    const float* inverse;          ///< 6 x lanes: lower triangle of the inverse of the diagonal block
    const float* free;             ///< 3 x lanes: 1 where the component is not held, else 0; null: all are free
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
  void lay_out(const SpringNetwork& network, std::span<const std::int32_t> order,
               std::span<const std::int32_t> first_row);
  void fill(const SpringNetwork& network, std::span<const std::int32_t> order,
            const std::vector<std::int32_t>& row_of, std::size_t group, double unit);
  void fill_slot(const SpringNetwork& network, std::size_t contact, bool from_i, std::size_t slot, std::size_t lane,
                 double unit);

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

}  // namespace equidem::multigrid
