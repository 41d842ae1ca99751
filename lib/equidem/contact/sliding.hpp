// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tangential contact in one step: spring, dashpot, Coulomb's limit. Of one contact (Number: simd::One) or of several.
///
/// The spring is stretched by the slip x, x' = v; it resists with kT x, the dashpot with c v. Friction carries at most
/// mu N, N the normal force (none where N < 0). While sliding the spring keeps its stretch, at most mu N/kT; the rest
/// of the work is lost. Rolling resistance is the same law of the rolling velocity (Iwashita and Oda 1998).
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>

#include "equidem/core/simd.hpp"

namespace equidem {

/// All >= 0.
struct Sliding {
  double stiffness = 0;    ///< kT, N/m
  double dashpot = 0;      ///< c, N s/m
  double coefficient = 0;  ///< mu
};

/// Constants of contacts in steps of dt.
template <class Number>
struct SlidingLaw {
  Number friction;     ///< mu
  Number half_spring;  ///< kT/2, N/m
  Number spring;       ///< kT dt, N s/m
  Number rate;         ///< kT dt²/2, kg
  Number slack;        ///< 1/(kT dt), m/(N s); finite without a spring, too
};

/// \param stiffness kT, N/m
/// \param compliance 1/kT, m/N
template <class Number>
EQUIDEM_ALWAYS_INLINE SlidingLaw<Number> sliding_law(const Number& friction, const Number& stiffness,
                                                     const Number& compliance, double dt) {
  return {friction, 0.5 * stiffness, dt * stiffness, (0.5 * dt * dt) * stiffness, (1 / dt) * compliance};
}
/// Likewise where some contacts have no spring.
template <class Number>
EQUIDEM_ALWAYS_INLINE SlidingLaw<Number> sliding_law(const Number& friction, const Number& stiffness, double dt) {
  using namespace simd;
  return sliding_law(friction, stiffness, 1 / choose(negative(Number{} - stiffness), stiffness, all<Number>(1)), dt);
}

template <class Number>
struct SlidingStep {
  Number impulse;  ///< over the step, against the slip velocity, N s
  Number stretch;  ///< of the spring at the end of the step, m
  /// J, >= 0 by the midpoint rule: work done on the contact at the mean velocity, less energy stored.
  Number slip_loss, dashpot_loss;
  simd::Bits<Number> slides;
};

/// A tangential law gives the impulse of a step and the stretch after it; its spring stores kT stretch²/2. Another law
/// is another struct with this function, named by a law of contact (laws/law.hpp).
struct CoulombSpring {
  /// Midpoint rule: impulse, stretch and velocity are consistent over the step, so that sticking keeps energy and
  /// sliding only loses it.
  ///
  /// Verlet schemes: explicit, with the stretch at the instant (LAMMPS, YADE, Sukegawa (2.9)-(2.16)). Half of the kicks
  /// before and after the drift acts along its slip; the loss of a drift may be negative by the error of the scheme.
  /// \tparam equal all contacts have a spring
  /// \param dashpot c dt, kg
  /// \param stretch at the start of the step
  /// \param velocity slip at the instant; midpoint rule: mean over the step as all other forces make it, of constant
  ///        ones that at the start plus half its change
  /// \param mean_slip Verlet schemes: mean velocity over the drift before, in which the normal turns; it stretches the
  ///        spring, whose energy would else differ from the work on it by the first order of the step
  /// \param mobility midpoint rule: mean velocity per impulse, half the inverse of the tangential mass, 1/kg
  /// \param before Verlet schemes: impulse on j in the last step
  /// \param yield mu times the normal impulse
  template <bool verlet, bool equal, class Number>
  EQUIDEM_ALWAYS_INLINE static SlidingStep<Number> step(const SlidingLaw<Number>& law, const Number& dashpot,
                                                        const Number& stretch, const Number& velocity,
                                                        const Number& mean_slip, const Number& mobility,
                                                        const Number& before, const Number& yield, double dt) {
    using namespace simd;
    Number resistance, mean = velocity;
    if constexpr (!verlet) {
      // mean = velocity - mobility * resistance, resistance = kT dt (stretch + mean dt/2) + c dt mean
      const Number rate = law.rate + dashpot;
      resistance = (law.spring * stretch + rate * velocity) * (1 / (1 + mobility * rate));
    } else {
      resistance = law.spring * (stretch + mean_slip * dt) + dashpot * velocity;
    }
    const Bits<Number> slides = negative(yield - magnitude(resistance));
    const Number friction =
        equal ? within(resistance, yield) : choose(slides, with_sign(yield, resistance), resistance);
    if constexpr (!verlet) mean = velocity - mobility * friction;
    // held at what friction carries, but never carried further than the bodies moved: so work - energy stored >= 0
    const Number moved = stretch + (verlet ? mean_slip : mean) * dt;
    Number end = choose(slides, within(moved, yield * law.slack), moved);
    if constexpr (!equal) end = only(negative(Number{} - law.spring), end);
    const Number released = law.half_spring * (stretch - end) * (stretch + end);
    if constexpr (!verlet) {
      const Number dragged = only(~slides, dashpot * mean);
      return {friction, end, only(slides, friction * mean + released), dragged * mean, slides};
    }
    const Number loss = 0.5 * mean_slip * (friction - before) + released;
    return {friction, end, only(slides, loss), only(~slides & negative(Number{} - dashpot), loss), slides};
  }
};

/// One contact by the midpoint rule; without a spring (kT = c = 0) at most what stops the slip within the step, so that
/// a slip that stops stays stopped: under a steady acceleration g that friction can hold, a slip of g dt/2 remains.
/// \param velocity, inverse_mass as in slide(), of the tangential mass: 1/m_i + 1/m_j + r_i²/I_i + r_j²/I_j, 1/kg
/// \param normal_impulse over the step, N s
inline SlidingStep<double> slide(const Sliding& law, double stretch, double velocity, double inverse_mass,
                                 double normal_impulse, double dt) {
  assert(inverse_mass > 0 && dt > 0);
  const double yield = law.coefficient * std::max(normal_impulse, 0.0), mobility = 0.5 * inverse_mass;
  if (law.stiffness == 0 && law.dashpot == 0) {
    const double friction = std::clamp(velocity / inverse_mass, -yield, yield);
    return {friction, 0, friction * (velocity - mobility * friction), 0, true};
  }
  using simd::One;
  const auto step = CoulombSpring::step<false, false>(sliding_law(One{law.coefficient}, One{law.stiffness}, dt),
                                                      One{law.dashpot * dt}, One{stretch}, One{velocity}, One{},
                                                      One{mobility}, One{}, One{yield}, dt);
  return {step.impulse[0], step.stretch[0], step.slip_loss[0], step.dashpot_loss[0], step.slides[0] != 0};
}

}  // namespace equidem
