// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables and plots of `equidem stability`.
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"

#include "stability/stability_results.hpp"

namespace equidem {
namespace {

constexpr const char* dispersion_table = "dispersion.csv";
constexpr const char* ratio_table = "critical_ratio.csv";
constexpr const char* dispersion_plot = "dispersion_plot";
constexpr const char* ratio_plot = "critical_ratio_plot";

/// Frequencies of a branch along the path; 0 below the round-off of the largest.
std::vector<double> frequencies(const WaveSurvey& survey, std::size_t branch) {
  constexpr double round_off = 1e-12;  // of squares
  double largest = 0;
  for (const PathPoint& point : survey.path)
    largest = std::max({largest, std::abs(point.squared_frequencies.front()), point.squared_frequencies.back()});
  std::vector<double> values;
  for (const PathPoint& point : survey.path) {
    const double squared = point.squared_frequencies[branch];
    values.push_back(std::abs(squared) <= round_off * largest ? 0 : signed_root(squared));
  }
  return values;
}

Table dispersion(const WaveSurvey& survey) {
  std::vector<std::string> names;
  std::vector<double> along, qx, qy, ratio;
  for (const PathPoint& point : survey.path) {
    names.push_back(point.at.name);
    along.push_back(point.along), qx.push_back(point.at.q.x), qy.push_back(point.at.q.y);
    ratio.push_back(point.critical_ratio);
  }
  Table table;
  table.add("point", names).add("path_rad_per_m", along).add("qx_rad_per_m", qx).add("qy_rad_per_m", qy);
  for (std::size_t b = 0; b < survey.path.front().squared_frequencies.size(); ++b)
    table.add(fmt::format("omega_{}_rad_per_s", b + 1), frequencies(survey, b));
  if (survey.ratio_sought) table.add("critical_ratio", ratio);
  return table;
}

/// The whole zone: q and, where it is another wave vector, -q.
Table critical_over_zone(const WaveSurvey& survey) {
  std::vector<double> qx, qy, ratio;
  const std::vector<Vec2> grid = zone_grid(survey.zone, survey.grid);
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const Vec2 q = survey.zone.folded(grid[k]), opposite = survey.zone.folded(-grid[k]);
    const bool other = norm(survey.zone.folded(q - opposite)) > 1e-6 * norm(survey.zone.reciprocal[0]);
    const bool listed = other && 2 * (k % (survey.grid / 2 + 1)) % survey.grid == 0;  // rows that hold their own -q
    for (int side = 0; side < (other && !listed ? 2 : 1); ++side) {
      qx.push_back(side == 0 ? q.x : opposite.x), qy.push_back(side == 0 ? q.y : opposite.y);
      ratio.push_back(survey.critical.on_grid[k]);
    }
  }
  Table table;
  table.add("qx_rad_per_m", qx).add("qy_rad_per_m", qy).add("critical_ratio", ratio);
  return table;
}

/// A plot along the path, with the points of symmetry marked.
Plot along_path(const WaveSurvey& survey, const std::string& title, const std::string& y) {
  const std::string names = joined(survey.zone.path, &ZonePoint::name, " - ");
  Plot plot{.title = title,
            .x = {.label = literal("wave vector along " + names + ", rad/m")},
            .y = {.label = y},
            .enhanced = true};
  plot.x.min = 0;
  plot.x.max = survey.path.back().along;
  for (const PathPoint& point : survey.path)
    if (!point.at.name.empty() && point.along > 0 && point.along < *plot.x.max)
      plot.vertical_lines.push_back({point.along, literal(point.at.name)});
  return plot;
}

std::vector<double> positions(const WaveSurvey& survey) {
  std::vector<double> x;
  for (const PathPoint& point : survey.path) x.push_back(point.along);
  return x;
}

Plot plot_of_dispersion(const Stability& s, const std::string& title) {
  const WaveSurvey& survey = *s.survey;
  Plot plot = along_path(survey, title.empty() ? "Dispersion" : literal(title),
                         s.lowest ? "ω, rad/s; below 0: growth rate, 1/s" : "ω, rad/s");
  const std::size_t branches = survey.path.front().squared_frequencies.size();
  constexpr std::array colours{PlotColour::blue, PlotColour::vermilion, PlotColour::black};
  for (std::size_t b = 0; b < branches; ++b) {
    Series series{.x = positions(survey),
                  .y = frequencies(survey, b),
                  .colour = branches <= colours.size() ? colours[b] : PlotColour::blue,
                  .column = fmt::format("omega_{}", b + 1)};
    plot.series.push_back(std::move(series));
  }
  if (!s.lowest) plot.y.min = 0;
  return plot;
}

Plot plot_of_critical_ratio(const Stability& s) {
  const WaveSurvey& survey = *s.survey;
  Plot plot = along_path(survey, "k_T/k_N at which each wave loses its stiffness in statics", "critical k_T/k_N");
  Series series{
      .label = "of each wave", .x = positions(survey), .colour = PlotColour::blue, .column = "critical_ratio"};
  for (const PathPoint& point : survey.path) series.y.push_back(point.critical_ratio);
  plot.series.push_back(std::move(series));
  const double end = survey.path.back().along;
  if (s.ratio && *s.ratio < 0)
    plot.series.push_back({.label = "this case",
                           .x = {0, end},
                           .y = {*s.ratio, *s.ratio},
                           .style = SeriesStyle::dashed_line,
                           .colour = PlotColour::vermilion,
                           .column = "this_case"});
  plot.y.min = -1.05;
  plot.y.max = 0.05;
  return plot;
}

}  // namespace

void expect_survey(const OutputPlan& plan) {
  for (const char* name : {dispersion_table, ratio_table}) plan.expect(name);
  for (const char* name : {dispersion_plot, ratio_plot}) plan.expect_plot(name);
}

void write_survey(const std::filesystem::path& folder, const std::string& title, const Stability& s, bool overwrite) {
  if (!s.survey) return;
  write_csv(folder / dispersion_table, dispersion(*s.survey), overwrite);
  if (s.survey->ratio_sought) write_csv(folder / ratio_table, critical_over_zone(*s.survey), overwrite);
  write_plot(folder, dispersion_plot, plot_of_dispersion(s, title), overwrite);
  const auto& path = s.survey->path;
  if (std::any_of(path.begin(), path.end(), [](const PathPoint& p) { return std::isfinite(p.critical_ratio); }))
    write_plot(folder, ratio_plot, plot_of_critical_ratio(s), overwrite);
}

}  // namespace equidem
