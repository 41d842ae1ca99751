// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Report and JSON of `equidem stability`.
#include "stability/stability_results.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

constexpr const char* greek_gamma = "Gamma";

/// "3 points M" or "q = (1.2, 3.4) rad/m".
std::string name_of(const ZonePoint& wave, const std::vector<ZonePoint>& equivalent) {
  if (wave.name.empty()) return fmt::format("q = ({:.6g}, {:.6g}) rad/m", wave.q.x, wave.q.y);
  if (wave.name == long_waves_name)
    return fmt::format("long waves, q -> 0 along ({:.4g}, {:.4g})", wave.q.x / norm(wave.q), wave.q.y / norm(wave.q));
  const auto alike =
      std::count_if(equivalent.begin(), equivalent.end(), [&](const ZonePoint& p) { return p.name == wave.name; });
  const std::string place = fmt::format("({:.6g}, {:.6g}) rad/m", wave.q.x, wave.q.y);
  return alike > 1 ? fmt::format("the {} points {}, such as {}", alike, wave.name, place)
                   : fmt::format("the point {}, {}", wave.name, place);
}

void add_mechanisms(Results& out, const Stability& s, bool periodic) {
  const std::vector<Vec2> waves = s.survey ? s.survey->free_waves : std::vector<Vec2>{};
  const bool none = s.mechanisms.count() == 0;
  std::string line;
  if (none) {
    const std::string of_the_whole = s.mechanisms.rigid_motions == 0 ? ""
                                     : periodic ? " (the two translations of a periodic cell do not count)"
                                                : fmt::format(" (the {} of a body that nothing holds do not count)",
                                                              counted(s.mechanisms.rigid_motions, "rigid motion"));
    line = fmt::format("none{}: every motion stretches or slips some contact{}",
                       waves.empty() ? "" : " that repeats with the cell", of_the_whole);
  } else {
    if (s.mechanisms.sentences.size() > 1)
      line = fmt::format("{} without energy: ", counted(s.mechanisms.count(), "motion"));
    line += joined(s.mechanisms.sentences, "; ");
  }
  out.line("mechanisms", line);
  out.set("mechanisms/count", s.mechanisms.count()).set("mechanisms/description", s.mechanisms.sentences);
  if (s.survey) out.set("mechanisms/free_waves", waves.size());
  out.set("mechanisms/rigid_motions_of_the_whole", s.mechanisms.rigid_motions);
  if (waves.empty()) return;
  const std::string name = s.survey->zone.name_of(waves.front());
  out.line("",
           fmt::format("of the infinite assembly: waves that stretch and slip no contact, at {} searched, such as {}",
                       counted(static_cast<std::int64_t>(waves.size()), "of the wave vectors", "of the wave vectors"),
                       name_of({name, waves.front()}, {})));
}

void add_inertia(Results& out, const Stability& s) {
  const InertiaReport& inertia = s.inertia;
  out.line("inertia").add("negative_pivots", "", inertia.negative_pivots, "negative pivot", {Shown::count});
  if (s.critical_load && inertia.negative_pivots > 0 && inertia.negative_pivots == inertia.unstable_modes) {
    out.note(fmt::format(": under its forces at rest the assembly gives way by {}",
                         counted(inertia.unstable_modes, "mode")));
  } else if (inertia.negative_pivots > 0) {
    out.note(inertia.unstable_modes == 0 ? ", one for each rotation: no translation has lost its stiffness"
             : inertia.unstable_modes > 0
                 ? fmt::format(", {} beyond one for each rotation: the assembly gives way by so many modes",
                               inertia.unstable_modes)
                 : "; the rotations alone are singular, so that they cannot be told apart");
  }
  out.set("unstable_modes", known(inertia.unstable_modes));
}

/// The factor of the forces at rest at which stability is lost.
void add_critical_load(Results& out, const CriticalLoad& load, const Assembly& assembly) {
  out.line("critical load");
  if (!load.sought) {
    out.note("not sought: " + load.why).set("critical_load/factor", nullptr);
    return;
  }
  if (!std::isfinite(load.factor)) {
    out.note(fmt::format("none up to {:.1g} times the forces at rest", load.searched));
    out.set("critical_load/factor", nullptr);
    return;
  }
  out.add("critical_load/factor", "", load.factor, "times the forces at rest", {.digits = 10});
  out.add("critical_load/width", "proven to", load.width, "of it", {Shown::power, 0});
  if (!load.motion.empty())
    out.line("", "gives way by ").add("critical_load/motion", "", describe_motion(assembly, load.motion));
}

