// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The springs with which an assembly represents a given continuum.
#pragma once

#include <optional>

#include "equidem/assembly/assembly.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem {

/// A relation between springs and moduli (Abe 1996) with the measures that it needs.
struct ChosenRelation {
  SpringRelation relation;
  IsotropicMeasures measures;
};

/// The relation that holds for an assembly: that of its lattice where springs are equal, else the isotropic one, (20)
/// and (21), with the solid fraction and the coordination number; of springs weighted by contact_density or
/// local_contact_density k psi = K/phi by (21); of springs weighted by voronoi K = kN/2, since the facets of Voronoi
/// cells obey sum h l = 2 V and uniform strain then stores w = kN <(n e n)²>.
/// \param lattice of the assembly; null: none
ChosenRelation spring_relation(const Assembly& assembly, SpringWeighting weighting, const Lattice* lattice);

/// The springs, before weighting, with which the assembly represents a continuum of these moduli.
/// \throws Error (bad_input) as springs_for; weighted springs on a lattice whose relation is for equal springs
SpringConstants springs_of_moduli(const ElasticModuli& moduli, const Assembly& assembly, SpringWeighting weighting,
                                  const Lattice* lattice, NegativeTangential negative = NegativeTangential::refuse);

/// The density rho of the discs themselves, kg/m³: the given one, else gamma/phi, gamma the density of the continuum
/// and phi the solid fraction (Abe 1996, section 2). None where neither is given.
/// \throws Error (bad_input): both are given and gamma differs from rho phi by more than 1e-6 of it; gamma alone is
///         given for spheres, since a sheet of them has no mass per metre of depth
std::optional<double> disc_density(std::optional<double> of_discs, std::optional<double> of_continuum, Body body,
                                   const Assembly& assembly);

}  // namespace equidem
