// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// [grains] and [[grain]]: the bodies of a case.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/casefile/engine/toml.hpp"
#include "equidem/grains/scene/grain_scene.hpp"
#include "equidem/material/inertia.hpp"

namespace equidem {

struct GrainBodies {
  Body body = Body::disc;
  std::vector<Grain> grains;        ///< those of the file, then those of the case
  std::vector<double> densities;    ///< kg/m³
  std::vector<Clump> clumps;        ///< shapes, each once
  std::vector<std::string> groups;  ///< of each grain
  std::string file;                 ///< that of [grains] path; empty: none
  std::vector<int> lines;           ///< of its grains, in that file
};

/// \param root seen by check_and_complete; the path becomes that which the program opens
/// \throws Error (bad_input) with line and key: no grains, no density, a file that is not a table of grains
GrainBodies read_bodies(TomlValue& root, const std::filesystem::path& folder);

}  // namespace equidem
