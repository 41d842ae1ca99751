// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The two springs of a contact.
#pragma once

namespace equidem {

/// Normal and tangential contact spring, N/m per metre of depth = Pa.
struct SpringConstants {
  double kN = 0;  ///< > 0
  double kT = 0;  ///< any sign; negative is static-only

  [[nodiscard]] double ratio() const { return kT / kN; }
};

}  // namespace equidem
