// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Linear spring and dashpot: F = k d + c v, c = 2 zeta sqrt(m k) (Cundall & Strack 1979; the law C of Fujioka &
/// Ushijima 2005).
#pragma once

#include "equidem/contact/laws/law.hpp"

namespace equidem::laws {

struct LinearDashpot : LinearSpringDashpot {
  static constexpr const char* name = "linear_dashpot";
  static constexpr const char* letter = "C";
  static constexpr const char* source = "Cundall & Strack 1979";
  static constexpr const char* summary = "linear spring and dashpot";
  static constexpr LawKind kind = LawKind::force;
  static constexpr double steps_per_contact = 50;

  template <class Number>
  [[gnu::always_inline]] static Number spring(const Number& k, const Number& d) {
    return k * d;
  }
  template <class Number>
  [[gnu::always_inline]] static Number dashpot(const Number& c, const Number& /*d*/) {
    return c;
  }

  /// Largest omega dt of one contact: 2/(sqrt(1 + zeta²) + zeta), omega² = k/m.
  static double stable_step(double damping_ratio) { return semi_implicit_limit(damping_ratio); }
};

}  // namespace equidem::laws
