// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The built-in studies, one file each.
#pragma once

#include <span>
#include <string>

#include "equidem/material/spring_constants.hpp"
#include "equidem/study/study.hpp"

namespace equidem {

struct BuiltInStudy {
  const char* name;
  const char* summary;        ///< one line of the help
  Study (*make)(bool quick);  ///< quick: fewer and smaller settings
  /// The study with problems of up to that many discs; null: its sizes are fixed.
  Study (*make_up_to)(double discs) = nullptr;
};
std::span<const BuiltInStudy> built_in_studies();

/// \param discs of the largest problem; 0: as the study has it
/// \throws Error (bad_input) naming the choices, or where the sizes of the study are fixed and discs are given
Study built_in_study(const std::string& name, bool quick, double discs = 0);

/// Springs of every contact in the studies of lattices and random cells, Pa.
inline constexpr SpringConstants study_springs{1e9, 0.5e9};

// The studies.
Study abe_lattice_study(bool quick);
Study random_assembly_study(bool quick);
Study solvers_study(bool quick);
Study solvers_study_up_to(double discs);
Study collision_laws_study(bool quick);
Study integrators_study(bool quick);
Study ellipse_contact_study(bool quick);
Study settled_void_ratio_study(bool quick);
Study neighbour_margin_study(bool quick);
Study effects_study(bool quick);
Study effects_statics_study(bool quick);

}  // namespace equidem
