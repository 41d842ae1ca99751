// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "equidem/core/text.hpp"
#include "equidem/grains/scene/kinds.hpp"

#include "run/run_bonds_report.hpp"
#include "run/run_grains_measures.hpp"
#include "run/run_report.hpp"
#include "solve/report.hpp"

namespace equidem {
namespace {

/// "0.02 m", "0.01 to 0.02 m".
std::string range(double smallest, double largest) {
  return smallest == largest ? fmt::format("{:.6g}", smallest) : fmt::format("{:.6g} to {:.6g}", smallest, largest);
}

/// Number of bodies of each shape, in the order of GrainShape.
std::array<std::int64_t, 3> counts_of_shapes(const GrainCase& resolved) {
  std::array<std::int64_t, 3> counts{};
  for (const Grain& grain : resolved.scene.grains) ++counts[static_cast<std::size_t>(grain.shape())];
  return counts;
}

/// "24 discs", "3 discs, 1 ellipse and 2 clumps".
std::string describe_shapes(const GrainCase& resolved) {
  const auto [round, ellipses, clumps] = counts_of_shapes(resolved);
  std::vector<std::string> parts;
  for (const auto& [count, name] :
       {std::pair{round, to_string(resolved.body)}, std::pair{ellipses, std::string("ellipse")},
        std::pair{clumps, std::string("clump")}})
    if (count > 0) parts.push_back(fmt::format("{} {}{}", grouped(count), name, count == 1 ? "" : "s"));
  std::string text = parts.front();
  for (std::size_t k = 1; k < parts.size(); ++k) text += (k + 1 == parts.size() ? " and " : ", ") + parts[k];
  return text;
}

const char* describe_ellipse_contact(GrainOptions::EllipseLaw law) {
  using enum GrainOptions::EllipseLaw;
  return law == exact ? "ellipses meet at their closest points (exact)"
         : law == enlarged_mended
             ? "ellipses meet by the test of enlarged ellipses, mended: shallow contacts are missed"
             : "ellipses meet by the test of enlarged ellipses as printed: many contacts are missed";
}

std::string describe_bodies(const GrainCase& resolved) {
  double mass = 0, smallest = INFINITY, largest = 0;
  std::map<std::string, std::int64_t> groups;
  for (const Grain& grain : resolved.scene.grains) {
    mass += grain.inertia.mass;
    smallest = std::min(smallest, grain.radius);
    largest = std::max(largest, grain.radius);
    ++groups[resolved.contacts.kinds[static_cast<std::size_t>(grain.kind)]];
  }
  const auto [round, ellipses, clumps] = counts_of_shapes(resolved);
  std::string out = report_line(
      "bodies", fmt::format("{}, {} {} m, {:.6g} {} in all", describe_shapes(resolved),
                            ellipses + clumps == 0 ? "radius" : "radius of the circle around each",
                            range(smallest, largest), mass, resolved.body == Body::disc ? "kg per m of depth" : "kg"));
  if (clumps > 0) {
    std::size_t fewest = resolved.scene.clumps.front().discs.size(), most = fewest;
    for (const Clump& clump : resolved.scene.clumps) {
      fewest = std::min(fewest, clump.discs.size());
      most = std::max(most, clump.discs.size());
    }
    out += report_line("", fmt::format("clumps of {} {}",
                                       fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most),
                                       most == 1 ? "disc" : "discs"));
  }
  if (ellipses > 0) out += report_line("", describe_ellipse_contact(resolved.options.ellipse_law));
  if (groups.size() > 1) {
    std::string list;
    for (const auto& [name, members] : groups) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", name, members);
    out += report_line("groups", list);
  }
  std::string walls;
  for (const Wall& wall : resolved.scene.walls) {
    constexpr const char* shapes[] = {"line", "segment", "arc"};
    walls += fmt::format("{}{} ({}{})", walls.empty() ? "" : ", ", wall.name, shapes[static_cast<int>(wall.shape)],
                         wall.moves() ? ", moves" : "");
  }
  return walls.empty() ? out : out + report_line("walls", walls);
}

std::string describe_pair(const GrainCase& resolved, const PairContact& pair) {
  const PairProperties& p = pair.properties;
  std::string text = fmt::format("restitution {}", p.restitution);
  if (describe(resolved.options.law).has_dashpot && p.restitution < 1)
    text += p.end == ContactEnd::at_zero_force ? " (never pulls)" : " (may pull at the end)";
  if (pair.duration > 0) {
    text += fmt::format(", contacts of {:.6g} s", pair.duration);
  } else if (p.dimensionless > 0) {
    text += fmt::format(", k dt²/m = {:.6g}", p.dimensionless);
  } else {
    text += fmt::format(", k = {:.6g} {}", p.stiffness, describe(resolved.options.law).stiffness_unit);
  }
  if (p.friction == 0) return text + ", no friction";
  text += fmt::format(", friction {}, kT/kN {:.6g}", p.friction, p.tangential_ratio);
  if (p.tangential_ratio == 0) text += " (slides always)";
  if (p.tangential_damping > 0) text += fmt::format(", tangential damping {}", p.tangential_damping);
  return text;
}

/// Every two kinds that can meet; those that meet alike on one line.
std::string describe_pairs(const GrainCase& resolved) {
  std::vector<std::pair<std::string, std::string>> lines;  // what, who
  const auto masses = masses_of_kinds(resolved.scene.grains, resolved.scene.kinds);
  constexpr int most_kinds = 8;
  if (resolved.contacts.kind_count() > most_kinds)
    return report_line("contacts", fmt::format("{} kinds of bodies, each pair with its own stiffness",
                                               resolved.contacts.kind_count()));
  for (int a = 0; a < resolved.contacts.kind_count(); ++a) {
    for (int b = a; b < resolved.contacts.kind_count(); ++b) {
      if (!reduced_masses(masses, a, b)) continue;
      const std::string what = describe_pair(resolved, resolved.contacts.between(a, b));
      const std::string who = fmt::format("{} and {}", resolved.contacts.kinds[static_cast<std::size_t>(a)],
                                          resolved.contacts.kinds[static_cast<std::size_t>(b)]);
      const auto at = std::find_if(lines.begin(), lines.end(), [&](const auto& line) { return line.first == what; });
      if (at == lines.end()) {
        lines.emplace_back(what, who);
      } else {
        at->second += ", " + who;
      }
    }
  }
  std::string out;
  for (const auto& [what, who] : lines)
    out += report_line(out.empty() ? "contacts" : "", lines.size() == 1 ? what : fmt::format("{}: {}", who, what));
  return out;
}

std::string describe_law(const GrainCase& resolved) {
  const LawDescription& law = describe(resolved.options.law);
  const std::string text = fmt::format("{} ({}): {}", law.name, law.letter, law.summary);
  if (law.kind != LawKind::force) return text;
  return fmt::format("{}, {}", text,
                     resolved.options.scheme == GrainOptions::Scheme::semi_implicit_euler ? "semi-implicit Euler"
                     : resolved.options.scheme == GrainOptions::Scheme::velocity_verlet
                         ? "velocity Verlet"
                         : "velocity Verlet, contacts that begin or end within a step corrected");
}

/// A map turns the approach of two bodies round as if nothing else acted on them: summed at one body, that is too much.
std::string describe_limit_of_maps(const GrainCase& resolved) {
  if (!is_map(resolved.options.law) || resolved.scene.grains.size() + resolved.scene.walls.size() <= 2) return "";
  return report_line(
      "",
      "for bodies that meet two by two: each contact is taken as if nothing else acted on its bodies, and where they "
      "press on one another energy comes and goes; for beds exact_flow or linear_dashpot");
}

/// Likely cause of a large error of the balance, and the remedy.
std::string advice_on_balance(const GrainSetup& setup, const GrainSimulation& simulation, const EnergyLedger& ledger) {
  const GrainCase& resolved = setup.resolved;
  if (is_map(resolved.options.law)) {
    return fmt::format(
        "{:.3g} {} {}, as this law takes each contact as if nothing else acted on its bodies; take exact_flow or "
        "linear_dashpot where they press on one another",
        std::abs(ledger.error()), energy_unit(resolved.body),
        ledger.error() > 0 ? "came from nothing" : "vanished uncounted");
  }
  const bool euler =
      gives_force(resolved.options.law) && resolved.options.scheme == GrainOptions::Scheme::semi_implicit_euler;
  if (euler && !simulation.effects().tangential_springs && ledger.lost_slip > std::abs(ledger.error())) {
    return "contacts without tangential springs that nearly stick count too large a loss by slip in "
           "semi_implicit_euler; take velocity_verlet, or a tangential_ratio above 0";
  }
  return "compare with a shorter step before trusting the motion";
}

std::string describe_step(const GrainSetup& setup) {
  const GrainTimeStep& step = setup.step;
  std::string out = report_line("time step", fmt::format("{:.6g} s{}", step.step, step.automatic ? ", automatic" : ""));
  if (step.contact > 0) {
    out += report_line("", fmt::format("the shortest contact lasts {:.4g} s, {:.3g} steps ({})", step.contact,
                                       step.steps_in_contact(), step.between));
  } else {
    out += report_line("", "how long contacts last is not known: " +
                               std::string(describe(setup.resolved.options.law).spring_power != 1
                                               ? "with this law it depends on the speed (give closing_speed)"
                                               : "no two bodies can meet"));
  }
  if (step.omega_step > 0 && step.limit > 0) {
    out += report_line("", fmt::format("omega dt = {:.4g}, {:.3g} of {:.4g}, {}", step.omega_step,
                                       step.omega_step / step.limit, step.limit,
                                       is_map(setup.resolved.options.law)
                                           ? "past which a contact is over in a step"
                                           : "the limit of stability of one contact; several at a body lower it"));
  } else if (step.omega_step > 0) {
    out += report_line("", fmt::format("omega dt = {:.4g}; a single contact is exact at any step", step.omega_step));
  }
  return out;
}

}  // namespace

