// SPDX-License-Identifier: GPL-3.0-or-later
#include "sukegawa2010/packings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/overlaps.hpp"
#include "equidem/packing/size_distribution.hpp"

#include "sukegawa2010/sukegawa2010.hpp"
#include "text_table.hpp"

namespace equidem::sukegawa2010 {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double dense = 0.8;       // solid fraction that the closed box has with all discs
constexpr double scattered = 0.45;  // at the start of growth
constexpr double moved_fraction = 0.74;

/// Discs of section 8.2 and a box as wide as four fifths of its height when they fill it.
class Ways {
 public:
  explicit Ways(bool quick) : width_(quick ? 0.25 : 0.6) {
    Random random(1);
    radii_ = draw_radii({.smallest = smallest_radius, .largest = largest_radius}, quick ? 200 : 1000, random);
    settling_ = {.density = density,
                 .springs = springs_of_wave_speeds(density, wave_speeds_from_shear(shear_speed, poisson_ratio)),
                 .damping = 1,
                 .gravity = gravity,
                 .friction = friction,
                 .wall_friction = wall_friction};
    if (quick) settling_.springs.kN /= 25, settling_.springs.kT /= 25;
  }

  std::vector<PackedDiscs> all() {
    using enum PackingMethod;
    by_method("rejection", rejection, dense, true);
    by_method("local moves", local_moves, moved_fraction, false);
    by_method("local moves from a grid", local_moves, moved_fraction, false, true);
    by_method("insertion", insertion, dense, true);
    by_method("growth", growth, dense, true);
    grown_then_gravity();
    const GrainPacking fallen = fall();
    relieved(fallen);
    removed(fallen);
    return std::move(rows_);
  }

 private:
  [[nodiscard]] PackingOptions options_of(PackingMethod method, double fraction) const {
    PackingOptions options;
    options.method = method;
    options.radii = radii_;
    options.attempts = 20'000;
    options.settling = settling_;
    options.box.size = {width_, area_of(PackingShape{}, radii_) / (fraction * width_)};
    return options;
  }

  void add(const std::string& way, const GrainPacking& packing, double seconds, std::optional<Region> region = {},
           double moved = unknown) {
    const PackingMeasures measures = measure(packing, region);
    rows_.push_back({.way = way,
                     .discs = static_cast<std::int64_t>(packing.size()),
                     .solid_fraction = measures.solid_fraction,
                     .coordination = measures.coordination,
                     .held = measures.coordination_without_rattlers,
                     .rattlers = static_cast<double>(measures.rattlers) / static_cast<double>(packing.size()),
                     .overlap = measures.largest_overlap,
                     .moved = moved,
                     .seconds = seconds});
  }

  void by_method(const std::string& way, PackingMethod method, double fraction, bool as_dense_as_possible,
                 bool from_grid = false) {
    PackingOptions options = options_of(method, fraction);
    options.as_dense_as_possible = as_dense_as_possible;
    options.from_grid = from_grid;
    const GrainPacking packing = pack(options);
    add(way, packing, packing.seconds);
  }

  /// Mean distance between two states over the mean radius.
  [[nodiscard]] static double distance(const std::vector<Grain>& before, const std::vector<Grain>& after) {
    double way = 0, radii = 0;
    for (std::size_t g = 0; g < before.size(); ++g) {
      way += norm(after[g].position - before[g].position);
      radii += before[g].radius;
    }
    return way / radii;
  }

  /// Under gravity to rest.
  GrainPacking settled(GrainPacking packing) const {
    GrainScene scene = scene_of_box(width_, settling_);
    scene.grains = packing.grains;
    SettledBodies rest = settle(std::move(scene), settling_);
    if (rest.failure) throw *rest.failure;
    packing.grains = std::move(rest.grains);
    packing.box.sides = PackingBox::Sides::open_top;
    packing.box.size.y = 0;
    for (const Grain& grain : packing.grains)
      packing.box.size.y = std::max(packing.box.size.y, grain.position.y + grain.radius);
    return packing;
  }

