// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem reproduce: a paper's tables and figures beside ours.
#include <array>
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/material/spring_relations.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/output/plots/plot.hpp"

#include "abe1996/abe1996.hpp"
#include "abe1996_random/mean_field.hpp"
#include "command.hpp"
#include "fujioka2005/fujioka2005.hpp"
#include "sukegawa2010/sukegawa2010.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

struct ReproduceOptions {
  CommonOptions common;
  std::string paper;
  abe1996::Block block;
  std::string gauge = "centre";
  bool quick = false;
  std::vector<const CLI::Option*> of_block;  ///< that only the block of abe1996 knows
  const CLI::Option* of_quick = nullptr;     ///< that abe1996 does not know
};

constexpr std::array plot_names{"figure7", "figure8", "error_by_size"};
constexpr std::array plot_files{".csv", ".gp", ".svg", ".png"};
constexpr double shown_ratio = 0.5;  // of the picture and the file for ParaView

void check_outputs(const CommonOptions& options) {
  const OutputPlan plan(options);
  plan.expect_json();
  for (const char* name : plot_names) {
    for (const char* end : plot_files) plan.expect(std::string(name) + end);
  }
  for (const char* name : {"report.txt", "result.json", "tension.svg", "tension.png", "tension.vtm",
                           "tension_discs.vtp", "tension_contacts.vtp"}) {
    plan.expect(name);
  }
}

Series theory_line(double from, double to, double (*formula)(double), const std::string& label) {
  Series line{.label = label, .style = SeriesStyle::line};
  constexpr int pieces = 100;
  for (int k = 0; k <= pieces; ++k) {
    line.x.push_back(from + (to - from) * k / pieces);
    line.y.push_back(formula(line.x.back()));
  }
  return line;
}

Plot figure7(const abe1996::Reproduction& result) {
  Series stable{
      .label = "computed, stable", .style = SeriesStyle::points, .colour = PlotColour::blue, .column = "nu_stable"};
  Series unstable{.label = "computed, unstable",
                  .style = SeriesStyle::points,
                  .colour = PlotColour::vermilion,
                  .filled = false,
                  .column = "nu_unstable"};
  for (const auto& p : result.points) {
    Series& series = p.stable() ? stable : unstable;
    series.x.push_back(p.ratio);
    series.y.push_back(p.poisson_ratio);
  }
  Plot plot{.title = fmt::format("Abe (1996), Fig. 7: {} rows of {} and {} discs", result.block.rows,
                                 result.block.columns, result.block.columns - 1),
            .x = {.label = "kT/kN", .min = -1, .max = 1},
            .y = {.label = "Poisson's ratio (plane strain)", .min = -0.2, .max = 0.8}};
  plot.series = {theory_line(-1, 1, poisson_ratio_of_ratio, "eq. (22): (1 - kT/kN)/4"), stable, unstable};
  plot.vertical_lines = {
      {result.lattice_limit, "infinite lattice: -1/3", PlotColour::black},
      {result.block_limit, fmt::format("this block: {:.4f}", result.block_limit), PlotColour::vermilion}};
  return plot;
}

Plot figure8(const abe1996::Reproduction& result) {
  Series computed{.label = "computed, eq. (36)", .style = SeriesStyle::points, .colour = PlotColour::blue};
  for (const auto& p : result.points) {
    if (p.ratio < 0) continue;
    computed.x.push_back(p.ratio);
    computed.y.push_back(p.stiffness_ratio);
  }
  Plot plot{.title = fmt::format("Abe (1996), Fig. 8: {} rows of {} and {} discs", result.block.rows,
                                 result.block.columns, result.block.columns - 1),
            .x = {.label = "kT/kN", .min = 0, .max = 1},
            .y = {.label = "2G/((1 - nu) kN)", .min = 1, .max = 2}};
  plot.series = {theory_line(0, 1, hexagonal_stiffness_ratio, "eq. (37)"), computed};
  return plot;
}

