// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/grain_scene.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/geometry/neighbours.hpp"
#include "equidem/grains/cell/periodic_motion.hpp"
#include "equidem/grains/contacts/bonds.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/grains/scene/wall_joints.hpp"
#include "equidem/grains/servo_walls.hpp"

namespace equidem {
namespace {

/// Tolerance over the radius, for rounding in the placement of clumps.
constexpr double clump_tolerance = 1e-6;

void check_clump(const Clump& clump, const Grain& grain, std::size_t i) {
  check(clump);
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
  const Grain& before = scene.grains[i > 0 ? i - 1 : 0];
  if (i == 0 || !before.present || before.clump != grain.clump || before.radius != grain.radius)
    check_clump(scene.clumps[grain.clump], grain, i);
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
    if (!grain.present || grain.shape() != GrainShape::disc) continue;
    const double factor = grain.inertia.moment / (grain.inertia.mass * grain.radius * grain.radius);
    if (!(std::abs(factor - inertia_factor(Body::sphere)) <= 1e-9)) continue;
    bad_input(fmt::format("grain {} is a sphere (its moment of inertia is 2/5 m r²) among ellipses or clumps", i),
              "the mass of these is per metre of depth", "Give it the inertia of a disc");
  }
}

bool is_behind(const GrainScene& scene, const Grain& grain, const Wall& wall) {
  const Vec2 start = wall.displacement(0);
  const Outline outline = outline_of(grain, scene.clumps);
  for (std::size_t p = 0; p < outline.parts(); ++p) {
    const double distance = nearest(wall, start, grain.position + outline.offset(p)).distance;
    if (!(distance > 0 && std::isfinite(distance))) return true;
  }
  return false;
}

void check_resistance(const PairProperties& pair, NormalLaw law) {
  const bool slides = pair.tangential_ratio > 0, rolls = pair.rolling_friction > 0;
  if (gives_force(law) && pair.friction > 0 && !slides)
    bad_input_at("tangential_ratio", fmt::format("friction {} is given without a tangential spring", pair.friction),
                 fmt::format("contacts by {} stick by one", to_string(law)),
                 "Give tangential_ratio > 0, such as 2/7, or friction = 0");
  if (pair.tangential_damping > 0 && !slides)
    bad_input_at("tangential_damping", "tangential damping is given without a tangential spring",
                 "it is measured by that spring", "Give tangential_ratio > 0");
  if (rolls && !(pair.rolling_ratio > 0))
    bad_input_at("rolling_ratio",
                 fmt::format("rolling friction {} is given without a rolling spring", pair.rolling_friction),
                 "contacts stick by one", "Give rolling_ratio > 0, such as 2/7");
  if (!rolls && (pair.rolling_ratio > 0 || pair.rolling_damping > 0))
    bad_input_at("rolling_friction", "a rolling spring is given without rolling friction", "it would carry nothing",
                 "Give rolling_friction > 0");
  if ((pair.cohesion > 0) != (pair.cohesion_range > 0))
    bad_input_at(
        pair.cohesion > 0 ? "cohesion" : "cohesion_range",
        pair.cohesion > 0 ? "cohesion is given without its range" : "a range of cohesion is given without a force",
        "bodies attract by a force within a gap", "Give cohesion and cohesion_range > 0, the range in m");
  if (!gives_force(law) && (rolls || pair.cohesion > 0))
    bad_input_at(rolls ? "rolling_friction" : "cohesion",
                 fmt::format("{} has no {}", to_string(law), rolls ? "rolling resistance" : "cohesion"),
                 "that law solves a contact by itself, without other forces of it",
                 "Use " + names_of_laws(LawKind::force));
}

namespace {

constexpr Bound<Grain> grain_bounds[] = {{"radius", &Grain::radius, Range::positive(), "m"}};
constexpr Bound<Inertia> inertia_bounds[] = {{"mass", &Inertia::mass, Range::positive()},
                                             {"moment of inertia", &Inertia::moment, Range::positive()}};
constexpr Bound<PairProperties> pair_bounds[] = {
    {"friction", &PairProperties::friction, Range::not_negative()},
    {"tangential_ratio", &PairProperties::tangential_ratio, Range::not_negative()},
    {"tangential_damping", &PairProperties::tangential_damping, Range::not_negative()},
    {"rolling_friction", &PairProperties::rolling_friction, Range::not_negative()},
    {"rolling_ratio", &PairProperties::rolling_ratio, Range::not_negative()},
    {"rolling_damping", &PairProperties::rolling_damping, Range::not_negative()},
    {"cohesion", &PairProperties::cohesion, Range::not_negative()},
    {"cohesion_range", &PairProperties::cohesion_range, Range::not_negative(), "m"}};
constexpr Bound<GrainOptions> option_bounds[] = {
    {"time step", &GrainOptions::time_step, Range::positive(), "s"},
    {"reference length", &GrainOptions::reference_length, Range::not_negative(), "m"},
    {"margin", &GrainOptions::margin, Range::not_negative(), "m"}};
constexpr Bound<GrainBond> bond_bounds[] = {
    {"normal_dashpot", &GrainBond::normal_dashpot, Range::not_negative()},
    {"tangential_dashpot", &GrainBond::tangential_dashpot, Range::not_negative()},
    {"rolling_dashpot", &GrainBond::rolling_dashpot, Range::not_negative()},
    {"normal_spring", &GrainBond::normal_spring, Range::not_negative()},
    {"tangential_spring", &GrainBond::tangential_spring, Range::not_negative()},
    {"bending_spring", &GrainBond::bending_spring, Range::not_negative()}};

void check_grain(const GrainScene& scene, std::size_t i) {
  const Grain& grain = scene.grains[i];
  const auto owner = [i] { return fmt::format(" of grain {}", i); };
  check_bounds(grain, grain_bounds, owner);
  check_bounds(grain.inertia, inertia_bounds, owner);
  constexpr double most = 1e150;
  for (const double number : {grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y,
                              grain.spin * grain.radius, grain.spin, grain.angle}) {
    if (std::abs(number) <= most) continue;
    bad_input(fmt::format("grain {} has a position, a velocity or a spin, a radius or an angle of {}", i, number),
              fmt::format("squares of what is above {:.0e} are no numbers", most), "Give smaller numbers");
  }
  if (grain.kind < 0 || grain.kind >= scene.kinds) {
    bad_input(fmt::format("grain {} is of the kind {}", i, grain.kind),
              fmt::format("the table of pairs has {}", scene.kinds), "Use kinds from 0 to one less than that");
  }
}

void check_pair(const PairProperties& pair, const GrainOptions& options) {
  if ((pair.stiffness != 0) == (pair.dimensionless != 0)) {
    bad_input(
        pair.stiffness != 0 ? "a contact has a stiffness and a dimensionless stiffness" : "a contact has no stiffness",
        "one number says how hard a contact is", "Give one of the two");
  }
  const double hardness = pair.stiffness != 0 ? pair.stiffness : pair.dimensionless;
  check_positive(hardness, "stiffness of a contact");
  describe(options.law).dissipation(pair.restitution, pair.end);
  check_bounds(pair, pair_bounds, [] { return " of a contact"; });
  check_resistance(pair, options.law);
  if (options.ellipse_law == GrainOptions::EllipseLaw::enlarged && (pair.rolling_friction > 0 || pair.cohesion > 0))
    bad_input(fmt::format("{} is given with the contact of enlarged ellipses",
                          pair.rolling_friction > 0 ? "rolling friction" : "cohesion"),
              "that contact knows no gap, and is for comparison alone", "Use the exact contact");
}

/// The range of the law, by a of the lightest bodies of every two kinds.
void check_range(const GrainScene& scene, const GrainOptions& options) {
  const std::vector<KindMasses> masses = masses_of_kinds(scene.grains, scene.kinds);
  const LawDescription& law = describe(options.law);
  const double per_stiffness =
      law.length_factor(reference_length(scene, options)) * options.time_step * options.time_step;
  for (int a = 0; a < scene.kinds; ++a) {
    for (int b = a; b < scene.kinds; ++b) {
      const auto reduced = reduced_masses(masses, a, b);
      if (!reduced) continue;
      const PairProperties& pair = scene.between(a, b);
      law.check_range(pair.stiffness > 0 ? pair.stiffness * per_stiffness / reduced->smallest : pair.dimensionless,
                      pair.restitution);
    }
  }
}

void check_table(const GrainScene& scene, const GrainOptions& options) {
  if (scene.kinds < 1 ||
      scene.pairs.size() != static_cast<std::size_t>(scene.kinds) * static_cast<std::size_t>(scene.kinds)) {
    bad_input(fmt::format("{} pairs are given for {} kinds", scene.pairs.size(), scene.kinds),
              "the table has kinds times kinds", "Give every pair");
  }
  for (int a = 0; a < scene.kinds; ++a) {
    for (int b = 0; b < scene.kinds; ++b) {
      check_pair(scene.between(a, b), options);
      if (!(scene.between(a, b) == scene.between(b, a))) {
        bad_input(fmt::format("kinds {} and {} meet by other rules than {} and {}", a, b, b, a), "action is reaction",
                  "Make the table symmetric");
      }
    }
  }
  check_range(scene, options);
}

[[noreturn]] void refuse_grain(std::size_t grain, const PlaceOfGrain& where, std::string problem, std::string why,
                               std::string remedy) {
  bad_input_at(where ? where(grain) : "", std::move(problem), std::move(why), std::move(remedy));
}

void check_bond(const GrainScene& scene, const GrainBond& bond) {
  for (const std::size_t grain : {bond.i, bond.j}) {
    if (grain >= scene.grains.size()) {
      bad_input(
          fmt::format("a bond ties grain {}", grain),
          fmt::format("there are {}, counted from 0", counted(static_cast<long long>(scene.grains.size()), "grain")),
          "Correct the number");
    }
  }
  if (!scene.ties(bond)) return;
  for (const std::size_t grain : {bond.i, bond.j}) {
    if (scene.grains[grain].shape() == GrainShape::disc) continue;
    bad_input(fmt::format("a bond ties grain {}, which is no disc", grain),
              "bonds lie on the line of the centres of discs",
              "Tie discs only; clumps of discs are rigid without bonds");
  }
  if (bond.i == bond.j) {
    bad_input(fmt::format("a bond ties grain {} to itself", bond.i), "it could not move against itself",
              "Tie two grains");
  }
  check_bounds(bond, bond_bounds, [&] { return fmt::format(" of the bond of grains {} and {}", bond.i, bond.j); });
  if (scene.strengths && !(bond.normal_spring > 0)) {
    bad_input(fmt::format("the bond of grains {} and {} has no normal spring", bond.i, bond.j),
              "it carries the force that breaks a bond", "Give a normal_spring > 0");
  }
  if (std::ranges::all_of(bond_bounds, [&](const Bound<GrainBond>& of) { return bond.*of.member == 0; })) {
    bad_input(fmt::format("the bond of grains {} and {} has neither dashpot nor spring", bond.i, bond.j),
              "it ties nothing", "Give a normal_dashpot and a tangential_dashpot > 0");
  }
  const Grain &i = scene.grains[bond.i], &j = scene.grains[bond.j];
  const double distance = norm(rest_of(scene, bond.i, bond.j).branch);
  if (!bond.rest && !(distance > nearest_centres_of_bonds * (i.radius + j.radius))) {
    bad_input(fmt::format("the centres of the bonded grains {} and {} are {:.3g} m apart", bond.i, bond.j, distance),
              "a bond lies along the line between them", "Move them apart");
  }
  if (bond.rest && !(norm(bond.rest->branch) > nearest_centres_of_bonds * (i.radius + j.radius))) {
    bad_input(
        fmt::format("the bond of grains {} and {} is at rest at {:.3g} m", bond.i, bond.j, norm(bond.rest->branch)),
        "a bond lies along the line between the centres", "Give the branch at rest");
  }
}

}  // namespace

double reference_length(const GrainScene& scene, const GrainOptions& options) {
  if (options.reference_length > 0) return options.reference_length;
  double largest = 0;
  for (const Grain& grain : scene.present()) largest = std::max(largest, grain.radius);
  return 2 * largest;
}

void check(const GrainScene& scene, const GrainOptions& options, const PlaceOfGrain& where) {
  check_properties(scene, options, where);
  check_places(scene, where, {});
  check_bonds(scene, options);
}

void check_places(const GrainScene& scene, const PlaceOfGrain& where, std::span<const std::int32_t> begun) {
  std::vector<Circle> circles;
  std::vector<std::size_t> numbers;
  for (const Grain& grain : scene.present()) {
    circles.push_back({grain.position, grain.radius});
    numbers.push_back(static_cast<std::size_t>(&grain - scene.grains.data()));
  }
  std::optional<Periods> periods;
  if (const auto& cell = scene.cell) {
    periods = periods_of(*cell);
    const Vec2 centre = cell->corner + 0.5 * Vec2{cell->width, cell->height};
    for (Circle& circle : circles) circle.centre += periods->shift(image_inside(*periods, centre, circle.centre));
  }
  for (const CirclePair& pair : pairs_within(circles, periods, 0)) {
    const std::size_t i = numbers[pair.i], j = numbers[pair.j.body];
    if (!begun.empty() && begun[i] >= 0 && begun[j] >= 0) continue;
    const Vec2 branch = circles[pair.j.body].centre + pair.shift - circles[pair.i].centre;
    if (!are_inside_one_another(outline_of(scene.grains[i], scene.clumps), outline_of(scene.grains[j], scene.clumps),
                                branch))
      continue;
    refuse_grain(j, where, fmt::format("grains {} and {} start inside one another", i, j),
                 fmt::format("their centres are {:.4g} m apart, their radii {:.4g} m and {:.4g} m", norm(branch),
                             scene.grains[i].radius, scene.grains[j].radius),
                 "Move them apart");
  }
  for (const std::size_t i : numbers) {
    for (const Wall& wall : scene.walls) {
      if (!is_behind(scene, scene.grains[i], wall)) continue;
      refuse_grain(i, where, fmt::format("grain {} starts behind wall \"{}\" or on it", i, wall.name),
                   "the normal of their contact would be undefined",
                   wall.shape == Wall::Shape::line ? "Move it, or turn the normal of the wall round" : "Move it");
    }
  }
}

void check_properties(const GrainScene& scene, const GrainOptions& options, const PlaceOfGrain& where) {
  if (scene.present().empty()) bad_input("the scene has no grains", "there is nothing to move", "Add a grain");
  check_bounds(options, option_bounds, [] { return ""; });
  check_laws_of_shapes(scene, options);
  if (!gives_force(options.law) && options.verlet()) {
    bad_input(fmt::format("velocity_verlet is asked for with the law \"{}\"", to_string(options.law)),
              "that law makes the step itself", "Leave the scheme out, or use " + names_of_laws(LawKind::force));
  }
  if (!std::isfinite(scene.gravity.x + scene.gravity.y)) {
    bad_input("gravity is not a number", "nothing could fall by it", "Give finite numbers");
  }
  for (std::size_t i = 0; i < scene.grains.size(); ++i) {
    if (!scene.grains[i].present) continue;
    try {
      check_grain(scene, i);
      check_shape(scene, i);
    } catch (const Error& error) {
      throw error.at(where ? where(i) : std::string());
    }
  }
  for (const Wall& wall : scene.walls) {
    check(wall);
    if (wall.kN != 0) {
      bad_input(fmt::format("wall \"{}\" has kN = {} Pa", wall.name, wall.kN),
                "the stiffness of a wall that bodies collide with is that of its kind", "Give it to the pair of kinds");
    }
    if (wall.kind < 0 || wall.kind >= scene.kinds) {
      bad_input(fmt::format("wall \"{}\" is of the kind {}", wall.name, wall.kind),
                fmt::format("the table of pairs has {}", scene.kinds), "Use kinds from 0 to one less than that");
    }
  }
  constexpr double on_one_another = 1e-6;
  const double smallest = smallest_inscribed_radius(scene);
  check_servos(scene, options.law);
  if (const auto twice = coinciding_walls(joined_walls(scene.walls, joint_gap * smallest), on_one_another * smallest)) {
    bad_input(fmt::format("walls \"{}\" and \"{}\" lie on one another", scene.walls[twice->first].name,
                          scene.walls[twice->second].name),
              "a grain would meet both at once, twice as stiff", "Remove one, or let it end where the other begins");
  }
  check_table(scene, options);
  if (scene.cell) check_cell(scene, options);
}

void check_bonds(const GrainScene& scene, const PlaceOfBond& where) {
  if (scene.strengths && scene.strengths->tension.size() != scene.bonds.size()) {
    bad_input(fmt::format("there are strengths of {}", counted(std::ssize(scene.strengths->tension), "bond")),
              fmt::format("the scene has {}", scene.bonds.size()), "Give each bond one");
  }
  const auto place = [&](std::size_t bond) { return where ? where(bond) : std::string(); };
  std::vector<std::size_t> order(scene.bonds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (const std::size_t b : order) {
    try {
      check_bond(scene, scene.bonds[b]);
    } catch (const Error& error) {
      throw error.at(place(b));
    }
  }
  const auto tied = [&](std::size_t b) {
    return std::pair<std::size_t, std::size_t>(std::minmax(scene.bonds[b].i, scene.bonds[b].j));
  };
  std::ranges::stable_sort(order, {}, tied);
  const auto twice = std::ranges::adjacent_find(order, {}, tied);
  if (twice == order.end()) return;
  const auto [i, j] = tied(*twice);
  bad_input_at(place(*std::next(twice)), fmt::format("grains {} and {} are bonded twice", i, j), "one bond ties them",
               "Give the sum of both");
}

}  // namespace equidem
