// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/packing/measures.hpp"
#include "equidem/packing/overlaps.hpp"

#include "packing/packings.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;

namespace {

using Kind = PackingShape::Kind;

/// A triangle with one larger disc that overlaps the others, far from the origin.
const std::vector<Clump::Disc> triangle = {{{3, 7}, 1}, {{4.4, 7}, 1}, {{3.7, 8}, 1.3}};

std::vector<PackingShape> shapes() {
  return {{.kind = Kind::ellipse, .aspect = 2},
          {.kind = Kind::ellipse, .aspect = 1},
          {.kind = Kind::bonded_pair},
          {.kind = Kind::rigid_pair},
          {.kind = Kind::clump, .discs = triangle}};
}

PackingOptions box_of(PackingMethod method, PackingBox::Sides sides, const PackingShape& shape, std::int64_t bodies,
                      double solid_fraction) {
  PackingOptions options = square_box(method, sides, bodies, solid_fraction);
  options.shape = shape;
  const double side = std::sqrt(area_of(shape, options.radii) / solid_fraction);
  options.box.size = {side, side};
  return options;
}

double area_of_grains(const GrainPacking& packing) {
  double area = 0;
  for (const Grain& grain : packing.grains) area += area_of(grain, packing.clumps);
  return area;
}

/// Points on the edge of every grain, all along it, that lie in another grain or behind a wall: how deep at most, over
/// the smallest radius. Knows nothing of contacts: an oracle.
double deepest_point(const GrainPacking& packing) {
  const double smallest = *std::min_element(packing.radii.begin(), packing.radii.end());
  const Vec2 size = packing.box.size;
  constexpr int points = 90;
  double deepest = 0;
  const auto depth_in = [&](const Grain& grain, Vec2 way) {
    const Outline outline = outline_of(grain, packing.clumps);
    double depth = 0;
    for (std::size_t p = 0; p < outline.parts(); ++p) {
      const Ellipse e = outline.part(p);
      const Vec2 x = way - outline.offset(p);
      const double u = dot(e.axis, x) / e.a, v = cross(e.axis, x) / e.b;
      depth = std::max(depth, (1 - std::sqrt(u * u + v * v)) * e.b);
    }
    return depth;
  };
  for (std::size_t i = 0; i < packing.grains.size(); ++i) {
    const Grain& grain = packing.grains[i];
    const Outline outline = outline_of(grain, packing.clumps);
    for (std::size_t p = 0; p < outline.parts(); ++p) {
      const Ellipse e = outline.part(p);
      for (int k = 0; k < points; ++k) {
        const Vec2 turn = axis_of_turns(static_cast<double>(k) / points);
        const Vec2 at =
            grain.position + outline.offset(p) + e.a * turn.x * e.axis + e.b * turn.y * perpendicular(e.axis);
        if (!packing.box.periodic()) deepest = std::max({deepest, -at.x, -at.y, at.x - size.x, at.y - size.y});
        for (std::size_t j = 0; j < packing.grains.size(); ++j) {
          if (packing.body_of(i) == packing.body_of(j)) continue;
          Vec2 way = at - packing.grains[j].position;
          if (packing.box.periodic()) {
            way.x -= size.x * std::round(way.x / size.x);
            way.y -= size.y * std::round(way.y / size.y);
          }
          if (std::abs(way.x) < packing.grains[j].radius && std::abs(way.y) < packing.grains[j].radius)
            deepest = std::max(deepest, depth_in(packing.grains[j], way));
        }
      }
    }
  }
  return deepest / smallest;
}

struct ReachedByShapes {
  PackingMethod method;
  double solid_fraction;
};
/// That each method must reach with bodies of 5 to 10 mm.
constexpr ReachedByShapes reached_by_shapes[] = {{PackingMethod::rejection, 0.4},
                                                 {PackingMethod::local_moves, 0.62},
                                                 {PackingMethod::insertion, 0.55},
                                                 {PackingMethod::growth, 0.76}};
constexpr ReachedByShapes reached_by_discs[] = {{PackingMethod::rejection, 0.5},
                                                {PackingMethod::local_moves, 0.72},
                                                {PackingMethod::insertion, 0.66},
                                                {PackingMethod::growth, 0.8}};

}  // namespace

