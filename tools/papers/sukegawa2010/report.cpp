// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"
#include "equidem/fields/spectrum.hpp"
#include "equidem/material/wave_speed_springs.hpp"

#include "sukegawa2010/sukegawa2010.hpp"
#include "tables.hpp"

namespace equidem::sukegawa2010 {
namespace {

std::string figures(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}
std::string spread(const MeanEstimate& sample, int digits) {
  const std::string deviation =
      std::isfinite(sample.standard_deviation) ? " ± " + figures(sample.standard_deviation, digits) : "";
  return figures(sample.mean, digits) + deviation;
}

std::string table_of_void_ratios(const Reproduction& result, double Outcome::*first, double Outcome::*last) {
  TextTable table(" & before & printed & after & printed & change & printed & seeds");
  for (const Printed& printed : printed_void_ratios) {
    const Kind kind{.shape = printed.shape};
    const MeanEstimate changes = sample_of(result, kind, [&](const Outcome& o) { return o.*last - o.*first; });
    const auto beside = [&](double value) { return printed.before > 0 ? figures(value, 3) : ""; };
    table.add("{} & {} & {} & {} & {} & {} & {} & {}", words(plural_of(printed.shape)),
              spread(sample_of(result, kind, first), 4), beside(printed.before),
              spread(sample_of(result, kind, last), 4), beside(printed.after), spread(changes, 4),
              beside(printed.after - printed.before), changes.samples);
  }
  return table.text();
}

std::string void_ratios(const Reproduction& result) {
  return "Void ratio before and after 400 gal, 10 Hz; mean and standard deviation over seeds. The thesis does not "
         "state "
         "where it\nis measured.\nWhole width between the walls, below the mean surface:\n" +
         table_of_void_ratios(result, &Outcome::whole_before, &Outcome::whole) +
         "Two mean diameters away from walls and floor, three below the lowest point of the surface:\n" +
         table_of_void_ratios(result, &Outcome::void_ratio_before, &Outcome::void_ratio);
}

std::string contact_margin(const Reproduction& result) {
  const MeanEstimate sample = sample_of(result, {}, &Outcome::whole_before);
  if (sample.samples == 0) return "";
  const double solid = 1 / (1 + sample.mean);
  std::string text =
      "If the margin beta of contact detection (3.1) were that of the contact law, grains would pack as grains beta "
      "times as\nlarge: the porosity n of discs before shaking, over the whole width, would be 1 - (1 - n)/beta^2:\n ";
  for (const double beta : {1.0, 1.05, 1.1})
    text += fmt::format(" beta {:4.2f}: {:.4f};", beta, 1 - solid / (beta * beta));
  return text + "  printed 0.1756\n";
}

/// Compares printed details, one at a time, with the void ratio of discs under (2.16), 0.245, and the printed 0.213.
std::string printed_level(const Reproduction& result) {
  const auto whole = &Outcome::whole_before;
  const Fill fill;
  const double printed = printed_void_ratios[0].before, radius = 0.5 * (smallest_radius + largest_radius);
  const double stiffness = springs_of_wave_speeds(density, wave_speeds_from_shear(shear_speed, poisson_ratio)).kN;
  const double mass = std::numbers::pi * radius * radius * density;
  const double fastest = mass * gravity / dashpot_of(fill.damping, mass, stiffness);
  std::string text;
  const MeanEstimate capped = sample_of(result, {.variant = "printed_cap"}, whole);
  for (const auto& [variant, name] :
       {std::pair{"increments", "forces in increments"}, std::pair{"printed_integrator", "integrator (3.16)-(3.17)"},
        std::pair{"mass_damping_1", "c_i = 1/s m_i"}, std::pair{"mass_damping_10", "c_i = 10/s m_i"},
        std::pair{"beta_1.05", "beta = 1.05"}}) {
    const MeanEstimate with = sample_of(result, {.variant = variant}, whole);
    if (with.samples == 0 || capped.samples == 0) continue;
    // An entry with one seed is judged by the scatter of the runs with (2.16) alone.
    const bool one = with.samples == 1;
    const double half = one && capped.samples > 1
                            ? student_critical_value(0.95, capped.samples - 1) * capped.standard_deviation
                            : with.half_width;
    const char* verdict = !std::isfinite(half)         ? "not decided"
                          : with.mean - half > printed ? "does not explain it, too loose"
                          : with.mean + half < printed ? "does not explain it, too dense"
                                                       : "agrees with it within the scatter";
    text += fmt::format("  {:<26} {} against {} without, printed {:g}: {}{}\n", name, spread(with, 4),
                        spread(capped, 4), printed, verdict, one ? " (one seed)" : "");
  }
  if (text.empty()) return "";
  return "Whether what is printed explains the void ratio of discs before shaking, over the whole width, all with "
         "(2.16):\n" +
         text +
         fmt::format(
             "  c_i is not given. Read as (2.27), 2 h sqrt(m k), it would let a disc of {:g} cm fall at {:.2g} m/s at "
             "most: {:.2g} s for\n  the {:g} m of the start, {:.1g} printed steps. rho = (1 + e) gamma in springs and "
             "masses multiplies all forces and\n  masses by the same number: the same motion but for rounding.\n\n",
             100 * radius, fastest, printed_box_height / fastest, printed_box_height,
             printed_box_height / fastest / printed_step);
}

std::string variants(const Reproduction& result) {
  if (result.quick) return "";
  const std::vector<std::pair<Kind, const char*>> rows{
      {{}, "as above"},
      {{.cycles = long_shakings[0]}, "shaken for 5 s, not 1 s"},
      {{.cycles = long_shakings[1]}, "shaken for 20 s"},
      {{.variant = "half_step"}, "half the step"},
      {{.variant = "soft"}, "springs nine times softer"},
      {{.variant = "less_damping"}, "h = 0.1"},
      {{.variant = "printed_step"}, "the printed step, 1e-6 s"},
      {{.variant = "printed_cap"}, "friction limits the spring alone (2.16)"},
      {{.variant = "printed_cap", .cycles = long_shakings[0]}, "(2.16), shaken for 5 s"},
      {{.variant = "printed_cap", .cycles = long_shakings[1]}, "(2.16), shaken for 20 s"},
      {{.variant = "increments_capped"}, "forces of chapter 2 in increments, friction limits all"},
      {{.variant = "increments"}, "forces in increments, (2.16)"},
      {{.variant = "printed_integrator"}, "the same with the integrator (3.16)-(3.17)"},
      {{.variant = "mass_damping_1"}, "the same with c_i = 1/s m_i in (3.13)"},
      {{.variant = "mass_damping_10"}, "the same with c_i = 10/s m_i"},
      {{.variant = "beta_1.05"}, "the same with beta = 1.05 of (3.1) in the force"},
      {{.variant = "bulk_springs"}, "springs of E, nu, rho = (1+e) gamma (2.23)-(2.26)"},
      {{.variant = "bulk_density"}, "rho = (1+e) gamma in springs and masses"},
      {{.variant = "low_drop"}, "rows 0.7 times as high at the start"},
      {{.variant = "smooth"}, "no friction between grains"},
      {{.variant = "rough"}, "friction 0.5"},
      {{.shape = Shape::ellipse}, "ellipses"},
      {{.shape = Shape::ellipse, .variant = "printed_cap", .cycles = long_shakings[0]}, "ellipses, (2.16), 5 s"},
      {{.shape = Shape::ellipse, .variant = "small"}, "612 ellipses, springs nine times softer"},
      {{.shape = Shape::ellipse, .variant = "mended_test"}, "the same, contacts by (4.1)-(4.49) corrected"},
      {{.shape = Shape::bonded_pair}, "bonded pairs"},
      {{.shape = Shape::bonded_pair, .variant = "printed_cap", .cycles = long_shakings[0]},
       "bonded pairs, (2.16), 5 s"},
      {{.shape = Shape::bonded_pair, .gal = 0}, "bonded pairs at rest for the same time"},
      {{.shape = Shape::bonded_pair, .variant = "strong_bonds"}, "bonded pairs, C_n and C_s tenfold"}};
  TextTable table(" & before & after & change & inner: before & change & seeds");
  for (const auto& [kind, name] : rows) {
    const auto cell = [&, of = kind](const auto& value) { return spread(sample_of(result, of, value), 4); };
    const std::int64_t seeds = sample_of(result, kind, &Outcome::void_ratio).samples;
    if (seeds == 0) continue;
    table.add("{} & {} & {} & {} & {} & {} & {}", name, cell(&Outcome::whole_before), cell(&Outcome::whole),
              cell(&Outcome::whole_change), cell(&Outcome::void_ratio_before), cell(&Outcome::change), seeds);
  }
  if (table.empty()) return "";
  return "Dependence of the void ratio on one parameter at a time: over the whole width, and in the inner region\n" +
         table.text() +
         "With (2.16) the tangential dashpot force has no limit: no contact sticks, the heap comes to rest looser and "
         "continues\nto compact for as long as it is shaken (compaction_over_time.png).\n\n" +
         printed_level(result);
}

std::string shakings(const Reproduction& result) {
  TextTable table(" & e before & e after & change & surface, mm & centre, mm & rough, mm & after, mm & slope & thrown");
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    std::vector<Done> runs = mapped(result, shape);
    std::erase_if(runs, [](const Done& done) {
      const double f = done.run.shaking->frequency;
      return f != 1 && f != 2 && f != 5 && f != 10;
    });
    std::sort(runs.begin(), runs.end(), [](const Done& a, const Done& b) {
      return std::pair(-a.run.shaking->frequency, a.run.shaking->gal) <
             std::pair(-b.run.shaking->frequency, b.run.shaking->gal);
    });
    for (const Done& done : runs) {
      const Outcome& o = done.outcome;
      table.add("{}, {:g} gal, {:g} Hz & {} & {} & {} & {} & {} & {} & {} & {} & {}", words(plural_of(shape)),
                done.run.shaking->gal, done.run.shaking->frequency, figures(o.void_ratio_before, 4),
                figures(o.void_ratio, 4), figures(o.change(), 4), figures(1e3 * (o.height_before - o.height), 1),
                figures(1e3 * (o.centre_before - o.centre), 2), figures(1e3 * o.roughness_before, 1),
                figures(1e3 * o.roughness, 1), figures(o.slope, 2), figures(o.thrown, 0));
    }
  }
  return "Shaking of one filling of each shape: settlement of the surface and of the centre of mass, roughness and "
         "largest slope\nof the surface\n" +
         table.text();
}

std::string periods(const Reproduction& result) {
  const auto discs = std::find_if(result.runs.begin(), result.runs.end(), [](const Done& done) {
    return done.run.fill.shape == Shape::disc && done.run.fill.variant.empty();
  });
  if (discs == result.runs.end()) return "";
  const double width = discs->run.fill.grid.width(), depth = discs->outcome.height_before;
  TextTable table(" & linear theory & (7.2) as printed");
  const auto add = [&](const std::string& name, double h) {
    table.add("{} & {} s & {} s", name, figures(sloshing_period(width, h, gravity), 4),
              figures(printed_formula_period(width, h), 4));
  };
  add("height of the start, 2.25 m", printed_box_height);
  add(fmt::format("depth of the heap, {:.3f} m", depth), depth);
  TextTable sweep("period & swing, mm & amplification & liquid without loss & slope & thrown");
  for (const Done& done : resonance_runs(result)) {
    const double period = 1 / done.run.shaking->frequency;
    sweep.add("discs, 400 gal, {:.3g} s & {} & {} & {} & {} & {}", period, figures(1e3 * done.outcome.swing, 2),
              figures(amplification_of(done), 3), figures(liquid_amplification(period, width, depth), 3),
              figures(done.outcome.slope, 3), figures(done.outcome.thrown, 0));
  }
  return "First sloshing period T1 of a tank of the same width\n" + table.text() +
         fmt::format(
             "  The printed 1.85 s follows from neither; 1.25 s, the value of both for h = 2.25 m, may have been "
             "misread. "
             "2.25 m is\n  75 rows of 3 cm, the height from which the grains fall; the depth of the heap is {:.2f} "
             "m.\n",
             depth) +
         "Resonance of the box: swing of the centre of mass in the box, and the same over that of a liquid tilted by "
         "a/g\n" +
         sweep.text();
}

std::string bonds(const Reproduction& result) {
  TextTable table(" & distance & rotation, rad");
  for (const Done& done : result.runs) {
    if (done.run.fill.shape != Shape::bonded_pair || !std::isfinite(done.outcome.creep)) continue;
    table.add("{} & {:.3g} & {:.3g}", words(done.run.name()), done.outcome.creep, done.outcome.roll);
  }
  if (table.empty()) return "";
  return fmt::format(
             "Bonds of dashpots alone creep: mean change of the distance over the sum of the radii, and of the "
             "relative "
             "rotation,\nsince the start. C_n = m_r/dt with the printed dt = {:g} s, C_s a third, at any time step.\n",
             printed_step) +
         table.text() + "\n";
}

std::string numerics(const Reproduction& result) {
  TextTable table(" & step, s & steps & largest overlap & energy error & contacts per body & seconds");
  for (const Done& done : result.runs) {
    const Shaking& shaking = *done.run.shaking;
    const Fill& fill = done.run.fill;
    const bool usual = fill.variant.empty() && shaking.cycles <= 10;
    if (fill.seed != 1 || !(usual || fill.step) || shaking.gal != 400 || shaking.frequency != 10) continue;
    const Outcome& o = done.outcome;
    table.add("{} & {:.3g} & {:.0f} & {:.2g} of r_min & {:+.2g} & {:.2f} & {:.0f}", words(plural_of(fill.shape)),
              o.time_step, o.steps, o.overlap, o.energy_error, o.coordination, o.seconds);
  }
  return "Computation, seed 1, 400 gal, 10 Hz\n" + table.text();
}

}  // namespace

