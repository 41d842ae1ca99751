// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "equidem/casefile/grain_pairs.hpp"
#include "equidem/contact/collision_stiffness.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_step.hpp"

namespace equidem {
namespace {

using std::numbers::pi;

/// The contact of the lightest bodies of two kinds.
struct Shortest {
  double duration = std::numeric_limits<double>::infinity();  ///< s
  /// s, what a step must resolve: the same, and where a strong dashpot does its work sooner, that time.
  double detail = std::numeric_limits<double>::infinity();
  double omega = 0;  ///< 1/s; hertz_dashpot: at the largest overlap; 0: not known
  double zeta = 0;
  int a = 0, b = 0;
  bool any = false;  ///< two bodies can meet
};

/// The longest lever of a normal force about the mass centre, m: of an ellipse a - b.
double longest_lever(const GrainCase& resolved, const Grain& grain) {
  switch (grain.shape()) {
    case GrainShape::ellipse:
      return grain.radius - grain.short_half_axis;
    case GrainShape::clump: {
      double lever = 0;
      for (const Clump::Disc& disc : resolved.clumps[static_cast<std::size_t>(grain.clump)].discs)
        lever = std::max(lever, norm(disc.offset));
      return lever;
    }
    case GrainShape::disc:
      break;
  }
  return 0;
}

/// Of each kind the largest 1 + m l²/I: a push at the lever l moves a body as if its mass were less by that.
std::vector<double> agility_of_kinds(const GrainCase& resolved) {
  std::vector<double> agility(resolved.kinds.size(), 1.0);
  for (const Grain& grain : resolved.grains) {
    const double lever = longest_lever(resolved, grain);
    double& most = agility[static_cast<std::size_t>(grain.kind)];
    most = std::max(most, 1 + grain.inertia.mass * lever * lever / grain.inertia.moment);
  }
  return agility;
}

/// \param step s, of a stiffness that is held in steps; 0: not known
/// \throws Error where the contact of some pair has no known duration
Shortest shortest_contact(const GrainCase& resolved, double step) {
  Shortest shortest;
  const LawDescription& law = describe(resolved.law);
  const auto masses = masses_of_kinds(resolved);
  const auto agility = agility_of_kinds(resolved);
  for (int a = 0; a < resolved.kind_count(); ++a) {
    for (int b = a; b < resolved.kind_count(); ++b) {
      const auto reduced = reduced_masses(masses, a, b);
      if (!reduced) continue;
      shortest.any = true;
      const PairCase& pair = resolved.between(a, b);
      const PairProperties& properties = pair.properties;
      // Spring and dashpot of a contact are those of bodies that do not turn.
      const double faster =
          std::sqrt(std::max(agility[static_cast<std::size_t>(a)], agility[static_cast<std::size_t>(b)]));
      const double zeta = faster * damping_ratio(resolved.law, properties);
      const double swing = zeta < 1 ? std::sqrt(1 - zeta * zeta) : 1;
      double duration = 0, omega = 0;
      if (properties.dimensionless > 0 && step == 0) {
        bad_input("time_step = \"auto\" with dimensionless_stiffness", "the step is what makes the stiffness",
                  "Give time_step = ... in s, or another stiffness");
      }
      // simultaneous laws: omega dt = 1 by default, whatever the damping; else by the faster of the two rates of decay
      const double haste = zeta > 1 ? zeta + std::sqrt(zeta * zeta - 1) : 1;
      if (law.spring_power != 1) {
        if (pair.closing_speed == 0) {
          if (step > 0) return Shortest{.duration = 0, .any = true};
          bad_input(fmt::format("time_step = \"auto\" of {} without closing_speed", law.name),
                    "a contact of this law lasts the shorter the faster it is",
                    "Add closing_speed = ... in m/s to [collisions], or give time_step = ... in s");
        }
        double length = resolved.reference_length;
        if (length == 0)
          for (const Grain& grain : resolved.grains) length = std::max(length, 2 * grain.radius);
        const double k = properties.stiffness > 0
                             ? properties.stiffness
                             : properties.dimensionless * reduced->smallest / (step * step * law.length_factor(length));
        const ElasticImpact impact = law.elastic_impact(k, reduced->smallest, pair.closing_speed);
        duration = impact.duration / faster;
        omega = faster * std::sqrt(law.spring_power * k * law.length_factor(impact.overlap) / reduced->smallest);
      } else {
        const double still = damping_ratio(resolved.law, properties);
        omega = faster * (pair.duration > 0          ? pi / (pair.duration * std::sqrt(1 - still * still))
                          : properties.stiffness > 0 ? std::sqrt(properties.stiffness / reduced->smallest)
                                                     : std::sqrt(properties.dimensionless) / step);
        duration = pi / (omega * swing);
      }
      const double detail = law.kind == LawKind::simultaneous ? pi / omega : duration / haste;
      if (detail < shortest.detail) {
        shortest = {.duration = duration, .detail = detail, .omega = omega, .zeta = zeta, .a = a, .b = b, .any = true};
      }
    }
  }
  return shortest;
}

/// Half the limit of bonds: there the dashpots of a pair bring it to rest in a step.
void limit_by_bonds(const GrainCase& resolved, GrainStep& result) {
  const double limit = bond_step_limit(build_grain_scene(resolved, result.step), resolved.bonds.step);
  if (std::isfinite(limit)) result.bond_limit = limit;
  if (result.automatic) result.step = std::min(result.step, 0.5 * limit);
  try {
    check_bonds(build_grain_scene(resolved, result.step), grain_options(resolved, result.step));
  } catch (const Error& error) {
    const char* table = resolved.document.find("bonds") != nullptr ? "bonds" : "bond";
    throw error.at(resolved.where(is_simultaneous(resolved.law) ? "collisions.law"
                                  : result.step >= limit        ? "run.time_step"
                                                                : table));
  }
}

}  // namespace

GrainStep choose_grain_step(const GrainCase& resolved) {
  Shortest shortest;
  GrainStep result{.step = resolved.time_step.value_or(0), .between = {}, .automatic = !resolved.time_step};
  try {
    shortest = shortest_contact(resolved, result.step);
    if (result.automatic && !shortest.any)
      bad_input("time_step = \"auto\" where no two bodies can meet", "there is one grain and no wall",
                "Give time_step = ... in s, or add a [[wall]]");
  } catch (const Error& error) {
    throw error.at(resolved.where("run.time_step"));
  }
  if (!shortest.any) return result;
  if (result.automatic) {
    result.step = std::min(shortest.detail / resolved.steps_per_contact, resolved.duration);
  }
  if (!resolved.bonds.bonds.empty()) limit_by_bonds(resolved, result);
  result.contact = shortest.duration;
  result.between = fmt::format("{} and {}", resolved.kinds[static_cast<std::size_t>(shortest.a)],
                               resolved.kinds[static_cast<std::size_t>(shortest.b)]);
  result.omega_step = shortest.omega * result.step;
  result.limit = describe(resolved.law).stable_step(shortest.zeta);
  if (gives_force(resolved.law) && result.omega_step > result.limit) {
    throw Error(ErrorKind::bad_input,
                fmt::format("the step of {:.6g} s is {:.4g} times the limit of stability of a contact of {}",
                            result.step, result.omega_step / result.limit, result.between),
                "contacts would gain energy without end",
                fmt::format("Stay below {:.6g} s, or take softer contacts or the law exact_flow",
                            result.step * result.limit / result.omega_step),
                resolved.where("run.time_step"));
  }
  return result;
}

std::int64_t count_steps(const GrainCase& resolved, double step) {
  constexpr double most = 1e15;  // years of stepping, and every number below is exact in a double
  const double steps = std::ceil(resolved.duration / step * (1 - 1e-12));
  if (steps <= most) return std::llround(steps);
  throw Error(ErrorKind::bad_input,
              fmt::format("{:.3g} s in steps of {:.3g} s are {:.3g} steps", resolved.duration, step, steps),
              fmt::format("no run makes more than {:.0e}", most), "Shorten the duration, or take a longer step",
              resolved.where("run.duration"));
}

GrainScene build_grain_scene(const GrainCase& resolved, double step) {
  GrainScene scene;
  scene.grains = resolved.grains;
  scene.clumps = resolved.clumps;
  scene.bonds = resolved.bonds.bonds;
  scene.walls = resolved.walls;
  scene.gravity = resolved.gravity;
  scene.kinds = resolved.kind_count();
  for (const PairCase& pair : resolved.pairs) {
    PairProperties properties = pair.properties;
    if (pair.duration > 0) {
      const double zeta = damping_ratio(resolved.law, properties);
      const double turn = pi * step / pair.duration;
      properties.dimensionless = turn * turn / (1 - zeta * zeta);
    }
    scene.pairs.push_back(properties);
  }
  return scene;
}

GrainOptions grain_options(const GrainCase& resolved, double step) {
  GrainOptions options;
  options.law = resolved.law;
  options.scheme = resolved.scheme;
  options.time_step = step;
  options.reference_length = resolved.reference_length;
  options.ellipse_law = resolved.ellipse_law;
  options.bond_step = resolved.bonds.step;
  return options;
}

}  // namespace equidem
