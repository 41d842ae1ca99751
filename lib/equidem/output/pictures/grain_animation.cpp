// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/grain_animation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/pictures/colour_map.hpp"

namespace equidem {
namespace {

constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr double page_width = 900, page_height = 1260, bar_room = 48;  // pixels

struct View {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  void include(Vec2 centre, double radius) {
    low = {std::min(low.x, centre.x - radius), std::min(low.y, centre.y - radius)};
    high = {std::max(high.x, centre.x + radius), std::max(high.y, centre.y + radius)};
  }
  [[nodiscard]] double span() const { return std::max(high.x - low.x, high.y - low.y); }
};

Vec2 displacement(const Wall& wall, double time) {
  return wall.displacement(time);
}

/// A segment or an arc as a line of points, where it stands at first.
std::vector<Vec2> outline_of(const Wall& wall) {
  if (wall.shape == Wall::Shape::segment) return {wall.point, wall.end};
  std::vector<Vec2> points;
  constexpr int pieces = 90;
  for (int k = 0; k <= pieces; ++k) {
    const double angle = wall.from + (wall.to - wall.from) * k / pieces;
    points.push_back(wall.point + wall.radius * Vec2{std::cos(angle), std::sin(angle)});
  }
  return points;
}

/// All bodies, segments and arcs of all frames.
View view_of(const GrainAnimation& animation) {
  View view;
  for (const GrainFrame& frame : animation.frames) {
    for (std::size_t g = 0; g < frame.places.size(); ++g) {
      const Vec2 x = frame.places[g];
      if (!std::isfinite(x.x + x.y + frame.angles[g]))
        bad_input(fmt::format("grain {} at ({}, {}) cannot be drawn", g, x.x, x.y), "its place is not finite",
                  "Check the run that it comes from");
      view.include(x, animation.shapes[g].radius);
    }
    for (const Wall& wall : animation.walls) {
      if (wall.shape == Wall::Shape::line) continue;
      for (const Vec2 point : outline_of(wall)) view.include(point + displacement(wall, frame.time), 0);
    }
  }
  const double edge = 0.03 * view.span();
  view.low -= Vec2{edge, edge};
  view.high += Vec2{edge, edge};
  // One body that falls is no reason for a strip, one that slides for a line.
  const Vec2 size = view.high - view.low;
  const Vec2 missing{std::max(0.0, 0.5 * size.y - size.x), std::max(0.0, 0.25 * size.x - size.y)};
  view.low -= 0.5 * missing;
  view.high += 0.5 * missing;
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
  for (const double value : values) text += fmt::format("{}{:.{}g}", text.size() > 1 ? "," : "", value, figures);
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

/// The piece of a line within the view, longer if the line moves.
std::string wall_points(const Wall& wall, const View& view) {
  std::vector<Vec2> points;
  if (wall.shape == Wall::Shape::line) {
    const Vec2 along = perpendicular(wall.normal), middle = 0.5 * (view.low + view.high);
    const Vec2 foot = wall.point + dot(middle - wall.point, along) * along;
    points = {foot - 4 * view.span() * along, foot + 4 * view.span() * along};
  } else {
    points = outline_of(wall);
  }
  std::vector<double> values;
  for (const Vec2& point : points) values.insert(values.end(), {point.x, point.y});
  return list(values, 6);
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

/// The page fits the window; the picture gives way.
constexpr const char* page_start = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{0}</title>
<style>
body {{ font-family: sans-serif; margin: 0; padding: 0.8em; height: 100vh; box-sizing: border-box; display: flex;
  flex-direction: column; }}
h1 {{ font-size: 1.3em; margin: 0 0 0.4em; }}
p {{ margin: 0.4em 0 0; }}
input {{ width: 40%; vertical-align: middle; }}
canvas {{ max-width: 100%; min-height: 15em; object-fit: contain; object-position: left top; align-self: flex-start; }}
</style>
</head>
<body>
<h1>{0}</h1>
<canvas id="view" width="{2:.0f}" height="{3:.0f}"></canvas>
<p><button id="play">pause</button> <input id="at" type="range" min="0" value="0"> <span id="time"></span>{4}</p>
<p>{1}</p>
<script>
)";

constexpr const char* script = R"(
const digits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_';
const value = {};
for (let k = 0; k < 64; ++k) value[digits[k]] = k;
const fills = ['#add4ed', '#f7d494', '#a8dec7', '#f0b899', '#e6c2d9', '#f7f0a6'];
const inks = ['#0073b3', '#bf8000', '#00805e', '#b34d00', '#a65985', '#8c8500'];
const canvas = document.getElementById('view'), draw = canvas.getContext('2d');
const slider = document.getElementById('at'), button = document.getElementById('play');
const clock = document.getElementById('time');
const scale = canvas.width / size[0], floor = canvas.height - room, length = times[times.length - 1] - times[0];
const decimals = Math.min(9, Math.max(0, 2 - Math.floor(Math.log10(length || 1))));
const shapes = parts.map(body => {
  const shape = new Path2D();
  for (let p = 0; p < body.length; p += 4) {
    shape.moveTo(body[p] + body[p + 2], body[p + 1]);
    shape.ellipse(body[p], body[p + 1], body[p + 2], body[p + 3], 0, 0, 2 * Math.PI);
  }
  return shape;
});
slider.max = times.length - 1;
function number(text, at) { return (64 * value[text[at]] + value[text[at + 1]]); }
function show(f) {
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.clearRect(0, 0, canvas.width, canvas.height);
  draw.setTransform(scale, 0, 0, -scale, 0, floor);
  const text = frames[f];
  for (let g = 0; g < parts.length; ++g) {
    const x = number(text, 6 * g) / 4095 * span, y = number(text, 6 * g + 2) / 4095 * span;
    const angle = number(text, 6 * g + 4) / 4096 * 2 * Math.PI, body = parts[g];
    draw.save();
    draw.translate(x, y);
    draw.rotate(angle);
    draw.fillStyle = fills[groups[g] % 6];
    draw.strokeStyle = inks[groups[g] % 6];
    draw.lineWidth = 1.6 / scale;  // the fill covers its inner half and the edges between discs of one body
    draw.stroke(shapes[g]);
    draw.fill(shapes[g]);
    draw.lineWidth = 0.8 / scale;
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
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.clearRect(0, floor, canvas.width, room);
  draw.lineWidth = 1.5;
  draw.beginPath();
  for (const [x, y] of [[0, -5], [0, 5], [0, 0], [bar * scale, 0], [bar * scale, -5], [bar * scale, 5]])
    draw.lineTo(20 + x, canvas.height - 10 + y);
  draw.stroke();
  draw.fillStyle = '#202024';
  draw.font = '18px sans-serif';
  draw.textAlign = 'center';
  draw.fillText(bar_text, 20 + bar * scale / 2, canvas.height - 18);
  slider.value = f;
  clock.textContent = 't = ' + times[f].toFixed(decimals) + ' s';
}
let playing = true, since = performance.now(), from = 0, shown = -1;
function go(now) {
  if (playing) {
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

std::string speed_text(double speed) {
  return speed == 1 ? "" : fmt::format(", shown at {:g} of its speed", speed);
}

void check(const GrainAnimation& animation) {
  if (animation.shapes.empty() || animation.frames.empty())
    bad_input("the animation would be empty", animation.shapes.empty() ? "there are no grains" : "there are no frames",
              "Give some");
  for (std::size_t f = 0; f < animation.frames.size(); ++f) {
    const GrainFrame& frame = animation.frames[f];
    if (frame.places.size() != animation.shapes.size() || frame.angles.size() != animation.shapes.size())
      bad_input(fmt::format("frame {} holds {}", f, counted(std::ssize(frame.places), "grain")),
                fmt::format("the animation is of {}", animation.shapes.size()), "Give all of them in each frame");
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
  const double scale = std::min(page_width / size.x, page_height / size.y);
  const double bar = scale_bar_length(0.2 * size.x);
  const UnitPrefix prefix = unit_prefix(bar);
  std::string text = fmt::format(page_start, escaped(animation.title), escaped(animation.caption), scale * size.x,
                                 scale * size.y + bar_room, speed_text(animation.speed));
  text += fmt::format("const low = {}, size = {}, span = {:.6g}, speed = {:g};\n", list({view.low.x, view.low.y}, 6),
                      list({size.x, size.y}, 6), view.span(), animation.speed);
  text += fmt::format("const room = {:g}, bar = {:g}, bar_text = '{:.3g} {}m';\n", bar_room, bar, bar * prefix.factor,
                      prefix.prefix);
  text += "const parts = " + parts_of(animation) + ";\n";
  std::vector<double> groups(animation.groups.begin(), animation.groups.end()), times;
  groups.resize(animation.shapes.size(), 0);
  text += "const groups = " + list(groups, 3) + ";\n";
  std::string walls, moves, frames;
  for (const Wall& wall : animation.walls) walls += (walls.empty() ? "" : ",") + wall_points(wall, view);
  for (const GrainFrame& frame : animation.frames) {
    times.push_back(frame.time);
    std::vector<double> moved;
    for (const Wall& wall : animation.walls) {
      const Vec2 to = displacement(wall, frame.time);
      moved.insert(moved.end(), {to.x, to.y});
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
