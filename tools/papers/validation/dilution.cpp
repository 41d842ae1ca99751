// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rigidity of the triangular lattice with central forces, from which bonds or sites are removed at random.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"

#include "tables.hpp"
#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

/// A removed bond keeps this share of its stiffness, so that floppy cells have a modulus, too; ten or a hundred times
/// as much where the matrix is else too close to singular.
constexpr double least_remainder = 1e-11, largest_remainder = 1e-9;

enum class Removed { bonds, sites };

/// A triangular lattice without symmetry: no two bonds are in line, so that rigidity depends on the graph alone, as in
/// the pebble game.
Assembly generic_lattice(int size, std::uint64_t seed) {
  return delaunay_assembly({.discs = static_cast<std::int64_t>(size) * size,
                            .points = PointProcess::perturbed_hexagonal,
                            .disorder = 0.1,
                            .seed = seed,
                            .periodic = true});
}

std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed);
  for (std::size_t k = count; k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  return order;
}

ContactSprings springs_of(const Assembly& lattice, Removed removed, const std::vector<std::size_t>& order,
                          std::size_t kept, double removed_stiffness = least_remainder) {
  std::vector<char> there(order.size(), 0);
  for (std::size_t k = 0; k < kept; ++k) there[order[k]] = 1;
  std::vector<SpringConstants> springs;
  for (std::size_t c = 0; c < lattice.contacts.size(); ++c) {
    const auto i = static_cast<std::size_t>(lattice.contacts[c].i), j = static_cast<std::size_t>(lattice.contacts[c].j);
    const bool held = removed == Removed::bonds ? there[c] != 0 : there[i] != 0 && there[j] != 0;
    springs.push_back({held ? 1 : removed_stiffness, 0});
  }
  return ContactSprings(std::move(springs));
}

/// Share of the remainders in the energy of the softest strain, d ln C/d ln(remainder): 1 of a floppy cell, whose
/// stiffness is proportional to the remainder, 0 of a rigid one, which does without.
double share_in_removed(const Assembly& lattice, const ContactSprings& springs) {
  const EffectiveStiffness result = effective_stiffness(lattice, springs);
  const auto softest = eigenstrains(result.stiffness).strains[0];
  const auto states = strained_states(lattice, springs, result, 1);
  double all = 0, weak = 0;
  for (std::size_t c = 0; c < lattice.contacts.size(); ++c) {
    double force = 0;
    for (std::size_t k = 0; k < 3; ++k) force += softest[k] * states[k].forces[c].normal;
    const double energy = force * force / springs[c].kN;
    all += energy;
    if (springs[c].kN < 1) weak += energy;
  }
  return weak / all;
}

double share_of_remainders(const Assembly& lattice, Removed removed, const std::vector<std::size_t>& order,
                           std::size_t kept) {
  for (double stiffness = least_remainder;; stiffness *= 10) {
    try {
      return share_in_removed(lattice, springs_of(lattice, removed, order, kept, stiffness));
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::interrupted || stiffness > 0.5 * largest_remainder) throw;
    }
  }
}

/// The share of bonds or sites at which a cell becomes rigid, as they come back in a random order: more of them never
/// make it softer.
double onset_of(Removed removed, int size, std::uint64_t seed) {
  const Assembly lattice = generic_lattice(size, seed);
  const auto order =
      random_order(removed == Removed::bonds ? lattice.contacts.size() : lattice.size(), seed ^ 0x5bd1e995ULL);
  const auto units = static_cast<double>(order.size());
  auto floppy = static_cast<std::size_t>(0.5 * units), rigid = static_cast<std::size_t>(0.9 * units);
  while (rigid - floppy > 1) {
    const std::size_t middle = (floppy + rigid) / 2;
    (share_of_remainders(lattice, removed, order, middle) < 0.5 ? rigid : floppy) = middle;
  }
  return static_cast<double>(rigid) / units;
}

struct Size {
  int side = 0;  ///< discs
  std::size_t samples = 0;
};
std::vector<Size> sizes_of(bool quick) {
  if (quick) return {{8, 48}, {12, 48}, {20, 32}};
  return {{8, 400}, {12, 400}, {18, 300}, {26, 240}, {38, 160}};
}

