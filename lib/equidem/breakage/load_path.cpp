// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/load_path.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/loads.hpp"

namespace equidem {
namespace {

bool any_nonzero(const std::vector<double>& numbers) {
  return std::any_of(numbers.begin(), numbers.end(), [](double x) { return x != 0; });
}

/// The sum of |f_d| over discs, moments over the mean radius.
double sum_of_loads(const std::vector<double>& force, std::size_t per_disc) {
  double sum = 0;
  for (std::size_t first = 0; first < force.size(); first += per_disc) {
    double square = 0;
    for (std::size_t k = 0; k < per_disc; ++k) square += squared(force[first + k]);
    sum += std::sqrt(square);
  }
  return sum;
}

/// How far two supports move from each other, m: of the components that both prescribe.
double length_between(const Support& a, const Support& b) {
  const auto difference = [](const std::optional<double>& x, const std::optional<double>& y) {
    return x && y ? *y - *x : 0.0;
  };
  return std::hypot(difference(a.ux, b.ux), difference(a.uy, b.uy));
}

/// S of imposed motions, m: the largest relative motion of two supports; rotations, times a, from rest where all are
/// alike; motions from rest where no support moves against another.
/// \param scale a, m
double size_of_motions(const std::vector<Support>& supports, double scale) {
  std::map<std::string, Support> of_group;  // several supports of a group prescribe one motion
  for (const Support& support : supports) {
    Support& whole = of_group[support.group];
    if (support.ux) whole.ux = support.ux;
    if (support.uy) whole.uy = support.uy;
    if (support.rotation) whole.rotation = support.rotation;
  }
  using Translation = std::pair<std::optional<double>, std::optional<double>>;
  std::set<Translation> translations;
  std::set<double> rotations;
  for (const auto& [group, support] : of_group) {
    translations.insert({support.ux, support.uy});
    if (support.rotation) rotations.insert(scale * *support.rotation);
  }
  double between = 0, from_rest = 0;
  if (rotations.size() == 1) between = std::abs(*rotations.begin());
  if (rotations.size() > 1) between = *rotations.rbegin() - *rotations.begin();
  for (const auto& [ux, uy] : translations) {
    const Support one{{}, ux, uy, {}};
    from_rest = std::max(from_rest, length_between({{}, 0.0, 0.0, {}}, one));
    for (const auto& [vx, vy] : translations) between = std::max(between, length_between(one, {{}, vx, vy, {}}));
  }
  return between > 0 ? between : from_rest;
}

void check_strain(const Assembly& assembly, const Voigt& strain) {
  if (!std::isfinite(strain.xx) || !std::isfinite(strain.yy) || !std::isfinite(strain.xy))
    bad_input("the mean strain is not finite", "no motion could follow it", "Give numbers");
  if (assembly.periodic()) return;
  bad_input("a mean strain is given, and the assembly is not periodic",
            "it moves the images of a cell; a free assembly has none",
            "Take a periodic assembly, or move the sides by [[support]]");
}

}  // namespace

void check_legs(const std::vector<double>& legs) {
  double from = 0;
  for (const double to : legs) {
    if (!std::isfinite(to))
      bad_input(fmt::format("a leg ends at lambda = {}", to), "it must be finite", "Give a number");
    if (to == from) {
      bad_input(fmt::format("a leg leads from lambda = {:g} to the same value", to), "nothing happens on it",
                "Remove it");
    }
    from = to;
  }
}

namespace {

[[noreturn]] void refuse_nothing() {
  bad_input("nothing grows with lambda", "the loads, the imposed motions and the mean strain are all zero or absent",
            "Add [[load]], a motion in [[support]], or [strain]");
}

/// N/m, m or a strain; and Pa: the largest squared over the softest spring, 1e300, stays within a double.
constexpr double most_driving = 1e70, stiffest = 1e160;
constexpr const char* unit_of_size = "Choose another unit; lambda multiplies what grows";

/// Energies must stay within a double: sizes lie between 1/`most` and `most`.
void check_size(const std::string& what, double size, double most, const char* remedy) {
  if (size >= 1 / most && size <= most) return;
  bad_input(
      fmt::format("the size of {} is {:g}", what, size),
      fmt::format("energies would leave the range of numbers: sizes from {:g} to {:g} can be followed", 1 / most, most),
      remedy);
}

}  // namespace

/// With kT < 0 every equilibrium is a saddle of the energy (one negative eigenvalue for each rotation): statics solves
/// for it, but no motion of the discs leads from one to the next, which is what a break asks for.
void check_breaking_springs(const ContactSprings& springs) {
  if (springs.bends()) {
    bad_input("bending springs in a network that breaks at rest",
              "the search for the next break knows forces, and no moments of contacts",
              "Take kM and bond_width out; bonds of colliding bodies carry moments and break in run");
  }
  check_size("the largest spring", springs.largest(), stiffest, "Check the unit of kN and kT, which are in Pa");
  if (!springs.any_negative()) return;
  bad_input("kT < 0 in a network that breaks",
            "behind a break the discs move to another equilibrium, and with kT < 0 no motion of discs is stable",
            "Take kT >= 0; solve gives the forces of the unbroken network for any kT");
}

LoadPath make_load_path(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                        const LoadPathOptions& options) {
  check_breaking_springs(springs);
  check_legs(options.legs);
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, options.supports);
  LoadPath path;
  path.legs = options.legs;
  path.max_events = options.max_events;
  path.control = options.control;
  path.pattern.force = assemble_loads(assembly, unknowns, options.loads);
  check_inert_loads(assembly, unknowns, path.pattern.force);
  path.pattern.prescribed = unknowns.prescribed;
  std::vector<std::string> driving;
  if (any_nonzero(path.pattern.force)) {
    driving.emplace_back("the loads");
    path.driven_by = DrivenBy::loads;
    path.size = sum_of_loads(path.pattern.force, static_cast<std::size_t>(unknowns.per_disc));
  }
  if (any_nonzero(path.pattern.prescribed)) {
    driving.emplace_back("the motions of supports");
    path.driven_by = DrivenBy::motions;
    path.size = size_of_motions(options.supports, unknowns.rotation_scale);
  }
  if (options.strain) {
    const Voigt& e = *options.strain;
    check_strain(assembly, e);
    path.pattern.gradient = Tensor2{e.xx, 0.5 * e.xy, 0.5 * e.xy, e.yy};
    const double size = std::max({std::abs(e.xx), std::abs(e.yy), std::abs(e.xy)});
    if (size > 0) {
      driving.emplace_back("the mean strain");
      path.driven_by = DrivenBy::strain;
      path.size = size;
    }
  }
  if (driving.empty()) refuse_nothing();
  if (driving.size() > 1) {
    bad_input(fmt::format("{} grow with lambda together", listed(driving)),
              "the load and the motion through which it works are then not one pair of numbers",
              "Keep one; loads that stay are [[dead_load]]");
  }
  check_size(driving.front(), path.size, most_driving, unit_of_size);
  if (!options.dead_loads.empty()) {
    RightHandSide dead;
    dead.force = assemble_loads(assembly, unknowns, options.dead_loads);
    check_inert_loads(assembly, unknowns, dead.force);
    if (any_nonzero(dead.force)) {
      check_size("the dead loads", sum_of_loads(dead.force, static_cast<std::size_t>(unknowns.per_disc)), most_driving,
                 unit_of_size);
      path.dead = std::move(dead);
    }
  }
  return path;
}

