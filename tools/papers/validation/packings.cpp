// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Packings: random sequential adsorption, jamming without friction, coordination with friction.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/packing.hpp"

#include "tables.hpp"
#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

struct LateCoverage {
  double time = 0;  ///< attempts times the area of a disc, over the area of the cell
  MeanEstimate coverage;
};

/// Discs of diameter 1 in a periodic square, one attempt each.
double coverage_after(double time, double side, std::uint64_t seed) {
  const double disc = std::numbers::pi / 4;
  PackingOptions options;
  options.method = PackingMethod::rejection;
  options.box = {{side, side}, PackingBox::Sides::periodic};
  options.radii.assign(static_cast<std::size_t>(std::llround(time * side * side / disc)), 0.5);
  options.as_dense_as_possible = true;
  options.attempts = 1;
  options.seed = seed;
  return static_cast<double>(pack(options).size()) * disc / (side * side);
}

struct BidispersePacking {
  double solid_fraction = 0, coordination = 0, surplus = 0, rattlers = 0;
};

constexpr double jamming_overlap = 1e-7;  // mean, of the mean radius

/// Excess of z at that overlap: 3.6 (phi - phi_J)^(1/2) (O'Hern et al. 2003), phi - phi_J about the overlap.
double excess_coordination() {
  return published("excess coordination").value * std::sqrt(jamming_overlap);
}

/// Half of the discs 1.4 times as large as the others, grown in a periodic square until they jam.
BidispersePacking jam(std::size_t discs, std::uint64_t seed) {
  PackingOptions options;
  options.method = PackingMethod::growth;
  options.as_dense_as_possible = true;
  options.overlap = jamming_overlap;
  options.seed = seed;
  double area = 0;
  for (std::size_t k = 0; k < discs; ++k) {
    options.radii.push_back(k < discs / 2 ? 0.5 : 0.7);
    area += std::numbers::pi * squared(options.radii.back());
  }
  const double side = std::sqrt(area / published("jamming fraction").value);  // only a start: the radii are scaled
  options.box = {{side, side}, PackingBox::Sides::periodic};
  const PackingMeasures measures = measure(pack(options));
  const auto held = static_cast<double>(discs) - static_cast<double>(measures.rattlers);
  const double z = measures.coordination_without_rattlers;
  return {measures.solid_fraction, z, 0.5 * z * held - (2 * held - 1),
          static_cast<double>(measures.rattlers) / static_cast<double>(discs)};
}

struct JammedSize {
  std::size_t discs = 0, refused = 0;
  MeanEstimate solid_fraction, coordination, surplus, rattlers;

  /// Size to the power -1/nu, nu of O'Hern et al. (2003).
  [[nodiscard]] double x() const {
    return std::pow(static_cast<double>(discs), -0.5 / published("jamming exponent").value);
  }
};

JammedSize jam_many(std::size_t discs, std::size_t samples) {
  std::vector<std::optional<BidispersePacking>> found(samples);
  for_samples(fmt::format("jamming {} discs:", discs), samples, [&](std::size_t k) {
    try {
      found[k] = jam(discs, k + 1);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted) throw;
    }
  });
  const auto estimate = [&](double BidispersePacking::*member) {
    std::vector<double> values;
    for (const auto& packing : found) {
      if (packing) values.push_back((*packing).*member);
    }
    return estimate_mean(values, 0.95);
  };
  const auto refused =
      static_cast<std::size_t>(std::count_if(found.begin(), found.end(), [](const auto& packing) { return !packing; }));
  return {discs,
          refused,
          estimate(&BidispersePacking::solid_fraction),
          estimate(&BidispersePacking::coordination),
          estimate(&BidispersePacking::surplus),
          estimate(&BidispersePacking::rattlers)};
}

