// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem stability: mechanisms, inertia, waves, critical kT/kN, natural frequencies and time step.
#include "equidem/waves/stability.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/waves/natural_frequencies.hpp"

#include "command.hpp"
#include "problem.hpp"
#include "spring_effects.hpp"
#include "state_files.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

/// omega of omega²; negative, with the growth rate as its size, where omega² is: spectra with unstable branches are
/// drawn so.
double signed_root(double squared) {
  return squared >= 0 ? std::sqrt(squared) : -std::sqrt(-squared);
}

constexpr const char* greek_gamma = "Gamma";

/// "3 points M" or "q = (1.2, 3.4) rad/m".
std::string name_of(const ZonePoint& wave, const std::vector<ZonePoint>& equivalent) {
  if (wave.name.empty()) return fmt::format("q = ({:.6g}, {:.6g}) rad/m", wave.q.x, wave.q.y);
  if (wave.name == long_waves_name)
    return fmt::format("long waves, q -> 0 along ({:.4g}, {:.4g})", wave.q.x / norm(wave.q), wave.q.y / norm(wave.q));
  const auto alike = std::ranges::count(equivalent, wave.name, &ZonePoint::name);
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
    out.note(fmt::format(": under its forces at rest the assembly is unstable in {}",
                         counted(*inertia.unstable_modes, "mode")));
  } else if (inertia.negative_pivots > 0) {
    out.note(inertia.unstable_modes == 0 ? ", one for each rotation: no translation has lost its stiffness"
             : inertia.unstable_modes > 0
                 ? fmt::format(", {} beyond one for each rotation: the assembly is unstable in so many modes",
                               *inertia.unstable_modes)
                 : "; the rotations alone are singular, so that they cannot be told apart");
  }
  out.set("unstable_modes", inertia.unstable_modes);
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
    out.line("", "loses stability by ").add("critical_load/motion", "", describe_motion(assembly, load.motion));
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
    if (state == "unstable") out.warn();
    return;
  }
  if (std::isfinite(c.ratio)) {
    out.line("critical kT/kN").add("critical_ratio", "", c.ratio, "", {.digits = 12});
    if (c.wave) out.note(", lost at " + name_of(*c.wave, c.equivalent));
  } else {
    out.set("critical_ratio", nullptr).line("critical kT/kN", "none: stable in statics down to kT = -kN");
  }
  if (!c.motion.empty()) out.line("", "loses stability by ").add("critical_motion", "", c.motion);
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
  if (state == "unstable" || (state != "stable" && !(margin >= 0))) out.warn();
}