std::string describe_grains(const GrainSetup& setup, const GrainSimulation& simulation) {
  const GrainCase& resolved = setup.resolved;
  std::string out;
  if (!resolved.title.empty()) out += resolved.title + "\n\n";
  out += describe_bodies(resolved);
  std::string active;
  for (const Effects::Entry& entry : simulation.effects().entries)
    if (entry.active) active += (active.empty() ? "" : ", ") + entry.name;
  out += report_line("effects", active);
  for (const Effects::Entry& entry : simulation.effects().entries)
    if (!entry.active) out += report_line("", fmt::format("no {}: {}", entry.name, entry.why));
  out += report_line("law", describe_law(resolved)) + describe_limit_of_maps(resolved);
  return out + describe_pairs(resolved) + describe_shaking(resolved) + describe_step(setup) + describe_bonds(setup);
}

std::string describe_grain_balance(const GrainSetup& setup, const GrainSimulation& simulation, const Balance& balance) {
  std::string out;
  if (std::abs(balance.now) > balance_to_doubt)
    out += report_line("", "that is much: " + advice_on_balance(setup, simulation, simulation.energy()));
  if (const std::int64_t doubtful = simulation.counters().doubtful; doubtful > 0)
    out += report_line(
        "",
        fmt::format("of all evaluations {} were of contacts pressed together in a step that may feed their vibration: "
                    "the step is safe for one contact, not for any cluster; compare with one a third as long",
                    grouped(doubtful)));
  return out;
}

