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

constexpr double shown_ratio = 0.5;  // kT/kN of the picture and of the file for ParaView

std::string title_of(const char* figure, const Block& block) {
  return fmt::format("Abe (1996), {}: {} rows of {} and {} discs", figure, block.rows, block.columns,
                     block.columns - 1);
}

Plot figure7(const Reproduction& result) {
  std::vector<RatioPoint> stable, unstable;
  for (const RatioPoint& p : result.points) (p.stable() ? stable : unstable).push_back(p);
  const auto computed = [](const char* label, const char* column, PlotColour colour, const auto& points) {
    return with_points({.label = label,
                        .style = SeriesStyle::points,
                        .colour = colour,
                        .filled = colour == PlotColour::blue,
                        .column = column},
                       points, &RatioPoint::ratio, &RatioPoint::poisson_ratio);
  };
  Plot plot{.title = title_of("Fig. 7", result.block),
            .x = {.label = "kT/kN", .min = -1, .max = 1},
            .y = {.label = "Poisson's ratio (plane strain)", .min = -0.2, .max = 0.8}};
  plot.series = {curve({.label = "eq. (22): (1 - kT/kN)/4"}, -1, 1, poisson_ratio_of_ratio),
                 computed("computed, stable", "nu_stable", PlotColour::blue, stable),
                 computed("computed, unstable", "nu_unstable", PlotColour::vermilion, unstable)};
  plot.vertical_lines = {
      {result.lattice_limit, "infinite lattice: -1/3", PlotColour::black, true},
      {result.block_limit, fmt::format("this block: {:.4f}", result.block_limit), PlotColour::vermilion}};
  return plot;
}

Plot figure8(const Reproduction& result) {
  std::vector<RatioPoint> points = result.points;
  std::erase_if(points, [](const RatioPoint& p) { return p.ratio < 0; });
  Plot plot{.title = title_of("Fig. 8", result.block),
            .x = {.label = "kT/kN", .min = 0, .max = 1},
            .y = {.label = "2G/((1 - nu) kN)", .min = 1, .max = 2}};
  plot.series = {curve({.label = "eq. (37)"}, 0, 1, hexagonal_stiffness_ratio),
                 with_points({.label = "computed, eq. (36)", .style = SeriesStyle::points, .colour = PlotColour::blue},
                             points, &RatioPoint::ratio, &RatioPoint::stiffness_ratio)};
  return plot;
}

Plot error_by_size(const Reproduction& result) {
  Plot plot{.title = "Abe's tension test: error against size",
            .x = {.label = "rows", .logarithmic = true},
            .y = {.label = "error", .logarithmic = true}};
  constexpr std::array colours{PlotColour::black, PlotColour::orange, PlotColour::blue, PlotColour::vermilion};
  for (std::size_t k = 0; k < result.convergence.size(); ++k) {
    const Convergence& c = result.convergence[k];
    if (c.ratio == 0) continue;  // exact: round-off has no place on this plot
    Series nu{
        .label = fmt::format("nu, kT/kN = {}", c.ratio), .style = SeriesStyle::line_with_points, .colour = colours[k]};
    Series stiffness = nu;
    stiffness.label = fmt::format("(36), kT/kN = {}", c.ratio);
    stiffness.marker = Marker::square;
    stiffness.filled = false;
    plot.series.push_back(with_points(nu, c.points, &SizePoint::rows, &SizePoint::poisson_ratio_error));
    plot.series.push_back(with_points(stiffness, c.points, &SizePoint::rows, &SizePoint::stiffness_ratio_error));
  }
  plot.series.push_back(with_points({.label = "1/rows", .style = SeriesStyle::dashed_line},
                                    result.convergence.front().points, &SizePoint::rows,
                                    [](const SizePoint& p) { return 0.2 / p.rows; }));
  return plot;
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
      .colour = DiscColour::stress_xx};
  write_picture(*options.out, "tension", state, picture, options.overwrite);
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
}

struct Options {
  CommonOptions common;
  Block block;
  std::string gauge = "centre";
};

int reproduce(const Options& options) {
  Block block = options.block;
  block.test.gauge = enum_from<GaugePlacement>(options.gauge);
  start_paper(options.common, {"figure7", "figure8", "error_by_size"},
              {"tension.svg", "tension.png", "tension.vtm", "tension_discs.vtp", "tension_contacts.vtp"});
  const Reproduction result = reproduce(block);
  if (options.common.out) show_block(block, options.common);
  const ContactSprings springs(SpringConstants{block.kN, shown_ratio * block.kN});
  return finish_paper(options.common, {.paper = "abe1996",
                                       .report = report(result),
                                       .times = result.times,
                                       .effects = derive_effects(springs, Rotation::from_scene),
                                       .add_numbers = [&](Results& object) { add_numbers(object, result); },
                                       .plots = {{"figure7", figure7(result)},
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
