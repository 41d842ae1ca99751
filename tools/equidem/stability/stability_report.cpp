// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The report of `equidem stability` for people.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"

#include "solve/report.hpp"
#include "stability/stability_analysis.hpp"

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

std::string speed(double squared) {
  return squared >= 0 ? fmt::format("{:.6g}", std::sqrt(squared)) : fmt::format("none (c² = {:.3g})", squared);
}

std::string frequency(double squared) {
  return squared >= 0 ? fmt::format("omega = {:.9g} rad/s", std::sqrt(squared))
                      : fmt::format("none: it grows at {:.6g} 1/s", std::sqrt(-squared));
}

void append_mechanisms(std::string& out, const Stability& s) {
  const std::vector<Vec2> waves = s.survey ? s.survey->free_waves : std::vector<Vec2>{};
  const bool none = s.mechanisms.count() == 0;
  std::string line;
  if (none) {
    const std::string of_the_whole = s.mechanisms.rigid_motions == 0 ? ""
                                     : s.problem.assembly.periodic()
                                         ? " (the two translations of a periodic cell do not count)"
                                         : fmt::format(" (the {} of a body that nothing holds do not count)",
                                                       counted(s.mechanisms.rigid_motions, "rigid motion"));
    line = fmt::format("none{}: every motion stretches or slips some contact{}",
                       waves.empty() ? "" : " that repeats with the cell", of_the_whole);
  } else {
    line = s.mechanisms.sentences.size() > 1
               ? fmt::format("{} without energy: ", counted(s.mechanisms.count(), "motion"))
               : std::string();
    for (std::size_t k = 0; k < s.mechanisms.sentences.size(); ++k)
      line += (k > 0 ? "; " : "") + s.mechanisms.sentences[k];
  }
  out += report_line("mechanisms", line);
  if (waves.empty()) return;
  const std::string name = s.survey->zone.name_of(waves.front());
  out += report_line(
      "", fmt::format("of the infinite assembly: waves that stretch and slip no contact, at {} searched, such as {}",
                      counted(static_cast<std::int64_t>(waves.size()), "of the wave vectors", "of the wave vectors"),
                      name_of({name, waves.front()}, {})));
}

void append_inertia(std::string& out, const Stability& s) {
  const InertiaReport& inertia = s.inertia;
  std::string line = counted(inertia.negative_pivots, "negative pivot");
  if (inertia.negative_pivots > 0) {
    line += inertia.unstable_modes == 0 ? ", one for each rotation: no translation has lost its stiffness"
            : inertia.unstable_modes > 0
                ? fmt::format(", {} beyond one for each rotation: the assembly gives way by so many modes",
                              inertia.unstable_modes)
                : "; the rotations alone are singular, so that they cannot be told apart";
  }
  out += report_line("inertia", line);
}

void append_critical(std::string& out, const Stability& s) {
  const CriticalMotion& c = s.critical;
  if (!c.sought) {
    out += report_line("critical kT/kN", "not sought: " + c.searched);
    out += report_line("this case", s.status() == "stable"     ? "stable in statics"
                                    : s.status() == "unstable" ? "UNSTABLE in statics"
                                                               : "a mechanism: see above");
    return;
  }
  if (!std::isfinite(c.ratio)) {
    out += report_line("critical kT/kN", "none: stable in statics down to kT = -kN");
  } else {
    out += report_line("critical kT/kN",
                       fmt::format("{:.12g}{}", c.ratio, c.wave ? ", lost at " + name_of(*c.wave, c.equivalent) : ""));
  }
  if (!c.motion.empty()) out += report_line("", "gives way by " + c.motion);
  out += report_line("", "searched: " + c.searched);
  if (!s.ratio) {
    out += report_line("", "contacts of this case have different kT/kN: the critical ratio is that of equal ones");
    return;
  }
  const double margin = *s.ratio - c.ratio;
  const std::string where = std::isfinite(margin) ? fmt::format(", {:.6g} {} the critical ratio", std::abs(margin),
                                                                margin >= 0 ? "above" : "below")
                                                  : "";
  const std::string state = s.status();
  out += report_line("this case",
                     fmt::format("kT/kN = {:.6g}{}: {}", *s.ratio, where,
                                 state == "stable"     ? "stable in statics"
                                 : state == "unstable" ? "UNSTABLE in statics"
                                 : margin >= 0 ? "stable in statics but for its mechanisms, which nothing resists"
                                               : "UNSTABLE in statics, and a mechanism"));
}

void append_growth(std::string& out, const Stability& s) {
  if (!s.lowest) return;
  const double rate = s.growth_rate();
  if (rate == 0) {
    const bool all_waves = !s.problem.assembly.periodic() || s.survey;
    out += report_line("growth", fmt::format("none: some kT are negative, but no motion{} has negative energy",
                                             all_waves ? "" : " that repeats with the cell"));
    return;
  }
  std::string which;
  if (s.survey && s.survey->growing.value >= -s.lowest->value * (1 - 1e-9)) {
    const ZoneMaximum& growing = s.survey->growing;
    which = ", fastest at " + name_of(growing.at, growing.points);
    if (growing.at.name == greek_gamma && s.cell_discs == 1) which += ": all discs spin alike";
  }
  out += report_line(
      "growth", fmt::format("{:.9g} 1/s in motion: a disturbance grows e-fold in {:.3g} s{}", rate, 1 / rate, which));
  out += report_line(
      "",
      "kT < 0 gives rotations negative stiffness. Statics finds where all forces balance; for the rotations that is "
      "a maximum of the energy, not a minimum, so that it is a state of rest no explicit run can "
      "reach or keep, at any time step and any damping. Use such springs in statics only");
}

