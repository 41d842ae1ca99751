// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/output/results.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

GrainFrame frame_of(const std::vector<Grain>& grains, double time) {
  GrainFrame frame{.time = time, .places = {}, .angles = {}};
  for (const Grain& grain : grains) {
    frame.places.push_back(grain.position);
    frame.angles.push_back(grain.angle);
  }
  return frame;
}

struct AnimatedScene {
  std::vector<Grain> grains;
  std::vector<Clump> clumps{{{{{-0.1, 0}, 0.1}, {{0.1, 0}, 0.15}}}};
  std::vector<Wall> walls;
  std::vector<int> groups{0, 1, 7};
  std::vector<GrainFrame> frames;

  AnimatedScene() {
    grains.push_back({.position = {0.2, 0.3}, .radius = 0.1, .inertia = {1, 1}});
    grains.push_back({.position = {1.1, 0.4}, .radius = 0.3, .inertia = {1, 1}, .short_half_axis = 0.15});
    grains.push_back({.position = {0.5, 0.9}, .radius = 0.25, .inertia = {1, 1}, .clump = 0});
    Wall floor, plate;
    floor.move_x = {.kind = Schedule::Kind::sine, .value = 0.1, .frequency = 1};
    plate.shape = Wall::Shape::segment;
    plate.point = {-1, 0}, plate.end = {1, 1};
    walls = {floor, plate};
    for (int k = 0; k < 5; ++k) {
      std::vector<Grain> moved = grains;
      for (std::size_t g = 0; g < moved.size(); ++g) {
        moved[g].position += 0.07 * k * Vec2{1, -0.3 * static_cast<double>(g)};
        moved[g].angle = 1.7 * k - 3 * static_cast<double>(g);
      }
      frames.push_back(frame_of(moved, 0.1 * k));
    }
  }

  GrainAnimation animation(const std::string& title) const {
    return {.title = title,
            .caption = "colours < 3",
            .shapes = grains,
            .clumps = clumps,
            .groups = groups,
            .walls = walls,
            .frames = frames};
  }
};

/// Numbers of the data of a page, by path: "frames.0.time".
class Data {
 public:
  explicit Data(const std::string& html) {
    const std::string start = "const data = ", end = ";\n\nconst fills";
    const auto from = html.find(start) + start.size();
    text_ = html.substr(from, html.find(end) - from);
  }
  double operator()(const std::string& path) const {
    const auto value = number_in_json(text_, path);
    INFO(path);
    REQUIRE(value);
    return *value;
  }

 private:
  std::string text_;
};

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

}  // namespace

TEST_CASE("an_animation_shows_every_body_where_it_is") {
  AnimatedScene scene;
  const double thrown = GENERATE(0.0, 40.0, -40.0);
  scene.frames[3].places[0] += GENERATE(Vec2{0, 1}, Vec2{1, 0}) * thrown;
  const Data data(grain_animation_player(scene.animation("three bodies")));
  const double unit = data("unit");
  for (std::size_t f = 0; f < scene.frames.size(); ++f) {
    const GrainFrame& frame = scene.frames[f];
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
      CAPTURE(thrown, frame.time, g, unit);
      const auto body = [&](std::size_t k) { return data(fmt::format("frames.{}.bodies.{}", f, 3 * g + k)); };
      CHECK(data("low.0") + body(0) * unit == Approx(frame.places[g].x).margin(0.6 * unit));
      CHECK(data("low.1") + body(1) * unit == Approx(frame.places[g].y).margin(0.6 * unit));
      const double turned = body(2) / 4096 - frame.angles[g] / (2 * std::numbers::pi);
      CHECK(std::abs(turned - std::round(turned)) < 1.01 / 4096);
    }
  }
}

TEST_CASE("the_view_of_an_animation_holds_its_walls") {
  AnimatedScene scene;
  const double far = GENERATE(0.0, -1e4);  // position along its line of the point that defines a wall
  scene.walls[0].point.x = far;
  Wall& plate = scene.walls[1];
  plate.end = {GENERATE(1.0, 6.0), 6};
  plate.move_y = {.kind = Schedule::Kind::sine, .value = 0.5, .frequency = 2.5};  // highest at 0.1 s
  const Data data(grain_animation_player(scene.animation("three bodies")));
  const double left = data("low.0"), bottom = data("low.1"), width = data("size.0"), height = data("size.1");
  const double from = data("walls.0.0"), floor = data("walls.0.1"), to = data("walls.0.2");
  CAPTURE(far, plate.end.x, left, bottom, width, height, from, to, floor);
  CHECK(std::max(from, to) > left + width);
  CHECK(std::min(from, to) < left);
  CHECK(floor == 0);
  CHECK(left < plate.point.x);
  CHECK(left + width > plate.end.x);
  CHECK(bottom + height > plate.end.y + 0.5);
  CHECK(width > 0.49 * height);
  CHECK(height > 0.24 * width);
}

TEST_CASE("a_player_is_one_well_formed_element") {
  const AnimatedScene scene;
  const std::string html = grain_animation_player(scene.animation("a < b & c > d"));
  CHECK(html.starts_with("<div class=\"player\">"));
  CHECK(html.ends_with("</div>\n"));
  CHECK(count_of(html, "a &lt; b &amp; c &gt; d") == 1);
  CHECK(count_of(html, "colours &lt; 3") == 1);
  for (const char* tag : {"div", "script", "canvas", "button", "span", "p"}) {
    CAPTURE(tag);
    const std::string name = tag;
    CHECK(count_of(html, "<" + name + ">") + count_of(html, "<" + name + " ") == count_of(html, "</" + name + ">"));
  }
  CHECK(html.find("http") == std::string::npos);  // no resource outside the file
  const std::string script = html.substr(html.find("<script>"), html.find("</script>") - html.find("<script>"));
  for (const auto& [open, close] : {std::pair{"{", "}"}, {"(", ")"}, {"[", "]"}})
    CHECK(count_of(script, open) == count_of(script, close));
  CHECK(script.find("nan") == std::string::npos);
  CHECK(script.find("inf") == std::string::npos);
}

TEST_CASE("a_place_that_is_no_number_cannot_be_animated") {
  AnimatedScene scene;
  scene.frames[1].places[2].y = std::numeric_limits<double>::quiet_NaN();
  const auto refusal = refusal_of([&] { static_cast<void>(grain_animation_player(scene.animation(""))); });
  CHECK(refusal.says("grain 2"));
}
