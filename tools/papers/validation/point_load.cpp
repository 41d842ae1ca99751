// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A force on one disc of the surface of a hexagonal lattice, against the elastic half-plane.
#include <array>
#include <cmath>
#include <numbers>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "tables.hpp"
#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

constexpr double load = 1;  // N/m, into the half-plane

/// The half-plane y < 0 under a force at the origin, in plane stress with the moduli of the sheet (Flamant 1892).
struct HalfPlane {
  double young = 0, poisson = 0;

  /// Of the lattice: K = sqrt3/2 kN, G = sqrt3/4 (kN + kT) (Abe 1996, eq. 34), E = 4 K G/(K + G), nu = (K - G)/(K + G).
  explicit HalfPlane(const SpringConstants& springs) {
    const double K = std::numbers::sqrt3 / 2 * springs.kN, G = std::numbers::sqrt3 / 4 * (springs.kN + springs.kT);
    young = 4 * K * G / (K + G);
    poisson = (K - G) / (K + G);
  }
  /// Up to a rigid translation along y. Timoshenko & Goodier, article 36, angle from the line of the force.
  [[nodiscard]] Vec2 displacement(Vec2 x) const {
    const double r = norm(x), angle = std::atan2(x.x, -x.y), s = std::sin(angle), c = std::cos(angle);
    const double unit = load / (std::numbers::pi * young);
    const double along = unit * (-2 * c * std::log(r) - (1 - poisson) * angle * s);
    const double across =
        unit * (2 * poisson * s + 2 * s * std::log(r) - (1 - poisson) * angle * c + (1 - poisson) * s);
    return {along * s + across * c, -along * c + across * s};
  }
  /// Radial stress -2 P cos(angle)/(pi r); the others vanish.
  [[nodiscard]] static double radial_stress(Vec2 x) { return 2 * load * x.y / (std::numbers::pi * squared(x)); }
};

/// Errors in the half ring from a quarter to three quarters of the depth, relative to 2 P/(pi r) of the stress and to
/// P/E of the displacement; root mean squares.
struct LoadedBlock {
  int depth = 0;  ///< rows
  double displacement = 0, stress = 0, other_stress = 0;
  struct Below {
    double depth = 0;       ///< over the diameter
    double stress = 0;      ///< radial, times -pi r/(2 P)
    double settlement = 0;  ///< times E/P
  };
  std::vector<Below> below;  ///< discs in line with the force, the deepest first

  /// Difference of the settlements at a quarter and at three quarters of the line over Flamant's 2/pi ln(z2/z1).
  [[nodiscard]] double settled() const {
    const Below &deep = below[below.size() / 4], &shallow = below[3 * below.size() / 4];
    return (shallow.settlement - deep.settlement) / (2 / std::numbers::pi * std::log(deep.depth / shallow.depth));
  }
  [[nodiscard]] const Below& half_way() const { return below[below.size() / 2]; }
};

/// A block twice as wide as deep; discs of its sides and bottom follow the elastic solution.
LoadedBlock loaded_block(int depth, const SpringConstants& springs) {
  const double radius = 0.5;
  // An odd number of rows: the top row is a long one, with a disc in its middle.
  Assembly block = hexagonal_lattice({.columns = 2 * depth + 1, .rows = depth | 1, .radius = radius});
  const DiscGroup top = group(block, "top");
  const std::int32_t loaded = top.discs[top.discs.size() / 2];
  const Vec2 origin = block.centres[static_cast<std::size_t>(loaded)];
  const HalfPlane elastic(springs);
  std::vector<Support> supports;
  for (const char* side : {"left", "right", "bottom"}) {
    for (const std::int32_t disc : group(block, side).discs) {
      const std::string name = fmt::format("disc {}", disc);
      if (block.groups.contains(name)) continue;
      const Vec2 u = elastic.displacement(block.centres[static_cast<std::size_t>(disc)] - origin);
      block.groups[name] = {.discs = {disc}, .tributary_lengths = {}};
      supports.push_back({.group = name, .ux = u.x, .uy = u.y, .rotation = {}});
    }
  }
  block.groups["loaded"] = {.discs = {loaded}, .tributary_lengths = {}};
  const ContactSprings all(springs);
  const Equilibrium rest =
      solve_equilibrium(block, all, supports, {{.group = "loaded", .kind = LoadKind::total, .force = {0, -load}}});
  const std::vector<Tensor2> stresses = disc_stresses(block, rest.contact_forces);

  LoadedBlock found{.depth = depth, .below = {}};
  const double reach = -(block.centres[static_cast<std::size_t>(group(block, "bottom").discs.front())].y - origin.y);
  double count = 0;
  for (std::size_t d = 0; d < block.size(); ++d) {
    const Vec2 x = block.centres[d] - origin;
    const double r = norm(x);
    if (std::abs(x.x) < 0.1 * radius && x.y < -3 * radius && x.y > -0.9 * reach) {
      found.below.push_back({-x.y / (2 * radius), -stresses[d].yy * std::numbers::pi * r / (2 * load),
                             -rest.motions[d].u.y * elastic.young / load});
    }
    if (r < 0.25 * reach || r > 0.75 * reach || x.y > -2 * radius) continue;
    const double unit = 2 * load / (std::numbers::pi * r);
    const Vec2 n = x / r, s = perpendicular(n);
    const auto along = [&](Vec2 a, Vec2 b) {
      const Tensor2& t = stresses[d];
      return a.x * (t.xx * b.x + t.xy * b.y) + a.y * (t.yx * b.x + t.yy * b.y);
    };
    found.stress += squared((along(n, n) - HalfPlane::radial_stress(x)) / unit);
    found.other_stress += (squared(along(s, s) / unit) + squared(along(n, s) / unit)) / 2;
    found.displacement += squared((rest.motions[d].u - elastic.displacement(x)) * (elastic.young / load));
    count += 1;
  }
  for (double* error : {&found.displacement, &found.stress, &found.other_stress}) *error = std::sqrt(*error / count);
  return found;
}

