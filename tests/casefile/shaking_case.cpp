// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <string>

#include "equidem/casefile/grains/grain_case.hpp"

#include "casefile/grain_example.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

const std::string box = R"(schema = "equidem/1"
[grains]
density = 2500.0
[[grain]]
position = [0.5, 0.1]
radius = 0.1
[collisions]
restitution = 0.8
contact_duration = 1.0e-3
[[wall]]
name = "floor"
point = [0.0, 0.0]
normal = [0.0, 1.0]
[[wall]]
name = "left"
point = [0.0, 0.0]
normal = [1.0, 0.0]
[run]
duration = 2.0
gravity = [0.0, -9.8]
)";

std::string shaking(const std::string& keys) {
  return box + "[shaking]\n" + keys;
}

}  // namespace

TEST_CASE("all_walls_move_alike_with_the_acceleration") {
  const GrainCase resolved =
      grains(shaking("direction = [3.0, 4.0]\nacceleration = 0.4\nfrequency = 5.0\nstart = 0.25\ncycles = 3\n"));
  REQUIRE(resolved.shaking);
  CHECK(resolved.shaking->peak_acceleration == Approx(0.4));
  for (const Wall& wall : resolved.scene.walls) {
    const double t = 0.4, h = 1e-4;
    const auto x = [&](double time) { return wall.displacement(time); };
    const Vec2 a = (x(t + h) - 2 * x(t) + x(t - h)) / (h * h);
    const double wanted = 0.4 * std::cos(2 * 3.141592653589793 * 5 * 0.15);
    CAPTURE(wall.name, a.x, a.y, wanted);
    CHECK(a.x == Approx(0.6 * wanted).margin(1e-4));
    CHECK(a.y == Approx(0.8 * wanted).margin(1e-4));
    CHECK(x(0.25 + 0.6).x == 0);
  }
}

TEST_CASE("a_box_shakes_to_the_end_where_nothing_else_is_said_and_walls_may_stand_still") {
  const GrainCase resolved =
      grains(shaking("acceleration = 4.0\nfrequency = 5.0\nstart = 0.5\n"), {"wall.1.shaken=false"});
  CHECK(resolved.shaking->cycles == 8);
  CHECK(resolved.scene.walls[0].moves());
  CHECK_FALSE(resolved.scene.walls[1].moves());
  CHECK(grains(shaking("acceleration = 4.0\nfrequency = 5.0\nduration = 0.6\n")).shaking->cycles == 3);
  CHECK_FALSE(grains(box).shaking);
}

TEST_CASE("shakings_without_a_meaning_are_refused_with_their_line_and_a_way_out") {
  struct Bad {
    const char* keys;
    const char* word;
  };
  for (const Bad& bad : {
           Bad{"", "acceleration"},
           Bad{"acceleration = 4.0", "frequency"},
           Bad{"acceleration = -4.0\nfrequency = 1.0", "acceleration"},
           Bad{"acceleration = 4.0\nfrequency = 0.0", "frequency"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\nduration = 0.5", "1.5 cycles"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\nduration = 1.0\ncycles = 3", "duration does not apply"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\nstart = 2.5", "the run ends at 2 s"},
           Bad{"acceleration = 4.0\nfrequency = 3.0\ndirection = [0.0, 0.0]", "direction of the shaking is zero"},
       }) {
    const std::string sentence = sentence_of(shaking(bad.keys));
    CAPTURE(bad.keys, sentence);
    CHECK(sentence.find(bad.word) != std::string::npos);
    CHECK(sentence.find("a.toml:") == 0);
  }
  const std::string ok = shaking("acceleration = 4.0\nfrequency = 3.0\n");
  CHECK(sentence_of(ok).empty());
  CHECK(sentence_of(ok, {"wall.0.shaken=false", "wall.1.shaken=false"}).find("no wall that shakes") !=
        std::string::npos);
  const std::string moves = "[[schedule]]\nname = \"up\"\nkind = \"ramp\"\nend = 1.0\n";
  CHECK(sentence_of(ok + moves, {"wall.0.displacement=0.1", "wall.0.schedule=up"}).find("moves by itself") !=
        std::string::npos);
  CHECK(sentence_of(box, {"measures.region=[0.0, 1.0, 1.0, 0.5]"}).find("no area") != std::string::npos);
  CHECK(sentence_of(box, {"grains.body=sphere", "measures.cell=0.2"}).find("spheres") != std::string::npos);
}
