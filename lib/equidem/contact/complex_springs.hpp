// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The springs of every contact at one frequency.
#pragma once

#include "equidem/contact/contact_springs.hpp"
#include "equidem/material/viscoelasticity.hpp"

namespace equidem {

/// Complex springs k = storage + i loss of every contact.
struct ComplexSprings {
  ContactSprings storage;
  ContactSprings loss;
};

/// The springs of every contact times the factors of the frequency (Hz) and times `unit`.
/// \throws Error (bad_input) outside the frequencies of a table
ComplexSprings complex_springs(const ContactSprings& elastic, const Viscoelasticity& viscoelasticity, double frequency,
                               double unit = 1);

}  // namespace equidem
