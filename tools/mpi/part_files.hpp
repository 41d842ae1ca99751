// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Files for ParaView that every rank writes for its part, and their index.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "equidem/contact/frame.hpp"

#include "command.hpp"
#include "petsc/part.hpp"

namespace equidem {

/// Whether every disc that the rank owns has a cell of some area.
bool cells_are_known(const petsc::Part& part);

/// \throws Error (bad_input) where a file of any rank could not be written
void expect_part_files(const OutputPlan& plan, const petsc::Ranks& ranks, const std::string& name);

/// NAME_discs_K.vtp and NAME_contacts_K.vtp of rank K, by rank 0 also NAME.vtm.
/// \param motions per disc of the part
void write_part_files(const std::filesystem::path& folder, const std::string& name, const petsc::Ranks& ranks,
                      const petsc::Part& part, std::span<const DiscMotion> motions,
                      std::span<const ContactForce> forces, bool overwrite);

}  // namespace equidem
