// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/grain_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/turns.hpp"
#include "equidem/grains/scene/clipped_area.hpp"

namespace equidem {

Clump centred_clump(std::vector<Clump::Disc> discs) {
  if (discs.empty()) bad_input("a clump has no discs", "there is nothing to it", "Give at least one");
  for (const Clump::Disc& disc : discs) {
    if (std::isfinite(disc.offset.x + disc.offset.y) && disc.radius > 0 && std::isfinite(disc.radius)) continue;
    bad_input(fmt::format("a disc of a clump has the radius {} m and is at ({}, {}) m", disc.radius, disc.offset.x,
                          disc.offset.y),
              "it would touch nothing", "Give a radius > 0 and finite numbers");
  }
  for (std::size_t p = 0; p < discs.size(); ++p) {
    for (std::size_t q = 0; q < discs.size(); ++q) {
      // A disc that touches the other from inside adds nothing either, whatever rounding says.
      const double reach = norm(discs[p].offset - discs[q].offset) + discs[p].radius;
      if (p == q || reach > discs[q].radius * (1 + 1e-12)) continue;
      bad_input(fmt::format("disc {} of a clump lies within disc {}", p, q),
                "it adds nothing to the body, and where the two meet others contacts would count twice",
                "Leave it out");
    }
  }
  const Vec2 centre = union_of(discs).centre;
  for (Clump::Disc& disc : discs) disc.offset -= centre;
  return {std::move(discs)};
}

Inertia inertia_of_clump(const Clump& clump, double density) {
  if (!(density > 0 && std::isfinite(density))) {
    bad_input(fmt::format("the density of the clumps is {:.6g} kg/m³", density), "it must be positive and finite",
              "Give a density above 0 kg/m³");
  }
  const DiscUnion all = union_of(clump.discs);
  return {density * all.area, density * all.polar_moment};
}

double radius_of(const Clump& clump) {
  double radius = 0;
  for (const Clump::Disc& disc : clump.discs) radius = std::max(radius, norm(disc.offset) + disc.radius);
  return radius;
}

bool has_shapes(const GrainScene& scene) {
  return std::any_of(scene.grains.begin(), scene.grains.end(),
                     [](const Grain& grain) { return grain.shape() != GrainShape::disc; });
}

std::vector<GrainPart> parts_of(const Grain& grain, const std::vector<Clump>& clumps) {
  switch (grain.shape()) {
    case GrainShape::disc:
      return {{{}, grain.radius, grain.radius, grain.radius}};
    case GrainShape::ellipse:
      return {{{}, grain.radius, grain.short_half_axis, std::sqrt(grain.radius * grain.short_half_axis)}};
    case GrainShape::clump:
      break;
  }
  std::vector<GrainPart> parts;
  for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs) {
    parts.push_back({disc.offset, disc.radius, disc.radius, disc.radius});
  }
  const auto place = [](const GrainPart& part) { return std::tuple(part.offset.x, part.offset.y, part.a); };
  std::sort(parts.begin(), parts.end(), [&](const GrainPart& p, const GrainPart& q) { return place(p) < place(q); });
  return parts;
}

double inscribed_radius(const Grain& grain, std::span<const Clump> clumps) {
  switch (grain.shape()) {
    case GrainShape::clump:
      return std::ranges::min(clumps[static_cast<std::size_t>(grain.clump)].discs, {}, &Clump::Disc::radius).radius;
    case GrainShape::ellipse:
      return grain.short_half_axis;
    case GrainShape::disc:
      break;
  }
  return grain.radius;
}

double smallest_inscribed_radius(const GrainScene& scene) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Grain& grain : scene.grains) smallest = std::min(smallest, inscribed_radius(grain, scene.clumps));
  return smallest;
}

Vec2 axis_of_turns(double turns) {
  return {sine_of_turns(turns + 0.25), sine_of_turns(turns)};
}
Vec2 axis_at(double angle) {
  return axis_of_turns(angle / (2 * std::numbers::pi));
}

namespace {

void check_length(const char* what, double length) {
  if (length > 0 && std::isfinite(length)) return;
  bad_input(fmt::format("the {} {} m is not positive", what, length), "a body has a size", "Give a number > 0");
}

}  // namespace

void GrainShapes::check_body(const char* shape) const {
  if (body_ == Body::disc) return;
  bad_input(fmt::format("{} among spheres", shape),
            "ellipses and clumps are cylinders, their mass is per metre of depth", "Write body = \"disc\" in [grains]");
}

void GrainShapes::make_disc(Grain& grain, double radius, double density) const {
  check_length("radius", radius);
  grain.radius = radius;
  grain.inertia = inertia_of(radius, density, body_);
}

void GrainShapes::make_ellipse(Grain& grain, double long_half_axis, double short_half_axis, double density) const {
  check_body("an ellipse");
  check_length("long half-axis", long_half_axis);
  check_length("short half-axis", short_half_axis);
  if (short_half_axis > long_half_axis) {
    bad_input(
        fmt::format("the short half-axis {} m is longer than the long one, {} m", short_half_axis, long_half_axis),
        "at angle 0 the long one lies along x", "Exchange them, and add a quarter turn (1.5708) to the angle");
  }
  grain.radius = long_half_axis;
  grain.short_half_axis = short_half_axis;
  grain.inertia = inertia_of_ellipse(long_half_axis, short_half_axis, density);
}

void GrainShapes::make_clump(Grain& grain, std::vector<Clump::Disc> discs, double density) {
  check_body("a clump");
  std::vector<std::array<double, 3>> key;
  for (const Clump::Disc& disc : discs) key.push_back({disc.offset.x, disc.offset.y, disc.radius});
  const auto [at, is_new] = known_.try_emplace(std::move(key), static_cast<int>(clumps_.size()));
  if (is_new) {
    constexpr double rounding = 1e-12;
    Clump centred = centred_clump(discs);
    const double shift = norm(centred.discs[0].offset - discs[0].offset);
    if (shift <= rounding * radius_of(centred)) centred.discs = std::move(discs);  // read back: the same bits
    clumps_.push_back(std::move(centred));
    inertias_.push_back(inertia_of_clump(clumps_.back(), 1));
  }
  const auto c = static_cast<std::size_t>(at->second);
  grain.clump = at->second;
  grain.radius = radius_of(clumps_[c]);
  grain.inertia = {density * inertias_[c].mass, density * inertias_[c].moment};
}

}  // namespace equidem
