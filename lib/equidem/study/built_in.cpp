// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/built_in.hpp"

#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/names.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr BuiltInStudy studies[] = {
    {"abe_lattice", "nu and G of Abe's tension test against the size of the lattice", abe_lattice_study},
    {"random_assembly", "moduli of random periodic cells against discs and seeds", random_assembly_study},
    {"solvers", "solvers of a block in tension: direct, multigrid, relaxation; error, time and memory by size",
     solvers_study, solvers_study_up_to},
    {"collision_laws", "laws of collision against the time step: one impact, stacked spheres", collision_laws_study},
    {"integrators", "integrators against the time step on a wave in a bonded lattice", integrators_study},
    {"ellipse_contact", "contact of ellipses: exact, sampled, enlarged as printed and mended", ellipse_contact_study},
    {"settled_void_ratio", "void ratio of discs that fell, against the time step", settled_void_ratio_study},
    {"neighbour_margin", "margin of the neighbour lists: time alone", neighbour_margin_study},
    {"effects", "each effect of the motion: time and bytes", effects_study},
    {"effects_statics", "tangential springs and rotations in statics: unknowns, factor, time", effects_statics_study},
};

}  // namespace

std::span<const BuiltInStudy> built_in_studies() {
  return studies;
}

Study built_in_study(const std::string& name, bool quick, double discs) {
  std::vector<std::string> names;
  for (const BuiltInStudy& study : studies) {
    if (study.name == name && discs > 0 && study.make_up_to == nullptr)
      bad_input(fmt::format("the study '{}' takes no number of discs", name), "its sizes are fixed",
                "Leave out --discs");
    if (study.name == name) return discs > 0 ? study.make_up_to(discs) : study.make(quick);
    names.emplace_back(study.name);
  }
  const auto meant = nearest(name, names);
  bad_input(fmt::format("there is no study '{}'", name), "the built-in ones are " + joined(names),
            meant ? fmt::format("Did you mean '{}'?", *meant) : "Choose one of them, or give a study file (.toml)");
}

}  // namespace equidem
