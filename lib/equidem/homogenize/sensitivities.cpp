// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/sensitivities.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/statistics.hpp"
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

/// The contacts that carry load in the states of a result.
std::vector<std::int32_t> bearing_contacts(const Assembly& assembly, const ContactSprings& springs,
                                           const EffectiveStiffness& result) {
  return bearing_contacts(assembly, result.discs_removed > 0 ? load_bearing_network(assembly, springs, result.effects)
                                                             : LoadBearingNetwork{});
}

EndMotions end_motions(const EffectiveStiffness& result, const Contact& contact, std::size_t strain) {
  const std::vector<DiscMotion>& motions = result.fluctuations[strain];
  return {motions[contact.i], motions[contact.j], unit_gradients[strain]};
}

void refuse_unsuitable(const EffectiveStiffness& result) {
  if (result.fluctuations.size() < 3) {
    bad_input("derivatives of the stiffness are asked for, and the boundary carries tractions",
              "they follow from the states of prescribed mean strains",
              "Use boundary = \"periodic\" or \"displacement\"");
  }
  const std::int64_t unstable = result.unstable_modes.value_or(0);
  if (unstable == 0) return;
  bad_input(fmt::format("derivatives of the stiffness are asked for, and the network has {}",
                        counted(unstable, "unstable mode")),
            "their stiffness is that of no state of rest", "Choose springs at which it is stable");
}

}  // namespace

SpringSensitivities spring_sensitivities(const Assembly& assembly, const ContactSprings& springs,
                                         const EffectiveStiffness& result) {
  refuse_unsuitable(result);
  SpringSensitivities found;
  found.by_kN.resize(assembly.contacts.size());
  found.by_kT.resize(assembly.contacts.size());
  if (springs.bends()) found.by_kM.resize(assembly.contacts.size());
  for (const std::int32_t number : bearing_contacts(assembly, springs, result)) {
    const auto c = static_cast<std::size_t>(number);
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    Strains stretch, slip, turn;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto& [i, j, gradient] = end_motions(result, contact, a);
      const ContactDeformation beside = deformation(frame, i, j);
      const ContactDeformation mean = affine_deformation(frame, assembly.branch(contact), gradient);
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

namespace {

void refuse_shapes(const Assembly& assembly, const ContactSprings& springs) {
  constexpr const char* asked = "derivatives by positions and radii are asked for";
  if (!assembly.periodic())
    bad_input(std::string(asked) + " of a sample with sides", "its area changes with the discs at them",
              "Take a periodic cell");
  if (!assembly.contact_arms.empty())
    bad_input(std::string(asked) + ", and contact points are off the line of centres",
              "how they move with the bodies is not known", "Take discs");
  if (springs.prestressed())
    bad_input(std::string(asked) + ", and contacts carry forces at rest", "these would change too",
              "Write prestress = \"off\" in [effects]");
}

/// The upper half is that below the diagonal.
void mirror(Matrix3& symmetric) {
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < a; ++b) symmetric[b][a] = symmetric[a][b];
}

/// Whether each contact point divides the distance as the radii do.
bool points_by_radii(const Assembly& assembly) {
  return std::ranges::all_of(assembly.contacts, [&](const Contact& c) {
    const double r_i = assembly.radii[c.i], r_j = assembly.radii[c.j];
    return std::abs(c.lever_i * r_j - c.lever_j * r_i) <= 1e-9 * std::abs(c.lever_i * r_j);
  });
}

}  // namespace

ShapeSensitivities shape_sensitivities(const Assembly& assembly, const ContactSprings& springs,
                                       const EffectiveStiffness& result) {
  refuse_unsuitable(result);
  refuse_shapes(assembly, springs);
  ShapeSensitivities found{.by_position = std::vector<std::array<Matrix3, 2>>(assembly.size()), .by_radius = {}};
  if (points_by_radii(assembly)) found.by_radius.resize(assembly.size());
  for (const std::int32_t number : bearing_contacts(assembly, springs, result)) {
    const auto c = static_cast<std::size_t>(number);
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    const Vec2 branch = assembly.branch(contact);
    const double r_i = assembly.radii[contact.i], r_j = assembly.radii[contact.j];
    const double per_radius = norm(branch) / ((r_i + r_j) * (r_i + r_j));
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const EndMotions of_a = end_motions(result, contact, a), of_b = end_motions(result, contact, b);
        const auto [by_branch, by_point] =
            energy_by_shape(frame, branch, springs[c],
                            {of_a, of_b, deformation(frame, branch, of_a), deformation(frame, branch, of_b)});
        const auto add = [&, &by = by_branch, area = result.area](std::int32_t disc, double sign) {
          found.by_position[disc][0][a][b] += sign * by.x / area;
          found.by_position[disc][1][a][b] += sign * by.y / area;
        };
        add(contact.j, 1);
        add(contact.i, -1);
        if (found.by_radius.empty()) continue;
        found.by_radius[contact.i][a][b] += by_point * r_j * per_radius / result.area;
        found.by_radius[contact.j][a][b] -= by_point * r_i * per_radius / result.area;
      }
    }
  }
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    mirror(found.by_position[d][0]), mirror(found.by_position[d][1]);
    if (!found.by_radius.empty()) mirror(found.by_radius[d]);
  }
  return found;
}

