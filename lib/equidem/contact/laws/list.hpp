// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The laws of normal contact: the only list of them. NormalLaw, the loops over contacts, the choices and help of the
/// case file and the reports follow from it.
///
/// To add a law, write laws/NAME.hpp with a struct that has the pieces of laws/law.hpp, include it here, and add
/// a line to the list.
#pragma once

#include "equidem/contact/laws/energy_map.hpp"
#include "equidem/contact/laws/exact_flow.hpp"
#include "equidem/contact/laws/five_case_map.hpp"
#include "equidem/contact/laws/hertz_dashpot.hpp"
#include "equidem/contact/laws/linear_dashpot.hpp"

// clang-format off
/// Name in case files, struct: one line for each law.
#define EQUIDEM_LAWS(law)            \
  law(exact_flow, ExactFlow)         \
  law(linear_dashpot, LinearDashpot) \
  law(hertz_dashpot, HertzDashpot)   \
  law(five_case_map, FiveCaseMap)    \
  law(energy_map, EnergyMap)
// clang-format on
