// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/break_files.hpp"

#include <algorithm>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/energies.hpp"
#include "equidem/output/plots/plot.hpp"

namespace equidem {
namespace {

constexpr std::pair<BreakMode, PlotColour> modes_of_bonds[] = {{BreakMode::tension, PlotColour::vermilion},
                                                               {BreakMode::shear, PlotColour::blue},
                                                               {BreakMode::bending, PlotColour::green}};

}  // namespace

std::vector<GrainBond> bonds_left(std::span<const GrainBond> bonds, std::span<const BondBreak> breaks) {
  std::vector<char> broken(bonds.size(), 0);
  for (const BondBreak& event : breaks) broken[event.bond] = 1;
  std::vector<GrainBond> left;
  for (std::size_t b = 0; b < bonds.size(); ++b)
    if (broken[b] == 0) left.push_back(bonds[b]);
  return left;
}

void write_breaks(const std::filesystem::path& folder, const GrainCase& resolved, std::span<const BondBreak> breaks,
                  double time_step, bool overwrite) {
  if (!resolved.scene.strengths) return;
  if (resolved.output.csv) {
    Table table;
    const auto bond = [&](const BondBreak& event) -> const GrainBond& { return resolved.scene.bonds[event.bond]; };
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

void add_breaks(Results& out, const GrainCase& resolved, std::span<const BondBreak> breaks, double time_step) {
  if (!resolved.scene.strengths) return;
  double energy = 0;
  for (const BondBreak& event : breaks) energy += event.energy;
  out.line("broken bonds")
      .add("breaks/number", "", breaks.size(), "", {Shown::count})
      .note(fmt::format(" of {}", resolved.scene.bonds.size()));
  for (const auto& [mode, colour] : modes_of_bonds) {
    out.add(fmt::format("breaks/{}", to_string(mode)), to_string(mode),
            std::ranges::count(breaks, mode, &BondBreak::mode), "", {Shown::count});
  }
  out.set("breaks/energy", energy);
  if (breaks.empty()) return;
  const BondBreak& first = breaks.front();
  const GrainBond& bond = resolved.scene.bonds[first.bond];
  out.line("", fmt::format("the first, of grains {} and {}, in {}: ", bond.i, bond.j, to_string(first.mode)))
      .add("breaks/first/time", "", static_cast<double>(first.step) * time_step, "s")
      .set("breaks/first/bond", first.bond)
      .set("breaks/first/mode", to_string(first.mode));
}

}  // namespace equidem