bool has_shape_sensitivities(const Assembly& assembly, const ContactSprings& springs) {
  return assembly.periodic() && assembly.contact_arms.empty() && !springs.prestressed();
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

SpringDerivatives modulus_by_springs(const Matrix3& stiffness, const SpringSensitivities& sensitivities,
                                     double ModuliChange::*modulus) {
  const auto each = [&](const std::vector<Matrix3>& changes) {
    std::vector<double> found;
    found.reserve(changes.size());
    for (const Matrix3& change : changes) found.push_back(change_of_moduli(stiffness, change).*modulus);
    return found;
  };
  return {each(sensitivities.by_kN), each(sensitivities.by_kT), each(sensitivities.by_kM)};
}

namespace {

/// Returns the forces of contacts c of the part that carries load on discs, with their springs multiplied by z_c, under
/// the states of unit mean strains.
std::vector<RightHandSide> forces_of_changed_springs(const SampleSolver& sample, const EffectiveStiffness& result,
                                                     const std::vector<std::int32_t>& numbers, const Assembly& whole,
                                                     const std::vector<double>& z) {
  const DegreesOfFreedom& unknowns = sample.unknowns();
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<RightHandSide> cases(3);
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double>& force = cases[a].force;
    force.assign(unknowns.held.size(), 0.0);
    for (std::size_t c = 0; c < numbers.size(); ++c) {
      const Contact &inside = sample.assembly().contacts[c], &contact = whole.contacts[numbers[c]];
      const ContactFrame frame = frame_of(whole, numbers[c]);
      const auto& [i, j, gradient] = end_motions(result, contact, a);
      const ContactDeformation beside = deformation(frame, i, j);
      const ContactDeformation mean = affine_deformation(frame, whole.branch(contact), gradient);
      const SpringConstants& k = sample.springs()[c];
      const ContactForce f = linear_spring_force(
          k, ContactDeformation{z[c] * (beside.normal + mean.normal), z[c] * (beside.tangential + mean.tangential)});
      const double bending =
          sample.springs().bends() ? z[c] * bending_moment(sample.springs().bending(c), i.theta, j.theta) : 0;
      const auto add = [&](std::int32_t disc, Vec2 pull, double moment) {
        const std::size_t first = static_cast<std::size_t>(disc) * b;
        force[first] += pull.x, force[first + 1] += pull.y;
        if (b == 3) force[first + 2] += moment / unknowns.rotation_scale;
      };
      const Vec2 pull = force_on_i(frame, f);
      add(inside.i, pull, moment_on_i(frame, f) + bending);
      add(inside.j, -pull, moment_on_j(frame, f) - bending);
    }
    for (std::size_t k = 0; k < force.size(); ++k)
      if (unknowns.held[k] != 0) force[k] = 0;
  }
  return cases;
}

/// The second change of E and nu with those of K and G: d²E = -8 (G dK - K dG)²/(K + G)³, d²nu = 4 (dK + dG)
/// (K dG - G dK)/(K + G)³.
ModuliChange second_change(const EffectiveModuli& moduli, const ModuliChange& change) {
  const double K = moduli.bulk_modulus_2d, G = moduli.shear_modulus, sum = K + G;
  const double dK = change.bulk_modulus_2d / sum, dG = change.shear_modulus / sum;
  const double turn = (K * dG - G * dK) / sum;
  return {0, 0, -8 * turn * turn * sum, 4 * (dK + dG) * turn};
}

constexpr double ModuliChange::*every_modulus[] = {&ModuliChange::bulk_modulus_2d, &ModuliChange::shear_modulus,
                                                   &ModuliChange::young_modulus, &ModuliChange::poisson_ratio};

}  // namespace