void add_critical(Results& out, const Stability& s) {
  const CriticalMotion& c = s.critical;
  out.set("critical_ratio_searched", c.searched).set("ratio", s.ratio).set("critical_wave_vector", nullptr);
  if (c.wave) {
    std::vector<Results> all;
    for (const ZonePoint& point : c.equivalent)
      all.push_back(Results().set("name", point.name).set("wave_vector", point.q));
    out.set("critical_wave_vector", c.wave->q).set("critical_wave_vector_name", c.wave->name);
    out.set("critical_wave_vectors", all);
  }
  const std::string state = s.status();
  if (!c.sought) {
    out.set("critical_ratio", nullptr).line("critical kT/kN", "not sought: " + c.searched);
    out.line("this case", state == "stable"     ? "stable in statics"
                          : state == "unstable" ? "UNSTABLE in statics"
                                                : "a mechanism: see above");
    return;
  }
  if (std::isfinite(c.ratio)) {
    out.line("critical kT/kN").add("critical_ratio", "", c.ratio, "", {.digits = 12});
    if (c.wave) out.note(", lost at " + name_of(*c.wave, c.equivalent));
  } else {
    out.set("critical_ratio", nullptr).line("critical kT/kN", "none: stable in statics down to kT = -kN");
  }
  if (!c.motion.empty()) out.line("", "gives way by ").add("critical_motion", "", c.motion);
  out.line("", "searched: " + c.searched);
  if (!s.ratio) {
    out.line("", "contacts of this case have different kT/kN: the critical ratio is that of equal ones");
    return;
  }
  const double margin = *s.ratio - c.ratio;
  out.set("ratio_margin", margin).line("this case").add("", "kT/kN =", s.ratio);
  if (std::isfinite(margin))
    out.add("", "", std::abs(margin), margin >= 0 ? "above the critical ratio" : "below the critical ratio");
  out.note(state == "stable"     ? ": stable in statics"
           : state == "unstable" ? ": UNSTABLE in statics"
           : margin >= 0         ? ": stable in statics but for its mechanisms, which nothing resists"
                                 : ": UNSTABLE in statics, and a mechanism");
}

void add_growth(Results& out, const Stability& s, bool periodic) {
  const double rate = s.growth_rate();
  if (rate > 0 && s.survey) {
    out.set("growth_wave_vector", s.survey->growing.at.q);
    out.set("growth_wave_vector_name", s.survey->growing.at.name);
  }
  if (!s.lowest || rate == 0) out.set("growth_rate", rate);
  if (!s.lowest) return;
  if (rate == 0) {
    const bool all_waves = !periodic || s.survey;
    out.line("growth", fmt::format("none: some kT are negative, but no motion{} has negative energy",
                                   all_waves ? "" : " that repeats with the cell"));
    return;
  }
  out.line("growth").add("growth_rate", "", rate, "1/s in motion: a disturbance grows e-fold in", {.digits = 9});
  out.note(fmt::format(" {:.3g} s", 1 / rate));
  if (s.survey && s.survey->growing.value >= -s.lowest->value * (1 - 1e-9)) {
    const ZoneMaximum& growing = s.survey->growing;
    out.note(", fastest at " + name_of(growing.at, growing.points));
    if (growing.at.name == greek_gamma && s.cell_discs == 1) out.note(": all discs spin alike");
  }
  out.line("",
           "kT < 0 gives rotations negative stiffness. Statics finds where all forces balance; for the rotations that "
           "is a maximum of the energy, not a minimum, so that it is a state of rest no explicit run can reach or "
           "keep, at any time step and any damping. Use such springs in statics only");
}

void add_natural_frequencies(Results& out, const Stability& s, const Assembly& assembly) {
  const NaturalFrequencies& natural = s.natural;
  std::vector<double> omega, hertz, bounds;
  double largest = 0;  // of the relative errors
  for (std::size_t k = 0; k < natural.squared.size(); ++k) {
    omega.push_back(signed_root(natural.squared[k]));
    hertz.push_back(omega.back() / (2 * std::numbers::pi));
    bounds.push_back(natural.error_bounds[k]);
    largest = std::max(largest, natural.error_bounds[k] / std::abs(natural.squared[k]));
  }
  if (omega.empty() && natural.why_none.empty()) return;  // not sought
  out.line("frequencies");
  if (omega.empty()) {
    out.note("the lowest are not known: " + natural.why_none).set("natural_frequencies", nullptr);
  } else {
    out.add("natural_frequencies", "lowest", hertz, "Hz");
    constexpr double worthless = 0.5;
    out.note(largest > worthless  ? " (NOT TOLD APART FROM 0: the error may be as large as omega²)"
             : !natural.converged ? fmt::format(" (NOT CONVERGED: error up to {:.1e} of omega²)", largest)
                                  : "");
    if (assembly.periodic()) out.note(", of motions that repeat with the cell");
    out.line("", "longest period ").add("longest_period", "", 1 / hertz.front(), "s");
    out.add("", "error below", largest, "of omega²", {Shown::power, 1});
    out.line("", "the slowest is " + describe_motion(assembly, natural.motions.front()));
  }
  out.set("natural_omegas", omega).set("natural_omega_squared_error_bounds", bounds);
  out.set("natural_frequencies_converged", natural.converged).set("natural_frequencies_method", natural.solver);
  out.set("natural_frequencies_iterations", natural.iterations);
  out.set("zero_energy_modes", natural.zero_energy_modes);
  if (natural.zero_energy_modes > 0 && !omega.empty()) {
    out.line("", fmt::format("above {} with the frequency 0", counted(natural.zero_energy_modes, "zero-energy mode")));
  }
}

