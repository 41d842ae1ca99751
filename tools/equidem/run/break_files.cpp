// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/break_files.hpp"

#include <algorithm>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/histories.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem {
namespace {

constexpr std::pair<BreakMode, PlotColour> modes_of_bonds[] = {{BreakMode::tension, PlotColour::vermilion},
                                                               {BreakMode::shear, PlotColour::blue},
                                                               {BreakMode::bending, PlotColour::green}};

}  // namespace

void write_breaks(const std::filesystem::path& folder, const GrainCase& resolved, const BreaksOfRun& run,
                  double time_step, bool overwrite) {
  if (!resolved.scene.strengths) return;
  const std::span<const BondBreak> breaks = run.breaks;
  if (resolved.output.csv) {
    Table table;
    const auto bond = [&](const BondBreak& event) -> const GrainBond& { return run.bonds[event.bond]; };
    table.add("step", breaks, &BondBreak::step);
    table.add("time_s", breaks, [&](const BondBreak& event) { return static_cast<double>(event.step) * time_step; });
    table.add("bond", breaks, &BondBreak::bond);
    table.add("i", breaks, [&](const BondBreak& event) { return bond(event).i; });
    table.add("j", breaks, [&](const BondBreak& event) { return bond(event).j; });
    table.add("x_m", breaks, [](const BondBreak& event) { return event.place.x; });
    table.add("y_m", breaks, [](const BondBreak& event) { return event.place.y; });
    table.add("mode", breaks, [](const BondBreak& event) { return std::string(to_string(event.mode)); });
    table.add(std::string("energy_J") + per_depth(resolved.body), breaks, &BondBreak::energy);
    write_csv(folder / "breaks.csv", table, overwrite);
  }
  if (!resolved.output.picture || breaks.empty()) return;
  Plot plot{.title = resolved.title};
  plot.x.label = "x, m";
  plot.y.label = "y, m";
  for (const auto& [mode, colour] : modes_of_bonds) {
    Series series{.label = to_string(mode), .style = SeriesStyle::points, .colour = colour};
    for (const BondBreak& event : breaks) {
      if (event.mode != mode) continue;
      series.x.push_back(event.place.x);
      series.y.push_back(event.place.y);
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  write_plot(folder, "breaks_plot", plot, overwrite);
}

void add_breaks(Results& out, const GrainCase& resolved, const BreaksOfRun& run, double time_step) {
  if (!resolved.scene.strengths) return;
  const std::span<const BondBreak> breaks = run.breaks;
  double energy = 0;
  for (const BondBreak& event : breaks) energy += event.energy;
  out.line("broken bonds")
      .add("breaks/number", "", breaks.size(), "", {Shown::count})
      .note(fmt::format(" of {}", run.bonds.size()));
  for (const auto& [mode, colour] : modes_of_bonds) {
    out.add(fmt::format("breaks/{}", to_string(mode)), to_string(mode),
            std::ranges::count(breaks, mode, &BondBreak::mode), "", {Shown::count});
  }
  out.set("breaks/energy", energy);
  if (breaks.empty()) return;
  const BondBreak& first = breaks.front();
  const GrainBond& bond = run.bonds[first.bond];
  out.line("", fmt::format("the first, of grains {} and {}, in {}: ", bond.i, bond.j, to_string(first.mode)))
      .add("breaks/first/time", "", static_cast<double>(first.step) * time_step, "s")
      .set("breaks/first/bond", first.bond)
      .set("breaks/first/mode", to_string(first.mode));
}

}  // namespace equidem
