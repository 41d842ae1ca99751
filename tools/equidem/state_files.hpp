// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The states of assemblies as arrays, for callers who keep results in memory (hand_over).
/// The files of one state of an assembly: discsSUFFIX.csv, contactsSUFFIX.csv, stateSUFFIX.vtm, pictureSUFFIX.svg.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "equidem/casefile/assembly/case.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "command.hpp"

namespace equidem {

/// Arrays in the memory of `owner` or `numbers`, which they keep.
/// \param columns numbers in a row
template <class Row>
ResultArray array_of(std::string name, std::string unit, const std::shared_ptr<const std::vector<Row>>& owner,
                     std::size_t columns) {
  static_assert(sizeof(Row) % sizeof(double) == 0);
  return {std::move(name),
          std::move(unit),
          owner,
          reinterpret_cast<const double*>(owner->data()),
          owner->size(),
          columns,
          sizeof(Row) / sizeof(double)};
}

template <class Row>
ResultArray array_of(std::string name, std::string unit, std::vector<Row> numbers, std::size_t columns) {
  return array_of(std::move(name), std::move(unit), std::make_shared<const std::vector<Row>>(std::move(numbers)),
                  columns);
}

/// PREFIXdisplacements (n, 2) in m and PREFIXrotations (n) in rad.
std::vector<ResultArray> motion_arrays(const std::string& prefix,
                                       const std::shared_ptr<const std::vector<DiscMotion>>& motions);
/// The motions of all discs, PREFIXcontact_forces (contacts, 2), normal and tangential, in N/m, where contacts bend
/// PREFIXbending_moments (contacts) on the first disc in N, and of the discs that supports hold PREFIXsupported_discs,
/// PREFIXreactions (2 columns) in N/m and PREFIXreaction_moments in N.
std::vector<ResultArray> state_arrays(const std::string& prefix, const std::shared_ptr<const Equilibrium>& equilibrium);
/// The pictures alone of what is to be written.
inline OutputCase pictures_of(OutputCase wanted) {
  wanted.csv = wanted.vtk = false;
  wanted.assembly.reset();
  return wanted;
}

/// The names of the files of a state and of its picture.
std::vector<std::string> state_names(const OutputCase& wanted, const std::string& suffix);
/// Removes files of an earlier computation, where the present one has none to write over them.
void remove_files(const CommonOptions& options, const std::vector<std::string>& names);

/// Tables and files for ParaView that [output] asks for.
void write_state(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                 const AssemblyState& state);

/// Memory that the picture takes beside the state, where one is asked for.
double bytes_of_state_picture(const CommonOptions& options, const OutputCase& wanted, const Assembly& assembly);
/// The picture, where [output] asks for it.
void write_state_picture(const CommonOptions& options, const OutputCase& wanted, const std::string& suffix,
                         const AssemblyState& state, const PictureOptions& picture);

/// The assembly itself, where [output] asks for it.
/// \param assembly returns it when it is written
OutputPart assembly_part(const OutputCase& wanted, const std::function<const Assembly&()>& assembly);

}  // namespace equidem