namespace {

/// Sums over the contacts.
enum : std::size_t {
  energy_0,
  energy_1,
  energy_2,
  imposed_0,
  imposed_1,
  stress_0,
  stress_1 = stress_0 + 4,
  sums = stress_1 + 4
};

double product(std::span<const double> a, std::span<const double> b) {
  if (a.empty() || b.empty()) return 0;
  return contact_sums<1>(a.size(), [&](std::size_t k, std::array<double, 1>& sum) { sum[0] += a[k] * b[k]; })[0];
}

void add_tensor(const Tensor2& t, double* sum) {
  const double entries[] = {t.xx, t.xy, t.yx, t.yy};
  for (std::size_t e = 0; e < 4; ++e) sum[e] += entries[e];
}

Tensor2 tensor_of(const double* sum) {
  return {sum[0], sum[1], sum[2], sum[3]};
}

}  // namespace

double area_of_stress(const Assembly& assembly) {
  return assembly.periodic() || !assembly.cell_areas.empty() ? assembly.area() : 0;
}

double largest_force(std::span<const ContactForce> forces) {
  double most = 0;
  for (const ContactForce& f : forces) most = std::max({most, std::abs(f.normal), std::abs(f.tangential)});
  return most;
}

NetworkResponse response_of(const BreakableSystem& system, const Assembly& assembly, const ContactSprings& springs,
                            const LoadPath& path) {
  const bool dead = path.dead.has_value();
  const std::span<const ContactForce> f1 = system.forces(0), f0 = dead ? system.forces(1) : f1.first(0);
  const auto total = contact_sums<sums>(assembly.contacts.size(), [&](std::size_t c, std::array<double, sums>& sum) {
    const ContactForce a = dead ? f0[c] : ContactForce{}, b = f1[c];
    if (a.normal == 0 && a.tangential == 0 && b.normal == 0 && b.tangential == 0) return;
    const SpringConstants k = springs[c];
    const ContactFrame frame = frame_of(assembly, c);
    sum[energy_0] += linear_spring_energy_of(k, a);
    sum[energy_1] += a.normal * b.normal / k.kN + (k.kT != 0 ? a.tangential * b.tangential / k.kT : 0.0);
    sum[energy_2] += linear_spring_energy_of(k, b);
    const Vec2 branch = assembly.branch(assembly.contacts[c]);
    add_tensor(outer(force_on_i(frame, a), branch), &sum[stress_0]);
    add_tensor(outer(force_on_i(frame, b), branch), &sum[stress_1]);
    if (!path.pattern.gradient) return;
    const ContactDeformation d = affine_deformation(frame, branch, *path.pattern.gradient);
    sum[imposed_0] += a.normal * d.normal + a.tangential * d.tangential;
    sum[imposed_1] += b.normal * d.normal + b.tangential * d.tangential;
  });
  EquilibriumSums all;
  all.imposed = {total[imposed_1], total[imposed_0]};
  all.moment = {tensor_of(&total[stress_1]), tensor_of(&total[stress_0])};
  const std::span<const double> u1 = system.motion(0), u0 = dead ? system.motion(1) : u1.first(0);
  const std::vector<double>& p1 = path.pattern.force;
  all.load_work[0] = {product(p1, u1), product(p1, u0)};
  if (dead) all.load_work[1] = {product(path.dead->force, u1), product(path.dead->force, u0)};
  all.imposed[0] += product(path.pattern.prescribed, system.reactions(0));
  if (dead) all.imposed[1] += product(path.pattern.prescribed, system.reactions(1));
  NetworkResponse r = response_of(all, path, area_of_stress(assembly));
  r.energy = {total[energy_0], total[energy_1], total[energy_2]};
  return r;
}

NetworkResponse response_of(const EquilibriumSums& sums, const LoadPath& path, double area) {
  const auto& [by_pattern, by_dead] = sums.load_work;
  NetworkResponse r;
  r.loads_by_motions = {by_dead[1], by_dead[0] + by_pattern[1], by_pattern[0]};
  r.power = {by_dead[0] + sums.imposed[1], by_pattern[0] + sums.imposed[0]};
  r.energy = {0.5 * by_dead[1], r.power[0], 0.5 * r.power[1]};  // Clapeyron
  if (area > 0) r.stress = {1 / area * sums.moment[1], 1 / area * sums.moment[0]};
  if (path.driven_by == DrivenBy::loads) {
    r.load = {0, path.size};
    r.motion = {by_pattern[1] / path.size, by_pattern[0] / path.size};
  } else {
    const double by = path.driven_by == DrivenBy::strain ? path.size * area : path.size;
    r.load = {sums.imposed[1] / by, sums.imposed[0] / by};
    r.motion = {0, path.size};
  }
  return r;
}

}  // namespace equidem
