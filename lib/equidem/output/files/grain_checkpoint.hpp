// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A run of colliding bodies in the middle, as a file from which it goes on with the same bits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "equidem/core/vector.hpp"
#include "equidem/grains/grain_simulation.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/grain_energy.hpp"

namespace equidem {

/// What happened so far.
struct GrainRecord {
  std::vector<GrainEnergySample> energies;
  std::vector<std::vector<Vec2>>
      paths;  ///< places of all grains at each sample; empty where there are too many to draw
};

/// The same file, with the same guards, as that of other runs (checkpoint.hpp): motions hold positions and angles,
/// velocities those and spins; everything else stands in sums.
void write_grain_checkpoint(const CheckpointWriter& writer, const GrainState& state, const GrainRecord& record);

struct GrainCheckpoint {
  GrainState state;
  GrainRecord record;
};

/// \param grains of the case: radii, masses and kinds are not in the file
/// \throws Error (bad_input) as read_checkpoint
GrainCheckpoint read_grain_checkpoint(const std::filesystem::path& path, const std::string& case_text,
                                      std::vector<Grain> grains);

}  // namespace equidem
