// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/fields/box_measures.hpp"
#include "equidem/packing/measures.hpp"

#include "sukegawa2010/packings.hpp"
#include "sukegawa2010/sukegawa2010.hpp"
#include "text_table.hpp"

namespace equidem::sukegawa2010 {
namespace {

constexpr double longest_time = 2;   // s
constexpr double noticeable = 0.01;  // overlap, over the radius

/// Overlaps by the exact contact, whatever test the motion had.
void measure_overlaps(const std::vector<Grain>& grains, double width, FallenEllipses& box) {
  GrainPacking packing;
  packing.shape = Shape::ellipse;
  packing.grains = grains;
  packing.box = {{width, 1}, PackingBox::Sides::open_top};
  double solid = 0;
  for (const Grain& grain : grains) {
    packing.radii.push_back(std::sqrt(grain.radius * grain.short_half_axis));
    solid += std::numbers::pi * squared(packing.radii.back());
  }
  std::int64_t pairs = 0;
  for (const PackingContact& contact : contacts_of(packing)) {
    if (contact.j < 0) continue;
    const double smaller = std::min(packing.radii[static_cast<std::size_t>(contact.i)],
                                    packing.radii[static_cast<std::size_t>(contact.j)]);
    box.overlap = std::max(box.overlap, contact.overlap / smaller);
    if (contact.overlap > noticeable * smaller) ++pairs;
  }
  box.overlapping = static_cast<double>(pairs) / static_cast<double>(grains.size());
  const auto columns = static_cast<std::size_t>(std::max(2.0, width / (4 * largest_radius)));
  box.void_ratio = width * shape_of(surface_of(grains, {}, 0, width, columns)).height / solid - 1;
}

FallenEllipses drop(const Fill& fill) {
  const GrainScene scene = start_of(fill);
  FallenEllipses box{.law = fill.ellipse_law, .ellipses = scene.grains.size()};
  double weight = 0;
  for (const Grain& grain : scene.grains) weight += grain.inertia.mass * gravity;
  const Stopwatch watch;
  GrainSimulation simulation(scene, options_of(scene, fill));
  try {
    while (simulation.time() < longest_time && !box.at_rest) {
      simulation.advance(200);
      box.at_rest = simulation.time() > 0.5 && simulation.energy().kinetic < 1e-6 * weight * smallest_radius;
    }
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::computation_failed) throw;
    box.stopped = error.problem();
  }
  box.time = simulation.time();
  box.seconds = watch.seconds();
  measure_overlaps(simulation.grains(), fill.grid.width(), box);
  return box;
}

}  // namespace

std::vector<FallenEllipses> drop_ellipses(bool quick) {
  std::vector<FallenEllipses> boxes;
  const StartGrid grid = quick ? StartGrid{.columns = 6, .rows = 8} : StartGrid{.columns = 10, .rows = 20};
  for (const EllipseLaw law : {EllipseLaw::exact, EllipseLaw::enlarged_mended, EllipseLaw::enlarged_as_printed})
    boxes.push_back(drop({.shape = Shape::ellipse, .grid = grid, .softness = 25, .ellipse_law = law}));
  return boxes;
}

std::string report_of(const std::vector<FallenEllipses>& boxes) {
  if (boxes.empty()) return "";
  TextTable table(" & at rest & time, s & void ratio & largest overlap & pairs above 0.01 & seconds");
  std::string reasons;
  for (const FallenEllipses& box : boxes) {
    const char* name = box.law == EllipseLaw::exact             ? "exact contacts"
                       : box.law == EllipseLaw::enlarged_mended ? "(4.1)-(4.49) corrected"
                                                                : "(4.1)-(4.49) as printed";
    table.add("{} & {} & {:.3f} & {:.4f} & {:.2g} & {:.2f} & {:.1f}", name, box.at_rest ? "yes" : "no", box.time,
              box.void_ratio, box.overlap, box.overlapping, box.seconds);
    if (!box.stopped.empty()) reasons += fmt::format("  {}: {}\n", name, box.stopped);
  }
  return fmt::format(
             "Contact tests of ellipses in a box: {} ellipses with springs 25 times softer fall for at most {:g} s. "
             "Overlaps are those\nof the exact contact, over the radius of the disc of the same area; pairs that "
             "overlap by more than 0.01, per ellipse;\nthe void ratio over the whole width.\n",
             boxes.front().ellipses, longest_time) +
         table.text() + reasons;
}

}  // namespace equidem::sukegawa2010