MeanShift mean_shift_of_moduli(const Assembly& assembly, const ContactSprings& springs,
                               const EffectiveStiffness& result, const SpringSensitivities& sensitivities,
                               const MeanShiftOptions& options) {
  refuse_unsuitable(result);
  if (options.probes < 2)
    bad_input(fmt::format("{} random probes of the shift of the mean moduli", options.probes),
              "their scatter is the error of its estimate", "Take 2 or more");
  ModuliChange by_variances;
  const EffectiveModuli moduli = effective_moduli(result.stiffness);
  for (std::size_t c = 0; c < sensitivities.by_kN.size(); ++c) {
    Matrix3 change = springs[c].kN * sensitivities.by_kN[c] + springs[c].kT * sensitivities.by_kT[c];
    if (!sensitivities.by_kM.empty()) change = change + springs.bending(c) * sensitivities.by_kM[c];
    const ModuliChange second = second_change(moduli, change_of_moduli(result.stiffness, change));
    for (const auto modulus : every_modulus) by_variances.*modulus += 0.5 * second.*modulus;
  }
  EffectiveStiffness found;
  found.effects = result.effects;
  found.area = result.area;
  HomogenizeOptions homogenization;
  homogenization.boundary = result.boundary;
  homogenization.rotation = options.rotation;
  homogenization.solver = options.solver;
  SampleSolver sample = strain_sample(assembly, springs, homogenization, found);
  const std::vector<std::int32_t> numbers = bearing_contacts(assembly, springs, result);
  std::vector<std::vector<double>> shifts(std::size(every_modulus));
  Random random(options.seed);
  std::vector<double> z(numbers.size());
  for (int probe = 0; probe < options.probes; ++probe) {
    for (double& sign : z) sign = random.below(2) == 0 ? -1 : 1;
    const std::vector<RightHandSide> cases = forces_of_changed_springs(sample, result, numbers, assembly, z);
    const std::vector<Solution> solutions = sample.solve(cases, found);
    Matrix3 half;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        double work = 0;
        for (std::size_t k = 0; k < cases[a].force.size(); ++k) work += cases[a].force[k] * solutions[b].motion.high[k];
        half[a][b] = -work / result.area;
      }
    }
    const ModuliChange shift = change_of_moduli(result.stiffness, half);
    for (std::size_t m = 0; m < shifts.size(); ++m) shifts[m].push_back(shift.*every_modulus[m]);
  }
  MeanShift mean;
  for (std::size_t m = 0; m < shifts.size(); ++m) {
    const MeanEstimate of = estimate_mean(shifts[m], 0.95);
    mean.shift.*every_modulus[m] = of.mean + by_variances.*every_modulus[m];
    mean.standard_error.*every_modulus[m] = of.standard_error;
  }
  return mean;
}

}  // namespace equidem
