// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/grain_animation.hpp"

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
  std::vector<GrainWall> walls;
  std::vector<int> groups{0, 1, 7};
  std::vector<GrainFrame> frames;

  AnimatedScene() {
    grains.push_back({.position = {0.2, 0.3}, .radius = 0.1, .inertia = {1, 1}});
    grains.push_back({.position = {1.1, 0.4}, .radius = 0.3, .inertia = {1, 1}, .short_half_axis = 0.15});
    grains.push_back({.position = {0.5, 0.9}, .radius = 0.25, .inertia = {1, 1}, .clump = 0});
    GrainWall floor, arc;
    floor.move_x = {.kind = Schedule::Kind::sine, .value = 0.1, .frequency = 1};
    arc.shape = GrainWall::Shape::arc;
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
    return {.title = title, .shapes = grains, .clumps = clumps, .groups = groups, .walls = walls, .frames = frames};
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
  const AnimatedScene scene;
  const std::string html = grain_animation_html(scene.animation("three bodies"));
  const double span = std::stod(value_of(html, "span", ","));
  const std::string low = value_of(html, "const low", "]");
  const double left = std::stod(low.substr(1)), bottom = std::stod(low.substr(low.find(',') + 1));
  std::string frames = html.substr(html.find("const frames"));
  for (const GrainFrame& frame : scene.frames) {
    const auto from = frames.find('\'') + 1;
    const std::string text = frames.substr(from, frames.find('\'', from) - from);
    frames = frames.substr(from + text.size() + 1);
    REQUIRE(text.size() == 6 * scene.grains.size());
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
      CAPTURE(frame.time, g, span);
      CHECK(left + number(text, 6 * g) / 4095 * span == Approx(frame.places[g].x).margin(0.6 * span / 4095));
      CHECK(bottom + number(text, 6 * g + 2) / 4095 * span == Approx(frame.places[g].y).margin(0.6 * span / 4095));
      const double turned = number(text, 6 * g + 4) / 4096 - frame.angles[g] / (2 * std::numbers::pi);
      CHECK(std::abs(turned - std::round(turned)) < 1.01 / 4096);
    }
  }
}

TEST_CASE("an_animation_is_one_well_formed_page") {
  const AnimatedScene scene;
  const std::string html = grain_animation_html(scene.animation("a < b & c > d"));
  CHECK(html.starts_with("<!DOCTYPE html>"));
  CHECK(html.ends_with("</html>\n"));
  CHECK(count_of(html, "a &lt; b &amp; c &gt; d") == 2);
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