/// Onsets of the cells of one size, ascending.
struct Onsets {
  Size size;
  std::vector<double> shares;
  MeanEstimate mean;

  [[nodiscard]] double x() const { return std::pow(size.side, -1 / published("rigidity exponent").value); }
  [[nodiscard]] double scatter_error() const {
    return mean.standard_deviation / std::sqrt(2.0 * static_cast<double>(shares.size() - 1));
  }
};

std::vector<Onsets> all_onsets(Removed removed, bool quick) {
  std::vector<Onsets> all;
  for (const Size& size : sizes_of(quick)) {
    Onsets onsets{.size = size, .shares = std::vector<double>(size.samples), .mean = {}};
    const std::string what = removed == Removed::bonds ? "bonds" : "sites";
    for_samples(fmt::format("removing {} of {} x {} discs:", what, size.side, size.side), size.samples,
                [&](std::size_t k) { onsets.shares[k] = onset_of(removed, size.side, k + 1); });
    std::sort(onsets.shares.begin(), onsets.shares.end());
    onsets.mean = estimate_mean(onsets.shares, 0.95);
    all.push_back(std::move(onsets));
  }
  return all;
}

/// Mean onset of the infinite lattice: onset = p_c + b size^(-1/nu) with the published nu.
Estimate extrapolated(const std::vector<Onsets>& all) {
  std::vector<double> x, y, errors;
  for (const Onsets& onsets : all) {
    x.push_back(onsets.x());
    y.push_back(onsets.mean.mean);
    errors.push_back(onsets.mean.standard_error);
  }
  const LineFit fit = fit_line(x, y, errors);
  return {fit.intercept, fit.intercept_error};
}

/// Where the curves "share of cells that are rigid" of the smallest and the largest size cross, both curves normal
/// distributions of the onsets measured: (p - m_1)/s_1 = (p - m_2)/s_2.
Estimate crossing(const Onsets& small, const Onsets& large) {
  const double m1 = small.mean.mean, m2 = large.mean.mean;
  const double s1 = small.mean.standard_deviation, s2 = large.mean.standard_deviation, wide = s1 - s2;
  const double by_m1 = -s2 / wide, by_m2 = s1 / wide;
  const double by_s1 = s2 * (m1 - m2) / (wide * wide), by_s2 = s1 * (m2 - m1) / (wide * wide);
  return {(m2 * s1 - m1 * s2) / wide,
          std::sqrt(squared(by_m1 * small.mean.standard_error) + squared(by_m2 * large.mean.standard_error) +
                    squared(by_s1 * small.scatter_error()) + squared(by_s2 * large.scatter_error()))};
}

constexpr std::array colours_of_sizes{PlotColour::sky_blue, PlotColour::green, PlotColour::orange, PlotColour::purple,
                                      PlotColour::vermilion};

Plot onset_plot(const std::vector<Onsets>& all, const std::string& what, const std::string& key) {
  Plot plot{.title = fmt::format("Cells that resist every strain; {} of a triangular lattice removed", what),
            .x = {.label = fmt::format("share p of {} that are left", what)},
            .y = {.label = "share of cells that are rigid", .min = 0, .max = 1.12}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto count = static_cast<double>(all[k].shares.size());
    Series series{.label = fmt::format("{0} x {0} discs", all[k].size.side), .colour = colours_of_sizes[k]};
    for (std::size_t n = 0; n < all[k].shares.size(); ++n) {
      for (const double risen : {0.0, 1.0}) {
        series.x.push_back(all[k].shares[n]);
        series.y.push_back((static_cast<double>(n) + risen) / count);
      }
    }
    plot.series.push_back(std::move(series));
  }
  plot.vertical_lines = {{published(key).value, fmt::format("{:.4f}, {}", published(key).value, published(key).source),
                          PlotColour::black, true}};
  return plot;
}

