// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The integrators of bonded bodies.
#pragma once

#include <string>
#include <vector>

#include "equidem/core/names.hpp"
#include "equidem/dynamics/integrators/fourth_order.hpp"
#include "equidem/dynamics/integrators/leapfrog.hpp"
#include "equidem/dynamics/integrators/thesis.hpp"
#include "equidem/dynamics/integrators/velocity_verlet.hpp"

namespace equidem {

enum class Integrator { leapfrog, velocity_verlet, thesis, fourth_order };

template <>
struct EnumNames<Integrator> {
  struct Entry {
    Integrator value;
    const char* name;
    const IntegrationScheme* scheme;
  };
  static constexpr const char* what = "integrator";
  static constexpr Entry list[] = {
      {Integrator::leapfrog, "leapfrog", &integrators::leapfrog},
      {Integrator::velocity_verlet, "velocity_verlet", &integrators::velocity_verlet},
      {Integrator::thesis, "thesis", &integrators::thesis},
      {Integrator::fourth_order, "fourth_order", &integrators::fourth_order},
  };
};

inline const IntegrationScheme& scheme_of(Integrator integrator) {
  return *entry_of(integrator).scheme;
}

}  // namespace equidem
