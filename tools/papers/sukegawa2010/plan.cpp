// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/core/text.hpp"

#include "sukegawa2010/sukegawa2010.hpp"

namespace equidem::sukegawa2010 {
namespace {

/// Whole cycles of at least one second, at least two.
Shaking whole_cycles(double gal, double frequency) {
  return {gal, frequency, std::max<std::int64_t>(2, std::llround(frequency))};
}

Run shaken(const Fill& fill, double gal, double frequency, bool shown = false) {
  return {.fill = fill, .shaking = whole_cycles(gal, frequency), .shown = shown};
}

/// Fillings that differ from `base` in one parameter.
std::vector<Fill> variants_of(const Fill& base) {
  const auto made = [&](const char* name, auto change) {
    Fill fill = base;
    change(fill);
    fill.variant = name;
    return fill;
  };
  return {made("half_step", [](Fill& f) { f.step_share /= 2; }),  made("soft", [](Fill& f) { f.softness = 9; }),
          made("less_damping", [](Fill& f) { f.damping = 0.1; }), made("low_drop", [](Fill& f) { f.row_share = 0.7; }),
          made("smooth", [](Fill& f) { f.friction = 0; }),        made("rough", [](Fill& f) { f.friction = 0.5; })};
}

/// With the law as printed: friction limits the spring alone (2.16).
Fill as_printed(Shape shape, std::uint64_t seed = 1) {
  return {.shape = shape, .seed = seed, .step_share = 0.25, .cap = FrictionCap::spring_alone, .variant = "printed_cap"};
}

/// Discs moved by PrintedDiscs with (2.16), each with one thing as printed; and rho = (1 + e) gamma (2.25).
std::vector<Fill> printed_variants_of(const Fill& base) {
  using Integrator = PrintedOptions::Integrator;
  Fill printed = base;
  printed.step_share = 0.25;
  printed.cap = FrictionCap::spring_alone;
  printed.printed = {.integrator = Integrator::semi_implicit};
  const auto made = [&](const char* name, PrintedOptions options) {
    Fill fill = printed;
    fill.printed = options;
    fill.variant = name;
    return fill;
  };
  std::vector<Fill> fills{made("increments", {.integrator = Integrator::semi_implicit}), made("printed_integrator", {}),
                          made("mass_damping_1", {.integrator = Integrator::semi_implicit, .mass_damping = 1}),
                          made("mass_damping_10", {.integrator = Integrator::semi_implicit, .mass_damping = 10}),
                          made("beta_1.05", {.integrator = Integrator::semi_implicit, .beta = 1.05})};
  fills.push_back(fills.front());
  fills.back().cap = FrictionCap::whole_force;
  fills.back().variant = "increments_capped";
  for (const auto& [name, bulk] : {std::pair{"bulk_springs", Fill::BulkDensity::of_springs},
                                   std::pair{"bulk_density", Fill::BulkDensity::of_springs_and_masses}}) {
    fills.push_back(base);
    fills.back().bulk_density = bulk;
    fills.back().variant = name;
  }
  return fills;
}

/// Fewer grains, softer ones, fewer shakings.
std::vector<Run> quick_plan() {
  const Fill discs{.grid = {.columns = 8, .rows = 24}, .softness = 25};
  const auto filled = [&](Shape shape, std::uint64_t seed) {
    Fill fill = discs;
    fill.shape = shape;
    fill.seed = seed;
    return fill;
  };
  std::vector<Run> runs;
  for (const Shape shape : {Shape::disc, Shape::bonded_pair, Shape::rigid_pair, Shape::ellipse})
    runs.push_back(shaken(filled(shape, 1), 400, 10, true));
  for (const std::uint64_t seed : {2, 3}) runs.push_back(shaken(filled(Shape::disc, seed), 400, 10));
  for (const Shape shape : {Shape::disc, Shape::bonded_pair}) {
    runs.push_back(shaken(filled(shape, 1), 1200, 2, true));
    runs.back().animated = shape == Shape::disc;
  }
  for (const Fill& fill : printed_variants_of(discs)) runs.push_back(shaken(fill, 400, 10));
  for (Run& run : runs)
    run.mapped = run.fill.variant.empty() && run.fill.seed == 1 &&
                 (run.fill.shape == Shape::disc || run.fill.shape == Shape::bonded_pair);
  return runs;
}

}  // namespace

std::vector<Run> plan(bool quick) {
  constexpr std::array<std::uint64_t, 3> seeds{1, 2, 3};
  if (quick) return quick_plan();
  std::vector<Run> runs;
  const auto filled = [&](std::initializer_list<Shape> shapes, std::uint64_t seed) {
    for (const Shape shape : shapes) runs.push_back(shaken({.shape = shape, .seed = seed}, 400, 10, seed == 1));
  };
  // The nine shakings of sections 8.7 and 8.8, and 5 Hz for discs.
  const auto shakings = [&](Shape shape, std::uint64_t seed) {
    for (const double frequency : {1, 2, 10, 5}) {
      if (frequency == 5 && shape != Shape::disc) continue;
      for (const double gal : {1200, 800, 400}) {
        if (gal == 400 && frequency == 10) continue;  // among the fillings
        runs.push_back(shaken({.shape = shape, .seed = seed}, gal, frequency, seed == 1 && frequency != 5));
        runs.back().animated = seed == 1 && shape == Shape::disc && gal == 1200 && frequency == 1;
      }
    }
  };
  const auto printed = [&](std::uint64_t seed) {
    for (const Fill& fill : printed_variants_of({.seed = seed})) runs.push_back(shaken(fill, 400, 10));
  };
  const std::initializer_list<Shape> shapes{Shape::disc, Shape::bonded_pair, Shape::ellipse};
  filled(shapes, 1);
  shakings(Shape::disc, 1);
  shakings(Shape::bonded_pair, 1);
  printed(1);
  for (const std::uint64_t seed : seeds) runs.push_back(shaken(as_printed(Shape::disc, seed), 400, 10));
  for (const std::uint64_t seed : {2, 3}) filled(shapes, seed);
  for (const std::uint64_t seed : {2, 3}) {
    shakings(Shape::disc, seed);
    shakings(Shape::bonded_pair, seed);
  }
  for (const std::uint64_t seed : seeds) filled({Shape::rigid_pair}, seed);
  for (const std::uint64_t seed : {2, 3}) printed(seed);
  for (const std::uint64_t seed : seeds) {
    for (const Fill& fill : variants_of({.seed = seed})) runs.push_back(shaken(fill, 400, 10));
  }
  const auto long_shaken = [&](const Fill& fill, std::size_t k) {
    runs.push_back({.fill = fill, .shaking = Shaking{400, 10, long_shakings[k]}});
  };
  for (const std::uint64_t seed : seeds) {
    long_shaken({.seed = seed}, 0);
    long_shaken(as_printed(Shape::disc, seed), 0);
  }
  long_shaken(as_printed(Shape::bonded_pair), 0);
  long_shaken(as_printed(Shape::ellipse), 0);
  for (const double period : {printed_period, 1.32, 0.75, 2.4, 1.6, 1.1})
    runs.push_back({.fill = {}, .shaking = Shaking{.gal = 400, .frequency = 1 / period, .cycles = 3}});
  Fill pairs{.shape = Shape::bonded_pair};
  runs.push_back(shaken(pairs, 0, 10));
  pairs.bond_step /= 10;
  pairs.variant = "strong_bonds";
  runs.push_back(shaken(pairs, 400, 10));
  long_shaken({}, 1);
  long_shaken(as_printed(Shape::disc), 1);
  runs.push_back(shaken({.step = printed_step, .variant = "printed_step"}, 400, 10));
  // The thesis's contact test for ellipses is twenty times as slow: fewer and softer grains, and the corrected test
  // alone; as printed: drop_ellipses.
  for (const auto& [law, name] :
       {std::pair{EllipseLaw::exact, "small"}, std::pair{EllipseLaw::enlarged_mended, "mended_test"}}) {
    runs.push_back(shaken({.shape = Shape::ellipse,
                           .grid = {.columns = 18, .rows = 34},
                           .softness = 9,
                           .ellipse_law = law,
                           .variant = name},
                          400, 10));
  }
  for (Run& run : runs) {
    run.mapped = run.fill.variant.empty() && run.fill.seed == 1 && run.shaking->gal > 0 && run.shaking->cycles <= 10 &&
                 (run.fill.shape == Shape::disc || run.fill.shape == Shape::bonded_pair);
  }
  return runs;
}

double cost_of(const Run& run) {
  const double bodies = static_cast<double>(run.fill.grid.places()) / (run.fill.shape == Shape::rigid_pair ? 2 : 1);
  const double factor = run.fill.shape == Shape::ellipse ? 5 : run.fill.shape == Shape::disc ? 1 : 1.5;
  const double moved = run.shaking ? 0.5 + static_cast<double>(run.shaking->cycles) / run.shaking->frequency : 1.3;
  const double share = run.fill.step ? 0.1 : run.fill.step_share;
  return bodies * factor * moved / (share * std::sqrt(run.fill.softness));
}

std::string plural_of(Shape shape) {
  switch (shape) {
    case Shape::disc:
      return "discs";
    case Shape::ellipse:
      return "ellipses";
    case Shape::bonded_pair:
      return "bonded_pairs";
    case Shape::rigid_pair:
      return "rigid_pairs";
    case Shape::clump:
      break;
  }
  return "clumps";
}

std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string Fill::name() const {
  return fmt::format("{}{}{}_{}", plural_of(shape), variant.empty() ? "" : "_", variant, seed);
}

std::string Run::name() const {
  if (!shaking) return fill.name();
  const bool long_shaking = shaking->cycles > whole_cycles(shaking->gal, shaking->frequency).cycles;
  return fmt::format("{}_{:g}gal_{:.3g}Hz{}", fill.name(), shaking->gal, shaking->frequency,
                     long_shaking ? fmt::format("_{}cycles", shaking->cycles) : "");
}

namespace {

/// Row and column, from 0.
std::pair<std::int64_t, std::int64_t> place_of_followed(const StartGrid& grid, std::size_t k) {
  const std::array rows{grid.rows / 6, grid.rows / 2, grid.rows * 5 / 6};
  const std::array columns{grid.columns / 8 - 1, grid.columns / 2 - 1, grid.columns * 7 / 8 - 1};
  return {rows[k / 3], columns[k % 3]};
}

}  // namespace

std::array<std::size_t, 9> followed(const StartGrid& grid, Shape shape) {
  std::array<std::size_t, 9> grains{};
  for (std::size_t k = 0; k < grains.size(); ++k) {
    const auto [row, column] = place_of_followed(grid, k);
    grains[k] = static_cast<std::size_t>(row * grid.columns + column);
    if (shape == Shape::rigid_pair) grains[k] /= 2;
  }
  return grains;
}

std::string label_of_followed(const StartGrid& grid, std::size_t k) {
  const auto [row, column] = place_of_followed(grid, k);
  return fmt::format("No. {}", row * grid.columns + column + 1);
}

}  // namespace equidem::sukegawa2010