void add_grain_step(JsonObject& object, const GrainTimeStep& step) {
  const auto set_known = [&](const char* key, double value) {
    if (value > 0) {
      object.set(key, value);
    } else {
      object.set(key, nullptr);
    }
  };
  object.set("time_step", step.step).set("time_step_automatic", step.automatic);
  set_known("contact_duration", step.contact);
  set_known("steps_in_contact", step.contact / step.step);
  set_known("omega_time_step", step.omega_step);
  set_known("critical_time_step", step.omega_step > 0 ? step.step * step.limit / step.omega_step : 0);
}

void add_grain_results(JsonObject& object, const GrainSetup& setup, const GrainSimulation& simulation) {
  const GrainCase& resolved = setup.resolved;
  const auto [round, ellipses, clumps] = counts_of_shapes(resolved);
  JsonObject shapes;
  shapes.set(to_string(resolved.body) + "s", round).set("ellipses", ellipses).set("clumps", clumps);
  object.set("title", resolved.title)
      .set("body", to_string(resolved.body))
      .set("grains", resolved.scene.grains.size())
      .set("shapes", shapes)
      .set("walls", resolved.scene.walls.size())
      .set("law", to_string(resolved.options.law));
  add_bonds(object, setup, simulation.bonds());
  const GrainCounters& counters = simulation.counters();
  object.set("contacts", counters.contacts)
      .set("touching", simulation.contacts().size())
      .set("evaluations", counters.evaluations)
      .set("sweeps", counters.sweeps)
      .set("rebuilds", counters.rebuilds);
}

}  // namespace equidem
