// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/grain_animation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr double tallest = 1.4;  // of the view, in its widths

struct View {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  [[nodiscard]] double span() const { return std::max(high.x - low.x, high.y - low.y); }
};

View view_of(const GrainAnimation& animation) {
  View view;
  for (const GrainFrame& frame : animation.frames) {
    for (std::size_t g = 0; g < frame.places.size(); ++g) {
      const Vec2 x = frame.places[g];
      if (!std::isfinite(x.x + x.y + frame.angles[g]))
        bad_input(format("grain {} at ({}, {}) cannot be drawn", g, x.x, x.y), "its place is not finite",
                  "Check the run that it comes from");
      const double r = animation.shapes[g].radius;
      view.low = {std::min(view.low.x, x.x - r), std::min(view.low.y, x.y - r)};
      view.high = {std::max(view.high.x, x.x + r), std::max(view.high.y, x.y + r)};
    }
  }
  const double edge = 0.03 * view.span();
  view.low -= Vec2{edge, edge};
  view.high += Vec2{edge, edge};
  view.high.y = std::min(view.high.y, view.low.y + tallest * (view.high.x - view.low.x));
  return view;
}

/// Two digits of base 64.
void append(std::string& text, double share) {
  const auto value = static_cast<std::uint32_t>(std::clamp(std::round(share * 4095), 0.0, 4095.0));
  text += digits[value / 64];
  text += digits[value % 64];
}

std::string encoded(const GrainFrame& frame, const View& view) {
  std::string text;
  text.reserve(6 * frame.places.size());
  for (std::size_t g = 0; g < frame.places.size(); ++g) {
    append(text, (frame.places[g].x - view.low.x) / view.span());
    append(text, (frame.places[g].y - view.low.y) / view.span());
    const double turns = frame.angles[g] / (2 * std::numbers::pi);
    append(text, (turns - std::floor(turns)) * 4096 / 4095);
  }
  return text;
}

std::string list(const std::vector<double>& values, int figures) {
  std::string text = "[";
  for (const double value : values) text += format("{}{:.{}g}", text.size() > 1 ? "," : "", value, figures);
  return text + "]";
}

/// Parts of each body: x, y, a, b in its frame.
std::string parts_of(const GrainAnimation& animation) {
  std::string text = "[";
  for (const Grain& grain : animation.shapes) {
    std::vector<double> values;
    if (grain.clump >= 0) {
      for (const Clump::Disc& disc : animation.clumps[static_cast<std::size_t>(grain.clump)].discs)
        values.insert(values.end(), {disc.offset.x, disc.offset.y, disc.radius, disc.radius});
    } else {
      values = {0, 0, grain.radius, grain.short_half_axis > 0 ? grain.short_half_axis : grain.radius};
    }
    text += (text.size() > 1 ? "," : "") + list(values, 4);
  }
  return text + "]";
}

/// A wall as a line of points where it stands at first.
std::vector<double> outline_of(const GrainWall& wall, double far) {
  if (wall.shape == GrainWall::Shape::segment) return {wall.point.x, wall.point.y, wall.end.x, wall.end.y};
  if (wall.shape == GrainWall::Shape::line) {
    const Vec2 along = far * perpendicular(wall.normal), a = wall.point - along, b = wall.point + along;
    return {a.x, a.y, b.x, b.y};
  }
  std::vector<double> points;
  constexpr int pieces = 90;
  for (int k = 0; k <= pieces; ++k) {
    const double angle = wall.from + (wall.to - wall.from) * k / pieces;
    points.push_back(wall.point.x + wall.radius * std::cos(angle));
    points.push_back(wall.point.y + wall.radius * std::sin(angle));
  }
  return points;
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

constexpr const char* script = R"(
const digits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_';
const value = {};
for (let k = 0; k < 64; ++k) value[digits[k]] = k;
const fills = ['#add4ed', '#f7d494', '#a8dec7', '#f0b899', '#e6c2d9', '#f7f0a6'];
const inks = ['#0073b3', '#bf8000', '#00805e', '#b34d00', '#a65985', '#8c8500'];
const canvas = document.getElementById('view'), draw = canvas.getContext('2d');
const slider = document.getElementById('at'), button = document.getElementById('play'), clock = document.getElementById('time');
const scale = canvas.width / size[0];
slider.max = times.length - 1;
function number(text, at) { return (64 * value[text[at]] + value[text[at + 1]]); }
function show(f) {
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.clearRect(0, 0, canvas.width, canvas.height);
  draw.setTransform(scale, 0, 0, -scale, 0, canvas.height);
  draw.lineWidth = 0.8 / scale;
  const text = frames[f];
  for (let g = 0; g < parts.length; ++g) {
    const x = number(text, 6 * g) / 4095 * span, y = number(text, 6 * g + 2) / 4095 * span;
    const angle = number(text, 6 * g + 4) / 4096 * 2 * Math.PI, body = parts[g];
    draw.save();
    draw.translate(x, y);
    draw.rotate(angle);
    draw.fillStyle = fills[groups[g] % 6];
    draw.strokeStyle = inks[groups[g] % 6];
    for (let p = 0; p < body.length; p += 4) {
      draw.beginPath();
      draw.ellipse(body[p], body[p + 1], body[p + 2], body[p + 3], 0, 0, 2 * Math.PI);
      draw.fill();
      draw.stroke();
    }
    draw.beginPath();
    draw.moveTo(body[0], body[1]);
    draw.lineTo(body[0] + body[2], body[1]);
    draw.stroke();
    draw.restore();
  }
  draw.strokeStyle = '#404047';
  draw.lineWidth = 2 / scale;
  for (let w = 0; w < walls.length; ++w) {
    draw.beginPath();
    for (let p = 0; p < walls[w].length; p += 2)
      draw.lineTo(walls[w][p] - low[0] + moves[f][2 * w], walls[w][p + 1] - low[1] + moves[f][2 * w + 1]);
    draw.stroke();
  }
  slider.value = f;
  clock.textContent = times[f].toFixed(2) + ' s';
}
let playing = true, since = performance.now(), from = 0, shown = -1;
function go(now) {
  if (playing) {
    const length = times[times.length - 1] - times[0];
    let t = from + (now - since) / 1000 * speed;
    if (t > length + 1) { from = 0; since = now; t = 0; }
    let f = 0;
    while (f + 1 < times.length && times[f + 1] - times[0] <= t) ++f;
    if (f !== shown) show(shown = f);
  }
  requestAnimationFrame(go);
}
button.onclick = () => {
  playing = !playing;
  button.textContent = playing ? 'pause' : 'play';
  from = times[slider.value] - times[0];
  since = performance.now();
};
slider.oninput = () => {
  playing = false;
  button.textContent = 'play';
  show(shown = Number(slider.value));
};
requestAnimationFrame(go);
)";

