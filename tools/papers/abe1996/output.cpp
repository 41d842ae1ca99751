// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Figures, JSON and command line of the reproduction of Abe (1996).
#include <memory>

#include <CLI/CLI.hpp>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/picture.hpp"

#include "abe1996/abe1996.hpp"
#include "papers.hpp"
#include "tables.hpp"

namespace equidem::abe1996 {
namespace {

constexpr const char* ratio_label = "k_T/k_N";
constexpr double shown_ratio = 0.5;  // kT/kN of the picture and of the file for ParaView

std::string title_of(const char* figure, const Block& block) {
  return fmt::format("Abe (1996), {}: {} rows of {} and {} discs", figure, block.rows, block.columns,
                     block.columns - 1);
}

/// nu of the two blocks against theory. \param shown what is plotted of nu in plane strain
Plot poisson_plot(const Reproduction& result, const Plot& frame, const std::string& theory, double (*shown)(double)) {
  std::vector<RatioPoint> stable, unstable;
  for (const RatioPoint& p : result.points) (p.stable() ? stable : unstable).push_back(p);
  const auto computed = [&](Series series, const auto& points) {
    series.style = SeriesStyle::points;
    return with_points(series, points, &RatioPoint::ratio, [&](const RatioPoint& p) { return shown(p.poisson_ratio); });
  };
  Plot plot = frame;
  plot.x = {.label = ratio_label, .min = -1, .max = 1};
  plot.enhanced = true;
  plot.series = {
      curve({.label = theory, .column = "theory"}, -1, 1, [&](double r) { return shown(poisson_ratio_of_ratio(r)); }),
      computed({.label = fmt::format("{} rows", large_rows),
                .colour = PlotColour::orange,
                .marker = Marker::square,
                .filled = false,
                .column = "nu_large"},
               result.large_points),
      computed({.label = fmt::format("{} rows, stable", result.block.rows),
                .colour = PlotColour::blue,
                .column = "nu_stable"},
               stable),
      computed({.label = fmt::format("{} rows, unstable", result.block.rows),
                .colour = PlotColour::vermilion,
                .filled = false,
                .column = "nu_unstable"},
               unstable)};
  plot.vertical_lines = {
      {result.lattice_limit, "infinite lattice: -1/3", PlotColour::black, true},
      {result.block_limit, fmt::format("this block: {:.4f}", result.block_limit), PlotColour::vermilion}};
  return plot;
}

Plot figure7(const Reproduction& result) {
  return poisson_plot(result,
                      {.title = title_of("Fig. 7", result.block),
                       .y = {.label = "Poisson's ratio ν (plane strain)", .min = -0.2, .max = 0.8}},
                      "eq. (22): (1 - k_T/k_N)/4", [](double nu) { return nu; });
}

Plot figure7_plane_stress(const Reproduction& result) {
  return poisson_plot(result,
                      {.title = title_of("Fig. 7 in plane stress", result.block),
                       .y = {.label = "Poisson's ratio ν (plane stress)", .min = -0.2, .max = 1.4}},
                      "(1 - k_T/k_N)/(3 + k_T/k_N)", in_plane_stress);
}

Plot figure8(const Reproduction& result) {
  std::vector<RatioPoint> points = result.points;
  std::erase_if(points, [](const RatioPoint& p) { return p.ratio < 0; });
  Plot plot{.title = title_of("Fig. 8", result.block),
            .x = {.label = ratio_label, .min = 0, .max = 1},
            .y = {.label = "2G/((1 - ν) k_N)", .min = 1, .max = 2}};
  plot.enhanced = true;
  std::vector<RatioPoint> large = result.large_points;
  std::erase_if(large, [](const RatioPoint& p) { return p.ratio < 0; });
  plot.series = {curve({.label = "eq. (37)", .column = "theory"}, 0, 1, hexagonal_stiffness_ratio),
                 with_points({.label = fmt::format("{} rows", large_rows),
                              .style = SeriesStyle::points,
                              .colour = PlotColour::orange,
                              .marker = Marker::square,
                              .filled = false,
                              .column = "large"},
                             large, &RatioPoint::ratio, &RatioPoint::stiffness_ratio),
                 with_points({.label = fmt::format("{} rows, eq. (36)", result.block.rows),
                              .style = SeriesStyle::points,
                              .colour = PlotColour::blue,
                              .column = "computed"},
                             points, &RatioPoint::ratio, &RatioPoint::stiffness_ratio)};
  return plot;
}

Plot error_by_size(const Reproduction& result) {
  Plot plot{.title = "Abe's tension test: error against size",
            .x = {.label = "rows", .logarithmic = true},
            .y = {.label = "error", .logarithmic = true}};
  plot.enhanced = true;
  constexpr std::array colours{PlotColour::black, PlotColour::orange, PlotColour::blue, PlotColour::vermilion};
  for (std::size_t k = 0; k < result.convergence.size(); ++k) {
    const Convergence& c = result.convergence[k];
    if (c.ratio == 0) continue;  // exact: round-off has no place on this plot
    Series nu{.label = fmt::format("ν, k_T/k_N = {}", c.ratio),
              .style = SeriesStyle::line_with_points,
              .colour = colours[k],
              .column = fmt::format("nu_{}", c.ratio)};
    Series stiffness = nu;
    stiffness.label = fmt::format("(36), k_T/k_N = {}", c.ratio);
    stiffness.column = fmt::format("stiffness_{}", c.ratio);
    stiffness.marker = Marker::square;
    stiffness.filled = false;
    plot.series.push_back(with_points(nu, c.points, &SizePoint::rows, &SizePoint::poisson_ratio_error));
    plot.series.push_back(with_points(stiffness, c.points, &SizePoint::rows, &SizePoint::stiffness_ratio_error));
  }
  plot.series.push_back(with_points({.label = "0.2/rows", .style = SeriesStyle::dashed_line},
                                    result.convergence.front().points, &SizePoint::rows,
                                    [](const SizePoint& p) { return 0.2 / p.rows; }));
  return plot;
}

/// Sections 2.2, 4.2 and 4.3, and the causes of the error of nu.
void add_continuum(Results& object, const Reproduction& result) {
  std::vector<Results> variations, square, waves, unequal;
  for (const Variation& v : result.edges.variations) {
    Results one;
    one.set("block", v.name).set("poisson_ratio", v.poisson_ratio);
    variations.push_back(std::move(one));
  }
  for (const SquarePoint& p : result.square) {
    Results one;
    one.set("ratio", p.ratio).set("anisotropy", p.anisotropy);
    one.set("poisson_ratio_rows", p.nu_rows).set("poisson_ratio_diagonal", p.nu_diagonal);
    square.push_back(std::move(one));
  }
  for (const WavePoint& p : result.waves) {
    Results one;
    one.set("wanted_poisson_ratio", p.wanted).set("kN", p.springs.kN).set("kT", p.springs.kT);
    one.set("shear_modulus", p.shear_modulus).set("poisson_ratio", p.poisson_ratio).set("deviation", p.deviation);
    one.set("poisson_ratio_of_tension", p.nu_of_tension);
    waves.push_back(std::move(one));
  }
  for (const UnequalPoint& p : result.unequal) {
    Results one;
    one.set("spread", p.spread).set("solid_fraction", p.solid_fraction.mean);
    one.set("poisson_ratio", p.nu.mean).set("poisson_ratio_standard_error", p.nu.standard_error);
    one.set("shear_modulus_error", p.shear_error.mean).set("bulk_modulus_error", p.bulk_error.mean);
    one.set("scatter_xx", p.scatter_xx.mean).set("scatter_yy", p.scatter_yy.mean).set("scatter_xy", p.scatter_xy.mean);
    one.set("printed_mean_xx", p.printed_mean.mean).set("printed_scatter_xx", p.printed_scatter.mean);
    unequal.push_back(std::move(one));
  }
  object.set("error_of_nu", variations).set("square_lattice", square);
  object.set("restrained_waves", waves).set("unequal_radii", unequal);
}

/// The block under tension, as a picture and for ParaView.
void show_block(const Block& block, const CommonOptions& options) {
  const Assembly assembly = hexagonal_lattice({.columns = block.columns, .rows = block.rows, .radius = block.radius});
  const ContactSprings springs(SpringConstants{block.kN, shown_ratio * block.kN});
  const TensionSetup setup = tension_setup(assembly, block.test);
  const Equilibrium rest = solve_equilibrium(assembly, springs, setup.supports, setup.loads);
  const auto stresses = disc_stresses(assembly, rest.contact_forces);
  const AssemblyState state{
      .assembly = assembly, .motions = rest.motions, .contact_forces = rest.contact_forces, .stresses = stresses};
  write_vtk(*options.out, "tension", state, options.overwrite);
  const PictureOptions picture{
      .title = fmt::format("Abe (1996), Fig. 6: tension of {} rows, kT/kN = {}", block.rows, shown_ratio),
      .colour = DiscColour::stress_xx,
      .loads = drawn_loads(assembly, setup.loads),
      .supports = drawn_supports(assembly, setup.supports),
      .gauges = {{setup.horizontal.first, setup.horizontal.second, "A", "B"},
                 {setup.vertical.first, setup.vertical.second, "C", "D"}}};
  write_picture(*options.out, "figure6", state, picture, options.overwrite);
}

void add_numbers(Results& object, const Reproduction& result) {
  object.set("columns", result.block.columns).set("rows", result.block.rows);
  object.set("height", result.height).set("gauge_length", result.gauge_length).set("gauge_height", result.gauge_height);
  object.set("critical_ratio_lattice", result.lattice_limit).set("critical_ratio_block", result.block_limit);
  std::vector<Results> points, convergence;
  for (const auto& p : result.points) {
    Results point;
    point.set("ratio", p.ratio).set("poisson_ratio", p.poisson_ratio).set("stiffness_ratio", p.stiffness_ratio);
    point.set("negative_pivots", p.negative_pivots).set("unstable_modes", p.unstable_modes);
    point.set("relative_residual", p.relative_residual).set("stable", p.stable());
    point.set("theory_poisson_ratio", poisson_ratio_of_ratio(p.ratio));
    point.set("theory_stiffness_ratio", hexagonal_stiffness_ratio(p.ratio));
    points.push_back(std::move(point));
  }
  object.set("points", points);
  for (const auto& c : result.convergence) {
    for (const auto& p : c.points) {
      Results point;
      point.set("ratio", c.ratio).set("rows", p.rows).set("poisson_ratio_error", p.poisson_ratio_error);
      point.set("stiffness_ratio_error", p.stiffness_ratio_error);
      convergence.push_back(std::move(point));
    }
  }
  object.set("convergence", convergence);
  Results stress;
  stress.set("free_rotation_deviation", result.stress.free_rotation);
  stress.set("restrained_rotation_deviation", result.stress.restrained_rotation);
  stress.set("asymmetry", result.stress.asymmetry).set("expected_asymmetry", result.stress.expected_asymmetry);
  stress.set("moment_density", result.stress.moment_density);
  stress.set("restrained_poisson_ratio", result.stress.restrained_poisson_ratio);
  object.set("macroscopic_stress", stress);
  add_continuum(object, result);
}

struct Options {
  CommonOptions common;
  Block block;
  std::string gauge = "centre";
};

int reproduce(const Options& options) {
  Block block = options.block;
  block.test.gauge = enum_from<GaugePlacement>(options.gauge);
  const auto lock =
      start_paper(options.common, {"figure7", "figure7_plane_stress", "figure8", "error_by_size"},
                  {"figure6.svg", "figure6.png", "tension.vtm", "tension_discs.vtp", "tension_contacts.vtp"});
  const Reproduction result = reproduce(block);
  if (options.common.out) show_block(block, options.common);
  const ContactSprings springs(SpringConstants{block.kN, shown_ratio * block.kN});
  return finish_paper(options.common, {.paper = "abe1996",
                                       .report = report(result),
                                       .times = result.times,
                                       .effects = derive_effects(springs, Rotation::from_scene),
                                       .add_numbers = [&](Results& object) { add_numbers(object, result); },
                                       .plots = {{"figure7", figure7(result)},
                                                 {"figure7_plane_stress", figure7_plane_stress(result)},
                                                 {"figure8", figure8(result)},
                                                 {"error_by_size", error_by_size(result)}}});
}

}  // namespace

Run declare(CLI::App& command) {
  const auto options = std::make_shared<Options>();
  add_result_options(command, options->common);
  const auto add = [&](const char* name, auto& value, const char* help) {
    command.add_option(name, value, help)->capture_default_str();
  };
  add("--columns", options->block.columns, "discs in a long row of the block");
  add("--rows", options->block.rows, "rows of the block");
  add("--gauge", options->gauge, "where strains are measured: centre, quarter or ends");
  command.footer(
      "The tension test of Figs. 6 to 8, and the macroscopic stress of section 4.\n\n"
      "Examples:\n"
      "  equidem-papers abe1996                  tables on the screen\n"
      "  equidem-papers abe1996 --out figures    and Figs. 7, 8, the error against size");
  return [options] { return reproduce(*options); };
}

}  // namespace equidem::abe1996