Plot error_by_size(const abe1996::Reproduction& result) {
  Plot plot{.title = "Abe's tension test: error against size",
            .x = {.label = "rows", .logarithmic = true},
            .y = {.label = "error", .logarithmic = true}};
  constexpr std::array colours{PlotColour::orange, PlotColour::blue, PlotColour::vermilion};
  std::size_t colour = 0;
  for (const auto& convergence : result.convergence) {
    if (convergence.ratio == 0) continue;  // exact: round-off has no place on this plot
    Series nu{.label = fmt::format("nu, kT/kN = {}", convergence.ratio),
              .style = SeriesStyle::line_with_points,
              .colour = colours[colour]};
    Series stiffness{.label = fmt::format("(36), kT/kN = {}", convergence.ratio),
                     .style = SeriesStyle::line_with_points,
                     .colour = colours[colour],
                     .marker = Marker::square,
                     .filled = false};
    for (const auto& p : convergence.points) {
      nu.x.push_back(p.rows);
      nu.y.push_back(p.poisson_ratio_error);
      stiffness.x.push_back(p.rows);
      stiffness.y.push_back(p.stiffness_ratio_error);
    }
    plot.series.push_back(nu);
    plot.series.push_back(stiffness);
    ++colour;
  }
  Series guide{.label = "1/rows", .style = SeriesStyle::dashed_line};
  for (const auto& p : result.convergence.front().points) {
    guide.x.push_back(p.rows);
    guide.y.push_back(0.2 / p.rows);
  }
  plot.series.push_back(guide);
  return plot;
}

/// The block under tension, for the eye and for ParaView.
void show_block(const ReproduceOptions& options) {
  const abe1996::Block& block = options.block;
  const Assembly assembly = hexagonal_lattice({.columns = block.columns, .rows = block.rows, .radius = block.radius});
  const ContactSprings springs(SpringConstants{block.kN, shown_ratio * block.kN});
  const TensionSetup setup = tension_setup(assembly, block.test);
  const Equilibrium rest = solve_equilibrium(assembly, springs, setup.supports, setup.loads);
  const auto stresses = disc_stresses(assembly, rest.contact_forces);
  const AssemblyState state{
      .assembly = assembly, .motions = rest.motions, .contact_forces = rest.contact_forces, .stresses = stresses};
  write_vtk(*options.common.out, "tension", state, options.common.overwrite);
  PictureOptions picture{
      .title = fmt::format("Abe (1996), Fig. 6: tension of {} rows, kT/kN = {}", block.rows, shown_ratio),
      .colour = DiscColour::stress_xx};
  write_picture(*options.common.out, "tension", state, picture, options.common.overwrite);
}

JsonObject as_json(const abe1996::Reproduction& result, const std::string& text) {
  JsonObject object;
  const ContactSprings springs(SpringConstants{result.block.kN, shown_ratio * result.block.kN});
  add_common(object, "done", text, result.times, derive_effects(springs, Rotation::from_scene));
  object.set("paper", "abe1996").set("columns", result.block.columns).set("rows", result.block.rows);
  object.set("height", result.height).set("gauge_length", result.gauge_length).set("gauge_height", result.gauge_height);
  object.set("critical_ratio_lattice", result.lattice_limit).set("critical_ratio_block", result.block_limit);
  std::vector<JsonObject> points, convergence;
  for (const auto& p : result.points) {
    JsonObject point;
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
      JsonObject point;
      point.set("ratio", c.ratio).set("rows", p.rows).set("poisson_ratio_error", p.poisson_ratio_error);
      point.set("stiffness_ratio_error", p.stiffness_ratio_error);
      convergence.push_back(std::move(point));
    }
  }
  object.set("convergence", convergence);
  JsonObject stress;
  stress.set("free_rotation_deviation", result.stress.free_rotation);
  stress.set("restrained_rotation_deviation", result.stress.restrained_rotation);
  stress.set("asymmetry", result.stress.asymmetry).set("expected_asymmetry", result.stress.expected_asymmetry);
  stress.set("moment_density", result.stress.moment_density);
  stress.set("restrained_poisson_ratio", result.stress.restrained_poisson_ratio);
  object.set("macroscopic_stress", stress);
  return object;
}

void refuse_foreign(const CLI::Option* option, const ReproduceOptions& options) {
  if (option->count() == 0) return;
  bad_input(fmt::format("{} does not belong to {}", option->get_name(), options.paper), "it would change nothing",
            "Leave it out");
}