/// The line of estimates over x.
template <class Rows, class X>
LineFit fit_of(const Rows& rows, const X& x_of, MeanEstimate Rows::value_type::*member) {
  std::vector<double> x, y, errors;
  for (const auto& row : rows) {
    x.push_back(std::invoke(x_of, row));
    y.push_back((row.*member).mean);
    errors.push_back((row.*member).standard_error);
  }
  return fit_line(x, y, errors);
}

Estimate at_zero(const LineFit& fit) {
  return {fit.intercept, fit.intercept_error};
}

/// The line down to x = 0.
Series fitted_line(const LineFit& fit, double to) {
  return curve({.label = "fit", .style = SeriesStyle::dashed_line}, 0, to,
               [&](double x) { return fit.intercept + fit.slope * x; });
}

template <class Rows, class X>
void add_points(Plot& plot, Series series, const Rows& rows, const X& x_of, MeanEstimate Rows::value_type::*member) {
  std::vector<double> errors;
  for (const auto& row : rows) {
    series.x.push_back(std::invoke(x_of, row));
    series.y.push_back((row.*member).mean);
    errors.push_back((row.*member).standard_error);
  }
  series.style = SeriesStyle::points;
  plot.series.push_back(error_bars(series, errors));
  plot.series.push_back(std::move(series));
}

struct Frictional {
  double friction = 0, stiffness = 0;
  MeanEstimate coordination, depth;
};

/// Discs of two sizes fall into a box and come to rest.
Frictional settle_many(double friction, double stiffness, std::size_t discs, std::size_t samples, double damping = 1) {
  std::vector<double> coordination(samples), depth(samples);
  for_samples(fmt::format("settling with friction {:g}, kN = {:g} MPa:", friction, 1e-6 * stiffness), samples,
              [&](std::size_t k) {
                PackingOptions options;
                options.method = PackingMethod::falling;
                for (std::size_t d = 0; d < discs; ++d) options.radii.push_back(d % 2 == 0 ? 0.005 : 0.007);
                options.box = {{0.0108 * std::sqrt(static_cast<double>(discs)), 1}, PackingBox::Sides::open_top};
                options.seed = k + 1;
                options.settling.springs = {stiffness, stiffness};
                options.settling.damping = damping;
                options.settling.friction = options.settling.wall_friction = friction;
                options.settling.rest = 1e-5;
                options.settling.longest = 60;
                const GrainPacking packing = pack(options);
                const PackingMeasures measures = measure(packing);
                coordination[k] = measures.coordination_without_rattlers;
                depth[k] = std::sqrt(measures.largest_overlap);
              });
  return {friction, stiffness, estimate_mean(coordination, 0.95), estimate_mean(depth, 0.95)};
}

}  // namespace

