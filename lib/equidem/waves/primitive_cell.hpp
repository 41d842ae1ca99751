// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The smallest cell that repeats to a periodic assembly.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// A contact of two discs of the cell, or of a disc with an image of itself.
struct CellContact {
  std::int32_t i = 0;  ///< index into PrimitiveCell::discs
  std::int32_t j = 0;
  Vec2 branch;         ///< m, from i to the image of j that it touches: all that a phase exp(i q.l) needs
  ContactFrame frame;  ///< normal, levers and offsets
  SpringConstants springs;
  double kM = 0;                                ///< bending spring, N m/rad per metre of depth
  std::optional<ContactPrestress> prestress{};  ///< none: forces at rest do not count

  /// The contact must outlive it.
  [[nodiscard]] ContactStiffness stiffness(double rotation_scale) const {
    return {.ends = end_gradients(frame, rotation_scale),
            .kN = springs.kN,
            .kT = springs.kT,
            .kM = kM / (rotation_scale * rotation_scale),
            .prestress = prestress ? &*prestress : nullptr,
            .rotation_scale = rotation_scale};
  }
};

/// A cell of a periodic network. It may be oblique, unlike the period of an assembly.
struct PrimitiveCell {
  std::array<Vec2, 2> period;  ///< m, the shortest two lattice vectors (Lagrange & Gauss), period[0] x period[1] > 0
  std::vector<std::int32_t> discs;  ///< of the assembly, one for each disc of the cell, ascending
  std::vector<CellContact> contacts;
  std::int64_t copies = 1;    ///< cells in the given period of the assembly
  double rotation_scale = 1;  ///< a, m: the mean radius of the assembly

  [[nodiscard]] std::size_t size() const { return discs.size(); }
  /// See on_lines_of_centres(Assembly).
  [[nodiscard]] bool on_lines_of_centres() const {
    return std::all_of(contacts.begin(), contacts.end(),
                       [](const CellContact& c) { return c.frame.offset_i == 0 && c.frame.offset_j == 0; });
  }
  /// Whether contacts resist the relative rotation of their bodies.
  [[nodiscard]] bool bends() const {
    return std::any_of(contacts.begin(), contacts.end(), [](const CellContact& c) { return c.kM > 0; });
  }
  /// Whether forces at rest count.
  [[nodiscard]] bool prestressed() const {
    return std::any_of(contacts.begin(), contacts.end(), [](const CellContact& c) { return c.prestress.has_value(); });
  }
  [[nodiscard]] double area() const { return cross(period[0], period[1]); }
};

/// The given period of the assembly as a cell, whether or not a smaller one repeats.
/// \throws Error (bad_input) where the assembly is not periodic
PrimitiveCell given_cell(const Assembly& assembly, const ContactSprings& springs);

/// The smallest cell: all translations that map centres, radii, sections, contacts, their places, springs and
/// forces at rest onto themselves to 1e-9 (of the mean radius, of the largest spring) are found; one disc is left of a
/// lattice however many the assembly has. The assembly itself where none maps it. Linear in the number of discs where
/// none does, else n log n.
/// \throws Error (bad_input) where the assembly is not periodic
PrimitiveCell primitive_cell(const Assembly& assembly, const ContactSprings& springs);

}  // namespace equidem