constexpr std::array ratios{0.0, 0.5};

std::vector<double> logarithms(const std::vector<LoadedBlock>& blocks, double LoadedBlock::*error) {
  std::vector<double> all;
  for (const LoadedBlock& block : blocks) all.push_back(std::log(block.*error));
  return all;
}

/// Order of the last two sizes, with its change from the two before.
Estimate order(const std::vector<LoadedBlock>& blocks, double LoadedBlock::*error) {
  const std::vector<double> logs = logarithms(blocks, error);
  const std::size_t n = logs.size();
  const auto between = [&](std::size_t k) {
    return (logs[k] - logs[k + 1]) / std::log(static_cast<double>(blocks[k + 1].depth) / blocks[k].depth);
  };
  return {between(n - 2), std::abs(between(n - 2) - between(n - 3))};
}

}  // namespace

Findings point_load(bool quick) {
  Progress progress("a point load:");
  std::vector<int> depths{16, 32, 64, 128, 256};
  if (quick) depths = {12, 24, 48};
  Findings findings;
  findings.text =
      "A block of a hexagonal lattice, twice as wide as deep, the middle disc of its top row pushed down; discs of "
      "the other sides are moved as the elastic half-plane is (`solve_equilibrium`). In the half ring from a quarter "
      "to three quarters of the depth the stress of each disc (`disc_stresses`) and its displacement are set beside "
      "Flamant's. The error is the change from half the depth: the difference is that of a lattice from a continuum, "
      "and has to vanish with the size.";
  Plot plot{.title = "Point load on a hexagonal half-plane: difference from the elastic solution",
            .x = {.label = "depth of the block, rows", .logarithmic = true},
            .y = {.label = "root mean square of the difference", .logarithmic = true}};
  plot.enhanced = true;
  Table table;
  std::vector<double> ratio_column;
  std::vector<LoadedBlock> rows;
  for (std::size_t k = 0; k < ratios.size(); ++k) {
    std::vector<LoadedBlock> blocks;
    for (const int depth : depths) {
      blocks.push_back(loaded_block(depth, {1, ratios[k]}));
      progress.update(static_cast<double>(k * depths.size() + blocks.size()) /
                      static_cast<double>(ratios.size() * depths.size()));
    }
    const std::string name = fmt::format("kT/kN = {:g}", ratios[k]);
    const LoadedBlock& last = blocks.back();
    const LoadedBlock& before = blocks[blocks.size() - 2];
    const std::string why = "a lattice differs from a continuum by the diameter over the distance";
    findings.comparisons.push_back(compare_formula(
        fmt::format("{}: stress below the load over 2 P/(pi r), at {:.0f} diameters", name, last.half_way().depth), 1,
        "Flamant 1892", with_step_error(before.half_way().stress, last.half_way().stress), why));
    findings.comparisons.push_back(compare_formula(
        fmt::format("{}: settlement at {:.0f} less that at {:.0f} diameters over 2 P/(pi E) ln(z2/z1)", name,
                    last.below[3 * last.below.size() / 4].depth, last.below[last.below.size() / 4].depth),
        1, "Flamant 1892", with_step_error(before.settled(), last.settled()), why));
    for (const auto& [what, error] :
         {std::pair{"stress", &LoadedBlock::stress}, std::pair{"displacement", &LoadedBlock::displacement}}) {
      const Estimate p = order(blocks, error);
      findings.trends.push_back(
          {fmt::format("{}: the difference of the {} vanishes with the size", name, what), "Flamant 1892",
           p.value > 0.8 && last.*error < blocks.front().*error,
           fmt::format("{:.2g} at {} rows, order {:.2f} ± {:.2f}", last.*error, last.depth, p.value, p.error)});
    }
    for (const auto& [what, error, marker] :
         {std::tuple{"stress, over 2P/(πr)", &LoadedBlock::stress, Marker::circle},
          std::tuple{"displacement, over P/E", &LoadedBlock::displacement, Marker::square}}) {
      plot.series.push_back(with_points({.label = fmt::format("{}, k_T/k_N = {:g}", what, ratios[k]),
                                         .style = SeriesStyle::line_with_points,
                                         .colour = k == 0 ? PlotColour::blue : PlotColour::vermilion,
                                         .marker = marker,
                                         .filled = marker == Marker::circle},
                                        blocks, &LoadedBlock::depth, error));
    }
    ratio_column.insert(ratio_column.end(), blocks.size(), ratios[k]);
    rows.insert(rows.end(), blocks.begin(), blocks.end());
  }
  table.add("kT_over_kN", ratio_column).add("rows", rows, &LoadedBlock::depth);
  table.add("stress_difference", rows, &LoadedBlock::stress).add("other_stresses", rows, &LoadedBlock::other_stress);
  table.add("displacement_difference", rows, &LoadedBlock::displacement);
  findings.notes = {
      "Measurements on a few layers of discs or grains (Geng et al. 2001; Goldenberg & Goldhirsch 2002) are "
      "published as figures and are not compared."};
  findings.tables = {{"point_load", std::move(table)}};
  findings.plots = {{"point_load", std::move(plot)}};
  return findings;
}

}  // namespace equidem::validation