Findings adsorption(bool quick) {
  const double side = quick ? 40 : 80;
  const std::size_t samples = quick ? 8 : 24;
  std::vector<double> times{4, 8, 16, 32, 64, 128, 256};
  if (!quick) times.push_back(512);
  std::vector<LateCoverage> all;
  std::vector<double> limits(samples), coverage(samples * times.size());
  for (std::size_t t = 0; t < times.size(); ++t) {
    const std::span<double> row(&coverage[t * samples], samples);
    for_samples(fmt::format("adsorbing until t = {:g}:", times[t]), samples,
                [&](std::size_t k) { row[k] = coverage_after(times[t], side, k + 1); });
    all.push_back({times[t], estimate_mean(row, 0.95)});
  }
  // The coverages of one sample at several times are correlated: a line through those of each sample, then the mean.
  std::vector<double> logarithms(samples);
  const std::size_t late = times.size() - 4;
  for (std::size_t k = 0; k < samples; ++k) {
    std::vector<double> x, y;
    for (std::size_t t = late; t < times.size(); ++t) {
      x.push_back(1 / std::sqrt(times[t]));
      y.push_back(coverage[t * samples + k]);
    }
    limits[k] = fit_line(x, y, std::vector<double>(x.size(), 1)).intercept;
    // theta(4t) - theta(t) falls as t^a: a from two such differences a factor of two in t apart.
    const auto gain = [&](std::size_t t) { return coverage[(t + 2) * samples + k] - coverage[t * samples + k]; };
    logarithms[k] = std::log2(gain(late + 1) / gain(late));
  }
  Findings findings;
  findings.text = fmt::format(
      "Periodic squares of {0:g} x {0:g} diameters, {1} seeds; discs are tried one by one at random places and stay "
      "where they overlap none (`pack` by rejection, one attempt a disc). The time t is the number of attempts times "
      "the area of a disc over that of the cell. Feder's law, coverage = limit - c t^(-1/2), is fitted to the last "
      "four times of each seed (t = {2:g} to {3:g}).",
      side, samples, times[late], times.back());
  findings.comparisons = {compare("coverage at saturation", "adsorption coverage", mean_of(limits),
                                  "the law holds in the limit only; earlier times bend the line"),
                          compare("exponent of the approach", "adsorption exponent", mean_of(logarithms),
                                  "the law holds in the limit only; earlier times have a steeper approach")};
  Table table;
  table.add("t", all, &LateCoverage::time);
  table.add("coverage", all, [](const LateCoverage& c) { return c.coverage.mean; });
  table.add("standard_error", all, [](const LateCoverage& c) { return c.coverage.standard_error; });
  Plot plot{.title = "Random sequential adsorption of equal discs",
            .x = {.label = "t^{-1/2}", .min = -0.01, .max = 0.52},
            .y = {.label = "coverage"}};
  plot.enhanced = true;
  const double limit = mean_of(limits).value;
  const double slope = (all.back().coverage.mean - limit) * std::sqrt(times.back());
  plot.series.push_back(curve({.label = "limit - c t^{-1/2}, fitted to the last four times", .column = "fit"}, 0, 0.5,
                              [&](double x) { return limit + slope * x; }));
  const auto inverse_root = [](const LateCoverage& c) { return 1 / std::sqrt(c.time); };
  add_points(plot, {.label = "rejection", .colour = PlotColour::vermilion}, all, inverse_root, &LateCoverage::coverage);
  plot.series.push_back({.label = "0.5471, Zhang and Torquato 2013",
                         .x = {0},
                         .y = {published("adsorption coverage").value},
                         .style = SeriesStyle::points,
                         .marker = Marker::diamond,
                         .filled = false,
                         .column = "published"});
  findings.tables = {{"adsorption", std::move(table)}};
  findings.plots = {{"adsorption", std::move(plot)}};
  return findings;
}

