// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/network_response.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/ordered_sums.hpp"

namespace equidem {
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