TEST_CASE("every_shape_fills_the_box_by_every_method_without_overlaps") {
  std::vector<PackingShape> all = shapes();
  all.push_back({});
  for (const PackingShape& shape : all) {
    const bool discs = shape.kind == Kind::disc;
    for (const auto& [method, fraction] : discs ? reached_by_discs : reached_by_shapes) {
      for (const auto sides : {PackingBox::Sides::walls, PackingBox::Sides::periodic}) {
        const PackingOptions options = box_of(method, sides, shape, discs ? 400 : 60, fraction);
        const GrainPacking packing = pack(options);
        INFO(to_string(shape.kind) << " of aspect " << shape.aspect << " by " << to_string(method)
                                   << (packing.box.periodic() ? ", periodic" : ", walls"));
        REQUIRE(packing.size() == options.radii.size());
        CHECK(!packing.failure);
        CHECK(area_of_grains(packing) / packing.box.area() == Approx(fraction).epsilon(1e-12));
        const double deepest = deepest_point(packing);
        const PackingMeasures measures = measure(packing);
        CAPTURE(deepest, measures.largest_overlap);
        CHECK(deepest <= options.overlap);
        CHECK(measures.largest_overlap <= options.overlap);
        // Mass is area times density for every shape.
        double mass = 0;
        for (const Grain& grain : packing.grains) mass += grain.inertia.mass;
        CHECK(mass == Approx(options.settling.density * area_of_grains(packing)).epsilon(1e-12));
      }
    }
  }
}

// Once no place at random is free a body comes to lie against two others, or one and a wall.
TEST_CASE("inserted_bodies_of_every_shape_touch_two_others") {
  for (const PackingShape& shape : shapes()) {
    for (const auto sides : {PackingBox::Sides::walls, PackingBox::Sides::periodic}) {
      PackingOptions options = box_of(PackingMethod::insertion, sides, shape, 80, 0.8);
      options.as_dense_as_possible = true;
      options.attempts = 200;
      const GrainPacking packing = pack(options);
      const double near = 1e-7 * *std::min_element(packing.radii.begin(), packing.radii.end());
      std::vector<int> touches(packing.size(), 0);
      for (std::size_t i = 0; i < packing.grains.size(); ++i) {
        const Outline outline = outline_of(packing.grains[i], packing.clumps);
        int& count = touches[packing.body_of(i)];
        if (!packing.box.periodic())
          for_wall_touches(outline, packing.grains[i].position, packing.box, near, [&](int, const Touch&) { ++count; });
        for (std::size_t j = 0; j < packing.grains.size(); ++j) {
          if (packing.body_of(i) == packing.body_of(j)) continue;
          Vec2 way = packing.grains[j].position - packing.grains[i].position;
          if (packing.box.periodic()) {
            way.x -= packing.box.size.x * std::round(way.x / packing.box.size.x);
            way.y -= packing.box.size.y * std::round(way.y / packing.box.size.y);
          }
          for_touches(outline, outline_of(packing.grains[j], packing.clumps), way, near,
                      [&](const Touch&) { ++count; });
        }
      }
      const auto late = touches.begin() + static_cast<std::ptrdiff_t>(packing.size() / 2);
      const auto against_two = std::count_if(late, touches.end(), [](int count) { return count >= 2; });
      CAPTURE(to_string(shape.kind), shape.aspect, packing.box.periodic(), packing.size(), against_two,
              area_of_grains(packing) / packing.box.area(), packing.work);
      CHECK(2 * against_two > touches.end() - late);
    }
  }
}

TEST_CASE("a_seed_gives_the_same_bodies_for_every_number_of_threads_and_points_them_everywhere") {
  const int before = thread_count();
  for (const PackingShape& shape : shapes()) {
    PackingOptions options = box_of(PackingMethod::growth, PackingBox::Sides::periodic, shape, 60, 0.6);
    set_thread_count(1);
    const GrainPacking first = pack(options);
    set_thread_count(3);
    const GrainPacking again = pack(options);
    set_thread_count(before);
    INFO(to_string(shape.kind));
    bool same = true;
    Vec2 mean;
    for (std::size_t k = 0; k < first.grains.size(); ++k) {
      same = same && first.grains[k].position == again.grains[k].position &&
             first.grains[k].angle == again.grains[k].angle;
      mean += axis_of_turns(first.grains[k].angle / std::numbers::pi) / static_cast<double>(first.grains.size());
    }
    CHECK(same);
    // For 60 random directions the mean of (cos 2 theta, sin 2 theta) has the length 60^(-1/2) or so.
    if (shape.kind != Kind::bonded_pair) CHECK(norm(mean) < 4 / std::sqrt(60.0));
    options.seed = 2;
    CHECK(centres_of(first) != centres_of(pack(options)));
  }
}

