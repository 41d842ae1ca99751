// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/vibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {

void check_magnitudes(const Assembly& assembly, const ContactSprings& springs, const std::vector<Inertia>& inertia) {
  constexpr double most_ratio = 1e10;  // leaves six digits of the normal stiffness
  const auto fits = [](double value) { return value >= 1e-150 && value <= 1e150; };
  const auto refuse = [](const std::string& problem) {
    bad_input(problem, "beyond 1e-150 to 1e150 squares of frequencies and speeds leave the range of numbers",
              "Choose radius, density and springs nearer to those of a real assembly");
  };
  for (std::size_t d = 0; d < inertia.size(); ++d) {
    if (fits(inertia[d].mass) && fits(inertia[d].moment)) continue;
    refuse(fmt::format("disc {} has the mass {:.3g} and the moment of inertia {:.3g}, in kg and m", d, inertia[d].mass,
                       inertia[d].moment));
  }
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const SpringConstants k = springs[c];
    for (const std::int32_t d : {contact.i, contact.j}) {
      const double squared = k.kN / inertia[d].mass;
      if (!fits(squared)) refuse(fmt::format("contact {} has kN/m = {:.3g} 1/s² at disc {}", c, squared, d));
    }
    if (std::abs(k.kT) <= most_ratio * k.kN) continue;
    bad_input(fmt::format("contact {} has kT/kN = {:.3g}", c, k.kT / k.kN),
              fmt::format("springs so ill-scaled lose the normal stiffness in the round-off of the tangential one, "
                          "from about {:.0e} on",
                          most_ratio),
              "Choose kT nearer to kN");
  }
}

ExtremeEigenvalue extreme_squared_frequency(const Assembly& assembly, const ContactSprings& springs,
                                            const DegreesOfFreedom& unknowns, const std::vector<Inertia>& inertia,
                                            SpectrumEnd end, const LanczosOptions& options) {
  const ContactGraph graph(assembly);
  const StiffnessMatrix matrix = assemble_stiffness(assembly, graph, springs, unknowns);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<std::size_t> component;
  std::vector<double> inverse_root_mass;
  for (std::size_t k = 0; k < unknowns.held.size(); ++k) {
    if (unknowns.held[k] != 0) continue;
    const Inertia& body = inertia[k / b];
    const double scale = unknowns.rotation_scale;
    component.push_back(k);
    inverse_root_mass.push_back(1 / std::sqrt(k % b == 2 ? body.moment / (scale * scale) : body.mass));
  }
  constexpr std::size_t at_once = 1 << 13;
  std::vector<double> motion(unknowns.held.size(), 0.0), force(unknowns.held.size());
  return extreme_eigenvalue(
      component.size(),
      [&](std::span<const double> x, std::span<double> y) {
        parallel_ranges(component.size(), at_once, [&](std::size_t begin, std::size_t last) {
          for (std::size_t k = begin; k < last; ++k) motion[component[k]] = inverse_root_mass[k] * x[k];
        });
        multiply(matrix, assembly, graph, motion, force);
        parallel_ranges(component.size(), at_once, [&](std::size_t begin, std::size_t last) {
          for (std::size_t k = begin; k < last; ++k) y[k] = inverse_root_mass[k] * force[component[k]];
        });
      },
      end, options);
}

double element_bound(const Assembly& assembly, const ContactSprings& springs, const std::vector<Inertia>& inertia,
                     bool rotation) {
  std::vector<double> z(assembly.size(), 0.0);
  for (const Contact& contact : assembly.contacts) ++z[contact.i], ++z[contact.j];
  double bound = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const Inertia &i = inertia[contact.i], &j = inertia[contact.j];
    InverseInertia of_i{z[contact.i] / i.mass, z[contact.i] / i.moment};
    InverseInertia of_j{z[contact.j] / j.mass, z[contact.j] / j.moment};
    if (!rotation) of_i.moment = of_j.moment = 0;
    const ContactFrame frame = frame_of(assembly, c);
    const double kN = springs[c].kN, kT = std::max(springs[c].kT, 0.0), kM = rotation ? springs.bending(c) : 0;
    if (frame.offset_i == 0 && frame.offset_j == 0) {
      bound = std::max(bound, largest_bond_rate({kN, kT, kM}, frame, of_i, of_j));
      continue;
    }
    const BondModes inverse = bond_inverse_masses(frame, of_i, of_j);
    const double stretch =
        inverse.normal + of_i.moment * frame.offset_i * frame.offset_i + of_j.moment * frame.offset_j * frame.offset_j;
    const double both = of_i.moment * frame.offset_i * frame.lever_i + of_j.moment * frame.offset_j * frame.lever_j;
    const double middle = 0.5 * (kN * stretch + kT * inverse.tangential);
    const double coupled = middle * middle - kN * kT * (stretch * inverse.tangential - both * both);
    bound = std::max(bound, middle + std::sqrt(std::max(0.0, coupled)) + kM * inverse.rolling);
  }
  return bound;
}

TimeStepRules time_step_rules(const Assembly& assembly, const ContactSprings& springs,
                              const std::vector<Inertia>& inertia, bool rotation) {
  const double scale = assembly.mean_radius();
  std::vector<double> diagonal(3 * assembly.size(), 0.0);
  double mass_over_stiffness = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactStiffness k = contact_stiffness(springs, c, frame_of(assembly, c), scale);
    const auto add = [&](std::int32_t disc, const EndGradient& end) {
      std::array<double, 9> block{};
      k.add<3>(end, end, block.data());
      for (std::size_t r = 0; r < 3; ++r) diagonal[3 * disc + r] += block[4 * r];
    };
    add(contact.i, k.ends.i);
    add(contact.j, k.ends.j);
    mass_over_stiffness =
        std::min(mass_over_stiffness, std::min(inertia[contact.i].mass, inertia[contact.j].mass) / k.kN);
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t component = 0; component < diagonal.size(); ++component) {
    const bool turns = component % 3 == 2;
    if ((turns && !rotation) || diagonal[component] <= 0) continue;
    const Inertia& body = inertia[component / 3];
    shortest = std::min(shortest, (turns ? body.moment / (scale * scale) : body.mass) / diagonal[component]);
  }
  return {std::sqrt(2 * shortest), 2 * std::numbers::pi * std::sqrt(mass_over_stiffness) / 8};
}

}  // namespace equidem
