// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/effective_stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

/// Error from levers that leave a gap or an overlap: a rigid rotation of all discs would make their contact slip.
void check_levers(const Assembly& assembly, const ContactSprings& springs, const Effects& effects) {
  if (!effects.rotation || !assembly.contact_arms.empty()) return;  // check(Assembly) ensures that these meet
  constexpr double close = 1e-9, rounding = 8 * std::numeric_limits<double>::epsilon();  // of lengths, of coordinates
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    const double length = norm(assembly.branch(c));
    const Vec2 shift = assembly.period ? Vec2{c.shift_x * assembly.period->x, c.shift_y * assembly.period->y} : Vec2{};
    const double coordinates = norm(assembly.centres[c.i]) + norm(assembly.centres[c.j]) + norm(shift);
    const double gap = std::abs(c.lever_i + c.lever_j - length);
    if (springs[k].kT == 0 || gap <= close * length + rounding * coordinates) continue;
    bad_input(
        fmt::format(
            "contact {}, of discs {} and {}, has the lever arms {:.9g} and {:.9g} m over a distance of {:.9g} m", k,
            c.i, c.j, c.lever_i, c.lever_j, length),
        "they do not add up to it, so that turning the whole assembly would cost energy and no continuum is like it",
        "Correct the levers, or restrain rotation");
  }
}

/// Solve with springs of sizes near 1, so that no sum of squares leaves the range of a double.
EffectiveStiffness solve(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options) {
  const double unit = spring_unit(springs);
  const ContactSprings scaled = scaled_springs(springs, 1 / unit);
  EffectiveStiffness result;
  result.boundary = options.boundary;
  result.effects = derive_effects(assembly, springs, options.rotation);
  result.area = assembly.area();
  if (options.boundary == Boundary::traction) {
    solve_tractions(assembly, scaled, options, result);
  } else {
    solve_strains(assembly, scaled, options, result);
  }
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  result.error_bound += rounding * largest_entry(result.stiffness);
  result.scale(unit);
  result.cauchy = result.stiffness;
  if (springs.prestressed()) add_stress_at_rest(mean_stress_at_rest(assembly), result);
  if (!std::isfinite(8 * largest_entry(result.stiffness))) {  // sums of entries, too
    bad_input("the stiffness overflows a double", "the largest is 1.8e308", "Check the units of sizes and springs");
  }
  return result;
}

/// The network resists every mean strain where all springs are alike: what fails with others is for their sizes.
bool resists_with_equal_springs(const Assembly& assembly, const ContactSprings& springs,
                                const HomogenizeOptions& options) {
  try {
    EffectiveStiffness equal = solve(assembly, equal_springs(springs, assembly.mean_radius()), options);
    return !equal.judge_strains();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted || error.kind() == ErrorKind::out_of_memory) throw;
    return false;
  }
}

[[noreturn]] void refuse(const std::string& strain, const Assembly& assembly, const ContactSprings& springs,
                         const HomogenizeOptions& options) {
  if (!resists_with_equal_springs(assembly, springs, options)) {
    bad_input(
        "the network is floppy", strain + " costs no energy beyond rounding",
        "It has no modulus. " +
            remedy_of_mechanisms(assembly, springs, derive_effects(assembly, springs, options.rotation).rotation));
  }
  if (springs.any_negative()) {
    computation_failed("at this kT/kN the network is at its limit of stability",
                       "rounding hides the energy of " + strain,
                       "Choose another kT/kN; 'equidem stability' finds the limit");
  }
  constexpr double all_digits = 1e8;
  const double spread = spring_spread(assembly, springs);
  if (spread > all_digits) refuse_spread(spread);
  computation_failed("the network is nearly floppy", "rounding hides the energy of " + strain,
                     "Add contacts, or tangential springs where kT is 0");
}

}  // namespace

Tensor2 mean_stress_at_rest(const Assembly& assembly) {
  std::vector<ContactForce> at_rest(assembly.contacts.size());
  for (std::size_t c = 0; c < at_rest.size(); ++c) at_rest[c] = force_at_rest(assembly, c);
  return macroscopic_stress(assembly, at_rest);
}

void add_stress_at_rest(const Tensor2& at_rest, EffectiveStiffness& result) {
  result.stress_at_rest = at_rest;
  const Matrix3 change = change_to_cauchy(at_rest);
  result.cauchy = result.stiffness + change;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      result.prestress_part[a][b] += 0.5 * (change[a][b] + change[b][a]);
      result.stiffness[a][b] = 0.5 * (result.cauchy[a][b] + result.cauchy[b][a]);
    }
  }
  Matrix4& g = result.gradient_stiffness;
  if (!result.effects.restrained) {
    const Tensor2 turned = unit_gradients[3] * at_rest;
    const double column[] = {turned.xx, turned.yy, turned.xy, turned.yx};
    for (int r = 0; r < 4; ++r) g[r][2] -= 0.5 * column[r], g[r][3] += 0.5 * column[r];
  }
  const Tensor2 gradients[] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  double asymmetric = 0;
  for (int c = 0; c < 4; ++c) {
    const Tensor2 kirchhoff = Tensor2{g[0][c], g[2][c], g[3][c], g[1][c]} + at_rest * transposed(gradients[c]);
    asymmetric = std::max(asymmetric, std::abs(asymmetry(kirchhoff)));
  }
  result.stress_asymmetry = asymmetric / largest_entry(g);
}

