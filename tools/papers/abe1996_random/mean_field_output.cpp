// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

#include "abe1996_random/mean_field.hpp"
#include "papers.hpp"

namespace equidem::mean_field {
namespace {

constexpr std::array colours{PlotColour::yellow, PlotColour::sky_blue, PlotColour::green,     PlotColour::orange,
                             PlotColour::purple, PlotColour::blue,     PlotColour::vermilion, PlotColour::black};
constexpr std::array markers{Marker::circle, Marker::square, Marker::triangle, Marker::diamond};

Plot poisson_plot(const Result& result, std::size_t weighting) {
  Series theory{.label = "mean field (22), Voigt", .style = SeriesStyle::line, .column = "mean_field"};
  Series estimate{.label = "uniform stress", .style = SeriesStyle::dashed_line, .column = "uniform_stress"};
  constexpr int pieces = 100;
  for (int k = 0; k <= pieces; ++k) {
    const double r = result.plan.ratios.back() * k / pieces;
    theory.x.push_back(r);
    theory.y.push_back(poisson_ratio_of_ratio(r));
    estimate.x.push_back(r);
    estimate.y.push_back((1 - r) / (2 * (1 + r)));  // Kruyt & Rothenburg (2002), two dimensions, plane strain
  }
  Plot plot{.title = fmt::format("Random assemblies, springs weighted \"{}\"", to_string(weightings[weighting])),
            .x = {.label = "kT/kN"},
            .y = {.label = "Poisson's ratio (plane strain)"},
            .series = {theory, estimate}};
  std::size_t style = 0;
  for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
    const Family& family = result.plan.families[f];
    if (!family.isotropic() || !family.disordered()) continue;
    Series series{.label = family.name,
                  .style = SeriesStyle::line_with_points,
                  .colour = colours[style % colours.size()],
                  .marker = markers[style % markers.size()]};
    ++style;
    for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
      series.x.push_back(result.plan.ratios[r]);
      series.y.push_back(result.at(f, weighting, r).exact.poisson.mean);
    }
    plot.series.push_back(series);
  }
  return plot;
}

/// Error against the scatter of branch lengths: a line through the perturbed lattices, points for the others.
Plot error_plot(const Result& result, std::size_t weighting, const std::string& label, MeanEstimate Point::*error) {
  Plot plot{.title = fmt::format("Springs weighted \"{}\"; lines: hexagonal lattices with disorder",
                                 to_string(weightings[weighting])),
            .x = {.label = "scatter of branch lengths, sd/mean"},
            .y = {.label = label}};
  for (std::size_t r = 0; r < result.plan.ratios.size(); ++r) {
    const std::string name = fmt::format("kT/kN = {:g}", result.plan.ratios[r]);
    Series lattices{.label = name,
                    .style = SeriesStyle::line_with_points,
                    .colour = colours[(r + 1) % colours.size()],
                    .marker = markers[r % markers.size()]};
    Series others = lattices;
    others.label = "";
    others.style = SeriesStyle::points;
    others.column = name + ", others";
    for (std::size_t f = 0; f < result.plan.families.size(); ++f) {
      const Family& family = result.plan.families[f];
      if (!family.isotropic()) continue;
      const bool lattice = family.points == PointProcess::perturbed_hexagonal;
      const double scatter = result.disorder[f].branch_scatter.mean;
      Series& series = lattice ? lattices : others;
      series.x.push_back(scatter);
      series.y.push_back((result.at(f, weighting, r).*error).mean);
      if (r == 0 && !lattice) plot.vertical_lines.push_back({scatter, family.name, PlotColour::black});
    }
    plot.series.push_back(lattices);
    plot.series.push_back(others);
  }
  return plot;
}

std::string plot_name(const char* what, std::size_t weighting) {
  return fmt::format("{}_{}", what, to_string(weightings[weighting]));
}
constexpr const char* poisson_name = "poisson_ratio";
constexpr const char* poisson_error_name = "error_poisson_ratio";
constexpr const char* shear_error_name = "error_shear_modulus";

void add_modulus(JsonObject& object, const std::string& key, const MeanEstimate& e) {
  JsonObject one;
  one.set("mean", e.mean).set("standard_error", e.standard_error).set("standard_deviation", e.standard_deviation);
  object.set(key, one);
}

JsonObject moduli_json(const Moduli& m) {
  JsonObject object;
  add_modulus(object, "bulk_modulus_2d", m.bulk);
  add_modulus(object, "shear_modulus", m.shear);
  add_modulus(object, "poisson_ratio", m.poisson);
  return object;
}

}  // namespace

std::vector<std::pair<std::string, Plot>> plots(const Result& result) {
  std::vector<std::pair<std::string, Plot>> all;
  for (std::size_t w = 0; w < weightings.size(); ++w) {
    all.emplace_back(plot_name(poisson_name, w), poisson_plot(result, w));
    all.emplace_back(plot_name(poisson_error_name, w),
                     error_plot(result, w, "nu of the mean field less the exact one", &Point::poisson_error));
    all.emplace_back(plot_name(shear_error_name, w),
                     error_plot(result, w, "G of the mean field over the exact one, less 1", &Point::shear_error));
  }
  return all;
}

