// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/material_springs.hpp"

#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

ChosenRelation spring_relation(const Assembly& assembly, SpringWeighting weighting, const Lattice* lattice) {
  switch (weighting) {
    case SpringWeighting::contact_density:
    case SpringWeighting::local_contact_density:
      return {isotropic_relation, {assembly.solid_fraction(), 1.0}};
    case SpringWeighting::voronoi:
      return {isotropic_relation, {0.5, 1.0}};
    case SpringWeighting::uniform:
      break;
  }
  if (lattice != nullptr) return {lattice->relation, {}};
  const double psi = assembly.coordination_number() / (2 * std::numbers::pi);
  return {isotropic_relation, {assembly.solid_fraction(), psi}};
}

SpringConstants springs_of_moduli(const ElasticModuli& moduli, const Assembly& assembly, SpringWeighting weighting,
                                  const Lattice* lattice, NegativeTangential negative) {
  if (weighting != SpringWeighting::uniform && lattice != nullptr && lattice->relation.equal_springs != nullptr) {
    bad_input(fmt::format("the weighting is \"{}\" on the {}", to_string(weighting), lattice->relation.place),
              fmt::format("its relation to moduli ({}) is for equal springs", lattice->relation.source),
              "Use weighting = \"uniform\"");
  }
  const ChosenRelation chosen = spring_relation(assembly, weighting, lattice);
  return springs_for(moduli, chosen.relation, chosen.measures, negative);
}

std::optional<double> disc_density(std::optional<double> of_discs, std::optional<double> of_continuum, Body body,
                                   const Assembly& assembly) {
  if (!of_continuum) return of_discs;
  if (body == Body::sphere) {
    if (of_discs) return of_discs;
    bad_input("the density of a continuum does not give that of spheres",
              "a sheet of spheres has no mass per metre of depth", "Give assembly.density");
  }
  const double gamma = *of_continuum;
  const double phi = assembly.solid_fraction();
  if (!of_discs) return gamma / phi;
  const double rho = *of_discs;
  constexpr double tolerance = 1e-6;
  if (std::abs(gamma - rho * phi) <= tolerance * gamma) return rho;
  bad_input(fmt::format("density = {:.9g} kg/m³ contradicts the density of the discs", gamma),
            fmt::format("discs of {:.9g} kg/m³ that fill {:.6g} of the area make {:.9g} kg/m³", rho, phi, rho * phi),
            "Remove one of the two");
}

}  // namespace equidem
