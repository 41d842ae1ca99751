// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/fields/spectrum.hpp"

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {
namespace {

std::string figures(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}
std::string spread(const Sample& sample, int digits) {
  if (sample.values.empty()) return "-";
  const double deviation = sample.deviation();
  return figures(sample.mean(), digits) + (std::isfinite(deviation) ? " ± " + figures(deviation, digits) : "");
}

/// A row without the blanks of its last columns; ± counts as one character.
std::string row(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) {
  std::string text = "  ";
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto length = static_cast<std::size_t>(
        std::count_if(cells[k].begin(), cells[k].end(), [](char c) { return (c & 0xC0) != 0x80; }));
    const std::string blanks(widths[k] > length ? widths[k] - length : 1, ' ');
    text += k == 0 ? cells[k] + blanks : blanks + cells[k];
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

double before(const Outcome& o) {
  return o.void_ratio_before;
}
double after(const Outcome& o) {
  return o.void_ratio;
}

std::string table_of_void_ratios(const Reproduction& result, double Outcome::*first, double Outcome::*last) {
  const std::vector<std::size_t> widths{14, 16, 10, 18, 10, 19, 10, 8};
  std::string text = row({"", "before", "printed", "after", "printed", "change", "printed", "seeds"}, widths);
  for (const Printed& printed : printed_void_ratios) {
    const Kind kind{.shape = printed.shape};
    const Sample changes = sample_of(result, kind, [&](const Outcome& o) { return o.*last - o.*first; });
    const auto beside = [&](double value) { return printed.before > 0 ? figures(value, 3) : ""; };
    text += row({words(plural_of(printed.shape)),
                 spread(sample_of(result, kind, [&](const Outcome& o) { return o.*first; }), 4), beside(printed.before),
                 spread(sample_of(result, kind, [&](const Outcome& o) { return o.*last; }), 4), beside(printed.after),
                 spread(changes, 4), beside(printed.after - printed.before), fmt::format("{}", changes.values.size())},
                widths);
  }
  return text;
}

std::string void_ratios(const Reproduction& result) {
  return "Void ratio before and after 400 gal, 10 Hz; mean and standard deviation over seeds. The thesis does not say "
         "where it\n"
         "measures.\nAll between the walls, below the mean surface:\n" +
         table_of_void_ratios(result, &Outcome::whole_before, &Outcome::whole) +
         "Two mean diameters off the walls and the floor, three below the lowest place of the surface:\n" +
         table_of_void_ratios(result, &Outcome::void_ratio_before, &Outcome::void_ratio);
}

std::string contact_margin(const Reproduction& result) {
  const Sample sample = sample_of(result, {}, [](const Outcome& o) { return o.whole_before; });
  if (sample.values.empty()) return "";
  std::string text =
      "Were the margin beta of detection (3.1) that of the contact law, grains would lie as grains beta times as "
      "large:\n"
      "the porosity of discs before shaking, all between the walls, would be 1 - (1 - n)/beta^2,\n";
  const double porosity = sample.mean() / (1 + sample.mean());
  for (const double beta : {1.0, 1.05, 1.1})
    text += fmt::format("  beta {:4.2f}: {:.4f}{}", beta, 1 - (1 - porosity) / (beta * beta), beta > 1.07 ? "" : ";");
  return text + ";  printed 0.1756\n";
}

std::string variants(const Reproduction& result) {
  const std::vector<std::pair<Kind, const char*>> rows{
      {{}, "as above"},
      {{.cycles = long_shakings[0]}, "shaken for 5 s, not 1 s"},
      {{.cycles = long_shakings[1]}, "shaken for 20 s"},
      {{.variant = "half_step"}, "half the step"},
      {{.variant = "soft"}, "springs nine times softer"},
      {{.variant = "less_damping"}, "h = 0.1"},
      {{.variant = "printed_step"}, "the printed step, 1e-6 s"},
      {{.variant = "printed_cap"}, "friction caps the spring alone (2.16)"},
      {{.variant = "printed_cap", .cycles = long_shakings[0]}, "that, shaken for 5 s"},
      {{.variant = "printed_cap", .cycles = long_shakings[1]}, "that, shaken for 20 s"},
      {{.variant = "low_drop"}, "rows 0.7 times as high at the start"},
      {{.variant = "smooth"}, "no friction between grains"},
      {{.variant = "rough"}, "friction 0.5"},
      {{.shape = Shape::ellipse}, "ellipses"},
      {{.shape = Shape::ellipse, .variant = "printed_cap", .cycles = long_shakings[0]}, "ellipses, (2.16), 5 s"},
      {{.shape = Shape::ellipse, .variant = "small"}, "612 ellipses, springs nine times softer"},
      {{.shape = Shape::ellipse, .variant = "mended_test"}, "those, found by (4.1)-(4.49) mended"},
      {{.shape = Shape::bonded_pair}, "bonded pairs"},
      {{.shape = Shape::bonded_pair, .variant = "printed_cap", .cycles = long_shakings[0]},
       "bonded pairs, (2.16), 5 s"},
      {{.shape = Shape::bonded_pair, .gal = 0}, "bonded pairs left standing for as long"},
      {{.shape = Shape::bonded_pair, .variant = "strong_bonds"}, "bonded pairs, C_n and C_s tenfold"}};
  if (result.quick) return "";
  const auto changed = [](double Outcome::*first, double Outcome::*last) {
    return [first, last](const Outcome& o) { return o.*last - o.*first; };
  };
  const auto whole_change = changed(&Outcome::whole_before, &Outcome::whole);
  const auto inner_change = changed(&Outcome::void_ratio_before, &Outcome::void_ratio);
  std::string text;
  const std::vector<std::size_t> widths{43, 19, 19, 21, 19, 21, 7};
  for (const auto& [kind, name] : rows) {
    const auto cell = [&, of = kind](const auto& value) { return spread(sample_of(result, of, value), 4); };
    const std::size_t seeds = sample_of(result, kind, after).values.size();
    if (seeds == 0) continue;
    text += row(
        {name, cell([](const Outcome& o) { return o.whole_before; }), cell([](const Outcome& o) { return o.whole; }),
         cell(whole_change), cell(before), cell(inner_change), fmt::format("{}", seeds)},
        widths);
  }
  if (text.empty()) return "";
  return "What the void ratio depends on, one thing changed at a time: all between the walls, and away from them\n" +
         row({"", "before", "after", "change", "away: before", "change", "seeds"}, widths) + text +
         "By (2.16) the dashpot pushes along a contact without limit: nothing locks, the heap comes to rest looser and "
         "goes on\n"
         "compacting for as long as it is shaken (compaction_over_time.png).\n\n";
}

std::string shakings(const Reproduction& result) {
  std::string text =
      "Shaken, one filling of each; settlement of the surface and of the centre of mass, roughness of the surface, its "
      "largest "
      "slope\n";
  const std::vector<std::size_t> widths{32, 9, 9, 10, 12, 12, 12, 12, 9, 9};
  text += row(
      {"", "e before", "e after", "change", "surface, mm", "centre, mm", "rough, mm", "after, mm", "slope", "thrown"},
      widths);
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    for (const double frequency : {10, 5, 2, 1}) {
      for (const double acceleration : {400, 800, 1200}) {
        for (const Done& done : result.runs) {
          const Fill& fill = done.run.fill;
          const Shaking& shaking = *done.run.shaking;
          if (!done.run.mapped || fill.shape != shape || shaking.gal != acceleration || shaking.frequency != frequency)
            continue;
          const Outcome& o = done.outcome;
          text += row({fmt::format("{}, {:g} gal, {:g} Hz", words(plural_of(shape)), acceleration, frequency),
                       figures(o.void_ratio_before, 4), figures(o.void_ratio, 4),
                       figures(o.void_ratio - o.void_ratio_before, 4), figures(1e3 * (o.height_before - o.height), 1),
                       figures(1e3 * (o.centre_before - o.centre), 2), figures(1e3 * o.roughness_before, 1),
                       figures(1e3 * o.roughness, 1), figures(o.slope, 2), figures(o.thrown, 0)},
                      widths);
        }
      }
    }
  }
  return text;
}

std::string best_compaction(const Reproduction& result) {
  std::string text;
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    const Done* best = nullptr;
    std::size_t tried = 0;
    for (const Done& done : result.runs) {
      const Fill& fill = done.run.fill;
      if (!done.run.mapped || fill.shape != shape || !std::isfinite(done.outcome.void_ratio)) continue;
      ++tried;
      if (best == nullptr || done.outcome.void_ratio < best->outcome.void_ratio) best = &done;
    }
    if (tried < 2) continue;
    text += fmt::format("  {} lie densest after {:g} gal, {:.3g} Hz: e = {:.4f}, of {} shakings of one filling\n",
                        words(plural_of(shape)), best->run.shaking->gal, best->run.shaking->frequency,
                        best->outcome.void_ratio, tried);
  }
  return text.empty() ? "" : "Which compacts best (section 9.2)\n" + text + "\n";
}

std::string periods(const Reproduction& result) {
  const Done* discs = nullptr;
  for (const Done& done : result.runs)
    if (discs == nullptr && done.run.fill.shape == Shape::disc && done.run.fill.variant.empty()) discs = &done;
  if (discs == nullptr) return "";
  const double width = discs->run.fill.grid.width(), depth = discs->outcome.height_before;
  std::string text = "First period of a tank of that width, T1\n";
  const std::vector<std::size_t> widths{40, 16, 18};
  text += row({"", "linear theory", "(7.2) as printed"}, widths);
  for (const auto& [name, h] :
       {std::pair{"height of the start, 2.25 m", printed_box_height}, {"depth of the heap", depth}}) {
    text += row(
        {h == depth ? fmt::format("{}, {:.3f} m", name, depth) : name,
         figures(sloshing_period(width, h, gravity), 4) + " s", figures(printed_formula_period(width, h), 4) + " s"},
        widths);
  }
  text += fmt::format(
      "  The printed 1.85 s follows from neither; 1.25 s, which both give with h = 2.25 m, may have been misread. 2.25 "
      "m is\n"
      "  75 rows of 3 cm, the height from which the grains fall; what sloshes is {:.2f} m deep.\n",
      depth);
  std::string sweep;
  const std::vector<std::size_t> columns{26, 12, 16, 18, 14, 10};
  std::vector<const Done*> runs;
  for (const Done& done : result.runs)
    if (done.run.mapped && done.run.fill.shape == Shape::disc && done.run.shaking->gal == 400) runs.push_back(&done);
  std::sort(runs.begin(), runs.end(),
            [](const Done* a, const Done* b) { return a->run.shaking->frequency > b->run.shaking->frequency; });
  for (const Done* done : runs) {
    const double period = 1 / done->run.shaking->frequency;
    sweep += row({fmt::format("discs, 400 gal, {:.3g} s", period), figures(1e3 * done->outcome.swing, 2),
                  figures(amplification_of(*done), 3), figures(liquid_amplification(period, width, depth), 3),
                  figures(done->outcome.slope, 3), figures(done->outcome.thrown, 0)},
                 columns);
  }
  text += "Does the box resonate? Swing of the centre of mass in the box, and over that of a liquid tilted by a/g\n" +
          row({"period", "swing, mm", "amplification", "liquid without loss", "slope", "thrown"}, columns) + sweep;
  return text;
}

std::string bonds(const Reproduction& result) {
  std::string text;
  for (const Done& done : result.runs) {
    if (done.run.fill.shape != Shape::bonded_pair || !std::isfinite(done.outcome.creep)) continue;
    text += row(
        {words(done.run.name()), fmt::format("{:.3g}", done.outcome.creep), fmt::format("{:.3g}", done.outcome.roll)},
        {54, 14, 14});
  }
  if (text.empty()) return "";
  return fmt::format(
             "Bonds of dashpots alone creep: mean change of the distance over the sum of the radii, of the relative "
             "rotation in\n"
             "rad, since the start. C_n = m_r/dt with the printed dt = {:g} s, C_s a third, whatever the step of the "
             "loop.\n",
             printed_step) +
         row({"", "distance", "roll"}, {54, 14, 14}) + text + "\n";
}

std::string numerics(const Reproduction& result) {
  std::string text = "How it was computed, seed 1, 400 gal, 10 Hz\n";
  const std::vector<std::size_t> widths{14, 12, 12, 18, 16, 14, 12};
  text += row({"", "step, s", "steps", "largest overlap", "energy balance", "contacts", "seconds"}, widths);
  for (const Done& done : result.runs) {
    const Shaking& shaking = *done.run.shaking;
    const Fill& fill = done.run.fill;
    const bool usual = fill.variant.empty() && shaking.cycles <= 10;
    if (fill.seed != 1 || !(usual || fill.step) || shaking.gal != 400 || shaking.frequency != 10) continue;
    const Outcome& o = done.outcome;
    text += row({words(plural_of(fill.shape)), fmt::format("{:.3g}", o.time_step), fmt::format("{:.0f}", o.steps),
                 fmt::format("{:.2g} of r_min", o.overlap), fmt::format("{:+.2g}", o.energy_error),
                 fmt::format("{:.2f} a body", o.coordination), fmt::format("{:.0f}", o.seconds)},
                widths);
  }
  return text;
}

}  // namespace