Table onset_table(const std::vector<Onsets>& all) {
  Table table;
  table.add("side_discs", all, [](const Onsets& o) { return o.size.side; });
  table.add("samples", all, [](const Onsets& o) { return o.size.samples; });
  table.add("mean_onset", all, [](const Onsets& o) { return o.mean.mean; });
  table.add("standard_error", all, [](const Onsets& o) { return o.mean.standard_error; });
  table.add("standard_deviation", all, [](const Onsets& o) { return o.mean.standard_deviation; });
  return table;
}

void add_thresholds(Findings& findings, const std::vector<Onsets>& all, const std::string& key) {
  const std::string why = "in small cells the onset depends on the size by more than its first power size^(-1/ν)";
  findings.comparisons.push_back(
      compare("threshold, mean onset extrapolated to infinite size", key, extrapolated(all), why));
  findings.comparisons.push_back(
      compare(fmt::format("threshold, crossing of sizes {} and {}", all.front().size.side, all.back().size.side), key,
              crossing(all.front(), all.back()), why));
}

constexpr const char* method =
    "Periodic cells of a triangular lattice whose points are moved at random by up to a tenth of the spacing, so "
    "that no two bonds are in line (the *generic* lattice of the source); kT = 0. The {0} come back in a random "
    "order; the onset of a cell is the share of them at which it resists every mean strain, found by bisection. "
    "Missing bonds keep 1e-11 of their stiffness (up to 1e-9 where the matrix would be singular); a cell counts as "
    "floppy where these carry more than half of the energy of its softest strain (`effective_stiffness`, "
    "`strained_states`). The extrapolation takes ν = {1} of the source.";

/// A cell of the regular lattice with a share p of its bonds: K and G over those of the full lattice.
std::pair<double, double> relative_moduli(int side, double p, std::uint64_t seed) {
  const Assembly lattice = hexagonal_lattice({.columns = side, .rows = side, .radius = 0.5, .periodic = true});
  const auto order = random_order(lattice.contacts.size(), seed);
  const auto kept = static_cast<std::size_t>(std::llround(p * static_cast<double>(order.size())));
  const EffectiveModuli diluted =
      effective_moduli(effective_stiffness(lattice, springs_of(lattice, Removed::bonds, order, kept)).stiffness);
  const EffectiveModuli full = effective_moduli(effective_stiffness(lattice, ContactSprings({1, 0})).stiffness);
  return {diluted.bulk_modulus_2d / full.bulk_modulus_2d, diluted.shear_modulus / full.shear_modulus};
}

struct Dilution {
  double p = 0;
  MeanEstimate bulk, shear;
};

/// K and G over those of the full lattice of effective-medium theory (Feng et al. 1985): (p - 2/3)/(1/3).
double effective_medium(double p) {
  const double threshold = published("effective-medium threshold").value;
  return (p - threshold) / (1 - threshold);
}

std::vector<Dilution> dilute(bool quick) {
  const int side = quick ? 16 : 48;
  const std::size_t samples = quick ? 8 : 24;
  std::vector<Dilution> all;
  std::vector<double> shares{0.98, 0.96, 0.94, 0.9, 0.85, 0.8, 0.75, 0.7, 0.68, 0.66};
  if (quick) shares = {0.98, 0.94, 0.9, 0.8, 0.7};
  for (const double p : shares) {
    std::vector<double> bulk(samples), shear(samples);
    for_samples(fmt::format("moduli at p = {:g}:", p), samples,
                [&](std::size_t k) { std::tie(bulk[k], shear[k]) = relative_moduli(side, p, k + 1); });
    all.push_back({p, estimate_mean(bulk, 0.95), estimate_mean(shear, 0.95)});
  }
  return all;
}

/// Slope of a modulus over p at p = 1: (1 - M)/(1 - p) over 1 - p, extrapolated along a line from p >= 0.9.
Estimate slope_at_full(const std::vector<Dilution>& all, MeanEstimate Dilution::*modulus) {
  std::vector<double> x, y, errors;
  for (const Dilution& point : all) {
    if (point.p < 0.9) continue;
    x.push_back(1 - point.p);
    y.push_back((1 - (point.*modulus).mean) / (1 - point.p));
    errors.push_back((point.*modulus).standard_error / (1 - point.p));
  }
  const LineFit fit = fit_line(x, y, errors);
  return {fit.intercept, fit.intercept_error};
}