/// \param density kg/m³, of the discs; none: 1 was assumed
void add_time_step(Results& out, const Stability& s, std::optional<double> density, Body body) {
  const bool vibrates = s.highest.value > 0, grows = s.growth_rate() > 0;
  double omega = std::sqrt(s.highest.value);
  if (vibrates) {
    out.line("omega_max")
        .add("omega_max", "", omega, "rad/s, Lanczos", {.digits = 12})
        .add("", "residual", s.highest.residual / s.highest.value, "of omega²", {Shown::power, 1})
        .note(s.highest.converged ? "" : " (NOT CONVERGED: a lower bound)");
  } else {
    out.set("omega_max", omega).line("omega_max", "none: no motion that repeats with the given cell vibrates");
  }
  out.set("omega_max_squared_residual", s.highest.residual).set("omega_max_converged", s.highest.converged);
  if (s.survey) {
    const ZoneMaximum& highest = s.survey->highest;
    const double of_all = std::sqrt(highest.value);
    out.set("zone_omega_max", of_all).set("zone_critical_time_step", 2 / of_all);
    out.set("zone_omega_max_wave_vector", highest.at.q).set("zone_omega_max_wave_vector_name", highest.at.name);
    if (highest.value > 0) {
      out.line("", fmt::format("{:.12g} rad/s over all waves of the infinite assembly, at {}", of_all,
                               name_of(highest.at, highest.points)));
      if (!vibrates) omega = of_all;
    }
  }
  const auto row = [&](const std::string& name, double step, const std::string& what) {
    return Results()
        .add("", "time step", name)
        .add("", "step", step, "s", {.digits = 9})
        .add("", "over critical", step * omega / 2, "", {Shown::decimals, 3})
        .note(what);
  };
  std::vector<Results> rows;
  if (omega > 0) {
    rows.push_back(row("  2/omega_max", 2 / omega,
                       grows      ? "critical for what vibrates; with kT < 0 no time step is stable (see growth)"
                       : vibrates ? "critical: stable below, for this assembly"
                                  : "critical: stable below, for the waves of the infinite assembly"));
  }
  const auto unsafe = [&](double step) { return step * omega > 2 * (1 + 1e-9) ? ", and TOO LARGE here" : ""; };
  rows.push_back(row("  elements", 2 / std::sqrt(s.element_bound),
                     grows ? "never above the critical one: each contact with its share of the masses"
                           : "guaranteed: each contact with its share of the masses"));
  rows.push_back(row("  diagonal", s.rules.diagonal,
                     fmt::format("no guarantee{}: sqrt2 min sqrt(m/K_ii)", unsafe(s.rules.diagonal))));
  rows.push_back(row("  T/8", s.rules.eighth_of_period,
                     fmt::format("no guarantee{}: an eighth of 2 pi sqrt(m/kN)", unsafe(s.rules.eighth_of_period))));
  out.block("explicit integration (central differences):\n").table("", rows);
  out.set("diagonal_rule_time_step", s.rules.diagonal);
  out.set("eighth_of_period_time_step", s.rules.eighth_of_period);
  out.set("element_bound_time_step", 2 / std::sqrt(s.element_bound));
  out.set("critical_time_step", 2 / std::sqrt(s.highest.value));
  out.set("element_bound_omega_max", std::sqrt(s.element_bound));
  out.set("density", density.value_or(1)).set("density_assumed", !density.has_value());
  out.set("body", to_string(body));
  if (!density) {
    out.line(
        "",
        "DENSITY ASSUMED: 1 kg/m³, since the case gives none (assembly.density). Times scale with its square root, "
        "frequencies and speeds with the inverse");
  }
}