TEST_CASE("the_gradient_of_the_overlap_energy_is_what_pushes_bodies_apart") {
  // One step of FIRE from rest goes along minus the gradient: compare with differences of the energy.
  const PackingBox box = {{1, 1}, PackingBox::Sides::walls};
  for (const PackingShape& shape : shapes()) {
    const UnitBody body = unit_body_of(shape);
    if (body.lever == 0) continue;
    const Bodies start{{{0.45, 0.5}, {0.62, 0.55}, {0.06, 0.3}}, {0.1, 0.12, 0.09}, {0.1, 0.37, 0.2}};
    const auto energy = [&](const Bodies& bodies) {
      double sum = 0;
      const auto add = [&](const Touch& touch) { sum += 0.5 * touch.overlap * touch.overlap; };
      for (std::size_t i = 0; i < 3; ++i) {
        const Outline one = body.outline(bodies.radii[i], bodies.turns[i]);
        for_wall_touches(one, bodies.centres[i], box, 0, [&](int, const Touch& touch) { add(touch); });
        for (std::size_t j = i + 1; j < 3; ++j)
          for_touches(one, body.outline(bodies.radii[j], bodies.turns[j]), bodies.centres[j] - bodies.centres[i], 0,
                      add);
      }
      return sum;
    };
    Bodies moved = start;
    PairFinder finder;
    push_apart(box, body, {.overlap = 1e-12, .unbalanced = 1e-12, .most = 2}, finder, moved);
    constexpr double h = 1e-6;
    double ratio = 0;
    INFO(to_string(shape.kind));
    REQUIRE(energy(start) > 0);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto slope = [&](const auto& change) {
        Bodies low = start, high = start;
        change(low, -h), change(high, h);
        return -(energy(high) - energy(low)) / (2 * h);
      };
      const double lever = body.lever * start.radii[k];
      const double forces[] = {slope([&](Bodies& b, double d) { b.centres[k].x += d; }),
                               slope([&](Bodies& b, double d) { b.centres[k].y += d; }),
                               slope([&](Bodies& b, double d) { b.turns[k] += d / (2 * std::numbers::pi * lever); })};
      const double ways[] = {moved.centres[k].x - start.centres[k].x, moved.centres[k].y - start.centres[k].y,
                             (moved.turns[k] - start.turns[k]) * 2 * std::numbers::pi * lever};
      if (ratio == 0) ratio = ways[0] / forces[0];
      for (int c = 0; c < 3; ++c) {
        CAPTURE(k, c, forces[c], ways[c]);
        CHECK(ways[c] == Approx(ratio * forces[c]).margin(1e-6 * ratio));
      }
    }
  }
}

TEST_CASE("bodies_that_grow_without_end_jam_denser_than_discs_where_they_are_ellipses") {
  const auto jammed = [](const PackingShape& shape) {
    PackingOptions options = box_of(PackingMethod::growth, PackingBox::Sides::periodic, shape, 120, 0.5);
    options.as_dense_as_possible = true;
    options.overlap = 1e-3;
    return measure(pack(options));
  };
  const PackingMeasures discs = jammed({}), ellipses = jammed({.kind = Kind::ellipse, .aspect = 1.5});
  CAPTURE(discs.solid_fraction, ellipses.solid_fraction, discs.coordination_without_rattlers,
          ellipses.coordination_without_rattlers);
  // Donev et al. (2004), Science 303, 990, and Delaney et al. (2005), Phil. Mag. Lett. 85, 89: densest near 1.4, 0.895.
  CHECK(ellipses.solid_fraction > discs.solid_fraction + 0.02);
  // Between those of discs, four, and of bodies with three unknowns, six.
  CHECK(ellipses.coordination_without_rattlers > 4.6);
  CHECK(ellipses.coordination_without_rattlers < 6.2);
}

