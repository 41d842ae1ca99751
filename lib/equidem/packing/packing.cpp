// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/packing/packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/inertia.hpp"
#include "equidem/packing/overlaps.hpp"
#include "equidem/packing/size_distribution.hpp"

namespace equidem {

bool grows_to_any_size(const PackingOptions& options) {
  return options.as_dense_as_possible && options.method == PackingMethod::growth;
}

/// \param width of the widest body, m \param least m, that a side of the box needs
[[noreturn]] static void refuse_narrow_box(const PackingOptions& options, const std::string& noun, double width,
                                           double least) {
  constexpr double margin = 1.01, other_unit = 10;  // of the needed side, since radii are drawn; over the side
  const PackingBox& box = options.box;
  const bool open = box.sides == PackingBox::Sides::open_top;
  const double side = open ? box.size.x : std::min(box.size.x, box.size.y);
  bad_input_at(
      "box",
      fmt::format("the largest {} is {:.4g} m wide, the box {:.4g} m by {:.4g} m", noun, width, box.size.x, box.size.y),
      box.periodic() ? "a period holds two of them side by side, so that none meets two images of another"
                     : "it does not fit in",
      width > other_unit * side
          ? std::string("Give all lengths in m: radii or sieves may be in mm")
          : fmt::format("Make {} at least {:.3g} m, by more bodies where the box follows from their number; or take "
                        "smaller bodies",
                        open ? "the width" : "both sides", margin * least));
}

void check(const PackingOptions& options) {
  const bool falls = entry_of(options.method).open_top;
  const UnitBody shape = unit_body_of(options.shape);
  const std::string noun = noun_of(options.shape.kind);
  if (options.radii.empty()) bad_input("there are no bodies to pack", "the box would stay empty", "Give their number");
  const PackingBox& box = options.box;
  if (!is_size(box.size.x) || (!falls && !is_size(box.size.y))) {
    bad_input_at("box", fmt::format("the box is {} m wide and {} m high", box.size.x, box.size.y),
                 "it must have an area that is a number", "Correct it");
  }
  if (falls != (box.sides == PackingBox::Sides::open_top)) {
    bad_input_at("sides",
                 falls ? "bodies fall into a closed box"
                       : fmt::format("{} into a box with an open top", to_string(options.method)),
                 "what falls comes from above, the others need a box to fill",
                 falls ? "Open its top" : "Close the box, or make it periodic");
  }
  double largest = 0;
  for (std::size_t k = 0; k < options.radii.size(); ++k) {
    if (!is_size(options.radii[k])) {
      bad_input_at("radii", fmt::format("{} {} has the radius {} m", noun, k, options.radii[k]),
                   "it must be positive, with an area and a moment of inertia that are numbers", "Correct the sizes");
    }
    largest = std::max(largest, options.radii[k]);
  }
  const double width = 2 * shape.reach * largest, least = box.periodic() ? 2 * width : width;
  if (!grows_to_any_size(options) && least > (falls ? box.size.x : std::min(box.size.x, box.size.y))) {
    refuse_narrow_box(options, noun, width, least);
  }
  const double share = area_of(options.shape, options.radii) / box.area();
  if (!falls && !options.as_dense_as_possible && share >= 1) {
    bad_input_at("box", fmt::format("the {}s have {:.3g} times the area of the box", noun, share),
                 "they leave gaps between them", "Make the box larger, or take fewer of them");
  }
  // Discs of one size cover at most pi/sqrt(12) of a convex region (Thue; Fejes Tóth).
  const double densest = std::numbers::pi / std::sqrt(12.0);
  const bool equal = std::ranges::all_of(options.radii, [&](double radius) { return radius == largest; });
  if (!falls && !options.as_dense_as_possible && options.shape.is_disc() && equal && share > densest) {
    bad_input_at("solid_fraction", fmt::format("discs of one size would have a solid fraction of {:.4g}", share),
                 fmt::format("that of the hexagonal lattice, {:.4f}, is the largest", densest),
                 "Make the box larger, take fewer of them, or radii of several sizes");
  }
  if (!(options.overlap > 0 && options.overlap <= 0.1)) {
    bad_input_at("overlap", fmt::format("the overlap allowed is {} of the smaller radius", options.overlap),
                 "it must be above 0, which nothing reaches, and at most 0.1", "Correct it");
  }
  if (options.attempts < 1)
    bad_input_at("attempts", fmt::format("{} attempts", options.attempts), "one is needed", "Give 1 or more");
}

void make_grains(const PackingShape& shape, const Bodies& bodies, double density, GrainPacking& packing) {
  const UnitBody body = unit_body_of(shape);
  const bool bonded = shape.kind == PackingShape::Kind::bonded_pair;
  packing.shape = shape.kind;
  packing.radii = bodies.radii;
  packing.grains.clear();
  packing.clumps.clear();
  packing.bonds.clear();
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const double r = bodies.radii[k];
    Grain grain;
    grain.position = bodies.centres[k];
    grain.radius = body.reach * r;
    if (!bodies.turns.empty()) grain.angle = 2 * std::numbers::pi * bodies.turns[k];
    if (bonded) {
      const Outline outline = body.outline(r, bodies.turns[k]);
      grain.radius = r;
      grain.inertia = inertia_of(r, density, Body::disc);
      for (std::size_t part = 0; part < 2; ++part) {
        packing.grains.push_back(grain);
        packing.grains.back().position += outline.offset(part);
      }
      packing.bonds.push_back({.i = 2 * k, .j = 2 * k + 1});
      continue;
    }
    if (shape.is_disc()) {
      grain.inertia = inertia_of(r, density, Body::disc);
    } else {
      const double mass = density * body.area * r * r;
      grain.inertia = {mass, mass * body.gyration * r * r};
    }
    if (shape.kind == PackingShape::Kind::ellipse) grain.short_half_axis = body.b * r;
    if (!body.discs.empty()) {
      grain.clump = static_cast<int>(packing.clumps.size());
      packing.clumps.push_back({body.discs});
      for (Clump::Disc& disc : packing.clumps.back().discs) disc = {r * disc.offset, r * disc.radius};
    }
    packing.grains.push_back(grain);
  }
}

std::vector<Wall> walls_of(const PackingBox& box) {
  if (box.periodic()) return {};
  std::vector<Wall> walls = walls_of_box(box.size.x);
  if (box.sides != PackingBox::Sides::open_top)
    walls.push_back({.name = "lid", .point = {0, box.size.y}, .normal = {0, -1}, .kind = 1});
  return walls;
}

GrainPacking try_to_pack(const PackingOptions& options) {
  check(options);
  const Stopwatch watch;
  GrainPacking packing;
  packing.box = options.box;
  entry_of(options.method).fill(options, packing);
  if (packing.failure && packing.grains.empty()) throw *packing.failure;
  packing.seconds = watch.seconds();
  return packing;
}

GrainPacking pack(const PackingOptions& options) {
  GrainPacking packing = try_to_pack(options);
  if (packing.failure) throw *packing.failure;
  return packing;
}

}  // namespace equidem
