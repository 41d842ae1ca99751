// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Moduli of packings of discs over coordination and kT/kN (Agnolin & Kruyt 2008).
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/bounds.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/network.hpp"
#include "equidem/packing/packing.hpp"

#include "tables.hpp"
#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

/// Shares of uniform strain that the fluctuations add along the tangents of the contacts, under shear.
struct Fluctuations {
  double displacement = 0, rotation = 0;
};
struct PackedModuli {
  double bulk = 0, shear = 0;              ///< over kN
  double bulk_share = 0, shear_share = 0;  ///< over those of uniform strain
  Fluctuations tangential;
};

GrainPacking compressed(std::size_t discs, double overlap, std::uint64_t seed) {
  PackingOptions options;
  options.method = PackingMethod::growth;
  options.as_dense_as_possible = true;
  options.overlap = overlap;
  options.seed = seed;
  double area = 0;
  for (std::size_t k = 0; k < discs; ++k) {
    options.radii.push_back(0.4 + 0.3 * static_cast<double>(k) / static_cast<double>(discs));
    area += std::numbers::pi * squared(options.radii.back());
  }
  const double side = std::sqrt(area / 0.85);
  options.box = {{side, side}, PackingBox::Sides::periodic};
  return pack(options);
}

/// Slip of the contacts under the unit shear strain xy: that of uniform strain, and what displacements and rotations of
/// the discs add to it, each summed with the uniform one and over its square.
Fluctuations tangential_fluctuations(const Assembly& network, const std::vector<DiscMotion>& motions) {
  const std::vector<ContactDeformation> uniform = affine_deformations(network, {0, 0.5, 0.5, 0}, 0);
  double squares = 0, displaced = 0, turned = 0;
  for (std::size_t c = 0; c < network.contacts.size(); ++c) {
    const Contact& contact = network.contacts[c];
    const DiscMotion &i = motions[static_cast<std::size_t>(contact.i)],
                     &j = motions[static_cast<std::size_t>(contact.j)];
    const ContactFrame frame = frame_of(network, c);
    const double slip = uniform[c].tangential;
    squares += slip * slip;
    displaced += slip * dot(j.u - i.u, frame.tangent());
    turned -= slip * (frame.lever_i * i.theta + frame.lever_j * j.theta);
  }
  return {displaced / squares, turned / squares};
}

PackedModuli moduli_of(const GrainPacking& packing, double ratio) {
  const SpringConstants springs{1, ratio};
  const Assembly network = network_of(packing, {.springs = springs});
  const ContactSprings all(springs);
  const EffectiveStiffness result = effective_stiffness(network, all);
  const EffectiveModuli exact = effective_moduli(result.stiffness);
  const EffectiveModuli uniform = effective_moduli(voigt_stiffness(network, all));
  return {exact.bulk_modulus_2d, exact.shear_modulus, exact.bulk_modulus_2d / uniform.bulk_modulus_2d,
          exact.shear_modulus / uniform.shear_modulus, tangential_fluctuations(network, result.fluctuations[2])};
}

/// Means over seeds at one compression and one kT/kN.
struct ModuliPoint {
  double ratio = 0;
  MeanEstimate coordination, bulk, shear, bulk_share, shear_share, displacement, rotation;
};

constexpr std::array colours_of_ratios{PlotColour::sky_blue, PlotColour::green, PlotColour::orange,
                                       PlotColour::vermilion, PlotColour::purple};

Plot share_plot(const std::vector<ModuliPoint>& points, const std::vector<double>& ratios, const char* modulus,
                MeanEstimate ModuliPoint::*share) {
  Plot plot{.title = fmt::format("{} of random packings of discs over that of uniform strain", modulus),
            .x = {.label = "coordination z, without rattlers"},
            .y = {.label = fmt::format("{0} / {0} of uniform strain", modulus), .min = 0, .max = 1}};
  plot.enhanced = true;
  for (std::size_t r = 0; r < ratios.size(); ++r) {
    Series series{.label = fmt::format("k_T/k_N = {:g}", ratios[r]),
                  .style = SeriesStyle::line_with_points,
                  .colour = colours_of_ratios[r % colours_of_ratios.size()]};
    std::vector<double> errors;
    for (const ModuliPoint& point : points) {
      if (point.ratio != ratios[r]) continue;
      series.x.push_back(point.coordination.mean);
      series.y.push_back((point.*share).mean);
      errors.push_back((point.*share).standard_error);
    }
    plot.series.push_back(error_bars(series, errors));
    plot.series.push_back(std::move(series));
  }
  return plot;
}

/// Whether a share rises with z at every kT/kN, and the smallest and largest share.
Trend rises(const std::vector<ModuliPoint>& points, const std::vector<double>& ratios, const char* modulus,
            MeanEstimate ModuliPoint::*share) {
  bool holds = true;
  double least = 1, most = 0;
  for (const double ratio : ratios) {
    const ModuliPoint* before = nullptr;
    for (const ModuliPoint& point : points) {
      if (point.ratio != ratio) continue;
      const MeanEstimate& here = point.*share;
      least = std::min(least, here.mean);
      most = std::max(most, here.mean);
      if (before != nullptr)
        holds = holds && here.mean > (before->*share).mean -
                                         2.6 * std::hypot(here.standard_error, (before->*share).standard_error);
      before = &point;
    }
  }
  return {fmt::format("uniform strain overestimates {}, the less the more contacts there are", modulus),
          "Agnolin & Kruyt 2008", holds && most < 1,
          fmt::format("{0} is {1:.3f} to {2:.3f} of it", modulus, least, most)};
}

}  // namespace