TEST_CASE("needles_and_single_bodies_are_packed_and_what_cannot_be_is_refused") {
  const PackingShape needle = {.kind = Kind::ellipse, .aspect = 20};
  const GrainPacking needles = pack(box_of(PackingMethod::growth, PackingBox::Sides::walls, needle, 150, 0.6));
  CHECK(measure(needles).largest_overlap <= 1e-6);
  CHECK(deepest_point(needles) <= 1e-6);
  for (const PackingShape& shape : shapes()) {
    for (const auto method : {PackingMethod::rejection, PackingMethod::local_moves, PackingMethod::growth}) {
      INFO(to_string(shape.kind) << " " << to_string(method));
      CHECK(pack(box_of(method, PackingBox::Sides::walls, shape, 1, 0.2)).size() == 1);
    }
  }
  const auto problem = [](PackingOptions options) {
    const test::Refusal refused = test::refusal_of([&] { pack(options); });
    CHECK(refused.remedy.empty() == refused.message.empty());
    return refused.problem;
  };
  const PackingOptions usual =
      box_of(PackingMethod::growth, PackingBox::Sides::walls, {.kind = Kind::ellipse}, 50, 0.5);
  PackingOptions options = usual;
  options.shape.aspect = 0.5;
  CHECK_THAT(problem(options), Catch::Contains("aspect"));
  options.shape.aspect = 400;
  CHECK_THAT(problem(options), Catch::Contains("the largest ellipse is"));
  options = usual;
  options.shape.kind = Kind::clump;
  CHECK_THAT(problem(options), Catch::Contains("no discs"));
  options.shape.discs = {{{0, 0}, -1}};
  CHECK_THAT(problem(options), Catch::Contains("-1"));
  options = usual;
  options.box.size *= 0.6;
  CHECK_THAT(problem(options), Catch::Contains("times the area"));
  options = usual;
  options.shape.kind = Kind::rigid_pair;
  CHECK_THAT(problem(options), Catch::Contains("times the area"));
  CHECK_THROWS_AS(enum_from<PackingShape::Kind>("elipse"), Error);
}

// Their images across the period are no partners: a body that reached its own would pass through it unseen.
TEST_CASE("no_body_grows_through_its_own_image") {
  for (const PackingShape& shape : shapes()) {
    for (const std::int64_t bodies : {1, 2}) {
      PackingOptions options = box_of(PackingMethod::growth, PackingBox::Sides::periodic, shape, bodies, 0.05);
      options.as_dense_as_possible = true;
      options.overlap = 1e-3;
      INFO(bodies << " of " << to_string(shape.kind) << " of aspect " << shape.aspect);
      try {
        const GrainPacking packing = pack(options);
        CHECK(area_of_grains(packing) < packing.box.area());
        for (const double radius : packing.radii) CHECK(2 * unit_body_of(shape).reach * radius <= packing.box.size.x);
      } catch (const Error& error) {
        CHECK_THAT(error.problem(), Catch::Contains("the largest") && Catch::Contains("grow"));
      }
    }
  }
}

TEST_CASE("ellipses_touch_once_pairs_and_clumps_as_often_as_they_do") {
  GrainPacking packing;
  packing.box = {{10, 10}, PackingBox::Sides::walls};
  // Side by side, along y.
  make_grains({.kind = Kind::ellipse, .aspect = 4}, {{{4, 5}, {5, 5}}, {1, 1}, {0.25, 0.25}}, 1, packing);
  REQUIRE(contacts_of(packing).size() == 1);
  CHECK(contacts_of(packing)[0].overlap == Approx(0).margin(1e-14));
  for (const Kind kind : {Kind::rigid_pair, Kind::bonded_pair}) {
    packing.box.size = {11, 10};
    make_grains({.kind = kind}, {{{4, 5}, {6, 5}, {9, 5}}, {1, 1, 1}, {0.25, 0.75, 0.5}}, 1, packing);
    const PackingMeasures measures = measure(packing, Rectangle{{0, 0}, {11, 10}});
    CHECK(measures.contacts == 2);
    CHECK(measures.wall_contacts == 1);
    CHECK(measures.coordination == Approx(5.0 / 3));
    CHECK(measures.solid_fraction * 110 == Approx(6 * std::numbers::pi).epsilon(1e-12));
  }
}

