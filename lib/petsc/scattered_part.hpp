// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Parts of an assembly that rank 0 has read or packed.
#pragma once

#include <optional>

#include "equidem/contact/contact_springs.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {

struct ScatteredPart {
  Part part;
  std::optional<ContactSprings> springs;  ///< of its contacts
};

/// Each rank receives the discs of a stretch of Hilbert's curve, with their contacts.
/// \param whole of rank 0; null on the others
/// \param springs of its contacts, likewise
/// \throws Error (bad_input) on all ranks where there are more ranks than discs
ScatteredPart scattered_part(const Ranks& ranks, const Assembly* whole, const ContactSprings* springs);

}  // namespace equidem::petsc