void check(const GrainAnimation& animation) {
  if (animation.shapes.empty() || animation.frames.empty())
    bad_input("the animation would be empty", animation.shapes.empty() ? "there are no grains" : "there are no frames",
              "Give some");
  for (std::size_t f = 0; f < animation.frames.size(); ++f) {
    const GrainFrame& frame = animation.frames[f];
    if (frame.places.size() != animation.shapes.size() || frame.angles.size() != animation.shapes.size())
      bad_input(format("frame {} holds {}", f, counted(std::ssize(frame.places), "grain")),
                format("the animation is of {}", animation.shapes.size()), "Give all of them in each frame");
  }
}

}  // namespace

GrainFrame frame_of(std::span<const Grain> grains, double time) {
  GrainFrame frame{.time = time, .places = {}, .angles = {}};
  for (const Grain& grain : grains) {
    frame.places.push_back(grain.position);
    frame.angles.push_back(grain.angle);
  }
  return frame;
}

std::string grain_animation_html(const GrainAnimation& animation) {
  check(animation);
  const View view = view_of(animation);
  const Vec2 size = view.high - view.low;
  constexpr double pixels = 900;
  const std::string title = escaped(animation.title);
  std::string text = format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>\n"
      "body {{ font-family: sans-serif; margin: 1em; }}\ncanvas {{ max-width: 100%; }}\n</style>\n</head>\n<body>\n"
      "<h1>{0}</h1>\n<canvas id=\"view\" width=\"{1:.0f}\" height=\"{2:.0f}\"></canvas>\n"
      "<p><button id=\"play\">pause</button> <input id=\"at\" type=\"range\" min=\"0\" value=\"0\"> "
      "<span id=\"time\"></span></p>\n<script>\n",
      title, pixels, pixels * size.y / size.x);
  text += format("const low = {}, size = {}, span = {:.6g}, speed = {:g};\n", list({view.low.x, view.low.y}, 6),
                 list({size.x, size.y}, 6), view.span(), animation.speed);
  text += "const parts = " + parts_of(animation) + ";\n";
  std::vector<double> groups(animation.groups.begin(), animation.groups.end()), times;
  groups.resize(animation.shapes.size(), 0);
  text += "const groups = " + list(groups, 3) + ";\n";
  std::string walls, moves, frames;
  for (const GrainWall& wall : animation.walls)
    walls += (walls.empty() ? "" : ",") + list(outline_of(wall, 4 * view.span()), 6);
  for (const GrainFrame& frame : animation.frames) {
    times.push_back(frame.time);
    std::vector<double> moved;
    for (const GrainWall& wall : animation.walls) {
      moved.push_back(wall.move_x.at(frame.time));
      moved.push_back(wall.move_y.at(frame.time));
    }
    moves += (moves.empty() ? "" : ",") + list(moved, 5);
    frames += (frames.empty() ? "'" : ",\n'") + encoded(frame, view) + "'";
  }
  text += "const walls = [" + walls + "];\nconst times = " + list(times, 6) + ";\nconst moves = [" + moves +
          "];\nconst frames = [\n" + frames + "];";
  return text + script + "</script>\n</body>\n</html>\n";
}

void write_grain_animation(const std::filesystem::path& path, const GrainAnimation& animation, bool overwrite) {
  write_file(path, grain_animation_html(animation), overwrite);
}

}  // namespace equidem