TEST_CASE("radii_in_ratio_100_do_not_make_placing_slow") {
  const auto placed = [](std::vector<double> radii) {
    PackingOptions options;
    options.method = PackingMethod::rejection;
    options.box = {{1, 1}, PackingBox::Sides::walls};
    options.radii = std::move(radii);
    const std::clock_t begin = std::clock();
    const GrainPacking packing = pack(options);
    CHECK(measure(packing).largest_overlap <= 0);
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  std::vector<double> radii(20000, 0.0005);
  const double alone = placed(radii);
  radii.insert(radii.begin(), 20, 0.05);
  const double beside_large = placed(radii);
  CAPTURE(alone, beside_large);
  CHECK(beside_large < 20 * alone);  // one grid, of the largest disc, takes 30 s
}

TEST_CASE("every_shape_falls_and_comes_to_rest_under_its_weight") {
  std::vector<PackingShape> all = shapes();
  all.push_back({});
  for (const PackingShape& shape : all) {
    if (shape.kind == Kind::bonded_pair || shape.aspect == 1) continue;
    PackingOptions options = shape.kind == Kind::disc ? falling_soil(120, 0.2) : falling_soil(14, 0.1);
    options.shape = shape;
    const GrainPacking packing = pack(options);
    INFO(to_string(shape.kind));
    CHECK(packing.settling.unbalanced <= 1e-6);
    // Springs are compressed by what they carry, but for what dashpots still do, and none pulls or slides beyond its
    // friction.
    double worst = 0, mean = 0;
    for (const GrainContact& contact : packing.contacts) {
      mean += contact.normal_force / static_cast<double>(packing.contacts.size());
      worst = std::max(worst, std::abs(contact.normal_force - options.settling.springs.kN * contact.overlap));
      const double mu = contact.j < 0 ? options.settling.wall_friction : options.settling.friction;
      CHECK(contact.normal_force > 0);
      CHECK(std::abs(contact.tangential_force) <= mu * contact.normal_force * (1 + 1e-9));
    }
    CHECK(worst < 1e-3 * mean);
    double weight = 0, carried = 0, highest = 0;
    for (const Grain& grain : packing.grains) {
      weight += grain.inertia.mass * options.settling.gravity;
      highest = std::max(highest, norm(grain.velocity));
    }
    for (const GrainContact& contact : packing.contacts) {
      if (contact.j >= 0) continue;
      carried -= contact.normal_force * contact.normal.y + contact.tangential_force * contact.normal.x;
    }
    CHECK(carried == Approx(weight).epsilon(1e-5));
    CHECK(highest < 1e-3);
    const PackingMeasures measures = measure(packing);
    // No contact carries more than all bodies weigh.
    const double smallest = *std::min_element(packing.radii.begin(), packing.radii.end());
    const double deepest = weight / (options.settling.springs.kN * smallest);
    CHECK(measures.largest_overlap < deepest);
    // As many contacts as the simulation found.
    CHECK(measures.contacts + measures.wall_contacts == static_cast<std::int64_t>(packing.contacts.size()));
    CHECK(deepest_point(packing) < deepest);
  }
}

TEST_CASE("pairs_tied_by_dashpots_come_to_rest_but_for_the_drift_that_these_allow") {
  PackingOptions options = falling_soil(6, 0.1);
  options.shape.kind = Kind::bonded_pair;
  options.settling.rest = 1e-3;
  const auto drift = [&](double share) {
    options.settling.bond_share = share;
    const GrainPacking packing = pack(options);
    CHECK(packing.grains.size() == 12);
    CHECK(packing.bonds.size() == 6);
    CHECK(packing.settling.unbalanced <= 1e-3);
    double mean = 0;  // of the distance of the centres, over the sum of the radii
    for (const GrainBond& bond : packing.bonds) {
      const Grain &i = packing.grains[bond.i], &j = packing.grains[bond.j];
      mean += std::abs(norm(j.position - i.position) / (i.radius + j.radius) - 1) / 6;
    }
    return mean;
  };
  const double usual = drift(0.5), stiff = drift(20);
  CAPTURE(usual, stiff);
  CHECK(usual > 0);
  CHECK(stiff < usual);
}
