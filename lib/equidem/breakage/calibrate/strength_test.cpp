// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/calibrate/strength_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/assembly/power_cells.hpp"
#include "equidem/breakage/strengths.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr const char* kept_disc = "kept from drifting";  // a group of one disc, which no case can name

struct Ends {
  const char *low, *high;
};

Ends ends_of(LoadAxis axis) {
  return axis == LoadAxis::x ? Ends{"left", "right"} : Ends{"bottom", "top"};
}

double across(LoadAxis axis, Vec2 x) {
  return axis == LoadAxis::x ? x.y : x.x;
}

Support support(LoadAxis axis, const char* name, std::optional<double> along, std::optional<double> across_it) {
  return axis == LoadAxis::x ? Support{name, along, across_it, {}} : Support{name, across_it, along, {}};
}

/// The disc of a group that is nearest to the middle of it, across the axis.
std::int32_t middle_disc(const Assembly& assembly, const DiscGroup& of, LoadAxis axis) {
  const auto place = [&](std::int32_t disc) { return across(axis, assembly.centres[static_cast<std::size_t>(disc)]); };
  const auto [low, high] = std::ranges::minmax(of.discs, {}, place);
  const double middle = 0.5 * (place(low) + place(high));
  return std::ranges::min(of.discs, {}, [&](std::int32_t disc) { return std::abs(place(disc) - middle); });
}

/// Through the middle of the sample. It lies a quarter of a radius beside the middle, where lattices have rows of
/// centres: a line through centres would cut the contacts on both sides of them.
Notch middle_notch(const Assembly& assembly, LoadAxis axis, double length) {
  const Rectangle extent = region_of_cells(assembly);
  const double beside = 0.25 * assembly.mean_radius();
  const Vec2 middle = 0.5 * (extent.low + extent.high) + (axis == LoadAxis::x ? Vec2{beside, 0} : Vec2{0, beside});
  const Vec2 half = axis == LoadAxis::x ? Vec2{0, 0.5 * length} : Vec2{0.5 * length, 0};
  return {middle - half, middle + half};
}

}  // namespace

StrengthSample::StrengthSample(Assembly assembly, ContactSprings springs, const StrengthTestOptions& options)
    : assembly_(std::move(assembly)), springs_(std::move(springs)), options_(options) {
  if (assembly_.periodic())
    bad_input("a periodic cell has no ends to pull at or press", "a strength is that of a free sample",
              "Set periodic = false; a mean strain breaks a cell by quasistatic");
  if (!(options_.fallen_to > 0 && options_.fallen_to < 1))
    bad_input_at("fallen_to", fmt::format("fallen_to is {:g}", options_.fallen_to),
                 "it is the share of the peak at which a test is over, between 0 and 1", "Leave it at 0.5");
  const Ends ends = ends_of(options_.axis);
  const std::string low = ends.low, high = ends.high;
  const DiscGroup &stays = group(assembly_, low), &moves = group(assembly_, high);
  for (const std::int32_t disc : stays.discs) {
    if (std::ranges::binary_search(moves.discs, disc))
      bad_input(fmt::format("disc {} is in both groups {} and {}", disc, low, high), "the ends could not move apart",
                "Take a longer sample");
  }
  for (const double length : moves.tributary_lengths) width_ += length;
  if (moves.tributary_lengths.empty()) {
    const Rectangle extent = upright_rectangle(assembly_.centres, assembly_.radii);
    width_ = across(options_.axis, extent.high - extent.low);
  }
  assembly_.groups[kept_disc].discs = {middle_disc(assembly_, stays, options_.axis)};
}

SampleStrength StrengthSample::strength(StrengthTestKind kind, const ContactStrengths& strengths,
                                        std::optional<double> notch) const {
  const LoadAxis axis = options_.axis;
  const auto [low, high] = ends_of(axis);
  const std::optional<double> held = options_.ends == EndPlates::glued ? std::optional<double>(0.0) : std::nullopt;
  const double motion = (kind == StrengthTestKind::tension ? 1e-3 : -1e-3) * assembly_.mean_radius();
  LoadPathOptions wanted;
  wanted.control = LoadControl::motion;
  wanted.supports = {support(axis, low, 0.0, held), support(axis, high, motion, held)};
  if (!held) wanted.supports.push_back(support(axis, kept_disc, {}, 0.0));
  const Effects effects = derive_effects(assembly_, springs_, options_.rotation);
  const LoadPath path = make_load_path(assembly_, springs_, effects, wanted);
  const BreakageScene scene{assembly_, springs_, strengths, path};
  BreakableSystem system(breakable_network(scene, effects, wanted.supports, options_.solver));
  if (notch) {
    if (!(*notch > 0))
      bad_input(fmt::format("a notch of {:g} m", *notch), "its length is positive", "Leave it out for none");
    if (!(*notch < width_))
      bad_input(fmt::format("a notch of {:g} m in a sample of {:g} m", *notch, width_), "it would cut it in two",
                "Give a shorter one");
    const Notch line = middle_notch(assembly_, axis, *notch);
    system.remove(contacts_across(assembly_, {&line, 1}));
  }
  BreakageRun run(scene, system);
  double peak = 0;
  bool fallen = false;
  while (!fallen && run.advance()) {
    peak = std::max(peak, run.events().back().load);
    fallen = NetworkResponse::at(run.response().load, run.lambda()) <= options_.fallen_to * peak;
  }
  if (!fallen && run.end() == PathEnd::carries_nothing && run.events().empty())
    bad_input("the sample carries nothing from one end to the other", "it has no strength",
              "Take an assembly that is in one piece, and a notch that leaves some of it");
  const auto sheared = std::ranges::count(run.events(), BreakMode::shear, &BreakEvent::mode);
  return {fallen ? peak / width_ : std::numeric_limits<double>::infinity(), std::ssize(run.events()), sheared,
          run.energy_error()};
}

double notch_toughness(double stress, double notch, double width) {
  const double around = 0.5 * std::numbers::pi * notch;  // pi a
  return stress * std::sqrt(around / std::cos(around / width));
}

}  // namespace equidem