void append_time_step(std::string& out, const Stability& s) {
  const bool vibrates = s.highest.value > 0, grows = s.growth_rate() > 0;
  double omega = std::sqrt(s.highest.value);
  out += report_line("omega_max", vibrates ? fmt::format("{:.12g} rad/s, Lanczos, residual {:.1e} of omega²{}", omega,
                                                         s.highest.residual / s.highest.value,
                                                         s.highest.converged ? "" : " (NOT CONVERGED: a lower bound)")
                                           : "none: no motion that repeats with the given cell vibrates");
  if (s.survey && s.survey->highest.value > 0) {
    const ZoneMaximum& highest = s.survey->highest;
    if (!vibrates) omega = std::sqrt(highest.value);
    out += report_line("", fmt::format("{:.12g} rad/s over all waves of the infinite assembly, at {}",
                                       std::sqrt(highest.value), name_of(highest.at, highest.points)));
  }
  const auto line = [&](const std::string& name, double step, const std::string& what) {
    out += report_line(name, fmt::format("{:<14.9g} s  {:.3f}  {}", step, step * omega / 2, what));
  };
  out += report_line("time step", "of explicit integration (central differences), and over the first of them");
  if (omega > 0) {
    line("  2/omega_max", 2 / omega,
         grows      ? "critical for what vibrates; with kT < 0 no time step is stable (see growth)"
         : vibrates ? "critical: stable below, for this assembly"
                    : "critical: stable below, for the waves of the infinite assembly");
  }
  line("  elements", 2 / std::sqrt(s.element_bound),
       grows ? "never above the critical one: each contact with its share of the masses"
             : "guaranteed: each contact with its share of the masses");
  line("  diagonal", s.rules.diagonal,
       s.rules.diagonal * omega > 2 * (1 + 1e-9) ? "no guarantee, and TOO LARGE here: sqrt2 min sqrt(m/K_ii)"
                                                 : "no guarantee: sqrt2 min sqrt(m/K_ii)");
  line("  T/8", s.rules.eighth_of_period,
       s.rules.eighth_of_period * omega > 2 * (1 + 1e-9)
           ? "no guarantee, and TOO LARGE here: an eighth of 2 pi sqrt(m/kN)"
           : "no guarantee: an eighth of 2 pi sqrt(m/kN)");
  if (s.density_assumed)
    out +=
        report_line("",
                    "DENSITY ASSUMED: 1 kg/m³, since assembly.density is not given. Times scale with its square root, "
                    "frequencies and speeds with the inverse");
}

void append_sound(std::string& out, const Stability& s) {
  if (s.survey) {
    const std::vector<SoundAlong>& sound = s.survey->sound;
    for (const std::size_t k : {0, 2, 3, 6}) {
      std::string line =
          fmt::format("{:3.0f} degrees from x: P {} S {}", sound[k].angle * 180 / std::numbers::pi,
                      speed(sound[k].speeds.longitudinal_squared), speed(sound[k].speeds.transverse_squared));
      if (!s.sound.empty())
        line += fmt::format(" m/s; homogenized P {} S {}", speed(s.sound[k].longitudinal_squared),
                            speed(s.sound[k].transverse_squared));
      out += report_line(k == 0 ? "sound" : "", line + " m/s");
    }
  } else {
    for (std::size_t k = 0; k < s.sound.size(); ++k)
      out += report_line(k == 0 ? "sound" : "",
                         fmt::format("along {}: P {} S {} m/s, of the homogenized continuum", k == 0 ? "x" : "y",
                                     speed(s.sound[k].longitudinal_squared), speed(s.sound[k].transverse_squared)));
  }
  if (!s.no_continuum.empty()) out += report_line("", "no homogenized continuum to compare with: " + s.no_continuum);
}

void append_waves(std::string& out, const Stability& s) {
  if (!s.problem.assembly.periodic()) return;
  if (!s.survey) {
    out += report_line("smallest cell", fmt::format("{}: too many for the spectrum of waves, which takes up to {}",
                                                    counted(s.cell_discs, "disc"), most_discs_of_survey));
    append_sound(out, s);
    return;
  }
  const WaveSurvey& survey = *s.survey;
  const auto [a, b] = survey.cell.period;
  out += report_line("smallest cell",
                     fmt::format("{}, {} lattice ({:.6g}, {:.6g}), ({:.6g}, {:.6g}) m, {} of it in the given one",
                                 counted(s.cell_discs, "disc"), survey.zone.lattice, a.x, a.y, b.x, b.y,
                                 counted(survey.cell.copies, "copy", "copies")));
  append_sound(out, s);
  if (survey.squared_rotational_gap)
    out += report_line("rotational gap", frequency(*survey.squared_rotational_gap) +
                                             ", the slowest long wave in which discs turn against their neighbours");
}

}  // namespace

std::string describe_stability(const Stability& s) {
  std::string out = describe_problem(s.problem, s.effects);
  if (s.problem.resolved.ensemble)
    out += report_line("not used", "[ensemble]: the one assembly of [assembly] is judged, with its seed");
  append_waves(out, s);
  append_mechanisms(out, s);
  append_inertia(out, s);
  append_critical(out, s);
  append_growth(out, s);
  append_time_step(out, s);
  out += report_line("times", fmt::format("{:.2g} s in all", s.times.total()));
  return out;
}

}  // namespace equidem