void add_sound(Results& out, const Stability& s) {
  std::vector<double> angles{0, 90}, p, q, homogenized_p, homogenized_s;
  if (s.survey) angles.clear();
  for (const SoundAlong& along : s.survey ? s.survey->sound : std::vector<SoundAlong>{}) {
    angles.push_back(std::round(along.angle * 180 / std::numbers::pi));
    p.push_back(signed_root(along.speeds.longitudinal_squared));
    q.push_back(signed_root(along.speeds.transverse_squared));
  }
  for (const PlaneWaves& waves : s.sound) {
    homogenized_p.push_back(signed_root(waves.longitudinal_squared));
    homogenized_s.push_back(signed_root(waves.transverse_squared));
  }
  std::vector<Results> rows;
  for (const std::size_t k : s.survey ? std::vector<std::size_t>{0, 2, 3, 6} : std::vector<std::size_t>{0, 1}) {
    Results row;
    row.add("", "sound speeds, m/s", fmt::format("  {:.0f} degrees from x", angles[k]));
    const auto add = [&](const char* label, const std::vector<double>& roots) {
      if (k >= roots.size()) return;
      row.add("", label,
              roots[k] >= 0 ? ResultValue(roots[k]) : fmt::format("none (c² = {:.3g})", -roots[k] * roots[k]));
    };
    add("P", p), add("S", q), add("P homogenized", homogenized_p), add("S homogenized", homogenized_s);
    rows.push_back(std::move(row));
  }
  if (s.survey || !s.sound.empty()) out.table("", rows);
  out.set("sound_speeds/angles_degrees", angles);
  if (s.survey) out.set("sound_speeds/longitudinal", p).set("sound_speeds/transverse", q);
  if (!s.sound.empty()) {
    out.set("sound_speeds/homogenized_longitudinal", homogenized_p);
    out.set("sound_speeds/homogenized_transverse", homogenized_s);
  }
  if (s.no_continuum.empty()) return;
  out.line("", "no homogenized continuum to compare with: ")
      .add("sound_speeds/no_homogenized_continuum", "", s.no_continuum);
}

void add_waves(Results& out, const Stability& s) {
  out.line("smallest cell").add("primitive_cell/discs", "", s.cell_discs, "disc", {Shown::count});
  out.set("mass_per_area", s.mass_per_area);
  if (!s.survey) {
    out.note(fmt::format(": too many for the spectrum of waves, which takes up to {}", most_discs_of_survey));
    add_sound(out, s);
    return;
  }
  const WaveSurvey& survey = *s.survey;
  const auto [a, b] = survey.cell.period;
  out.add("primitive_cell/lattice", "", survey.zone.lattice, "lattice")
      .note(fmt::format(" ({:.6g}, {:.6g}), ({:.6g}, {:.6g}) m", a.x, a.y, b.x, b.y))
      .add("primitive_cell/copies", "", survey.cell.copies, survey.cell.copies == 1 ? "copy" : "copies")
      .note(" of it in the given one");
  out.set("primitive_cell/period", std::vector<std::vector<double>>{{a.x, a.y}, {b.x, b.y}});
  add_sound(out, s);
  out.set("wave_vectors", survey.highest.on_grid.size()).set("rotational_gap", nullptr);
  if (!survey.squared_rotational_gap) return;
  const double gap = signed_root(*survey.squared_rotational_gap);
  out.set("rotational_gap", gap)
      .line("rotational gap",
            gap >= 0 ? fmt::format("omega = {:.9g} rad/s", gap) : fmt::format("none: it grows at {:.6g} 1/s", -gap))
      .note(", the slowest long wave in which discs turn against their neighbours");
}

}  // namespace

double signed_root(double squared) {
  return squared >= 0 ? std::sqrt(squared) : -std::sqrt(-squared);
}

Results stability_results(const Problem& problem, const Stability& s) {
  const bool periodic = problem.assembly.periodic();
  Results out = problem_results(problem, s.effects, AssemblyKeys::size);
  if (problem.resolved.ensemble)
    out.line("not used", "[ensemble]: the one assembly of [assembly] is judged, with its seed");
  if (periodic && !s.critical_load) add_waves(out, s);
  add_mechanisms(out, s, periodic);
  add_inertia(out, s);
  if (s.critical_load) add_critical_load(out, *s.critical_load, problem.assembly);
  add_critical(out, s);
  add_growth(out, s, periodic);
  add_natural_frequencies(out, s, problem.assembly);
  add_time_step(out, s, disc_density(problem.resolved, problem.assembly), problem.resolved.assembly.body);
  return out;
}

}  // namespace equidem
