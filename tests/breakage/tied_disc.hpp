// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A disc that does not turn, bonded along a direction of 45 degrees and touching another along x: its openings and
/// slips there are its motion.
#pragma once

#include <cmath>
#include <vector>

#include "equidem/breakage/strengths.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/statics/loads.hpp"

#include "breakage/scenes.hpp"
#include "support/assemblies.hpp"

namespace equidem::test {

/// Discs of radius 1: 1 is free, contact 0 with disc 0 may open and slip, contact 1 with disc 2 is the bond.
struct TiedDisc {
  static constexpr double kN = 1000, kT = 300;  // Pa, of contact 0

  static Assembly assembly() {
    Assembly scene = chain_of_discs(2, 1);
    const double r = std::sqrt(2.0);
    scene.centres.push_back(scene.centres[1] + Vec2{r, r});
    scene.radii.push_back(1);
    scene.contacts.push_back({1, 2, 0, 0, 1, 1});
    scene.groups["held"] = {{0, 2}, {}};
    scene.groups["disc"] = {{1}, {}};
    return scene;
  }
  /// \param across spring of the bond at right angles to it, Pa
  static ContactSprings springs(double across = 0) {
    return ContactSprings(std::vector<SpringConstants>{{kN, kT}, {kN, across}});
  }
  static ContactStrengths strengths() {
    ContactStrengths strengths = equal_strengths(assembly(), 0, 0);
    strengths.tension[1] = strengths.shear[1] = 1e9;
    return strengths;
  }
  static std::vector<Support> supports() { return {{"held", 0, 0, 0}, {"disc", {}, {}, 0}}; }
};

}  // namespace equidem::test
