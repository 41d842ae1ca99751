// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A small valid case, and how tests read it.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"

#include "support/refusal.hpp"

namespace equidem::test {

inline const std::string tension_case = R"(schema = "equidem/1"
title  = "Abe 1996, Fig. 6"
[assembly]
kind    = "hexagonal"
columns = 21
rows    = 21
radius  = 0.005
[springs]
kN = 1.0e9
kT = 0.5e9
[test]
kind   = "uniaxial_tension"
stress = 1.0e6
gauge  = "centre"
)";

inline const std::string load_case = R"(schema = "equidem/1"
[assembly]
kind = "delaunay"
discs = 50
points = "perturbed_hexagonal"
disorder = 0.2
seed = 7
[assembly.radii]
smallest = 0.004
largest = 0.006
[material]
shear_modulus = 1.0e9
poisson_ratio = 0.2
plane = "strain"
[effects]
rotation = "free"
[[group]]
name = "some"
discs = [0, 1, 2]
[[group]]
name = "inside"
box = [0.0, 0.0, 0.02, 0.02]
[[support]]
group = "left"
ux = true
uy = 1e-3
[[load]]
group = "some"
kind = "total"
force = [1.0, -2.0]
case = "a"
[[load]]
group = "inside"
moment = 3.0
case = "b"
[solver]
method = "umfpack"
max_refinements = 2
memory_limit = "4 GB"
[output]
files = ["csv", "vtk"]
)";

inline const std::string ensemble_case = R"(schema = "equidem/1"
[assembly]
kind = "delaunay"
discs = 50
radius = 0.005
periodic = true
density = 2650.0
body = "disc"
[material]
p_wave_speed = 1500.0
s_wave_speed = 900.0
density = 2200.0
plane = "strain"
weighting = "voronoi"
[homogenize]
boundary = "displacement"
bounds = "all"
[ensemble]
discs = [30, 60, 120]
samples = 4
accuracy = 0.02
)";

inline const std::string motion_case = R"(schema = "equidem/1"
[assembly]
kind = "hexagonal"
columns = 4
rows = 3
radius = 0.005
density = 2650.0
[springs]
kN = 1.0e9
kT = 0.5e9
[run]
duration = 0.25
time_step = 2e-6
step_rule = "bound"
step_fraction = 0.5
allow_unstable_step = true
integrator = "velocity_verlet"
motion = "finite"
gravity = [0.0, -9.81]
[run.damping]
mass = 3.0
contact = 0.1
local = 0.2
[[schedule]]
name = "open"
kind = "ramp"
start = 0.02
end = 0.1
[[schedule]]
name = "shake"
kind = "sine"
value = 0.5
frequency = 10.0
[[schedule]]
name = "pull"
kind = "table"
times = [0.0, 0.2]
values = [0.0, 1.0]
[[support]]
group = "left"
ux = 1e-4
uy = true
schedule = "open"
[[support]]
group = "bottom_right"
uy = 1e-5
[[load]]
group = "right"
force = [10.0, 0.0]
schedule = "pull"
[[load]]
group = "top"
moment = 2.0
[[wall]]
name = "left"
point = [-0.02, 0.0]
normal = [2.0, 0.0]
kN = 2.0e9
displacement = 2e-4
schedule = "shake"
[[wall]]
name = "right"
point = [0.1, 0.0]
normal = [-1.0, 0.0]
kN = 2.0e9
[[velocity]]
group = "right"
velocity = [0.1, 0.0]
spin = -3.0
[[probe]]
name = "tip"
group = "right"
quantities = ["velocity", "rotation"]
[output]
frame_interval = 0.05
probe_interval = 1e-3
checkpoint_interval = 30.0
)";

/// One of each kind: a test, supports and loads, many samples, motion in time.
inline const std::vector<std::string> example_cases = {tension_case, load_case, ensemble_case, motion_case};

inline Case parsed(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_case(text, "a.toml", ".", overrides);
}

/// Files data/cases/PREFIX*.toml; of "", those of assemblies.
inline std::vector<std::filesystem::path> cases_of_the_data_folder(const std::string& prefix) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(EQUIDEM_SOURCE_DIR "/data/cases")) {
    const std::string name = entry.path().filename().string();
    const bool other = name.starts_with("grains_") || name.starts_with("pack_") || name.starts_with("study_");
    if (name.ends_with(".toml") && (prefix.empty() ? !other : name.starts_with(prefix))) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

/// The sentence of the error of a case; empty where it is accepted.
inline std::string error_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const Refusal refused = refusal_of([&] { static_cast<void>(parsed(text, overrides)); });
  return (refused.kind == ErrorKind::bad_input ? "" : "wrong kind: ") + refused.message;
}

/// The text with the first `what` replaced.
inline std::string changed(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  if (at == std::string::npos) throw std::logic_error("the example has no '" + what + "'");
  return text.replace(at, what.size(), by);
}

}  // namespace equidem::test
