// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/loop_choice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/scene_check.hpp"

namespace equidem {
namespace {

void check_inertia(const Scene& scene) {
  for (std::size_t d = 0; d < scene.inertia.size(); ++d) {
    const Inertia& inertia = scene.inertia[d];
    if (inertia.mass > 0 && inertia.moment > 0 && std::isfinite(inertia.mass + inertia.moment)) continue;
    bad_input(fmt::format("disc {} has the mass {} and the moment of inertia {}", d, inertia.mass, inertia.moment),
              "a force would move it without limit", "Give a density > 0");
  }
}

void check_damping(const SimulationOptions& options) {
  const Damping& damping = options.damping;
  const std::pair<const char*, double> values[] = {{"mass", damping.mass},
                                                   {"stiffness", damping.stiffness},
                                                   {"contact", damping.contact},
                                                   {"local", damping.local},
                                                   {"viscoelastic normal", damping.normal_time},
                                                   {"viscoelastic tangential", damping.tangential_time}};
  for (const auto& [name, value] : values) {
    if (value >= 0 && std::isfinite(value)) continue;
    bad_input(fmt::format("{} damping is {}", name, value), "negative damping would feed the motion", "Give 0 or more");
  }
  if (damping.local >= 1) {
    bad_input(fmt::format("local damping is {}", damping.local), "at 1 and more nothing would start to move",
              "Give a share below 1, such as 0.7");
  }
  const bool dashpots = damping.dashpots(), viscoelastic = damping.normal_time > 0 || damping.tangential_time > 0;
  const bool kinds[] = {damping.stiffness > 0, damping.contact > 0, damping.local > 0, viscoelastic};
  if (std::ranges::count(kinds, true) > 1) {
    bad_input("several kinds of damping at contacts are asked for",
              "stiffness, contact and local damping and viscoelastic springs each say which dampers there are",
              "Keep one of them");
  }
  if (!scheme_of(options.integrator).takes_dashpots && (dashpots || damping.local > 0)) {
    bad_input(
        fmt::format("the integrator \"{}\" is asked for with dashpots or local damping", to_string(options.integrator)),
        "its forces depend on positions only, or on velocities by mass-proportional damping",
        "Use leapfrog, or damp by mass");
  }
}

bool in_the_middle(const Assembly& assembly, const Contact& contact) {
  const double half = 0.5 * norm(assembly.branch(contact));
  return std::abs(contact.lever_i - half) <= 1e-12 * half && std::abs(contact.lever_j - half) <= 1e-12 * half;
}

}  // namespace

void check_contacts(const Assembly& assembly) {
  if (assembly.contact_arms.empty()) return;
  bad_input(
      "the contacts of the assembly lie off the lines of centres",
      "the motion of a contact network is that of discs, whose normal forces pass through both centres",
      "Run the grains themselves ([grains], as pack writes them), or solve, homogenize or judge the network at rest");
}

void check(const Scene& scene, const SimulationOptions& options) {
  if (!(options.time_step > 0) || !std::isfinite(options.time_step)) {
    bad_input(fmt::format("the time step is {} s", options.time_step), "time could not go on", "Give a step > 0");
  }
  if (scene.inertia.size() != scene.assembly.size()) {
    bad_input(fmt::format("{} have a mass", counted(static_cast<std::int64_t>(scene.inertia.size()), "disc")),
              fmt::format("the assembly has {}", scene.assembly.size()), "Give the inertia of every disc");
  }
  check_contacts(scene.assembly);
  check_inertia(scene);
  check_damping(options);
  if (scene.springs.bends() && (options.damping.normal_time > 0 || options.damping.tangential_time > 0)) {
    bad_input("viscoelastic springs are asked for beside bending springs",
              "the relaxation of the normal and the tangential spring does not tell that of bending",
              "Remove [viscoelastic], or the bending springs");
  }
  check(scene, options.rotation);
}

Effects effects_of(const Scene& scene, const SimulationOptions& options) {
  Effects effects = derive_effects(scene.assembly, scene.springs, options.rotation);
  const auto add = [&](const char* name, bool active, const char* why) {
    effects.entries.push_back({name, active, active ? "" : why});
  };
  const LoopKind kind = loop_for(scene, options, effects);
  const Damping& damping = options.damping;
  const bool contacts = !scene.assembly.contacts.empty();
  constexpr const char* no_contacts = "there are no contacts";
  for (Effects::Entry& entry : effects.entries) {
    if (!contacts && entry.active && entry.name != "rotation") entry = {entry.name, false, no_contacts};
  }
  add("mass-proportional damping", damping.mass > 0, "none is asked for");
  add("dashpots at contacts", contacts && damping.dashpots(),
      contacts ? "no damping at contacts is asked for" : no_contacts);
  add("local damping", damping.local > 0, "none is asked for");
  add("gravity", scene.weighs(), "it is zero");
  add("loads", !scene.loads.empty(), "no load acts");
  add("supports", !scene.supports.empty(), "no disc is held");
  add("walls", !scene.walls.empty(), "there are none");
  add("finite motions", kind.motion == LoopKind::Motion::finite,
      "motions are taken as small: normals and contact points stay");
  add("springs and levers of each contact", !kind.equal_contacts,
      contacts ? "all contacts have the same springs and lie in the middle: three numbers each" : no_contacts);
  add("inertia of each disc", !kind.equal_discs, "all discs have the same");
  return effects;
}

LoopKind loop_for(const Scene& scene, const SimulationOptions& options, const Effects& effects) {
  LoopKind kind;
  kind.motion = options.motion;
  kind.springs = effects.rotation             ? LoopKind::Springs::rotation
                 : effects.tangential_springs ? LoopKind::Springs::tangential
                                              : LoopKind::Springs::normal;
  kind.bending = effects.bending;
  kind.equal_contacts = !kind.bending && scene.springs.uniform() &&
                        std::all_of(scene.assembly.contacts.begin(), scene.assembly.contacts.end(),
                                    [&](const Contact& c) { return in_the_middle(scene.assembly, c); });
  const Damping& damping = options.damping;
  kind.resistance = damping.dashpots()                   ? LoopKind::Resistance::dashpot
                    : damping.local > 0                  ? LoopKind::Resistance::local
                    : damping.mass > 0 || scene.weighs() ? LoopKind::Resistance::body
                                                         : LoopKind::Resistance::none;
  const auto same = [&](const Inertia& a) {
    return a.mass == scene.inertia[0].mass && a.moment == scene.inertia[0].moment;
  };
  kind.equal_discs = !kind.bending && kind.resistance == LoopKind::Resistance::none &&
                     std::all_of(scene.inertia.begin(), scene.inertia.end(), same);
  // Dashpots of a given damping ratio follow the masses at each contact.
  if (damping.contact > 0 && !std::all_of(scene.inertia.begin(), scene.inertia.end(), same))
    kind.equal_contacts = false;
  return kind;
}

SpringConstants dashpots_of(const Damping& damping, const SpringConstants& k, double mass_i, double mass_j) {
  if (damping.contact == 0) {
    return {(damping.stiffness + damping.normal_time) * k.kN, (damping.stiffness + damping.tangential_time) * k.kT};
  }
  const double reduced = mass_i * mass_j / (mass_i + mass_j);
  return {2 * damping.contact * std::sqrt(reduced * k.kN), 2 * damping.contact * std::sqrt(reduced * std::abs(k.kT))};
}

double bending_dashpot_of(const Damping& damping, double kM, double moment_i, double moment_j) {
  if (damping.contact == 0) return damping.stiffness * kM;
  return 2 * damping.contact * std::sqrt(moment_i * moment_j / (moment_i + moment_j) * kM);
}

}  // namespace equidem
