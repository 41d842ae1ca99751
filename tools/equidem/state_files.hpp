// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The files of one state of an assembly: discsSUFFIX.csv, contactsSUFFIX.csv, stateSUFFIX.vtm, pictureSUFFIX.svg.
#pragma once

#include <string>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/output/files/state.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "command.hpp"

namespace equidem {

/// The pictures alone of what is to be written.
inline OutputCase pictures_of(OutputCase wanted) {
  wanted.csv = wanted.vtk = false;
  wanted.assembly.reset();
  return wanted;
}

/// \throws Error (bad_input) where a file could not be written
void expect_state(const OutputPlan& plan, const OutputCase& wanted, const std::string& suffix);
/// Removes these files of an earlier computation, where the present one has no state to write over them.
void remove_state(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix);

/// Tables and files for ParaView that [output] asks for.
void write_state(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                 const AssemblyState& state);

/// The picture, where [output] asks for it.
void write_state_picture(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                         const AssemblyState& state, const PictureOptions& picture);

/// The assembly itself, where [output] asks for it.
void expect_assembly(const OutputPlan& plan, const OutputCase& wanted);
void write_assembly(const CommonOptions& options, const OutputCase& wanted, const Assembly& assembly);

}  // namespace equidem
