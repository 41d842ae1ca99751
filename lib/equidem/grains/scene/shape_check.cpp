// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/shape_check.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/clipped_area.hpp"
#include "equidem/grains/scene/clump.hpp"
#include "equidem/grains/scene/grain_parts.hpp"

namespace equidem {
namespace {

/// Tolerance over the radius, for rounding in the placement of clumps.
constexpr double clump_tolerance = 1e-6;

void check_clump(const Clump& clump, const Grain& grain, std::size_t i) {
  if (clump.discs.empty()) {
    bad_input(fmt::format("clump {} has no discs", grain.clump), "there is nothing to it", "Give at least one");
  }
  for (const Clump::Disc& disc : clump.discs) {
    if (disc.radius > 0 && std::isfinite(disc.radius) && std::isfinite(disc.offset.x + disc.offset.y)) continue;
    bad_input(fmt::format("clump {} has a disc of the radius {} m at ({}, {}) m", grain.clump, disc.radius,
                          disc.offset.x, disc.offset.y),
              "it would touch nothing", "Give a radius > 0 and finite numbers");
  }
  const double reach = radius_of(clump);
  if (reach > grain.radius * (1 + clump_tolerance)) {
    bad_input(fmt::format("grain {} has the radius {:.6g} m, its clump {} reaches {:.6g} m from the centre of mass", i,
                          grain.radius, grain.clump, reach),
              "the circle of that radius must hold the body", "Give radius_of(clump)");
  }
  const Vec2 centre = union_of(clump.discs).centre;
  if (norm(centre) > clump_tolerance * reach) {
    bad_input(fmt::format("clump {} has its centre of mass at ({:.4g}, {:.4g}) m", grain.clump, centre.x, centre.y),
              "the origin of its frame is the centre of mass", "Use centred_clump(discs), which shifts the discs");
  }
}

/// \param branch from the centre of p to that of q
bool run_through_one_another(const GrainPart& p, Vec2 axis_p, const GrainPart& q, Vec2 axis_q, Vec2 branch) {
  const double skew = cross(axis_p, axis_q);
  if (skew == 0) return false;
  const auto reaches = [](const GrainPart& part, double along) {
    return std::abs(along) < part.a - part.b * part.b / part.a;
  };
  return reaches(p, cross(branch, axis_q) / skew) && reaches(q, cross(branch, axis_p) / skew);
}

}  // namespace

void check_shape(const GrainScene& scene, std::size_t i) {
  const Grain& grain = scene.grains[i];
  if (grain.short_half_axis != 0 && !(grain.short_half_axis > 0 && grain.short_half_axis <= grain.radius)) {
    bad_input(fmt::format("grain {} has the short half-axis {} m and the long one {} m", i, grain.short_half_axis,
                          grain.radius),
              "an ellipse has both above 0, the long one along x at angle 0",
              "Exchange them and add a quarter turn to the angle, or give 0 for a disc");
  }
  if (grain.clump < 0) {
    if (grain.clump == -1) return;
  } else if (grain.short_half_axis > 0) {
    bad_input(fmt::format("grain {} is an ellipse and clump {}", i, grain.clump), "a body has one shape",
              "Leave out one");
  }
  if (grain.clump < 0 || static_cast<std::size_t>(grain.clump) >= scene.clumps.size()) {
    bad_input(fmt::format("grain {} is clump {}", i, grain.clump), fmt::format("the scene has {}", scene.clumps.size()),
              "Use numbers from 0 to one less than that, -1 for no clump");
  }
  // grains of the same clump and radius are checked once
  const bool known = i > 0 && scene.grains[i - 1].clump == grain.clump && scene.grains[i - 1].radius == grain.radius;
  if (!known) check_clump(scene.clumps[static_cast<std::size_t>(grain.clump)], grain, i);
}

void check_laws_of_shapes(const GrainScene& scene, const GrainOptions& options) {
  if (!has_shapes(scene)) return;
  if (!gives_force(options.law)) {
    bad_input(fmt::format("the law \"{}\" is asked for with ellipses or clumps", to_string(options.law)),
              "it solves a contact along the line of two centres, but their contacts turn the bodies as well",
              "Use " + names_of_laws(LawKind::force));
  }
  for (std::size_t i = 0; i < scene.grains.size(); ++i) {
    const Grain& grain = scene.grains[i];
    if (grain.shape() != GrainShape::disc) continue;
    const double factor = grain.inertia.moment / (grain.inertia.mass * grain.radius * grain.radius);
    if (!(std::abs(factor - inertia_factor(Body::sphere)) <= 1e-9)) continue;
    bad_input(fmt::format("grain {} is a sphere (its moment of inertia is 2/5 m r²) among ellipses or clumps", i),
              "the mass of these is per metre of depth", "Give it the inertia of a disc");
  }
}

bool are_inside_one_another(const GrainScene& scene, const Grain& a, const Grain& b) {
  if (a.shape() == GrainShape::disc && b.shape() == GrainShape::disc) {
    return norm(b.position - a.position) < std::max(a.radius, b.radius);
  }
  const Vec2 axis_a = axis_at(a.angle), axis_b = axis_at(b.angle);
  const std::vector<GrainPart> of_a = parts_of(a, scene.clumps), of_b = parts_of(b, scene.clumps);
  return std::any_of(of_a.begin(), of_a.end(), [&](const GrainPart& p) {
    return std::any_of(of_b.begin(), of_b.end(), [&](const GrainPart& q) {
      const Vec2 branch = b.position - a.position + (offset_of(q, axis_b) - offset_of(p, axis_a));
      return holds(p, axis_a, branch) || holds(q, axis_b, branch) ||
             run_through_one_another(p, axis_a, q, axis_b, branch);
    });
  });
}

bool is_behind(const GrainScene& scene, const Grain& grain, const Wall& wall) {
  const Vec2 start = wall.displacement(0);
  const auto is_out = [&](Vec2 centre) {
    const double distance = nearest(wall, start, centre).distance;
    return distance > 0 && std::isfinite(distance);
  };
  if (grain.shape() == GrainShape::disc) return !is_out(grain.position);
  const Vec2 axis = axis_at(grain.angle);
  const std::vector<GrainPart> parts = parts_of(grain, scene.clumps);
  return !std::all_of(parts.begin(), parts.end(),
                      [&](const GrainPart& part) { return is_out(grain.position + offset_of(part, axis)); });
}

}  // namespace equidem
