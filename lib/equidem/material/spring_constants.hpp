// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The two springs of a contact.
#pragma once

#include <string>

namespace equidem {

/// Normal and tangential contact spring, N/m per metre of depth = Pa.
template <typename Number>
struct SpringConstantsOf {
  Number kN = 0;  ///< > 0
  Number kT = 0;  ///< any sign; negative is static-only

  [[nodiscard]] Number ratio() const { return kT / kN; }
};
using SpringConstants = SpringConstantsOf<double>;

/// \param of "of contact 7" for the message, or empty
/// \throws Error (bad_input) where kN is not positive and finite, or kT not finite
void check(const SpringConstants& springs, const std::string& of = {});

}  // namespace equidem