Matrix3 change_to_cauchy(const Tensor2& at_rest) {
  Matrix3 change{};
  for (int k = 0; k < 3; ++k) {
    const Tensor2& h = unit_gradients[k];
    const Voigt s = voigt_stress(at_rest * transposed(h) + (-(h.xx + h.yy)) * at_rest);
    change[0][k] = s.xx, change[1][k] = s.yy, change[2][k] = s.xy;
  }
  return change;
}

void EffectiveStiffness::scale(double factor) {
  stiffness = factor * stiffness;
  tangential_part = factor * tangential_part;
  normal_part = factor * normal_part;
  bending_part = factor * bending_part;
  prestress_part = factor * prestress_part;
  gradient_stiffness = factor * gradient_stiffness;
  error_bound *= factor;
}

std::optional<std::string> EffectiveStiffness::judge_strains(double nothing) {
  const StiffnessEigen eigen = eigenstrains(stiffness);
  const double largest = std::max(std::abs(eigen.values[0]), std::abs(eigen.values[2]));
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(eigen.values[k]) > nothing * largest + 2 * error_bound) continue;
    const auto& [xx, yy, xy] = eigen.strains[k];
    return fmt::format("the mean strain (xx {:.3f}, yy {:.3f}, shear {:.3f})", xx, yy, xy);
  }
  unstable_strains = std::count_if(eigen.values.begin(), eigen.values.end(), [](double v) { return v < 0; });
  // The inertia of motions and mean strain together is that of K and that of C, its Schur complement (Haynsworth 1968).
  if (unstable_strains > 0) unstable_modes = unstable_modes.value_or(0) + unstable_strains;
  return {};
}

void check_sample(const Assembly& assembly, const ContactSprings& springs, const HomogenizeOptions& options) {
  check(assembly);
  check(options.solver);
  if (assembly.contacts.empty()) {
    bad_input("the assembly has no contacts", "nothing resists its deformation", "Give it contacts");
  }
  if (options.boundary == Boundary::periodic && !assembly.periodic()) {
    bad_input("the boundary is periodic but the assembly is not", "it has no images to be joined to",
              "Use boundary = \"displacement\" or \"traction\", or a periodic assembly");
  }
  if (springs.prestressed() && options.boundary == Boundary::traction) {
    bad_input("boundary = \"traction\" with forces at rest that count",
              "contacts across the cut would have to carry them as loads that turn with the sample",
              "Use boundary = \"periodic\" or \"displacement\", or effects.prestress = \"off\"");
  }
  check_levers(assembly, springs, derive_effects(assembly, springs, options.rotation));
}

EffectiveStiffness effective_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                       const HomogenizeOptions& options) {
  check_sample(assembly, springs, options);
  EffectiveStiffness result = solve(assembly, springs, options);
  if (const auto weak = result.judge_strains()) refuse(*weak, assembly, springs, options);
  return result;
}

DisplacementOperator displacement_operator(const EffectiveStiffness& result) {
  const Matrix4& c = result.gradient_stiffness;
  const EffectiveModuli moduli = effective_moduli(result.stiffness);
  const double kappa = 0.25 * (c[2][2] + c[3][3] - c[2][3] - c[3][2]);
  return {.shear_modulus = moduli.shear_modulus + kappa, .bulk_modulus_2d = moduli.bulk_modulus_2d - kappa};
}

std::vector<StrainedState> strained_states(const Assembly& assembly, const ContactSprings& springs,
                                           const EffectiveStiffness& result, double strain) {
  const LoadBearingNetwork bearing =
      result.discs_removed > 0 ? load_bearing_network(assembly, springs, result.effects) : LoadBearingNetwork{};
  const std::array<Tensor2, 3> gradients{{{.xx = strain}, {.yy = strain}, {.xy = strain / 2, .yx = strain / 2}}};
  std::vector<StrainedState> states;
  for (std::size_t k = 0; k < result.fluctuations.size(); ++k) {
    StrainedState state{.gradient = gradients[k],
                        .fluctuations = result.fluctuations[k],
                        .forces = affine_contact_forces(assembly, springs, gradients[k], 0),
                        .bending_moments = {}};
    if (springs.bends()) state.bending_moments.resize(assembly.contacts.size());
    for (DiscMotion& motion : state.fluctuations) motion = {strain * motion.u, strain * motion.theta};
    for (std::size_t c = 0; c < state.forces.size(); ++c) {
      const Contact& contact = assembly.contacts[c];
      const DiscMotion &i = state.fluctuations[contact.i], &j = state.fluctuations[contact.j];
      const ContactForce f = force_of(springs, c, {deformation(frame_of(assembly, c), i, j), i.theta, j.theta});
      state.forces[c].normal += f.normal;
      state.forces[c].tangential += f.tangential;
      if (springs.bends()) state.bending_moments[c] = bending_moment(springs.bending(c), i.theta, j.theta);
    }
    if (bearing.part) {
      std::vector<ContactForce> carried(state.forces.size());
      std::vector<double> moments(state.bending_moments.size());
      for (const std::int32_t c : bearing.part->contacts) {
        carried[c] = state.forces[c];
        if (!moments.empty()) moments[c] = state.bending_moments[c];
      }
      state.forces = std::move(carried);
      state.bending_moments = std::move(moments);
    }
    states.push_back(std::move(state));
  }
  return states;
}

}  // namespace equidem