Findings disc_moduli(bool quick) {
  const std::size_t discs = quick ? 150 : 800, samples = quick ? 4 : 12;
  std::vector<double> overlaps{1e-5, 1e-3, 5e-3, 0.02, 0.05}, ratios{0.05, 0.25, 0.5, 1};
  if (quick) overlaps = {1e-4, 5e-3, 0.04}, ratios = {0.05, 0.25, 0.5, 1};
  std::vector<ModuliPoint> points;
  for (const double overlap : overlaps) {
    std::vector<double> coordination(samples);
    std::vector<PackedModuli> moduli(samples * ratios.size());
    for_samples(fmt::format("packings of overlap {:g}:", overlap), samples, [&](std::size_t k) {
      const GrainPacking packing = compressed(discs, overlap, k + 1);
      coordination[k] = measure(packing).coordination_without_rattlers;
      for (std::size_t r = 0; r < ratios.size(); ++r) moduli[r * samples + k] = moduli_of(packing, ratios[r]);
    });
    for (std::size_t r = 0; r < ratios.size(); ++r) {
      const auto estimate = [&](const auto& number) {
        std::vector<double> values;
        for (std::size_t k = 0; k < samples; ++k) values.push_back(std::invoke(number, moduli[r * samples + k]));
        return estimate_mean(values, 0.95);
      };
      points.push_back({.ratio = ratios[r],
                        .coordination = estimate_mean(coordination, 0.95),
                        .bulk = estimate(&PackedModuli::bulk),
                        .shear = estimate(&PackedModuli::shear),
                        .bulk_share = estimate(&PackedModuli::bulk_share),
                        .shear_share = estimate(&PackedModuli::shear_share),
                        .displacement = estimate([](const PackedModuli& m) { return m.tangential.displacement; }),
                        .rotation = estimate([](const PackedModuli& m) { return m.tangential.rotation; })});
    }
  }
  Findings findings;
  findings.text = fmt::format(
      "Periodic cells of {} discs with radii between 0.4 and 0.7 of a length, compressed without friction to mean "
      "overlaps of {:g} to {:g} of the mean radius (`pack` by growth); {} seeds. Their contacts then carry springs "
      "kN and kT (`network_of`, `effective_stiffness`), beside the moduli of uniform strain (`voigt_stiffness`). The "
      "paper's moduli over z and kT/kN are figures, and its tables could not be had: its statements are decided "
      "here.",
      discs, overlaps.front(), overlaps.back(), samples);
  findings.trends = {rises(points, ratios, "K", &ModuliPoint::bulk_share),
                     rises(points, ratios, "G", &ModuliPoint::shear_share)};
  // "Generally": at three quarters of the points displacements do not relax the slip at all.
  std::size_t alone = 0;
  bool turned = true;
  double least = 1, most = -1, turns = 0;
  for (const ModuliPoint& point : points) {
    turned = turned && point.rotation.mean < 0;
    if (point.displacement.mean >= 0) ++alone;
    least = std::min(least, point.displacement.mean);
    most = std::max(most, point.displacement.mean);
    turns = std::min(turns, point.rotation.mean);
  }
  findings.trends.push_back(
      {"along the tangents of contacts the relaxation is generally due to rotations alone", "Agnolin & Kruyt 2008",
       turned && 4 * alone >= 3 * points.size(),
       fmt::format("rotations take up to {:.2f} of the slip of uniform shear; displacements change it by {:+.2f} to "
                   "{:+.2f}, and add to it at {} of {} points, those of smaller kT/kN",
                   -turns, least, most, alone, points.size())});
  findings.notes = {
      "Assemblies with z below 4, which the paper has too, are made with friction and are not made here."};
  Table table;
  table.add("kT_over_kN", points, &ModuliPoint::ratio);
  for (const auto& [name, member] : {std::pair{"z_without_rattlers", &ModuliPoint::coordination},
                                     {"K_over_kN", &ModuliPoint::bulk},
                                     {"G_over_kN", &ModuliPoint::shear},
                                     {"K_over_uniform_strain", &ModuliPoint::bulk_share},
                                     {"G_over_uniform_strain", &ModuliPoint::shear_share},
                                     {"slip_by_displacements", &ModuliPoint::displacement},
                                     {"slip_by_rotations", &ModuliPoint::rotation}}) {
    table.add(name, points, [member = member](const ModuliPoint& p) { return (p.*member).mean; });
    table.add(std::string(name) + "_standard_error", points,
              [member = member](const ModuliPoint& p) { return (p.*member).standard_error; });
  }
  findings.tables = {{"disc_moduli", std::move(table)}};
  findings.plots = {{"disc_moduli_K", share_plot(points, ratios, "K", &ModuliPoint::bulk_share)},
                    {"disc_moduli_G", share_plot(points, ratios, "G", &ModuliPoint::shear_share)}};
  return findings;
}

}  // namespace equidem::validation
