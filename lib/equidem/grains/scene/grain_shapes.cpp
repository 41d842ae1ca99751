// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/grains/scene/grain_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

Inertia inertia_of_clump(const Clump& clump, double density) {
  check_positive(density, "density of the clumps", "kg/m³");
  const DiscUnion all = union_of(clump.discs);
  return {density * all.area, density * all.polar_moment};
}

bool has_shapes(const GrainScene& scene) {
  return std::ranges::any_of(scene.present(), [](const Grain& grain) { return grain.shape() != GrainShape::disc; });
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
  for (const Clump::Disc& disc : clumps[grain.clump].discs) {
    parts.push_back({disc.offset, disc.radius, disc.radius, disc.radius});
  }
  const auto place = [](const GrainPart& part) { return std::tuple(part.offset.x, part.offset.y, part.a); };
  std::sort(parts.begin(), parts.end(), [&](const GrainPart& p, const GrainPart& q) { return place(p) < place(q); });
  return parts;
}

double smallest_inscribed_radius(const GrainScene& scene) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Grain& grain : scene.present())
    smallest = std::min(smallest, inscribed_radius(outline_of(grain, scene.clumps)));
  return smallest;
}

double clipped_area(std::span<const Grain> grains, std::span<const Clump> clumps, const Rectangle& region) {
  double area = 0;
  for (const Grain& grain : grains) area += clipped_area(outline_of(grain, clumps), grain.position, region);
  return area;
}

void GrainShapes::check_body(const char* shape) const {
  if (body_ == Body::disc) return;
  bad_input(fmt::format("{} among spheres", shape),
            "ellipses and clumps are cylinders, their mass is per metre of depth", "Write body = \"disc\" in [grains]");
}

void GrainShapes::make_disc(Grain& grain, double radius, double density) const {
  check_positive(radius, "radius", "m");
  grain.radius = radius;
  grain.inertia = inertia_of(radius, density, body_);
}

void GrainShapes::make_ellipse(Grain& grain, double long_half_axis, double short_half_axis, double density) const {
  check_body("an ellipse");
  check_positive(long_half_axis, "long half-axis", "m");
  check_positive(short_half_axis, "short half-axis", "m");
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
