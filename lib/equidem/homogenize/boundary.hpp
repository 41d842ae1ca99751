// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The boundary of a sample: the discs that carry prescribed displacements, and the shares by which they carry
/// tractions.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// Boundary conditions that impose the macroscopic strain. As quadratic forms on the same cell: traction <= periodic <=
/// displacement <= Voigt (Huet 1990).
enum class Boundary {
  periodic,      ///< images move with the mean strain: the cell repeats without end
  displacement,  ///< the discs at the boundary follow a uniform displacement gradient (and turn freely)
  traction,      ///< the boundary carries the tractions of a uniform stress
};

template <>
struct EnumNames<Boundary> {
  static constexpr const char* what = "kind of boundary";
  static constexpr NamedValue<Boundary> list[] = {
      {Boundary::periodic, "periodic"}, {Boundary::displacement, "displacement"}, {Boundary::traction, "traction"}};
};

/// 1 for discs at the boundary: of a free assembly those of its sides (groups left, right, bottom, top; where its
/// region is turned, the sides of the region), of a periodic cell those with a contact that crosses the period.
/// \throws Error (bad_input) where a free assembly has no sides
std::vector<std::uint8_t> boundary_discs(const Assembly& assembly);

/// A sample whose boundary carries a uniform stress s: the force s a on the disc of each share. A periodic cell is
/// cut open along the contacts that cross the period; such a contact then carries the force s a, and -s a acts on its
/// other disc. The vectors a (m) balance and obey sum a x = A I, so that the mean strain (1/A) sum u a works with s; it
/// is the same as that of the displacement and of the periodic boundary, and the order of the bounds follows.
struct TractionSample {
  Assembly assembly;       ///< without the contacts cut, free boundary
  ContactSprings springs;  ///< of the contacts left
  struct Share {
    std::int32_t disc = 0;
    Vec2 a;
  };
  std::vector<Share> shares;  ///< free sample: discs of the sides
  struct Cut {
    std::size_t contact = 0;  ///< of the periodic cell
    Vec2 a;
  };
  std::vector<Cut> cuts;  ///< periodic cell
};

/// \throws Error (bad_input) where no contact crosses the period one way, the sides have no lengths, or a contact that
///         would be cut has kT = 0 and cannot carry shear
TractionSample traction_sample(const Assembly& assembly, const ContactSprings& springs);

}  // namespace equidem