Table table(const Result& result) {
  std::vector<std::string> families, weighting_names;
  std::vector<double> disorders, stretches;
  for (const Point& p : result.points) {
    families.push_back(to_string(result.plan.families[p.family].points));
    disorders.push_back(result.plan.families[p.family].disorder);
    stretches.push_back(result.plan.families[p.family].stretch);
    weighting_names.push_back(to_string(p.weighting));
  }
  Table all;
  all.add("points", families).add("disorder", disorders).add("stretch", stretches).add("weighting", weighting_names);
  const auto column = [&](const std::string& name, const auto& value) {
    std::vector<double> values;
    for (const Point& p : result.points) values.push_back(value(p));
    all.add(name, std::move(values));
  };
  const auto estimate = [&](const std::string& name, const auto& value) {
    column(name, [&](const Point& p) { return value(p).mean; });
    column(name + "_standard_error", [&](const Point& p) { return value(p).standard_error; });
  };
  column("branch_scatter", [&](const Point& p) { return result.disorder[p.family].branch_scatter.mean; });
  column("kT_over_kN", [](const Point& p) { return p.ratio; });
  estimate("nu_exact", [](const Point& p) { return p.exact.poisson; });
  column("nu_mean_field", [](const Point& p) { return p.mean_field.poisson.mean; });
  column("nu_voigt", [](const Point& p) { return p.voigt.poisson.mean; });
  column("nu_uniform_stress", [](const Point& p) { return p.uniform_stress.poisson.mean; });
  estimate("G_exact_over_kN", [](const Point& p) { return p.exact.shear; });
  column("G_mean_field_over_kN", [](const Point& p) { return p.mean_field.shear.mean; });
  column("G_voigt_over_kN", [](const Point& p) { return p.voigt.shear.mean; });
  column("G_uniform_stress_over_kN", [](const Point& p) { return p.uniform_stress.shear.mean; });
  estimate("K_exact_over_kN", [](const Point& p) { return p.exact.bulk; });
  column("K_mean_field_over_kN", [](const Point& p) { return p.mean_field.bulk.mean; });
  column("K_voigt_over_kN", [](const Point& p) { return p.voigt.bulk.mean; });
  estimate("nu_error", [](const Point& p) { return p.poisson_error; });
  estimate("G_error", [](const Point& p) { return p.shear_error; });
  estimate("K_error", [](const Point& p) { return p.bulk_error; });
  estimate("anisotropy", [](const Point& p) { return p.anisotropy; });
  return all;
}

void add_result(JsonObject& object, const Result& result) {
  object.set("discs", result.plan.discs).set("samples", result.plan.samples);
  object.set("refusals", result.refusals);
  std::vector<JsonObject> points;
  for (const Point& p : result.points) {
    const Family& family = result.plan.families[p.family];
    JsonObject one;
    one.set("points", to_string(family.points)).set("disorder", family.disorder).set("stretch", family.stretch);
    one.set("branch_scatter", result.disorder[p.family].branch_scatter.mean);
    one.set("weighting", to_string(p.weighting)).set("ratio", p.ratio);
    one.set("exact", moduli_json(p.exact)).set("mean_field", moduli_json(p.mean_field));
    one.set("voigt", moduli_json(p.voigt)).set("uniform_stress", moduli_json(p.uniform_stress));
    add_modulus(one, "shear_modulus_error", p.shear_error);
    add_modulus(one, "bulk_modulus_error", p.bulk_error);
    add_modulus(one, "poisson_ratio_error", p.poisson_error);
    add_modulus(one, "anisotropy", p.anisotropy);
    points.push_back(std::move(one));
  }
  object.set("points", points);
}

Run declare(CLI::App& command) {
  return declare_with_quick(command,
                            "What the paper leaves open: the mean field (21), (22) and the correction (11) beside the "
                            "exact moduli\nof random assemblies, over disorder, kT/kN and weightings.",
                            [](const CommonOptions& options, bool quick) {
                              std::vector<std::string> names;
                              for (std::size_t w = 0; w < weightings.size(); ++w)
                                for (const char* what : {poisson_name, poisson_error_name, shear_error_name})
                                  names.push_back(plot_name(what, w));
                              start_paper(options, names, {"mean_field.csv"});
                              const Result result = compute(quick ? quick_plan() : full_plan());
                              return finish_paper(
                                  options, {.paper = "abe1996_random",
                                            .report = report(result),
                                            .times = result.times,
                                            .effects = derive_effects(ContactSprings({1, 1}), Rotation::free),
                                            .add_numbers = [&](JsonObject& object) { add_result(object, result); },
                                            .tables = {{"mean_field", table(result)}},
                                            .plots = plots(result)});
                            });
}

}  // namespace equidem::mean_field