Findings jamming(bool quick) {
  std::vector<std::pair<std::size_t, std::size_t>> sizes{{64, 400}, {128, 300}, {256, 200}, {512, 80}, {1024, 30}};
  if (quick) sizes = {{64, 60}, {128, 40}, {256, 16}};
  std::vector<JammedSize> all;
  for (const auto& [discs, samples] : sizes) all.push_back(jam_many(discs, samples));
  Findings findings;
  findings.text = fmt::format(
      "Half of the discs are 1.4 times as large as the others; periodic squares, no friction. The discs grow from "
      "random places and push each other apart; the radii then shrink until the mean overlap is {1:.0e} of the mean "
      "radius (`pack` by growth). Rattlers, discs with fewer than three contacts, are left out of the coordination "
      "z, and counted in the solid fraction. Size dependence: N^(-1/(2 ν)), ν = {0:g} of O'Hern et al. At jamming N' "
      "discs that are held have 2 N' - 1 contacts, so that z = 4 - 2/N'; at the overlap left z is larger by about "
      "{2:.2g} (O'Hern et al.), which is allowed for.",
      published("jamming exponent").value, jamming_overlap, excess_coordination());
  const LineFit fractions = fit_of(all, &JammedSize::x, &JammedSize::solid_fraction);
  findings.comparisons = {
      compare(
          "solid fraction, extrapolated to infinite size", "jamming fraction", at_zero(fractions),
          "it depends on how the packing is made (see below): here the discs are compressed in steps, there they are "
          "quenched from random places at once"),
      compare(
          "z without rattlers, extrapolated in 1/N", "jamming coordination",
          at_zero(fit_of(
              all, [](const JammedSize& s) { return 1 / static_cast<double>(s.discs); }, &JammedSize::coordination)))};
  findings.comparisons.back().allowance = excess_coordination();
  for (const JammedSize& size : all) {
    findings.comparisons.push_back(compare(fmt::format("contacts beyond 2 N' - 1, N = {}", size.discs),
                                           "contacts beyond 2 N' - 1", estimate_of(size.surplus)));
    findings.comparisons.back().allowance = 0.5 * static_cast<double>(size.discs) * excess_coordination();
  }
  const Estimate fraction = findings.comparisons.front().ours;
  const double least = published("least jamming fraction").value, most = published("largest jamming fraction").value;
  findings.trends = {
      {fmt::format("packings with 2 N' - 1 contacts jam between {:g} and {:g}, by how fast they are made", least, most),
       published("least jamming fraction").source, fraction.value > least && fraction.value < most,
       fmt::format("{:.4f} ± {:.4f} at infinite size", fraction.value, fraction.error)}};
  std::size_t refused = 0;
  for (const JammedSize& size : all) refused += size.refused;
  if (refused > 0) {
    findings.notes.push_back(fmt::format("`pack` found no state with the wanted overlap for {}, left out.",
                                         counted(static_cast<long long>(refused), "cell", "cells")));
  }
  Table table;
  table.add("discs", all, [](const JammedSize& s) { return s.discs; });
  table.add("samples", all, [](const JammedSize& s) { return s.solid_fraction.samples; });
  for (const auto& [name, member] : {std::pair{"solid_fraction", &JammedSize::solid_fraction},
                                     {"z_without_rattlers", &JammedSize::coordination},
                                     {"contacts_beyond_isostatic", &JammedSize::surplus},
                                     {"share_of_rattlers", &JammedSize::rattlers}}) {
    table.add(name, all, [member = member](const JammedSize& s) { return (s.*member).mean; });
    table.add(std::string(name) + "_standard_error", all,
              [member = member](const JammedSize& s) { return (s.*member).standard_error; });
  }
  Plot plot{.title = "Bidisperse discs (1 : 1.4) at jamming",
            .x = {.label = "N^{-1/(2ν)}, ν = 0.71", .min = -0.001},
            .y = {.label = "solid fraction"}};
  plot.enhanced = true;
  add_points(plot, {.label = "growth in periodic cells", .colour = PlotColour::vermilion}, all, &JammedSize::x,
             &JammedSize::solid_fraction);
  plot.series.push_back(fitted_line(fractions, all.front().x()));
  plot.series.push_back({.label = "0.842, O'Hern et al. 2003",
                         .x = {0},
                         .y = {published("jamming fraction").value},
                         .style = SeriesStyle::points,
                         .marker = Marker::diamond,
                         .filled = false,
                         .column = "published"});
  findings.tables = {{"jamming", std::move(table)}};
  findings.plots = {{"jamming", std::move(plot)}};
  return findings;
}