void add_growth(Results& out, const Stability& s, bool periodic) {
  const double rate = s.growth_rate();
  if (rate > 0 && s.survey) {
    out.set("growth_wave_vector", s.survey->growing.at.q);
    out.set("growth_wave_vector_name", s.survey->growing.at.name);
  }
  if (rate == 0) {
    out.set("growth_rate", rate);
    if (!s.lowest) return;
    const bool all_waves = !periodic || s.survey;
    out.line("growth", fmt::format("none: some kT are negative, but no motion{} has negative energy",
                                   all_waves ? "" : " that repeats with the cell"));
    return;
  }
  out.line("growth").add("growth_rate", "", rate, "1/s in motion: a disturbance grows e-fold in", {.digits = 9});
  out.note(fmt::format(" {:.3g} s", 1 / rate));
  if (s.survey && (!s.lowest || s.survey->growing.value >= -s.lowest->value * (1 - 1e-9))) {
    const ZoneMaximum& growing = s.survey->growing;
    out.note(", fastest at " + name_of(growing.at, growing.points));
    if (growing.at.name == greek_gamma && s.cell_discs == 1) out.note(": all discs spin alike");
  }
  if (!s.lowest) {
    out.line("", "forces at rest outweigh the springs in such waves: the assembly buckles");
    out.warn();
    return;
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
    if (largest > worthless || !natural.converged) out.warn();
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
    if (!s.highest.converged) out.warn();
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
    out.warning(
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

Results stability_results(const Problem& problem, const Stability& s) {
  const bool periodic = problem.assembly.periodic();
  Results out = problem_results(problem, s.effects, AssemblyKeys::size);
  if (problem.resolved.ensemble)
    out.line("not used", "[ensemble]: the one assembly of [assembly] is judged, with its seed");
  if (periodic && s.reached >= StabilityStage::waves) add_waves(out, s);
  add_mechanisms(out, s, periodic);
  add_inertia(out, s);
  if (s.critical_load) add_critical_load(out, *s.critical_load, problem.assembly);
  if (s.reached >= StabilityStage::critical_ratio) add_critical(out, s);
  if (s.reached < StabilityStage::time_step) return out;
  add_growth(out, s, periodic);
  add_natural_frequencies(out, s, problem.assembly);
  add_time_step(out, s, disc_density(problem.resolved, problem.assembly), problem.resolved.assembly.body);
  return out;
}

constexpr const char* dispersion_table = "dispersion.csv";
constexpr const char* ratio_table = "critical_ratio.csv";
constexpr const char* dispersion_plot = "dispersion_plot";
constexpr const char* ratio_plot = "critical_ratio_plot";

/// Frequencies of a branch along the path; 0 below the round-off of the largest.
std::vector<double> frequencies(const WaveSurvey& survey, std::size_t branch) {
  constexpr double round_off = 1e-12;  // of squares
  double largest = 0;
  for (const PathPoint& point : survey.path)
    largest = std::max({largest, std::abs(point.squared_frequencies.front()), point.squared_frequencies.back()});
  std::vector<double> values;
  for (const PathPoint& point : survey.path) {
    const double squared = point.squared_frequencies[branch];
    values.push_back(std::abs(squared) <= round_off * largest ? 0 : signed_root(squared));
  }
  return values;
}

Table dispersion(const WaveSurvey& survey) {
  const std::vector<PathPoint>& path = survey.path;
  Table table;
  table.add("point", path, [](const PathPoint& point) { return point.at.name; });
  table.add("path_rad_per_m", path, &PathPoint::along);
  table.add("qx_rad_per_m", path, [](const PathPoint& point) { return point.at.q.x; });
  table.add("qy_rad_per_m", path, [](const PathPoint& point) { return point.at.q.y; });
  for (std::size_t b = 0; b < path.front().squared_frequencies.size(); ++b)
    table.add(fmt::format("omega_{}_rad_per_s", b + 1), frequencies(survey, b));
  if (survey.ratio_sought) table.add("critical_ratio", path, &PathPoint::critical_ratio);
  return table;
}

/// The whole zone: q and, where it is another wave vector, -q.
Table critical_over_zone(const WaveSurvey& survey) {
  std::vector<double> qx, qy, ratio;
  const std::vector<Vec2> grid = zone_grid(survey.zone, survey.grid);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const Vec2 q = survey.zone.folded(grid[k]), opposite = survey.zone.folded(-grid[k]);
    const bool other = norm(survey.zone.folded(q - opposite)) > 1e-6 * norm(survey.zone.reciprocal[0]);
    const bool listed = other && 2 * (k % (survey.grid / 2 + 1)) % survey.grid == 0;  // rows that hold their own -q
    for (int side = 0; side < (other && !listed ? 2 : 1); ++side) {
      qx.push_back(side == 0 ? q.x : opposite.x), qy.push_back(side == 0 ? q.y : opposite.y);
      ratio.push_back(survey.critical.on_grid[k]);
    }
  }
  Table table;
  table.add("qx_rad_per_m", qx).add("qy_rad_per_m", qy).add("critical_ratio", ratio);
  return table;
}

/// A plot along the path, with the points of symmetry marked.
Plot along_path(const WaveSurvey& survey, const std::string& title, const std::string& y) {
  const std::string names = joined(survey.zone.path, &ZonePoint::name, " - ");
  Plot plot{.title = title,
            .x = {.label = literal("wave vector along " + names + ", rad/m")},
            .y = {.label = y},
            .enhanced = true};
  plot.x.min = 0;
  plot.x.max = survey.path.back().along;
  for (const PathPoint& point : survey.path)
    if (!point.at.name.empty() && point.along > 0 && point.along < *plot.x.max)
      plot.vertical_lines.push_back({point.along, literal(point.at.name)});
  return plot;
}

std::vector<double> positions(const WaveSurvey& survey) {
  std::vector<double> x;
  for (const PathPoint& point : survey.path) x.push_back(point.along);
  return x;
}

Plot plot_of_dispersion(const Stability& s, const std::string& title) {
  const WaveSurvey& survey = *s.survey;
  Plot plot = along_path(survey, title.empty() ? "Dispersion" : literal(title),
                         s.lowest ? "ω, rad/s; below 0: growth rate, 1/s" : "ω, rad/s");
  const std::size_t branches = survey.path.front().squared_frequencies.size();
  constexpr std::array colours{PlotColour::blue, PlotColour::vermilion, PlotColour::black};
  for (std::size_t b = 0; b < branches; ++b) {
    Series series{.x = positions(survey),
                  .y = frequencies(survey, b),
                  .colour = branches <= colours.size() ? colours[b] : PlotColour::blue,
                  .column = fmt::format("omega_{}", b + 1)};
    plot.series.push_back(std::move(series));
  }
  if (!s.lowest) plot.y.min = 0;
  return plot;
}

Plot plot_of_critical_ratio(const Stability& s) {
  const WaveSurvey& survey = *s.survey;
  Plot plot = along_path(survey, "k_T/k_N at which each wave loses its stiffness in statics", "critical k_T/k_N");
  Series series{
      .label = "of each wave", .x = positions(survey), .colour = PlotColour::blue, .column = "critical_ratio"};
  for (const PathPoint& point : survey.path) series.y.push_back(point.critical_ratio);
  plot.series.push_back(std::move(series));
  const double end = survey.path.back().along;
  if (s.ratio && *s.ratio < 0)
    plot.series.push_back({.label = "this case",
                           .x = {0, end},
                           .y = {*s.ratio, *s.ratio},
                           .style = SeriesStyle::dashed_line,
                           .colour = PlotColour::vermilion,
                           .column = "this_case"});
  plot.y.min = -1.05;
  plot.y.max = 0.05;
  return plot;
}

void write_survey(const CommonOptions& options, const Problem& problem, const Stability& s) {
  if (!s.survey) return;
  const std::filesystem::path& folder = *options.out;
  write_csv(folder / dispersion_table, dispersion(*s.survey), options.overwrite);
  if (s.survey->ratio_sought) write_csv(folder / ratio_table, critical_over_zone(*s.survey), options.overwrite);
  write_plot(folder, dispersion_plot, plot_of_dispersion(s, problem.resolved.title), options.overwrite);
  if (std::ranges::any_of(s.survey->path, [](const PathPoint& p) { return std::isfinite(p.critical_ratio); }))
    write_plot(folder, ratio_plot, plot_of_critical_ratio(s), options.overwrite);
}

/// Along the path through the Brillouin zone: dispersion/along in rad/m, dispersion/wave_vectors in 1/m and
/// dispersion/squared_frequencies, ascending, in 1/s².
std::vector<ResultArray> dispersion_arrays(const WaveSurvey& survey) {
  std::vector<double> along, squared_frequencies;
  std::vector<Vec2> wave_vectors;
  for (const PathPoint& point : survey.path) {
    along.push_back(point.along);
    wave_vectors.push_back(point.at.q);
    squared_frequencies.insert(squared_frequencies.end(), point.squared_frequencies.begin(),
                               point.squared_frequencies.end());
  }
  const std::size_t branches = along.empty() ? 0 : squared_frequencies.size() / along.size();
  ResultArray table = array_of("dispersion/squared_frequencies", "1/s²", std::move(squared_frequencies), branches);
  table.rows = along.size();
  table.stride = branches;
  return {array_of("dispersion/along", "rad/m", std::move(along), 1),
          array_of("dispersion/wave_vectors", "1/m", std::move(wave_vectors), 2), std::move(table)};
}

struct StabilityCommand : CommonOptions {
  int frequencies = StabilityOptions{}.natural_frequencies;
  bool sensitivities = false;
};

/// The density of the discs, or 1.
StabilityOptions options_of(const Problem& problem, const StabilityCommand& command) {
  const Case& resolved = problem.resolved;
  return {.rotation = resolved.rotation,
          .density = disc_density(resolved, problem.assembly).value_or(1),
          .body = resolved.assembly.body,
          .solver = resolved.solver,
          .natural_frequencies = command.frequencies,
          .derivatives = command.sensitivities};
}

constexpr const char* lowest_frequency = "f1";

/// Natural frequencies, speeds of sound along x and y and the critical kT/kN, those first that have derivatives.
std::vector<SpringDependent> numbers_by_springs(const Stability& s) {
  std::vector<SpringDependent> numbers;
  constexpr double turn = 2 * std::numbers::pi;
  for (std::size_t k = 0; k < s.natural.derivatives.size(); ++k) {
    SpringDerivatives by = s.natural.derivatives[k];
    for (std::vector<double>* each : {&by.by_kN, &by.by_kT, &by.by_kM})
      for (double& value : *each) value /= turn;
    numbers.push_back({std::move(by), fmt::format("f{}", k + 1), "natural_frequencies",
                       fmt::format("df{0}/f{0}", k + 1), "Hz", signed_root(s.natural.squared[k]) / turn, true, k == 0});
  }
  for (const SoundDerivatives& sound : s.sound_derivatives) {
    const std::string symbol = fmt::format("V{}_{}", sound.transverse ? "s" : "p", sound.angle == 0 ? "x" : "y");
    numbers.push_back({sound, symbol, "sound_speeds/" + symbol, fmt::format("d{0}/{0}", symbol), "m/s", sound.speed});
  }
  if (!s.critical.by_kN.empty())
    numbers.push_back({{s.critical.by_kN, {}, {}}, "critical_ratio", "critical_ratio", "d critical kT/kN", ""});
  return numbers;
}

/// \throws Error (bad_input) where nothing has derivatives
Results sensitivity_results(const Problem& problem, const Stability& s) {
  const std::vector<SpringDependent> numbers = numbers_by_springs(s);
  if (std::ranges::all_of(numbers, [](const SpringDependent& number) { return number.by_kN.empty(); }))
    bad_input("derivatives are asked for, and no natural frequency, speed of sound or critical kT/kN has any",
              numbers.empty() ? "of an unstable network, or without frequencies, nothing is found to differentiate"
                              : "derivatives do not exist where frequencies coincide",
              "Choose springs at which it is stable, or break the symmetry of the assembly");
  Results out = spring_effects(problem, numbers, "changes of frequencies, speeds of sound and the critical kT/kN");
  std::vector<std::string> alike;
  double error = 0;
  for (std::size_t k = 0; k < s.natural.derivatives.size(); ++k) {
    const FrequencyDerivatives& of = s.natural.derivatives[k];
    if (of.simple) error = std::max(error, of.error);
    if (!of.simple) alike.push_back(fmt::format("f{}", k + 1));
  }
  if (alike.size() < s.natural.derivatives.size())
    out.line("derivatives")
        .add("sensitivities/frequency_error", "those of frequencies to about", error, "of f", {Shown::power, 1});
  if (!alike.empty())
    out.line("", fmt::format("none of {}: frequencies coincide, or are not told apart, and then have no derivatives",
                             joined(alike)));
  if (s.critical.sought && std::isfinite(s.critical.ratio) && s.critical.by_kN.empty())
    out.line("", s.survey ? "none of the critical kT/kN: it is that of a wave of the infinite assembly"
                          : "none of the critical kT/kN: not one motion alone loses its stiffness there");
  return out;
}

/// Whether the contacts also carry what the loads and the motions of supports of the case cause: where prestress is
/// asked for.
/// \throws Error (bad_input) where there are several load cases: stability is that of one state
bool acts_on_rest(const Problem& problem) {
  if (problem.resolved.prestress != PrestressChoice::on) return false;
  const auto moves = [](const Support& support) {
    return support.ux.value_or(0) != 0 || support.uy.value_or(0) != 0 || support.rotation.value_or(0) != 0;
  };
  const auto& load_cases = problem.load_cases;
  const bool acts = std::ranges::any_of(load_cases, [](const NamedLoads& each) { return !each.loads.empty(); }) ||
                    (!load_cases.empty() && std::ranges::any_of(problem.supports, moves));
  if (acts && load_cases.size() > 1)
    bad_input_at(problem.resolved.where("load"), "there are several load cases, and prestress is asked for",
                 "stability is that of one state", "Keep the loads of one");
  return acts;
}

/// To first order, as in Euler's load, that is at the places of before the loads.
Problem under_loads(Problem problem) {
  if (!acts_on_rest(problem)) return problem;
  Assembly& assembly = problem.assembly;
  const Equilibrium loaded = solve_equilibrium(assembly, problem.springs.springs, problem.supports,
                                               problem.load_cases.front().loads, problem.options());
  assembly.contact_normal_force.resize(assembly.contacts.size());
  assembly.contact_tangential_force.resize(assembly.contacts.size());
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    assembly.contact_normal_force[c] += loaded.contact_forces[c].normal;
    assembly.contact_tangential_force[c] += loaded.contact_forces[c].tangential;
  }
  problem.times.add("loads", loaded.times.total());
  return problem;
}

/// Names of files of the mode that is lost at the critical load end like this.
constexpr const char* buckling_suffix = "_buckling";

void draw_mode(const CommonOptions& options, const Problem& problem, const Stability& result) {
  if (!result.critical_load || result.critical_load->motion.empty()) return;
  const auto [left, right] = std::ranges::minmax(problem.assembly.centres, {}, &Vec2::x);
  const auto [low, high] = std::ranges::minmax(problem.assembly.centres, {}, &Vec2::y);
  constexpr double visible = 0.1;  // of the larger side; a mode has no size of its own
  const std::string& title = problem.resolved.title;
  write_state_picture(options, pictures_of(problem.resolved.output), buckling_suffix,
                      {.assembly = problem.assembly, .motions = result.critical_load->motion},
                      {.title = fmt::format("{}{}buckles at {:.6g} times the forces at rest", title,
                                            title.empty() ? "" : ": ", result.critical_load->factor),
                       .undeformed = true,
                       .displacement_scale = visible * std::max(right.x - left.x, high.y - low.y)});
}

struct Judged {
  std::optional<Problem> problem = {};
  Stability stability = {};
};

std::vector<OutputPart> output_parts(const Case& resolved, const std::shared_ptr<const Judged>& judged,
                                     bool sensitivities) {
  const std::vector<std::string> pictures{lowest_frequency};
  std::vector<std::string> waves{dispersion_table, ratio_table};
  for (const char* name : {dispersion_plot, ratio_plot}) std::ranges::move(plot_files(name), std::back_inserter(waves));
  return {case_part([=]() -> const Case& { return judged->problem->resolved; }),
          {"the waves", [=](const CommonOptions& into) { write_survey(into, *judged->problem, judged->stability); },
           OutputPart::page, waves},
          {sensitivities_name,
           [=](const CommonOptions& into) {
             if (const auto numbers = numbers_by_springs(judged->stability); sensitivities && !numbers.empty())
               write_sensitivities(into, *judged->problem, numbers);
           },
           OutputPart::page,
           sensitivities ? files_of_sensitivities(resolved.output, pictures) : std::vector<std::string>{}},
          {"the mode", [=](const CommonOptions& into) { draw_mode(into, *judged->problem, judged->stability); },
           OutputPart::page, state_names(pictures_of(resolved.output), buckling_suffix)}};
}

/// Loads and motions that make a prestress are not solved for.
void dry_run_survey(const StabilityCommand& options, Problem given) {
  const bool acted_on = acts_on_rest(given);
  const Problem problem =
      acted_on && !carries_forces(given.assembly) ? std::move(given) : prestressed(std::move(given));

  const Assembly& assembly = problem.assembly;
  const ContactSprings& springs = problem.springs.springs;
  Results results;
  if (acted_on) results.line("forces at rest", "those of the loads and motions of the case count: one more solution");
  results.line("waves").set("waves", Results());
  if (assembly.periodic()) {
    const PrimitiveCell cell = primitive_cell(assembly, springs);
    results.set("waves/primitive_cell_discs", cell.size());
    if (cell.size() <= most_discs_of_survey) {
      results.add("waves/wave_vectors", "about", survey_size(cell), "wave vectors of a cell of")
          .note(" " + counted(static_cast<long long>(cell.size()), "disc"));
    } else {
      results.note(
          fmt::format("none: the smallest cell has {} discs, more than {}", cell.size(), most_discs_of_survey));
    }
  } else {
    results.note("none: the assembly is not periodic");
  }
  const StabilityOptions judged = options_of(problem, options);
  const bool assumed = !disc_density(problem.resolved, assembly);
  const auto inertia = inertia_of(assembly, judged.density, judged.body);
  check_magnitudes(assembly, springs, inertia);
  results.line("time step")
      .add("element_bound_time_step", "",
           2 / std::sqrt(element_bound(assembly, springs, inertia, problem.effects().rotation)),
           "s is guaranteed to be stable (element bound)")
      .note(assumed ? "; density 1 kg/m³ assumed" : "");
  results.set("density_assumed", assumed);
  dry_run(options, problem, results, AssemblyKeys::size,
          {.inertia = vectors_of_frequencies(options.frequencies),
           .bytes_of_disc = options.sensitivities ? bytes_of_sensitivities(problem, 2 * options.frequencies) : 0});
}

void stability(const StabilityCommand& options) {
  Case resolved = read_case(options);
  const auto judged = std::make_shared<Judged>();
  const std::vector<OutputPart> parts = output_parts(resolved, judged, options.sensitivities);
  expect_results(options, parts);
  const auto lock = lock_out(options);
  // Nothing needs to act: an assembly without supports is judged as a free body or a periodic cell.
  Problem built = acts(resolved) ? build_problem(std::move(resolved)) : problem_of(std::move(resolved));
  if (options.dry_run) return dry_run_survey(options, std::move(built));
  const Problem& problem = judged->problem.emplace(prestressed(under_loads(std::move(built))));
  std::optional<Error> failure;
  const Stability& result = judged->stability = found_by<Stability>(failure, [&] {
    return analyze_stability(problem.assembly, problem.springs.springs, problem.supports, options_of(problem, options));
  });
  Results results = stability_results(problem, result);
  if (options.sensitivities) {
    const std::optional<Error> none = failure_of([&] { results.append(sensitivity_results(problem, result)); });
    if (!failure) failure = none;
  }
  const StopsHeldBack held_back(failure);
  StageTimes times = problem.times;
  times.add(result.times);
  deliver(options, result.status(), std::move(results), std::move(times), parts, failure);
  if (arrays_wanted() && options.sensitivities) hand_over(sensitivity_arrays(numbers_by_springs(result)));
  if (arrays_wanted() && result.critical_load && !result.critical_load->motion.empty())
    hand_over(motion_arrays("buckling/", {judged, &result.critical_load->motion}));
  if (arrays_wanted() && result.survey) hand_over(dispersion_arrays(*result.survey));
  for (std::size_t k = 0; arrays_wanted() && k < result.natural.motions.size(); ++k) {
    const std::shared_ptr<const std::vector<DiscMotion>> mode(judged, &result.natural.motions[k]);
    hand_over(motion_arrays(fmt::format("modes/{}/", k), mode));
  }
  hand_over(std::shared_ptr<const Assembly>(judged, &problem.assembly));
}

}  // namespace

Run declare_stability(CLI::App& command) {
  const auto options = std::make_shared<StabilityCommand>();
  add_common_options(command, *options);
  add_require_stable(command, *options);
  command.add_option("--frequencies", options->frequencies, "number of the lowest natural frequencies; 0: none")
      ->check(whole_number(0, 50))
      ->capture_default_str()
      ->type_name("N");
  command.add_flag(
      "--sensitivities", options->sensitivities,
      "derivatives of frequencies, speeds of sound and the critical kT/kN\nby the springs of each contact: "
      "sensitivities.csv in --out");
  return [options] { return stability(*options); };
}

}  // namespace equidem