std::string report(const Reproduction& result) {
  const Run first = result.runs.empty() ? plan(result.quick).front() : result.runs.front().run;
  const StartGrid& grid = first.fill.grid;
  std::string text = "Sukegawa (2010), chapter 8: grains in a box, filled and shaken\n\n";
  if (!result.complete()) text += fmt::format("INCOMPLETE: {} of {} runs\n\n", result.runs.size(), result.planned);
  text += fmt::format(
      "{} places in {} rows of {}, {:g} cm apart, in a box {:.4g} m wide; pairs take two places. Radii {:g} to {:g} "
      "cm, ellipses\n"
      "of the same areas, Vs = {:g} m/s, nu = {:g}, {:g} kg/m³, h = 1, friction {:g}, with walls {:g}. Contacts "
      "follow (2.26),\n"
      "(2.27), and friction limits the whole tangential force; contacts of ellipses are exact; the integrator is "
      "corrected_verlet\n"
      "at half the stable step of a contact of the two lightest bodies. The bodies fall, come to rest, are shaken by "
      "a cos(2 pi f t)\n"
      "along x for a second and at least two cycles (the thesis does not state how long), and come to rest again.\n",
      grid.places(), grid.rows, grid.columns, 100 * StartGrid::cell, grid.width(), 100 * smallest_radius,
      100 * largest_radius, shear_speed, poisson_ratio, density, friction, wall_friction);
  if (first.fill.softness != 1)
    text +=
        fmt::format("Quick: fewer grains than in the thesis, and springs {:g} times softer.\n", first.fill.softness);
  if (!result.quick) {
    text +=
        "The start is deduced: 40 columns and 75 rows at 3 cm, every other row shifted by half a place, give 40.5 x 3 "
        "cm = 121.5 cm,\n"
        "the printed width, and 75 x 3 cm = 2.25 m, the printed height; No. 485, 500, 515 are then at the left, middle "
        "and right of row 13.\n";
  }
  return text + "\n" + void_ratios(result) + "\n" + contact_margin(result) + "\n" + variants(result) +
         shakings(result) + "\n" + verdicts(result) + periods(result) + "\n" + bonds(result) + numerics(result) + "\n" +
         report_of(result.packings) + "\n" + report_of(result.fallen_ellipses);
}

}  // namespace equidem::sukegawa2010
