// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A law for tests: linear spring and dashpot, and friction that falls with the slip velocity v, mu/(1 + |v|/v_w).
#pragma once

#include "equidem/contact/laws/law.hpp"

namespace equidem::laws {

struct WeakeningCoulomb {
  static constexpr double speed = 0.5;  ///< v_w, m/s

  template <bool verlet, bool equal, class Number>
  EQUIDEM_ALWAYS_INLINE static SlidingStep<Number> step(const SlidingLaw<Number>& law, const Number& dashpot,
                                                        const Number& stretch, const Number& velocity,
                                                        const Number& mean_slip, const Number& mobility,
                                                        const Number& before, const Number& yield, double dt) {
    const Number weaker = yield * (1 / (1 + (1 / speed) * simd::magnitude(velocity)));
    return CoulombSpring::step<verlet, equal>(law, dashpot, stretch, velocity, mean_slip, mobility, before, weaker, dt);
  }
};

struct WeakeningFriction {
  using Tangential = WeakeningCoulomb;
  static constexpr LawFacts facts = {
      .name = "weakening_friction", .letter = "W", .summary = "linear spring and dashpot, friction falls with slip"};

  template <class Number>
  [[gnu::always_inline]] static Number spring(const Number& k, const Number& d) {
    return k * d;
  }
  template <class Number>
  [[gnu::always_inline]] static Number dashpot(const Number& c, const Number& /*d*/) {
    return c;
  }
};

}  // namespace equidem::laws
