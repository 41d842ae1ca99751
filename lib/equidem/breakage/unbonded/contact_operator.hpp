// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The contacts of a network as a linear operator: deformations from motions, and forces on discs from those of
/// contacts.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/breakage/unbonded/contact_law.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

class ContactOperator {
 public:
  ContactOperator(const Assembly& assembly, const DegreesOfFreedom& unknowns);

  [[nodiscard]] std::size_t contacts() const { return rows_.size(); }
  [[nodiscard]] std::size_t components() const { return unknowns_.held.size(); }
  [[nodiscard]] const DegreesOfFreedom& unknowns() const { return unknowns_; }

  /// Deformation of a contact by a motion, per component.
  [[nodiscard]] ContactDeformation deformation(std::size_t contact, std::span<const double> motion) const;
  /// Deformations of all contacts by a mean gradient; empty: there is none.
  [[nodiscard]] std::vector<ContactDeformation> affine(const std::optional<Tensor2>& gradient) const;
  /// internal += the internal force of a contact force: the negative of what it exerts on the discs.
  void add_internal(std::size_t contact, const ContactForce& force, std::span<double> internal) const;

  /// sum G^T A G over contacts with the deformations G u and tangents A, and springs of `ground` Pa that hold every
  /// component, over the components that are not held.
  [[nodiscard]] CompressedColumns matrix(std::span<const ContactTangent> tangents, double ground) const;

 private:
  struct Rows {
    std::size_t i, j;  // first components
    EndGradients ends;
  };

  const Assembly& assembly_;
  const DegreesOfFreedom& unknowns_;
  std::vector<Rows> rows_;
  std::vector<std::int64_t> column_;  // of the matrix, per component; -1: held
  std::int64_t columns_ = 0;
};

}  // namespace equidem
