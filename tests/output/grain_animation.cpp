// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/grain_animation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"

#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

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
    Wall floor, arc;
    floor.move_x = {.kind = Schedule::Kind::sine, .value = 0.1, .frequency = 1};
    arc.shape = Wall::Shape::arc;
    arc.radius = 1, arc.to = 2;
    walls = {floor, arc};
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

/// What follows `const NAME = ` up to the next of the stops.
std::string value_of(const std::string& html, const std::string& name, const std::string& stops) {
  const std::string start = name + " = ";
  const auto from = html.find(start);
  REQUIRE(from != std::string::npos);
  const auto begin = from + start.size();
  return html.substr(begin, html.find_first_of(stops, begin) - begin);
}

/// Of a list the first two.
std::array<double, 2> pair_of(const std::string& html, const std::string& name) {
  const std::string values = value_of(html, name, "]");
  return {std::stod(values.substr(values.rfind('[') + 1)), std::stod(values.substr(values.find(',') + 1))};
}

double number(const std::string& text, std::size_t at) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  const auto high = digits.find(text[at]), low = digits.find(text[at + 1]);
  REQUIRE(high != std::string::npos);
  REQUIRE(low != std::string::npos);
  return static_cast<double>(64 * high + low);
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

bool mentions(const AnimatedScene& scene, const std::string& words) {
  const auto refusal = refusal_of([&] { static_cast<void>(grain_animation_html(scene.animation(""))); });
  INFO(refusal.message);
  CHECK(refusal.kind == ErrorKind::bad_input);
  return refusal.message.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("an_animation_shows_every_body_where_it_is") {
  AnimatedScene scene;
  const double thrown = GENERATE(0.0, 40.0, -40.0);
  scene.frames[3].places[0] += GENERATE(Vec2{0, 1}, Vec2{1, 0}) * thrown;
  const std::string html = grain_animation_html(scene.animation("three bodies"));
  const double span = std::stod(value_of(html, "span", ","));
  const auto [left, bottom] = pair_of(html, "const low");
  std::string frames = html.substr(html.find("const frames"));
  for (const GrainFrame& frame : scene.frames) {
    const auto from = frames.find('\'') + 1;
    const std::string text = frames.substr(from, frames.find('\'', from) - from);
    frames = frames.substr(from + text.size() + 1);
    REQUIRE(text.size() == 6 * scene.grains.size());
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
      CAPTURE(thrown, frame.time, g, span);
      CHECK(left + number(text, 6 * g) / 4095 * span == Approx(frame.places[g].x).margin(0.6 * span / 4095));
      CHECK(bottom + number(text, 6 * g + 2) / 4095 * span == Approx(frame.places[g].y).margin(0.6 * span / 4095));
      const double turned = number(text, 6 * g + 4) / 4096 - frame.angles[g] / (2 * std::numbers::pi);
      CHECK(std::abs(turned - std::round(turned)) < 1.01 / 4096);
    }
  }
}

TEST_CASE("the_view_of_an_animation_holds_its_walls") {
  AnimatedScene scene;
  const double far = GENERATE(0.0, -1e4);  // where on its line a wall is given
  scene.walls[0].point.x = far;
  Wall& arc = scene.walls[1];
  arc.radius = GENERATE(1.0, 6.0);
  arc.to = 3;
  arc.move_y = {.kind = Schedule::Kind::sine, .value = 0.5, .frequency = 2.5};  // at 0.1 s farthest up
  const std::string html = grain_animation_html(scene.animation("three bodies"));
  const auto [left, bottom] = pair_of(html, "const low");
  const auto [width, height] = pair_of(html, "size");
  const auto [from, floor] = pair_of(html, "const walls");
  const std::string rest = value_of(html, "const walls", "]");
  const double to = std::stod(rest.substr(rest.find(',', rest.find(',') + 1) + 1));
  CAPTURE(far, arc.radius, left, bottom, width, height, from, to, floor);
  CHECK(std::max(from, to) > left + width);
  CHECK(std::min(from, to) < left);
  CHECK(floor == 0);
  CHECK(left < arc.radius * std::cos(3.0));
  CHECK(left + width > arc.radius);
  CHECK(bottom + height > arc.radius + 0.5);
  CHECK(width > 0.49 * height);
  CHECK(height > 0.24 * width);
}

TEST_CASE("an_animation_is_one_well_formed_page") {
  const AnimatedScene scene;
  const std::string html = grain_animation_html(scene.animation("a < b & c > d"));
  CHECK(html.starts_with("<!DOCTYPE html>"));
  CHECK(html.ends_with("</html>\n"));
  CHECK(count_of(html, "a &lt; b &amp; c &gt; d") == 2);
  CHECK(count_of(html, "colours &lt; 3") == 1);
  for (const char* tag : {"html", "head", "body", "title", "script", "canvas", "button", "span", "p", "h1", "style"}) {
    CAPTURE(tag);
    const std::string name = tag;
    CHECK(count_of(html, "<" + name + ">") + count_of(html, "<" + name + " ") == count_of(html, "</" + name + ">"));
  }
  CHECK(html.find("http") == std::string::npos);  // nothing from elsewhere
  const std::string script = html.substr(html.find("<script>"), html.find("</script>") - html.find("<script>"));
  for (const auto& [open, close] : {std::pair{"{", "}"}, {"(", ")"}, {"[", "]"}})
    CHECK(count_of(script, open) == count_of(script, close));
  CHECK(script.find("nan") == std::string::npos);
  CHECK(script.find("inf") == std::string::npos);
}

TEST_CASE("what_cannot_be_animated_is_refused") {
  AnimatedScene scene;
  SECTION("no frames") {
    scene.frames.clear();
    CHECK(mentions(scene, "no frames"));
  }
  SECTION("a body is missing") {
    scene.frames[2].places.pop_back();
    CHECK(mentions(scene, "frame 2"));
  }
  SECTION("a place that is no number") {
    scene.frames[1].places[2].y = std::numeric_limits<double>::quiet_NaN();
    CHECK(mentions(scene, "grain 2"));
  }
}