  void grown_then_gravity() {
    const Stopwatch watch;
    PackingOptions options = options_of(PackingMethod::rejection, dense);
    for (double& radius : options.radii) radius *= std::sqrt(scattered / dense);
    GrainPacking packing = pack(options);
    Bodies bodies{{}, packing.radii, {}};
    for (const Grain& grain : packing.grains) bodies.centres.push_back(grain.position);
    PairFinder finder;
    const UnitBody disc = unit_body_of({});
    const std::vector<double> small = packing.radii;
    for (double fraction = scattered; fraction < dense;) {
      fraction = std::min(dense, fraction + (fraction < 0.7 ? 0.05 : 0.01));
      for (std::size_t k = 0; k < small.size(); ++k) bodies.radii[k] = small[k] * std::sqrt(fraction / scattered);
      push_apart(options.box, disc, {.overlap = fraction < dense ? 1e-2 : 1e-6, .most = 100'000}, finder, bodies);
    }
    make_grains({}, bodies, density, packing);
    const GrainPacking rest = settled(packing);
    add("rejection, growth, gravity", rest, watch.seconds(), {}, distance(packing.grains, rest.grains));
  }

  GrainPacking fall() {
    PackingOptions options = options_of(PackingMethod::falling, dense);
    options.box = {{width_, 0}, PackingBox::Sides::open_top};
    GrainPacking packing = pack(options);
    add("falling", packing, packing.seconds);
    return packing;
  }

  /// Gravity is taken away and what overlaps is pushed apart: for gravity across the plane.
  void relieved(const GrainPacking& fallen) {
    const Stopwatch watch;
    GrainPacking packing = fallen;
    packing.box.sides = PackingBox::Sides::walls;
    Bodies bodies{{}, packing.radii, {}};
    for (const Grain& grain : packing.grains) bodies.centres.push_back(grain.position);
    PairFinder finder;
    push_apart(packing.box, unit_body_of({}), {.most = 100'000}, finder, bodies);
    make_grains({}, bodies, density, packing);
    add("falling, strain relieved", packing, fallen.seconds + watch.seconds(), measured_region(fallen),
        distance(fallen.grains, packing.grains));
  }

  /// All to the right of a line at 60 degrees is taken away; what is left comes to rest again.
  void removed(const GrainPacking& fallen) {
    const Stopwatch watch;
    const double top = fallen.box.size.y, foot = 0.5 * width_ + top / std::tan(std::numbers::pi / 3);
    GrainPacking packing = fallen;
    packing.grains.clear();
    packing.radii.clear();
    for (std::size_t g = 0; g < fallen.grains.size(); ++g) {
      const Grain& grain = fallen.grains[g];
      if (grain.position.x > foot - grain.position.y / std::tan(std::numbers::pi / 3)) continue;
      packing.grains.push_back(grain);
      packing.grains.back().velocity = {};
      packing.grains.back().spin = 0;
      packing.radii.push_back(grain.radius);
    }
    const GrainPacking rest = settled(packing);
    const Region region{{4 * largest_radius, 4 * largest_radius}, {0.4 * width_, 0.5 * top}};
    add("falling, part removed, rest", rest, fallen.seconds + watch.seconds(), region,
        distance(packing.grains, rest.grains));
  }

  double width_;
  std::vector<double> radii_;
  SettlingOptions settling_;
  std::vector<PackedDiscs> rows_;
};

std::string number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

}  // namespace

std::vector<PackedDiscs> pack_every_way(bool quick) {
  return Ways(quick).all();
}

std::string report_of(const std::vector<PackedDiscs>& packings) {
  if (packings.empty()) return "";
  TextTable table(" & discs & solid fraction & contacts & without rattlers & rattlers & overlap & moved & seconds");
  for (const PackedDiscs& packed : packings) {
    table.add("{} & {} & {:.4f} & {:.2f} & {} & {:.1f} % & {:.1e} & {} & {:.2f}", packed.way, packed.discs,
              packed.solid_fraction, packed.coordination, packed.held > 0 ? number(packed.held, 2) : "-",
              100 * packed.rattlers, packed.overlap, number(packed.moved, 3), packed.seconds);
  }
  return fmt::format(
             "Packings of section 2.7 of the same discs: solid fraction away from the walls, contacts per disc, the "
             "largest overlap\nover the smaller radius; of a pipeline the mean motion in its last stage over the mean "
             "radius, and the time of all stages.\nThe closed box holds all discs at {:g}; rejection and insertion "
             "leave out what finds no place in it, growth scales the radii\nuntil the discs jam, local moves end at "
             "{:g}. Under gravity: the springs, dashpots and friction of section 8.2.\n",
             dense, moved_fraction) +
         table.text() +
         "Relieved of its strain, the fallen heap keeps its density, and its discs only just touch: none is held. "
         "Where a "
         "part of it is\nremoved at 60 degrees, the rest slides to a new slope.\n";
}

}  // namespace equidem::sukegawa2010