int reproduce_block(const ReproduceOptions& given) {
  ReproduceOptions options = given;
  options.block.test.gauge = gauge_placement_from(options.gauge);
  if (options.common.threads > 0) set_thread_count(options.common.threads);
  set_progress_shown(!options.common.quiet);
  check_outputs(options.common);
  const abe1996::Reproduction result = abe1996::reproduce(options.block);
  std::string text = abe1996::report(result);
  if (options.common.out) {
    const auto& folder = *options.common.out;
    const std::array plots{figure7(result), figure8(result), error_by_size(result)};
    text += "\n";
    for (std::size_t k = 0; k < plots.size(); ++k) {
      text += write_plot(folder, plot_names[k], plots[k], options.common.overwrite).message + "\n";
    }
    show_block(options);
    write_file(folder / "report.txt", text, options.common.overwrite);
  }
  deliver(options.common, text, as_json(result, text));
  if (options.common.out) say(options.common, fmt::format("written to {}", options.common.out->string()));
  return 0;
}

int reproduce(const ReproduceOptions& options) {
  if (options.paper == "abe1996") {
    refuse_foreign(options.of_quick, options);
    return reproduce_block(options);
  }
  struct Paper {
    const char* name;
    int (*reproduce)(const CommonOptions& options, bool quick);
  };
  constexpr std::array papers{Paper{"abe1996_random", mean_field::reproduce},
                              Paper{"fujioka2005", fujioka2005::reproduce},
                              Paper{"sukegawa2010", sukegawa2010::reproduce}};
  for (const Paper& paper : papers) {
    if (options.paper != paper.name) continue;
    for (const CLI::Option* option : options.of_block) refuse_foreign(option, options);
    return paper.reproduce(options.common, options.quick);
  }
  bad_input(fmt::format("there is no reproduction of '{}'", options.paper),
            "those known are abe1996, abe1996_random, fujioka2005 and sukegawa2010",
            "Write 'equidem reproduce abe1996'");
}

}  // namespace

Run declare_reproduce(CLI::App& command) {
  const auto options = std::make_shared<ReproduceOptions>();
  command.add_option("PAPER", options->paper, "abe1996, abe1996_random, fujioka2005 or sukegawa2010")
      ->required()
      ->type_name("NAME");
  add_result_options(command, options->common);
  const auto add = [&](const char* name, auto& value, const char* help) {
    options->of_block.push_back(command.add_option(name, value, help)->capture_default_str());
  };
  add("--columns", options->block.columns, "abe1996: discs in a long row of the block");
  add("--rows", options->block.rows, "abe1996: rows of the block");
  add("--gauge", options->gauge, "abe1996: where strains are read: centre, quarter or ends");
  options->of_quick =
      command.add_flag("--quick", options->quick, "all but abe1996: less of everything, seconds instead of hours");
  command.footer(
      "abe1996: the tension test of Figs. 6 to 8, and the macroscopic stress of section 4.\n"
      "abe1996_random: what the paper leaves open, the mean field (21), (22) and the correction (11)\n"
      "beside the exact moduli of random assemblies, over disorder, kT/kN and weightings.\n"
      "fujioka2005: Tables 1, 2 and Figs. 4 to 7, 10, 11 of normal contact in collisions, our law\n"
      "exact_flow beside the paper's, and what the paper does not try: coming to rest, time of computing\n"
      "for an accuracy.\n"
      "sukegawa2010: chapter 8, a box of 3000 discs, ellipses or bonded pairs filled and shaken; void\n"
      "ratios over seeds beside the printed ones, surface, grains thrown, pictures, an animation; which\n"
      "shaking compacts best, and whether "
      "the box resonates. Stopped, it goes on where it was when the same command is given again.\n\n"
      "Examples:\n"
      "  equidem reproduce abe1996                         tables on the screen\n"
      "  equidem reproduce abe1996 --out figures           and Figs. 7, 8, the error against size\n"
      "  equidem reproduce abe1996_random --out figures    minutes; with --quick seconds\n"
      "  equidem reproduce fujioka2005 --out figures       the same\n"
      "  equidem reproduce sukegawa2010 --out box          an hour or more; with --quick a minute");
  return [options] { return reproduce(*options); };
}

}  // namespace equidem
