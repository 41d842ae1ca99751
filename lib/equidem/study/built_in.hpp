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
};
std::span<const BuiltInStudy> built_in_studies();

/// \throws Error (bad_input) naming the choices
Study built_in_study(const std::string& name, bool quick);

/// Springs of every contact in the studies of lattices and random cells, Pa.
inline constexpr SpringConstants study_springs{1e9, 0.5e9};

// The studies.
Study abe_lattice_study(bool quick);
Study random_assembly_study(bool quick);
Study solvers_study(bool quick);
Study collision_laws_study(bool quick);
Study integrators_study(bool quick);
Study ellipse_contact_study(bool quick);
Study settled_void_ratio_study(bool quick);
Study neighbour_margin_study(bool quick);
Study effects_study(bool quick);
Study effects_statics_study(bool quick);

}  // namespace equidem
