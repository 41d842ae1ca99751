// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/sensitivities.hpp"

#include <cmath>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/sample_solver.hpp"

namespace equidem {
namespace {

using Strains = std::array<double, 3>;  // a number of a contact by unit strain xx, yy, xy

Matrix3 products(const Strains& x, double area) {
  Matrix3 result;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) result[a][b] = x[a] * x[b] / area;
  return result;
}

/// The contacts that carry load. \param bearing empty where all do
std::vector<std::int32_t> bearing_contacts(const Assembly& assembly, const LoadBearingNetwork& bearing) {
  if (bearing.part) return bearing.part->contacts;
  std::vector<std::int32_t> all(assembly.contacts.size());
  for (std::size_t c = 0; c < all.size(); ++c) all[c] = static_cast<std::int32_t>(c);
  return all;
}

void refuse_unsuitable(const EffectiveStiffness& result) {
  if (result.fluctuations.size() < 3) {
    bad_input("derivatives by springs are asked for, and the boundary carries tractions",
              "they follow from the states of prescribed mean strains",
              "Use boundary = \"periodic\" or \"displacement\"");
  }
  const std::int64_t unstable = result.unstable_modes.value_or(0);
  if (unstable == 0) return;
  bad_input(
      fmt::format("derivatives by springs are asked for, and the network has {}", counted(unstable, "unstable mode")),
      "their stiffness is that of no state of rest", "Choose springs at which it is stable");
}

}  // namespace

SpringSensitivities spring_sensitivities(const Assembly& assembly, const ContactSprings& springs,
                                         const EffectiveStiffness& result) {
  refuse_unsuitable(result);
  const LoadBearingNetwork bearing =
      result.discs_removed > 0 ? load_bearing_network(assembly, springs, result.effects) : LoadBearingNetwork{};
  SpringSensitivities found;
  found.by_kN.resize(assembly.contacts.size());
  found.by_kT.resize(assembly.contacts.size());
  if (springs.bends()) found.by_kM.resize(assembly.contacts.size());
  for (const std::int32_t number : bearing_contacts(assembly, bearing)) {
    const auto c = static_cast<std::size_t>(number);
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    Strains stretch, slip, turn;
    for (std::size_t a = 0; a < 3; ++a) {
      const DiscMotion &i = result.fluctuations[a][contact.i], &j = result.fluctuations[a][contact.j];
      const ContactDeformation beside = deformation(frame, i, j);
      const ContactDeformation mean = affine_deformation(frame, assembly.branch(contact), unit_gradients[a]);
      stretch[a] = beside.normal + mean.normal;
      slip[a] = beside.tangential + mean.tangential;
      turn[a] = j.theta - i.theta;
    }
    found.by_kN[c] = products(stretch, result.area);
    found.by_kT[c] = products(slip, result.area);
    if (springs.bends()) found.by_kM[c] = products(turn, result.area);
  }
  return found;
}

Matrix3 change_by_springs(const ContactSprings& springs, const SpringSensitivities& sensitivities,
                          std::size_t contact) {
  Matrix3 change =
      springs[contact].kN * sensitivities.by_kN[contact] + springs[contact].kT * sensitivities.by_kT[contact];
  if (!sensitivities.by_kM.empty()) change = change + springs.bending(contact) * sensitivities.by_kM[contact];
  return change;
}

ModuliChange change_of_moduli(const Matrix3& stiffness, const Matrix3& change) {
  const auto [K, G] = isotropic_part(stiffness);
  const auto [dK, dG] = isotropic_part(change);
  const double bulk = K / (K + G), shear = G / (K + G);  // E = 4KG/(K + G), nu = (K - G)/(K + G)
  return {.bulk_modulus_2d = dK,
          .shear_modulus = dG,
          .young_modulus = 4 * (shear * shear * dK + bulk * bulk * dG),
          .poisson_ratio = 2 * (shear * dK - bulk * dG) / (K + G)};
}

ModuliChange scatter_of_moduli(const ContactSprings& springs, const Matrix3& stiffness,
                               const SpringSensitivities& sensitivities) {
  double squares[4] = {};
  for (std::size_t c = 0; c < sensitivities.by_kN.size(); ++c) {
    const ModuliChange of = change_of_moduli(stiffness, change_by_springs(springs, sensitivities, c));
    const double changes[] = {of.bulk_modulus_2d, of.shear_modulus, of.young_modulus, of.poisson_ratio};
    for (std::size_t k = 0; k < 4; ++k) squares[k] += changes[k] * changes[k];
  }
  return {std::sqrt(squares[0]), std::sqrt(squares[1]), std::sqrt(squares[2]), std::sqrt(squares[3])};
}

}  // namespace equidem