Findings friction(bool quick) {
  const std::size_t discs = quick ? 150 : 500, samples = quick ? 2 : 4;
  std::vector<double> frictions{0, 0.1, 0.3, 1, 10};
  if (quick) frictions = {0, 0.3, 10};
  const double soft = 1e7, hard = quick ? 1e8 : 1e9;
  std::vector<Frictional> over_friction, over_stiffness;
  for (const double mu : frictions) over_friction.push_back(settle_many(mu, soft, discs, samples));
  over_stiffness = {over_friction.back()};
  for (double k = 10 * soft; k < 2 * hard; k *= 10) over_stiffness.push_back(settle_many(10, k, discs, samples));
  const auto depth_of = [](const Frictional& f) { return f.depth.mean; };
  const LineFit over_depth = fit_of(over_stiffness, depth_of, &Frictional::coordination);
  Findings findings;
  findings.text = fmt::format(
      "{} discs of radii 5 and 7 mm fall into a box and come to rest (`pack` by falling, h = 1 of the dashpots, kT = "
      "kN; {} seeds). z of discs without rattlers away from walls and surface, at friction 10 extrapolated to rigid "
      "discs over the square root of the largest overlap.",
      discs, samples);
  findings.comparisons = {
      compare("z without rattlers, friction 10, rigid discs", "frictional coordination", at_zero(over_depth),
              "3 is the least that can carry load, for discs compressed slowly together; discs that fall come to "
              "rest one after another and keep some contacts more, the more the faster they arrive (see below)")};
  bool falls = true;
  std::string evidence;
  for (std::size_t k = 0; k < over_friction.size(); ++k) {
    const Frictional& f = over_friction[k];
    const double error =
        2.6 * (k > 0 ? std::hypot(f.coordination.standard_error, over_friction[k - 1].coordination.standard_error) : 0);
    falls = falls && (k == 0 || f.coordination.mean < over_friction[k - 1].coordination.mean + error);
    evidence += fmt::format("{}{:.3f} ± {:.3f} at {:g}", k == 0 ? "" : ", ", f.coordination.mean,
                            f.coordination.standard_error, f.friction);
  }
  const double last = over_friction.back().coordination.mean;
  findings.trends = {{"z falls from 4 towards 3 as friction grows, most of the way", "Shundyak et al. 2007",
                      falls && last > 3 && last < 3.25 && over_friction.front().coordination.mean > 3.75, evidence}};
  const std::vector<double> dampings = quick ? std::vector{0.1, 1.0} : std::vector{0.1, 0.3, 1.0, 3.0};
  std::vector<std::string> braked;
  for (const double damping : dampings) {
    const Frictional f = damping == 1 ? over_stiffness[1] : settle_many(10, 10 * soft, discs, samples, damping);
    braked.push_back(
        fmt::format("{:.3f} ± {:.3f} at h = {:g}", f.coordination.mean, f.coordination.standard_error, damping));
  }
  findings.notes = {fmt::format("How slowly the discs come to rest matters: at friction 10 and kN = {:g} MPa, z is {}.",
                                1e-5 * soft, listed(braked))};
  Table table;
  std::vector<Frictional> rows = over_friction;
  rows.insert(rows.end(), over_stiffness.begin() + 1, over_stiffness.end());
  table.add("friction", rows, &Frictional::friction).add("kN_Pa", rows, &Frictional::stiffness);
  table.add("z_without_rattlers", rows, [](const Frictional& f) { return f.coordination.mean; });
  table.add("standard_error", rows, [](const Frictional& f) { return f.coordination.standard_error; });
  table.add("root_of_largest_overlap", rows, [](const Frictional& f) { return f.depth.mean; });
  Plot plot{.title = "Coordination of discs settled with friction 10",
            .x = {.label = "square root of the largest overlap over the radius", .min = -0.001},
            .y = {.label = "z without rattlers", .min = 2.95}};
  plot.enhanced = true;
  add_points(plot,
             {.label = fmt::format("k_N = {:g} to {:g} MPa, from right to left", 1e-6 * soft, 1e-6 * hard),
              .colour = PlotColour::vermilion},
             over_stiffness, depth_of, &Frictional::coordination);
  plot.series.push_back(fitted_line(over_depth, over_stiffness.front().depth.mean));
  plot.series.push_back(curve({.label = "3, Shundyak et al. 2007", .column = "published"}, 0,
                              over_stiffness.front().depth.mean,
                              [](double) { return published("frictional coordination").value; }));
  findings.tables = {{"friction", std::move(table)}};
  findings.plots = {{"friction", std::move(plot)}};
  return findings;
}

}  // namespace equidem::validation
