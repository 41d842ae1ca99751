// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Ellipses and clumps in files and pictures.
#include "equidem/grains/scene/grain_shapes.hpp"

#include <cmath>
#include <iterator>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/output/pictures/grain_picture.hpp"

#include "output/poly_data_reader.hpp"
#include "output/runs.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;

namespace {

/// A disc, an ellipse, two clumps of one shape and one of another, moving.
struct SampleBodies {
  GrainShapes shapes{Body::disc};
  std::vector<Grain> grains;
  std::vector<std::string> groups;
  std::vector<double> densities;

  SampleBodies() {
    const std::vector<Clump::Disc> pair{{{1, 2}, 0.1}, {{1.15, 2.01}, 0.12}};
    for (int k = 0; k < 5; ++k) {
      Grain& grain = grains.emplace_back();
      grain.position = {1.0 / 3 + k, 0.7 + 0.1 * k};
      grain.velocity = {0.1 * k, -1.0 / 7};
      grain.angle = 0.3 + 1.1 * k;
      grain.spin = 2.5 - k;
      densities.push_back(1000 + 100.0 * k);
      groups.emplace_back(k % 2 == 0 ? "a" : "b");
      if (k == 0) shapes.make_disc(grain, 0.2, densities[0]);
      if (k == 1) shapes.make_ellipse(grain, 0.3, 0.1, densities[1]);
      if (k == 2 || k == 3) shapes.make_clump(grain, pair, densities.back());
      if (k == 4) shapes.make_clump(grain, {{{0, 0}, 0.1}, {{0.1, 0}, 0.1}, {{0.05, 0.1}, 0.1}}, densities[4]);
    }
  }
  [[nodiscard]] WrittenGrains rows() const { return {grains, shapes.clumps(), groups, densities}; }
};

}  // namespace

TEST_CASE("a_table_of_grains_is_read_back_to_the_same_bits") {
  const TemporaryFolder folder;
  const SampleBodies bodies;
  write_grain_csv(folder / "grains.csv", bodies.rows(), false);
  CAPTURE(read_file(folder / "grains.csv"));
  const GrainCase found = parse_grain_case(
      "schema = \"equidem/1\"\n[grains]\npath = \"grains.csv\"\n[collisions]\nrestitution = 0.5\nstiffness = 1e6\n"
      "[run]\nduration = 1.0\n",
      "case.toml", folder.path());
  REQUIRE(found.scene.grains.size() == bodies.grains.size());
  CHECK(found.scene.clumps.size() == 2);
  for (std::size_t g = 0; g < bodies.grains.size(); ++g) {
    CAPTURE(g);
    const Grain &a = bodies.grains[g], &b = found.scene.grains[g];
    CHECK(b.shape() == a.shape());
    CHECK(b.position == a.position);
    CHECK(b.velocity == a.velocity);
    CHECK(b.angle == a.angle);
    CHECK(b.spin == a.spin);
    CHECK(b.radius == a.radius);
    CHECK(b.short_half_axis == a.short_half_axis);
    CHECK(b.inertia.mass == a.inertia.mass);
    CHECK(b.inertia.moment == a.inertia.moment);
    CHECK(found.densities[g] == bodies.densities[g]);
    if (a.shape() != GrainShape::clump) continue;
    const auto &wanted = bodies.shapes.clumps()[static_cast<std::size_t>(a.clump)].discs,
               &discs = found.scene.clumps[static_cast<std::size_t>(b.clump)].discs;
    REQUIRE(discs.size() == wanted.size());
    for (std::size_t d = 0; d < discs.size(); ++d) {
      CHECK(discs[d].offset == wanted[d].offset);
      CHECK(discs[d].radius == wanted[d].radius);
    }
  }
}

TEST_CASE("frames_show_clumps_as_their_discs_and_ellipses_with_both_half_axes") {
  const TemporaryFolder folder;
  SampleBodies bodies;
  const auto& clumps = bodies.shapes.clumps();
  FileMark mark;
  {
    FrameOptions options;
    const Assembly discs = discs_of_frames(bodies.grains, clumps, false, options);
    FrameWriter frames(folder.path(), "frames", discs, options);
    std::vector<DiscMotion> motions, velocities;
    for (const Grain& grain : bodies.grains) {
      motions.push_back({grain.position, grain.angle});
      velocities.push_back({grain.velocity, grain.spin});
    }
    frames.append(0, 0.0, motions, velocities, {});
    for (std::size_t g = 0; g < motions.size(); ++g) motions[g].theta = bodies.grains[g].angle += 0.5;
    frames.append(7, 0.5, motions, velocities, {});
    mark = frames.mark();
    frames.finish();
  }
  auto discs = arrays_of(frames_of(folder / "frames.pvd").back().discs);
  CHECK(discs["body"] == std::vector<double>{0, 1, 2, 2, 3, 3, 4, 4, 4});
  const auto &radius = discs["radius"], &axis = discs["short_half_axis"];
  CHECK(radius[1] == 0.3);
  CHECK(axis[1] == 0.1);
  CHECK(axis[0] == radius[0]);
  CHECK(axis[3] == radius[3]);
  const auto &position = discs["Points"], &velocity = discs["velocity"], &angle = discs["angle"];
  // The second disc of the third body in the second frame: place by the rotation matrix, velocity by differences.
  const Grain& grain = bodies.grains[2];
  const Vec2 offset = clumps[0].discs[1].offset;
  const auto place = [&](double turn) {
    const double c = std::cos(grain.angle + turn), s = std::sin(grain.angle + turn);
    return grain.position + Vec2{c * offset.x - s * offset.y, s * offset.x + c * offset.y};
  };
  const std::size_t at = 3;
  CHECK(position[3 * at] == Approx(place(0).x).epsilon(1e-14));
  CHECK(position[3 * at + 1] == Approx(place(0).y).epsilon(1e-14));
  CHECK(angle[at] == grain.angle);
  const double dt = 1e-6;
  const Vec2 difference = (place(grain.spin * dt) - place(-grain.spin * dt)) / (2 * dt) + grain.velocity;
  CHECK(velocity[3 * at] == Approx(difference.x).epsilon(1e-8));
  CHECK(velocity[3 * at + 1] == Approx(difference.y).epsilon(1e-8));
  // Frames of other shapes cannot be continued.
  SampleBodies other;
  other.grains[1].short_half_axis = 0.11;
  CHECK(equidem::test::refusal_of([&] {
          FrameOptions options{.continue_from = mark};
          const Assembly start = discs_of_frames(other.grains, clumps, false, options);
          FrameWriter(folder.path(), "frames", start, options);
        }).says("discs or frame_contacts are others"));
}

TEST_CASE("pictures_of_clumps_and_ellipses_are_written") {
  const TemporaryFolder folder;
  const SampleBodies bodies;
  write_grain_picture(folder.path(), "shapes", {.grains = bodies.grains, .clumps = bodies.shapes.clumps()}, false);
  const std::string picture = read_file(folder / "shapes.svg");
  CHECK(picture.find("matrix") == std::string::npos);  // no transformation that changes the width of lines
  // one tie to each disc of a clump; no other line has its width
  const std::regex tie("stroke-width[:=]\"?2[;\"]");
  CHECK(std::distance(std::sregex_iterator(picture.begin(), picture.end(), tie), {}) == 2 + 2 + 3);
}
