// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/grain_time_step.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_step.hpp"

namespace equidem {
namespace {

using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The contact of the lightest bodies of two kinds.
struct Shortest {
  double duration = infinity;  ///< s
  double detail = infinity;    ///< s, to be resolved by steps: the duration, or the shorter time of a strong dashpot
  double omega = 0;            ///< 1/s; hertz_dashpot: at the largest overlap; 0: not known
  double zeta = 0;
  int a = 0, b = 0;
  bool any = false;  ///< two bodies can meet
};

/// Largest 1 + m l²/I of each kind: under a force with the lever l a body moves as if its mass were less by that
/// factor.
std::vector<double> agility_of_kinds(const GrainScene& scene) {
  std::vector<double> agility(static_cast<std::size_t>(scene.kinds), 1.0);
  for (const Grain& grain : scene.grains) {
    const double lever = longest_lever(grain, scene.clumps);
    double& most = agility[static_cast<std::size_t>(grain.kind)];
    most = std::max(most, 1 + grain.inertia.mass * lever * lever / grain.inertia.moment);
  }
  return agility;
}

/// \param step s, for a stiffness that is kept in steps; 0: not known
/// \throws Error where the contact of some pair has no known duration
Shortest shortest_contact(const GrainScene& scene, const ContactTable& contacts, const GrainOptions& options,
                          double step) {
  Shortest shortest;
  const LawDescription& law = describe(options.law);
  const auto masses = masses_of_kinds(scene.grains, scene.kinds);
  const auto agility = agility_of_kinds(scene);
  for (int a = 0; a < scene.kinds; ++a) {
    for (int b = a; b < scene.kinds; ++b) {
      const auto reduced = reduced_masses(masses, a, b);
      if (!reduced) continue;
      shortest.any = true;
      const PairContact& pair = contacts.between(a, b);
      const PairProperties& properties = pair.properties;
      if (properties.dimensionless > 0 && step == 0)
        bad_input_at("time_step", "time_step = \"auto\" with dimensionless_stiffness",
                     "the step is what makes the stiffness", "Give time_step = ... in s, or another stiffness");
      // Spring and dashpot of a contact are those of bodies that do not turn.
      const double faster =
          std::sqrt(std::max(agility[static_cast<std::size_t>(a)], agility[static_cast<std::size_t>(b)]));
      const double still = damping_ratio(options.law, properties), zeta = faster * still;
      double duration = 0, omega = 0;
      if (law.spring_power != 1) {
        if (pair.closing_speed == 0) {
          if (step > 0) return Shortest{.duration = 0, .any = true};
          bad_input_at("time_step", fmt::format("time_step = \"auto\" of {} without closing_speed", law.name),
                       "a contact of this law lasts the shorter the faster it is",
                       "Add closing_speed = ... in m/s to [collisions], or give time_step = ... in s");
        }
        const double k = properties.stiffness > 0
                             ? properties.stiffness
                             : properties.dimensionless * reduced->smallest /
                                   (step * step * law.length_factor(reference_length(scene, options)));
        const ElasticImpact impact = law.elastic_impact(k, reduced->smallest, pair.closing_speed);
        duration = impact.duration / faster;
        omega = faster * std::sqrt(law.spring_power * k * law.length_factor(impact.overlap) / reduced->smallest);
      } else {
        omega = faster * (pair.duration > 0          ? pi / (pair.duration * std::sqrt(1 - still * still))
                          : properties.stiffness > 0 ? std::sqrt(properties.stiffness / reduced->smallest)
                                                     : std::sqrt(properties.dimensionless) / step);
        duration = pi / (omega * (zeta < 1 ? std::sqrt(1 - zeta * zeta) : 1));
      }
      // simultaneous laws: omega dt = 1 by default, whatever the damping; else by the faster of the two rates of decay
      const double haste = zeta > 1 ? zeta + std::sqrt(zeta * zeta - 1) : 1;
      const double detail = law.kind == LawKind::simultaneous ? pi / omega : duration / haste;
      if (detail < shortest.detail)
        shortest = {.duration = duration, .detail = detail, .omega = omega, .zeta = zeta, .a = a, .b = b, .any = true};
    }
  }
  return shortest;
}

void limit_by_bonds(const GrainScene& scene, GrainOptions options, GrainTimeStep& result) {
  const double limit = bond_step_limit(scene, options.bond_step);
  if (std::isfinite(limit)) result.bond_limit = limit;
  if (result.automatic) result.step = std::min(result.step, 0.5 * limit);
  constexpr double one_percent = 0.1;  // of the limit of explicit dashpots
  const double explicit_limit = explicit_step_limit(scene);
  if (options.bond_step == GrainOptions::BondStep::exact && result.step > one_percent * explicit_limit)
    result.chain_limit = explicit_limit;
  options.time_step = result.step;
  try {
    check_bonds(scene, options);
  } catch (const Error& error) {
    throw error.at(is_simultaneous(options.law) ? "law" : result.step >= limit ? "time_step" : "bonds");
  }
}

}  // namespace

double longest_lever(const Grain& grain, std::span<const Clump> clumps) {
  switch (grain.shape()) {
    case GrainShape::disc:
      return 0;
    case GrainShape::ellipse:
      return grain.radius - grain.short_half_axis;
    case GrainShape::clump:
      break;
  }
  double lever = 0;
  for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs)
    lever = std::max(lever, norm(disc.offset));
  return lever;
}

GrainTimeStep choose_time_step(const GrainScene& scene, const ContactTable& contacts, const GrainOptions& options,
                               const GrainStepOptions& wanted) {
  GrainTimeStep result{.step = wanted.time_step.value_or(0), .between = {}, .automatic = !wanted.time_step};
  const Shortest shortest = shortest_contact(scene, contacts, options, result.step);
  if (!shortest.any) {
    if (!result.automatic) return result;
    bad_input_at("time_step", "time_step = \"auto\" where no two bodies can meet", "there is one grain and no wall",
                 "Give time_step = ... in s, or add a [[wall]]");
  }
  if (result.automatic)
    result.step = std::min(shortest.detail / wanted.steps_per_contact.value_or(describe(options.law).steps_per_contact),
                           wanted.longest);
  if (!scene.bonds.empty()) limit_by_bonds(scene, options, result);
  result.contact = shortest.duration;
  result.between = fmt::format("{} and {}", contacts.kind(shortest.a), contacts.kind(shortest.b));
  result.omega_step = shortest.omega * result.step;
  result.limit = describe(options.law).stable_step(shortest.zeta);
  if (gives_force(options.law) && result.omega_step > result.limit)
    bad_input_at("time_step",
                 fmt::format("the step of {:.6g} s is {:.4g} times the limit of stability of a contact of {}",
                             result.step, result.omega_step / result.limit, result.between),
                 "contacts would gain energy without end",
                 fmt::format("Stay below {:.6g} s, or take softer contacts or the law exact_flow",
                             result.step * result.limit / result.omega_step));
  return result;
}

}  // namespace equidem