Plot moduli_plot(const std::vector<Dilution>& all) {
  Plot plot{.title = "Moduli of the triangular lattice with missing bonds, central forces",
            .x = {.label = "share p of bonds that are left", .min = 0.62, .max = 1.01},
            .y = {.label = "modulus over that of the full lattice", .min = -0.02}};
  plot.series.push_back(curve({.label = "effective medium, (p - 2/3)/(1/3)", .column = "effective_medium"},
                              published("effective-medium threshold").value, 1, effective_medium));
  for (const auto& [modulus, label, colour, marker] :
       {std::tuple{&Dilution::bulk, "K", PlotColour::vermilion, Marker::circle},
        std::tuple{&Dilution::shear, "G", PlotColour::blue, Marker::square}}) {
    Series points{.label = label, .style = SeriesStyle::points, .colour = colour, .marker = marker, .filled = false};
    std::vector<double> errors;
    for (const Dilution& point : all) {
      points.x.push_back(point.p);
      points.y.push_back((point.*modulus).mean);
      errors.push_back((point.*modulus).standard_error);
    }
    plot.series.push_back(error_bars(points, errors));
    plot.series.push_back(std::move(points));
  }
  plot.vertical_lines = {{published("bond threshold").value, "0.6602, generic lattice", PlotColour::black, true}};
  return plot;
}

Table moduli_table(const std::vector<Dilution>& all) {
  Table table;
  table.add("p", all, &Dilution::p);
  table.add("K_over_full", all, [](const Dilution& d) { return d.bulk.mean; });
  table.add("K_standard_error", all, [](const Dilution& d) { return d.bulk.standard_error; });
  table.add("G_over_full", all, [](const Dilution& d) { return d.shear.mean; });
  table.add("G_standard_error", all, [](const Dilution& d) { return d.shear.standard_error; });
  table.add("effective_medium", all, [](const Dilution& d) { return effective_medium(d.p); });
  return table;
}

}  // namespace

Findings bond_dilution(bool quick) {
  const std::vector<Onsets> all = all_onsets(Removed::bonds, quick);
  Findings findings;
  findings.text = fmt::format(method, "bonds", published("rigidity exponent").value) +
                  "\n\nModuli: the regular lattice, K and G over those of the full one. Effective-medium theory has "
                  "them linear in p; its slope at p = 1 is exact, what it leaves out are correlations between "
                  "missing bonds.";
  add_thresholds(findings, all, "bond threshold");
  const std::vector<Dilution> moduli = dilute(quick);
  for (const auto& [name, modulus] : {std::pair{"K", &Dilution::bulk}, std::pair{"G", &Dilution::shear}}) {
    findings.comparisons.push_back(compare(fmt::format("slope of {0}/{0}(1) over p at p = 1", name),
                                           "effective-medium slope", slope_at_full(moduli, modulus)));
    for (const Dilution& point : moduli) {
      if (point.p != 0.9 && point.p != 0.8 && point.p != 0.7) continue;
      findings.comparisons.push_back(compare_formula(
          fmt::format("{0}/{0}(1) at p = {1:g}", name, point.p), effective_medium(point.p), "Feng et al. 1985",
          estimate_of(point.*modulus), "effective-medium theory neglects correlations between missing bonds"));
    }
  }
  findings.tables = {{"bond_onsets", onset_table(all)}, {"bond_moduli", moduli_table(moduli)}};
  findings.plots = {{"bond_onsets", onset_plot(all, "bonds", "bond threshold")}, {"bond_moduli", moduli_plot(moduli)}};
  return findings;
}

Findings site_dilution(bool quick) {
  const std::vector<Onsets> all = all_onsets(Removed::sites, quick);
  Findings findings;
  findings.text =
      fmt::format(method, "discs, each with its bonds to those that are there,", published("rigidity exponent").value);
  add_thresholds(findings, all, "site threshold");
  findings.tables = {{"site_onsets", onset_table(all)}};
  findings.plots = {{"site_onsets", onset_plot(all, "discs", "site threshold")}};
  return findings;
}

}  // namespace equidem::validation
