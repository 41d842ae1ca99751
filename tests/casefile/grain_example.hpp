// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A small valid case of grains, and how tests read it.
#pragma once

#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"

#include "support/refusal.hpp"

namespace equidem::test {

inline const std::string grain_case = R"(schema = "equidem/1"
title  = "Grains"
[grains]
body = "sphere"
density = 2500.0
[[grain]]
position = [0.0, 0.1]
radius = 0.01
velocity = [1.0, -2.0]
spin = 3.0
[[grain]]
position = [0.5, 0.1]
radius = 0.02
group = "steel"
density = 7800.0
[[grain]]
position = [1.0, 0.1]
radius = 0.03
[collisions]
law = "linear_dashpot"
restitution = 0.8
stiffness = 1.0e5
friction = 0.3
[collisions.walls]
restitution = 0.6
[[collisions.pair]]
group = "steel"
with = "floor"
friction = 0.0
contact_duration = 1.0e-3
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 2.0]
[[wall]]
name = "paddle"
shape = "segment"
point = [-1.0, 0.0]
end = [-1.0, 1.0]
displacement = 0.1
direction = [3.0, 4.0]
schedule = "shake"
[[wall]]
name = "slope"
shape = "segment"
point = [0.0, 5.0]
end = [4.0, 6.0]
[[schedule]]
name = "shake"
kind = "sine"
frequency = 5.0
[run]
duration = 0.5
time_step = 1.0e-5
integrator = "velocity_verlet"
gravity = [0.0, -9.81]
[[probe]]
name = "balls"
group = "grains"
quantities = ["velocity", "spin"]
[output]
probe_interval = 0.01
)";

inline GrainCase grains(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_grain_case(text, "a.toml", "", overrides);
}

/// The sentence of the error of a case, or of its automatic step; empty where it is accepted.
inline std::string sentence_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return test::refusal_of([&] {
           const GrainCase resolved = grains(text, overrides);
           choose_grain_step(resolved);
         })
      .message;
}

}  // namespace equidem::test
