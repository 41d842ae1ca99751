// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Keys, tables and plots of `equidem stability`.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/plots/plot.hpp"

#include "stability/stability_analysis.hpp"

namespace equidem {
namespace {

constexpr const char* dispersion_table = "dispersion.csv";
constexpr const char* ratio_table = "critical_ratio.csv";
constexpr const char* dispersion_plot = "dispersion_plot";
constexpr const char* ratio_plot = "critical_ratio_plot";

/// omega, or the growth rate with a minus sign: how spectra with unstable branches are drawn.
double signed_root(double squared) {
  return squared >= 0 ? std::sqrt(squared) : -std::sqrt(-squared);
}

std::vector<double> components(Vec2 v) {
  return {v.x, v.y};
}

void add_critical(JsonObject& object, const Stability& s) {
  const CriticalMotion& c = s.critical;
  if (c.sought) {
    object.set("critical_ratio", c.ratio);
  } else {
    object.set_null("critical_ratio");
  }
  if (c.wave) {
    object.set("critical_wave_vector", components(c.wave->q));
    object.set("critical_wave_vector_name", c.wave->name);
    std::vector<JsonObject> all;
    for (const ZonePoint& point : c.equivalent) {
      JsonObject one;
      one.set("name", point.name).set("wave_vector", components(point.q));
      all.push_back(std::move(one));
    }
    object.set("critical_wave_vectors", all);
  } else {
    object.set_null("critical_wave_vector");
  }
  if (!c.motion.empty()) object.set("critical_motion", c.motion);
  object.set("critical_ratio_searched", c.searched);
  if (s.ratio) {
    object.set("ratio", *s.ratio);
    if (c.sought) object.set("ratio_margin", *s.ratio - c.ratio);
  } else {
    object.set_null("ratio");
  }
}

void add_time_steps(JsonObject& object, const Stability& s) {
  object.set("density", s.density);
  object.set("density_assumed", s.density_assumed);
  object.set("body", to_string(s.problem.resolved.assembly.body));
  object.set("omega_max", std::sqrt(s.highest.value));
  object.set("omega_max_squared_residual", s.highest.residual);
  object.set("omega_max_converged", s.highest.converged);
  object.set("critical_time_step", 2 / std::sqrt(s.highest.value));
  object.set("element_bound_omega_max", std::sqrt(s.element_bound));
  object.set("element_bound_time_step", 2 / std::sqrt(s.element_bound));
  object.set("diagonal_rule_time_step", s.rules.diagonal);
  object.set("eighth_of_period_time_step", s.rules.eighth_of_period);
  object.set("growth_rate", s.growth_rate());
  if (!s.survey) return;
  object.set("zone_omega_max", std::sqrt(s.survey->highest.value));
  object.set("zone_omega_max_wave_vector", components(s.survey->highest.at.q));
  object.set("zone_omega_max_wave_vector_name", s.survey->highest.at.name);
  object.set("zone_critical_time_step", 2 / std::sqrt(s.survey->highest.value));
  if (s.growth_rate() > 0) {
    object.set("growth_wave_vector", components(s.survey->growing.at.q));
    object.set("growth_wave_vector_name", s.survey->growing.at.name);
  }
}

JsonObject sound_json(const Stability& s) {
  std::vector<double> angles, p, q, homogenized_p, homogenized_s;
  if (s.survey) {
    for (const SoundAlong& along : s.survey->sound) {
      angles.push_back(std::round(along.angle * 180 / std::numbers::pi));
      p.push_back(signed_root(along.speeds.longitudinal_squared));
      q.push_back(signed_root(along.speeds.transverse_squared));
    }
  } else {
    angles = {0, 90};
  }
  for (const PlaneWaves& waves : s.sound) {
    homogenized_p.push_back(signed_root(waves.longitudinal_squared));
    homogenized_s.push_back(signed_root(waves.transverse_squared));
  }
  JsonObject sound;
  sound.set("angles_degrees", angles);
  if (s.survey) sound.set("longitudinal", p).set("transverse", q);
  if (!s.sound.empty())
    sound.set("homogenized_longitudinal", homogenized_p).set("homogenized_transverse", homogenized_s);
  if (!s.no_continuum.empty()) sound.set("no_homogenized_continuum", s.no_continuum);
  return sound;
}

void add_waves(JsonObject& object, const Stability& s) {
  if (!s.problem.assembly.periodic()) return;
  JsonObject cell;
  cell.set("discs", s.cell_discs);
  if (s.survey) {
    const auto [a, b] = s.survey->cell.period;
    cell.set("lattice", s.survey->zone.lattice);
    cell.set("period", std::vector<std::vector<double>>{components(a), components(b)});
    cell.set("copies", s.survey->cell.copies);
  }
  object.set("primitive_cell", cell);
  object.set("sound_speeds", sound_json(s));
  object.set("mass_per_area", s.mass_per_area);
  if (!s.survey) return;
  if (s.survey->squared_rotational_gap) {
    object.set("rotational_gap", signed_root(*s.survey->squared_rotational_gap));
  } else {
    object.set_null("rotational_gap");
  }
  object.set("wave_vectors", s.survey->highest.on_grid.size());
}

Table dispersion(const WaveSurvey& survey) {
  std::vector<std::string> names;
  std::vector<double> along, qx, qy, ratio;
  std::vector<std::vector<double>> branches(survey.path.front().squared_frequencies.size());
  for (const PathPoint& point : survey.path) {
    names.push_back(point.at.name);
    along.push_back(point.along), qx.push_back(point.at.q.x), qy.push_back(point.at.q.y);
    ratio.push_back(point.critical_ratio);
    for (std::size_t b = 0; b < branches.size(); ++b) branches[b].push_back(signed_root(point.squared_frequencies[b]));
  }
  Table table;
  table.add("point", names).add("path_rad_per_m", along).add("qx_rad_per_m", qx).add("qy_rad_per_m", qy);
  for (std::size_t b = 0; b < branches.size(); ++b) table.add(fmt::format("omega_{}_rad_per_s", b + 1), branches[b]);
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
  std::string names;
  for (const ZonePoint& corner : survey.zone.path) names += (names.empty() ? "" : " - ") + corner.name;
  Plot plot{.title = title, .x = {.label = "wave vector along " + names + ", rad/m"}, .y = {.label = y}};
  plot.x.min = 0;
  plot.x.max = survey.path.back().along;
  for (const PathPoint& point : survey.path)
    if (!point.at.name.empty() && point.along > 0 && point.along < *plot.x.max)
      plot.vertical_lines.push_back({point.along, point.at.name});
  return plot;
}

std::vector<double> positions(const WaveSurvey& survey) {
  std::vector<double> x;
  for (const PathPoint& point : survey.path) x.push_back(point.along);
  return x;
}

Plot plot_of_dispersion(const Stability& s) {
  const WaveSurvey& survey = *s.survey;
  Plot plot = along_path(survey, s.problem.resolved.title.empty() ? "Dispersion" : s.problem.resolved.title,
                         s.lowest ? "omega, rad/s; below 0: growth rate, 1/s" : "omega, rad/s");
  const std::size_t branches = survey.path.front().squared_frequencies.size();
  constexpr std::array colours{PlotColour::blue, PlotColour::vermilion, PlotColour::black};
  for (std::size_t b = 0; b < branches; ++b) {
    Series series{.x = positions(survey),
                  .colour = branches <= colours.size() ? colours[b] : PlotColour::blue,
                  .column = fmt::format("omega_{}", b + 1)};
    for (const PathPoint& point : survey.path) series.y.push_back(signed_root(point.squared_frequencies[b]));
    plot.series.push_back(std::move(series));
  }
  if (!s.lowest) plot.y.min = 0;
  return plot;
}

Plot plot_of_critical_ratio(const Stability& s) {
  const WaveSurvey& survey = *s.survey;
  Plot plot = along_path(survey, "kT/kN at which each wave loses its stiffness in statics", "critical kT/kN");
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

JsonObject stability_json(const Stability& s, const std::string& report) {
  JsonObject object;
  add_common(object, s.status(), report, s.times, s.effects);
  object.set("title", s.problem.resolved.title);
  object.set("discs", s.problem.assembly.size());
  object.set("contacts", s.problem.assembly.contacts.size());
  JsonObject mechanisms;
  mechanisms.set("count", s.mechanisms.count());
  mechanisms.set("description", s.mechanisms.sentences);
  if (s.survey) mechanisms.set("free_waves", s.survey->free_waves.size());
  mechanisms.set("rigid_motions_of_the_whole", s.mechanisms.rigid_motions);
  object.set("mechanisms", mechanisms);
  object.set("negative_pivots", s.inertia.negative_pivots);
  if (s.inertia.unstable_modes < 0)
    object.set_null("unstable_modes");
  else
    object.set("unstable_modes", s.inertia.unstable_modes);
  add_critical(object, s);
  add_time_steps(object, s);
  add_waves(object, s);
  return object;
}

std::vector<std::string> survey_files() {
  std::vector<std::string> files{dispersion_table, ratio_table};
  for (const char* plot : {dispersion_plot, ratio_plot})
    for (const char* end : {".csv", ".gp", ".svg", ".png"}) files.push_back(std::string(plot) + end);
  return files;
}

void write_survey(const std::filesystem::path& folder, const Stability& s, bool overwrite) {
  if (!s.survey) return;
  write_csv(folder / dispersion_table, dispersion(*s.survey), overwrite);
  if (s.survey->ratio_sought) write_csv(folder / ratio_table, critical_over_zone(*s.survey), overwrite);
  write_plot(folder, dispersion_plot, plot_of_dispersion(s), overwrite);
  const auto& path = s.survey->path;
  if (std::any_of(path.begin(), path.end(), [](const PathPoint& p) { return std::isfinite(p.critical_ratio); }))
    write_plot(folder, ratio_plot, plot_of_critical_ratio(s), overwrite);
}

}  // namespace equidem
