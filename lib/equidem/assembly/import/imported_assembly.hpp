// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Particles of other programs as an assembly.
#pragma once

#include <filesystem>
#include <string_view>

#include "equidem/assembly/files.hpp"
#include "equidem/assembly/import/particle_table.hpp"

namespace equidem {

/// The discs in the order of their ids, in m, with the contacts of options.contacts or of the file, else those that
/// touch. Contacts without levers divide the distance in the ratio of the radii, as those of a packing do; the bonds of
/// LAMMPS (bpm) have their point in the middle.
/// \param path of the text, for messages
/// \param format of the text, not none
/// \throws Error (bad_input) at "FILE: line N": as the readers of particle_rows.hpp; no unit of length or periodicity
///         where the file does not say it; particles with the same id, off the plane, or of no size; a contact of a
///         particle that is not there; options that the format does not take
Assembly imported_assembly(const std::filesystem::path& path, std::string_view text, ParticleFormat format,
                           const AssemblyFileOptions& options);

}  // namespace equidem
