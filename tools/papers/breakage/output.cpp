// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables, plots, the page and the command line.
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

#include "breakage/breakage.hpp"
#include "machine.hpp"
#include "tables.hpp"

namespace equidem::breakage {
namespace {

constexpr PlotColour colours[] = {PlotColour::blue, PlotColour::vermilion, PlotColour::green};
constexpr Marker markers[] = {Marker::circle, Marker::square, Marker::triangle};

Plot notch_plot(const Notches& notches) {
  Plot plot;
  plot.title = "Strength of plates with a notch in the middle";
  plot.x = {.label = "length of the notch 2a over the distance d of neighbours", .logarithmic = true};
  plot.y = {.label = "strength sigma d / f_t", .logarithmic = true};
  std::size_t colour = 0;
  for (const NotchFit& fit : notches.fits) {
    if (fit.ratio == 0) continue;
    Series points{.label = fmt::format("{} discs wide, kT/kN = {:g}", fit.columns, fit.ratio),
                  .style = SeriesStyle::points,
                  .colour = colours[colour % 3],
                  .marker = markers[colour % 3]};
    Series theory{.label = colour == 0 ? "K/sqrt(pi (a + c) sec(pi a/W)), K and c of each size" : "",
                  .style = SeriesStyle::line,
                  .colour = colours[colour % 3]};
    if (colour > 0) theory.column = fmt::format("theory {}", fit.columns);
    for (const NotchedPlate& plate : notches.plates) {
      if (plate.columns != fit.columns || plate.ratio != fit.ratio) continue;
      points.x.push_back(plate.length);
      points.y.push_back(plate.strength);
      theory.x.push_back(plate.length);
      theory.y.push_back(plate.strength * fit.toughness / plate.toughness *
                         std::sqrt(plate.length / (plate.length + 2 * fit.shift)));
    }
    plot.series.push_back(std::move(theory));
    plot.series.push_back(std::move(points));
    ++colour;
  }
  return plot;
}

Plot weibull_plot(const Weibull& weibull, bool scatter) {
  Plot plot;
  plot.title = scatter ? "Scatter of the strength" : "Mean strength";
  plot.x = {.label = "number of contacts", .logarithmic = true};
  plot.y = {
      .label = scatter ? "standard deviation over f_t (plates: times d)" : "mean strength over f_t (plates: times d)",
      .logarithmic = true};
  const auto add = [&](const std::vector<WeibullSize>& sizes, const std::string& kind, bool filled) {
    std::size_t colour = 0;
    for (double m = 0; const WeibullSize& first : sizes) {
      if (first.modulus == m) continue;
      m = first.modulus;
      Series points{.label = fmt::format("{}, m = {:g}", kind, m),
                    .style = filled ? SeriesStyle::line_with_points : SeriesStyle::points,
                    .colour = colours[colour % 3],
                    .marker = markers[colour % 3],
                    .filled = filled};
      Series theory{.label = colour == 0 && !filled ? "weakest link" : "",
                    .style = SeriesStyle::line,
                    .colour = colours[colour % 3],
                    .column = fmt::format("weakest link {:g}", m)};
      for (const WeibullSize& size : sizes) {
        if (size.modulus != m) continue;
        points.x.push_back(static_cast<double>(size.contacts));
        points.y.push_back(scatter ? size.strength.standard_deviation : size.strength.mean);
        theory.x.push_back(points.x.back());
        const double g1 = std::tgamma(1 + 1 / m), g2 = std::tgamma(1 + 2 / m);
        theory.y.push_back(scatter ? size.theory * std::sqrt(g2 / (g1 * g1) - 1) : size.theory);
      }
      if (!filled) plot.series.push_back(std::move(theory));
      plot.series.push_back(std::move(points));
      ++colour;
    }
  };
  add(weibull.chains, "chains", false);
  add(weibull.plates, "plates", true);
  return plot;
}

Table notch_table(const Notches& notches) {
  Table table;
  table.add("columns", notches.plates, &NotchedPlate::columns);
  table.add("discs", notches.plates, &NotchedPlate::discs);
  table.add("ratio", notches.plates, &NotchedPlate::ratio);
  table.add("notch_over_width", notches.plates, &NotchedPlate::notch);
  table.add("notch_over_distance", notches.plates, &NotchedPlate::length);
  table.add("strength", notches.plates, &NotchedPlate::strength);
  table.add("toughness", notches.plates, &NotchedPlate::toughness);
  table.add("energy_error", notches.plates, &NotchedPlate::energy_error);
  return table;
}

Table fits_table(const Notches& notches) {
  Table table;
  table.add("columns", notches.fits, &NotchFit::columns);
  table.add("ratio", notches.fits, &NotchFit::ratio);
  table.add("exponent", notches.fits, &NotchFit::exponent);
  table.add("exponent_error", notches.fits, &NotchFit::exponent_error);
  table.add("shift", notches.fits, &NotchFit::shift);
  table.add("shift_error", notches.fits, &NotchFit::shift_error);
  table.add("toughness", notches.fits, &NotchFit::toughness);
  table.add("toughness_error", notches.fits, &NotchFit::toughness_error);
  table.add("plain_exponent", notches.fits, &NotchFit::plain_exponent);
  table.add("plain_exponent_error", notches.fits, &NotchFit::plain_exponent_error);
  table.add("lattice", notches.fits, &NotchFit::lattice);
  table.add("griffith", notches.fits, &NotchFit::griffith);
  return table;
}

Table weibull_table(const std::vector<WeibullSize>& sizes, bool with_theory) {
  Table table;
  table.add("modulus", sizes, &WeibullSize::modulus);
  table.add("contacts", sizes, &WeibullSize::contacts);
  table.add("samples", sizes, [](const WeibullSize& s) { return s.strength.samples; });
  table.add("strength", sizes, [](const WeibullSize& s) { return s.strength.mean; });
  table.add("standard_error", sizes, [](const WeibullSize& s) { return s.strength.standard_error; });
  table.add("standard_deviation", sizes, [](const WeibullSize& s) { return s.strength.standard_deviation; });
  if (with_theory) table.add("weakest_link", sizes, &WeibullSize::theory);
  table.add("energy_error", sizes, &WeibullSize::energy_error);
  return table;
}

std::string cells(const std::vector<std::string>& of) {
  return "| " + joined(of, " | ") + " |\n";
}

std::string header(const std::vector<std::string>& of) {
  return cells(of) + cells(std::vector<std::string>(of.size(), "---"));
}

std::string with_error(double value, double error) {
  return std::isfinite(error) ? fmt::format("{:.4f} ± {:.4f}", value, error) : fmt::format("{:.4f}", value);
}

std::string fits_text(const Notches& notches) {
  std::string text = header({"discs wide", "kT/kN", "exponent of a", "exponent of a + c", "c/d", "K_Ic sqrt(d)/f_t",
                             "infinite lattice", "least by energy"});
  for (const NotchFit& fit : notches.fits) {
    text += cells({fmt::format("{}", fit.columns), fmt::format("{:g}", fit.ratio),
                   fit.plain_exponent != 0 ? with_error(fit.plain_exponent, fit.plain_exponent_error) : "-",
                   with_error(fit.exponent, fit.exponent_error), with_error(fit.shift, fit.shift_error),
                   with_error(fit.toughness, fit.toughness_error), fmt::format("{:.4f}", fit.lattice),
                   fmt::format("{:.4f}", fit.griffith)});
  }
  return text;
}

std::string sizes_text(const std::vector<WeibullSize>& sizes, bool with_theory) {
  std::vector<std::string> names{"m", "contacts", "mean strength", "standard deviation", "over the mean"};
  if (with_theory) names.insert(names.begin() + 3, {"weakest link", "standard errors apart"});
  std::string text = header(names);
  for (const WeibullSize& size : sizes) {
    const MeanEstimate& s = size.strength;
    std::vector<std::string> row{fmt::format("{:g}", size.modulus), fmt::format("{}", size.contacts),
                                 with_error(s.mean, s.standard_error), fmt::format("{:.4f}", s.standard_deviation),
                                 fmt::format("{:.3f}", s.standard_deviation / s.mean)};
    if (with_theory)
      row.insert(row.begin() + 3, {fmt::format("{:.4f}", size.theory),
                                   fmt::format("{:.1f}", (s.mean - size.theory) / s.standard_error)});
    text += cells(row);
  }
  return text;
}

/// The exponents, for each modulus, of the mean strength of plates between the two smallest and the two largest sizes,
/// and of its scatter between the smallest and the largest.
std::string weakening_text(const Weibull& weibull) {
  std::string text =
      header({"m", "weakest link, -1/m", "exponent, two smallest", "two largest", "exponent of the scatter"});
  for (std::size_t k = 0; k < weibull.plates.size();) {
    std::size_t end = k;
    while (end < weibull.plates.size() && weibull.plates[end].modulus == weibull.plates[k].modulus) ++end;
    const auto exponent = [&](std::size_t a, std::size_t b, double MeanEstimate::*of) {
      const WeibullSize &x = weibull.plates[a], &y = weibull.plates[b];
      return std::log(y.strength.*of / (x.strength.*of)) /
             std::log(static_cast<double>(y.contacts) / static_cast<double>(x.contacts));
    };
    const double m = weibull.plates[k].modulus;
    text += cells({fmt::format("{:g}", m), fmt::format("{:.3f}", -1 / m),
                   fmt::format("{:.3f}", exponent(k, k + 1, &MeanEstimate::mean)),
                   fmt::format("{:.3f}", exponent(end - 2, end - 1, &MeanEstimate::mean)),
                   fmt::format("{:.3f}", exponent(k, end - 1, &MeanEstimate::standard_deviation))});
    k = end;
  }
  return text;
}

double largest_energy_error(const Notches& notches, const Weibull& weibull) {
  double largest = 0;
  for (const NotchedPlate& plate : notches.plates) largest = std::max(largest, plate.energy_error);
  for (const auto* sizes : {&weibull.chains, &weibull.plates})
    for (const WeibullSize& size : *sizes) largest = std::max(largest, size.energy_error);
  return largest;
}

std::string page_of(const Notches& notches, const Weibull& weibull, bool quick) {
  std::string text = "# Breakage beside theory\n\n";
  text +=
      fmt::format("    equidem-papers breakage{} --out DIR\n\n{}\n\n", quick ? " --quick" : "", this_machine().text());
  text += fmt::format(
      "Samples are pulled apart between frictionless ends, contact after contact in exact equilibrium, under control "
      "of "
      "the motion; the\nstrength is the largest load over the width until it has fallen to {:g} % of it (scattered "
      "plates: {:g} %). d is the distance of neighbours, f_t the strength "
      "of a contact in tension.\n\n"
      "## Strength against the length of a notch\n\n"
      "Hexagonal plates twice as high as wide, equal strengths, tension alone; a straight cut of length 2a along a "
      "close-packed row in the\nmiddle, from 2 d to 0.6 of the width W. Linear elastic fracture mechanics: sigma "
      "sqrt(sec(pi a/W)) falls as a^(-1/2), K_Ic = sigma\nsqrt(pi a sec(pi a/W)), the secant for the finite width. The "
      "crack of a lattice ends between the last contact that is cut and the first\nthat is not: a + c takes the place "
      "of a. Three numbers are fitted (K, c, the exponent) for the exponent, two for K and c, where it\nis -1/2; "
      "without "
      "c, over notches of 12 d and more, exponents are those of the third column.\n\n"
      "The toughness of the infinite lattice is found without plates: the discs of a rim around the tip of a crack are "
      "moved by the field of\na crack (Williams 1957) until the first contact reaches f_t; rims of two radii are "
      "extrapolated. A crack that grows by d breaks two\ncontacts, which takes f_t²/kN at least (Griffith): K_Ic "
      "sqrt(d)/f_t >= sqrt(E/kN). Lattices are tougher: the energy between two breaks\nis lost, too.\n\n",
      100 * test_over, 100 * scattered_test_over);
  text += fits_text(notches);
  text += fmt::format("\n![Strength of notched plates](breakage/notches.svg)\n\n{} plates in {:.1f} s.\n\n",
                      notches.plates.size(), notches.seconds);
  text += fmt::format(
      "## Scatter and size by Weibull's law\n\nA share exp(-x^m) of the contacts is more than x f_t strong; f_s = 2 "
      "f_t, friction 0.5. A chain is as strong as its weakest link:\nits mean strength is Gamma(1 + 1/m) n^(-1/m) f_t, "
      "exactly. {} seeds of each chain, {} of each plate.\n\n",
      4 * weibull.seeds, weibull.seeds);
  text += sizes_text(weibull.chains, true);
  text += fmt::format("\n{:.1f} s. Plates, hexagonal, as many rows as columns:\n\n", weibull.seconds_of_chains);
  text += sizes_text(weibull.plates, false);
  text += fmt::format(
      "\n{:.1f} s. A plate holds when its weakest contact breaks: its mean falls much more slowly than the weakest "
      "link, the more slowly the\nlarger it is: no power law, and its "
      "scatter falls with the size:\n\n",
      weibull.seconds_of_plates);
  text += weakening_text(weibull);
  text += "\n![Mean strength](breakage/weibull_mean.svg)\n\n![Scatter](breakage/weibull_scatter.svg)\n\n";
  text += fmt::format(
      "## Energy\n\nEnergy released by all breaks plus strain energy equals the work from outside to {:.1e} of the "
      "largest of the three, in the worst of\nall these tests.\n",
      largest_energy_error(notches, weibull));
  return text;
}

int compute(const CommonOptions& options, bool quick) {
  const auto lock =
      start_paper(options, {"notches", "weibull_mean", "weibull_scatter"},
                  {"breakage.md", "notches_values.csv", "weibull_chains_values.csv", "weibull_plates_values.csv"});
  const Notches notches = notched_plates(quick);
  const Weibull weibull = weibull_samples(quick);
  PaperResult result{.paper = "breakage",
                     .report = {},
                     .times = {},
                     .effects = derive_effects(ContactSprings({1, 0.4}), Rotation::from_scene),
                     .add_numbers = {}};
  result.times.add("notches", notches.seconds);
  result.times.add("chains", weibull.seconds_of_chains);
  result.times.add("plates", weibull.seconds_of_plates);
  const std::string text = page_of(notches, weibull, quick);
  result.report = text;
  result.texts = {{"breakage.md", text}};
  result.tables = {{"notches_values", notch_table(notches)},
                   {"weibull_chains_values", weibull_table(weibull.chains, true)},
                   {"weibull_plates_values", weibull_table(weibull.plates, false)}};
  result.plots = {{"notches", notch_plot(notches)},
                  {"weibull_mean", weibull_plot(weibull, false)},
                  {"weibull_scatter", weibull_plot(weibull, true)}};
  result.add_numbers = [&](Results& object) {
    object.set("quick", quick).set("fits", rows_of(fits_table(notches)));
    object.set("chains", rows_of(weibull_table(weibull.chains, true)));
    object.set("plates", rows_of(weibull_table(weibull.plates, false)));
    object.set("energies/error", largest_energy_error(notches, weibull));
  };
  return finish_paper(options, result);
}

}  // namespace

Run declare(CLI::App& command) {
  return declare_with_quick(command,
                            "Strength of notched plates against the length of the notch, strength and scatter of "
                            "samples by Weibull's law\nagainst their size, each beside theory; energies.",
                            compute);
}

}  // namespace equidem::breakage
