// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rolling resistance of eight contacts (contacts/contact_effects.hpp): spring, dashpot and limit as of slip, of the
/// velocity R (spin of j - spin of i).
#pragma once

#include "equidem/grains/contacts/contact_effects.hpp"
#include "equidem/grains/kernels/resist.hpp"

namespace equidem::eight {

template <class Lanes>
struct RollingLanes {
  SpringLanes<Lanes> spring;
  Lanes dashpot;   ///< times dt, kg
  Lanes mobility;  ///< mean velocity per impulse, 1/kg
  Lanes velocity;  ///< of rolling, as that of resist()
};

/// What rolling carries from step to step.
template <class Lanes>
struct RollingMemory {
  Lanes impulse;  ///< on j at the lever, N s
  Lanes stretch;  ///< m
};

template <class Lanes>
EQUIDEM_ALWAYS_INLINE RollingLanes<Lanes> rolling_lanes(const ContactEffects& of, const Lanes& velocity, double dt) {
  return {spring_lanes(load<Lanes>(of.friction), load<Lanes>(of.stiffness), dt), load<Lanes>(of.dashpot),
          load<Lanes>(of.half_mobility), velocity};
}

template <class Lanes>
EQUIDEM_ALWAYS_INLINE RollingMemory<Lanes> rolling_memory(const ContactEffects& of) {
  return {load<Lanes>(of.impulse), load<Lanes>(of.stretch)};
}

using simd::store;
template <class Lanes>
EQUIDEM_ALWAYS_INLINE void store(const RollingMemory<Lanes>& memory, ContactEffects& of) {
  store(memory.impulse, of.impulse);
  store(memory.stretch, of.stretch);
}

/// \param repulsion impulse, >= 0
template <ResponseKind kind, class Lanes>
EQUIDEM_ALWAYS_INLINE SpringLosses<Lanes> roll(const RollingLanes<Lanes>& of, const Lanes& repulsion,
                                               const ContactChanges<Lanes>& at, double dt,
                                               RollingMemory<Lanes>& memory) {
  return resist<kind>(of.spring, of.dashpot, of.velocity, of.velocity, of.mobility, of.spring.friction * repulsion, at,
                      dt, memory.impulse, memory.stretch);
}

}  // namespace equidem::eight