std::string report(const Reproduction& result) {
  const Run& first = result.runs.empty() ? plan(result.quick).front() : result.runs.front().run;
  const StartGrid& grid = first.fill.grid;
  std::string text = "Sukegawa (2010), chapter 8: grains in a box, filled and shaken\n\n";
  if (!result.complete()) text += fmt::format("INCOMPLETE: {} of {} runs\n\n", result.runs.size(), result.planned);
  text += fmt::format(
      "{} places in {} rows of {}, {:g} cm apart, in a box {:.4g} m wide; pairs take two places. Radii {:g} to {:g} "
      "cm, ellipses\n"
      "of the same areas, Vs = {:g} m/s, nu = {:g}, {:g} kg/m³, h = 1, friction {:g}, with walls {:g}. Contacts are "
      "those of\n"
      "(2.26), (2.27) with friction capping the whole tangential force; ellipses touch exactly; the loop is "
      "corrected_verlet\n"
      "at half the limit of a contact of the two lightest bodies. They fall, come to rest, are shaken by a cos(2 pi f "
      "t) along x\n"
      "for a second and at least two cycles (the thesis does not say how long), and come to rest again.\n",
      grid.places(), grid.rows, grid.columns, 100 * StartGrid::cell, grid.width(), 100 * smallest_radius,
      100 * largest_radius, shear_speed, poisson_ratio, density, friction, wall_friction);
  if (first.fill.softness != 1)
    text +=
        fmt::format("Quick: fewer grains than in the thesis, and springs {:g} times softer.\n", first.fill.softness);
  if (!result.quick) {
    text +=
        "The start is deduced: 40 columns and 75 rows 3 cm apart, every other row half a place aside, take 40.5 x 3 cm "
        "= 121.5 cm,\n"
        "the printed width, and 75 x 3 cm = 2.25 m, the printed height; No. 485, 500, 515 are then left, middle and "
        "right of row 13.\n";
  }
  text += "\n" + void_ratios(result) + "\n" + contact_margin(result) + "\n" + variants(result) + shakings(result) +
          "\n" + best_compaction(result) + periods(result) + "\n" + bonds(result) + numerics(result);
  return text;
}

}  // namespace equidem::sukegawa2010
