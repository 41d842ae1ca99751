// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// An assembly with its computed results, the input of writers of files and pictures.
#pragma once

#include <cassert>
#include <span>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/vector.hpp"

namespace equidem {

/// A view: the data must outlive it. An empty span means "not computed": its columns, arrays and colours are omitted.
struct AssemblyState {
  const Assembly& assembly;
  std::span<const DiscMotion> motions = {};           ///< per disc
  std::span<const ContactForce> contact_forces = {};  ///< per contact
  std::span<const Tensor2> stresses = {};             ///< per disc, Pa
  std::span<const double> bending_moments = {};       ///< per contact, N, on its first disc
};

/// Precondition: sizes agree.
inline void assert_consistent([[maybe_unused]] const AssemblyState& state) {
  assert(state.motions.empty() || state.motions.size() == state.assembly.size());
  assert(state.contact_forces.empty() || state.contact_forces.size() == state.assembly.contacts.size());
  assert(state.bending_moments.empty() || state.bending_moments.size() == state.assembly.contacts.size());
  assert(state.stresses.empty() || state.stresses.size() == state.assembly.size());
}

/// Half the trace of a plane stress tensor, Pa; tension positive.
constexpr double mean_stress(const Tensor2& stress) {
  return 0.5 * (stress.xx + stress.yy);
}

}  // namespace equidem
