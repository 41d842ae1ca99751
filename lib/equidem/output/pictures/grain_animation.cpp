// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/grain_animation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/output/results.hpp"

namespace equidem {
namespace {

constexpr double page_width = 900, page_height = 1260;  // pixels
constexpr double levels = 4096;                         // of places in the view, of angles in a turn

/// The walls as they move to their places in a frame.
std::vector<Wall> walls_of(const GrainAnimation& animation, const GrainFrame& frame) {
  std::vector<Wall> walls(animation.walls.begin(), animation.walls.end());
  for (std::size_t w = 0; w < frame.walls.size(); ++w) {
    const Vec2 move = frame.walls[w] - walls[w].point;
    walls[w].move_x = {.value = move.x};
    walls[w].move_y = {.value = move.y};
  }
  return walls;
}

bool is_there(const GrainFrame& frame, std::size_t grain) {
  return !std::isnan(frame.places[grain].x);
}

/// The walls that are there in a frame.
std::vector<Wall> present_walls(const GrainAnimation& animation, const GrainFrame& frame) {
  std::vector<Wall> walls = walls_of(animation, frame);
  std::erase_if(walls, [](const Wall& w) { return !std::isfinite(w.move_x.value) || !std::isfinite(w.move_y.value); });
  return walls;
}

/// Which grains each frame shows.
struct ShownBodies {
  std::vector<std::vector<bool>> in;  ///< a row for each frame
  bool some_fell = false;             ///< grains that are there are not shown, because they fell out of the scene

  explicit ShownBodies(const GrainAnimation& animation) {
    const auto show = [&](bool all) {
      in.clear();
      std::ptrdiff_t shown = 0;
      for (const GrainFrame& frame : animation.frames) {
        const std::vector<bool> near =
            all ? std::vector<bool>()
                : near_the_scene(frame.places, animation.started, present_walls(animation, frame), frame.time);
        std::vector<bool>& row = in.emplace_back();
        for (std::size_t g = 0; g < frame.places.size(); ++g)
          row.push_back(is_there(frame, g) && (near.empty() || near[g]));
        shown += std::ranges::count(row, true);
      }
      return shown;
    };
    const std::ptrdiff_t shown = show(false);
    some_fell = show(true) > shown && shown > 0;
    if (some_fell) show(false);
  }
};

GrainView view_of(const GrainAnimation& animation, const ShownBodies& shown) {
  GrainView view;
  for (std::size_t f = 0; f < animation.frames.size(); ++f) {
    const GrainFrame& frame = animation.frames[f];
    for (std::size_t g = 0; g < frame.places.size(); ++g)
      if (shown.in[f][g]) view.include_grain(g, frame.places[g], frame.angles[g], animation.shapes[g].radius);
    view.include_walls(present_walls(animation, frame), frame.time);
  }
  view.widen();
  return view;
}

/// Discs or the ellipse of a body: x, y, a, b of each in the frame of the body.
std::vector<double> outlines(const Grain& grain, std::span<const Clump> clumps) {
  if (grain.clump < 0) return {0, 0, grain.radius, grain.short_half_axis > 0 ? grain.short_half_axis : grain.radius};
  std::vector<double> values;
  for (const Clump::Disc& disc : clumps[static_cast<std::size_t>(grain.clump)].discs)
    values.insert(values.end(), {disc.offset.x, disc.offset.y, disc.radius, disc.radius});
  return values;
}

/// x and y of points along a wall at time 0; of a line, more than the view shows.
std::vector<double> wall_points(Wall wall, const GrainView& view) {
  if (wall.shape == Wall::Shape::line) {
    const Vec2 along = perpendicular(wall.normal), middle = 0.5 * (view.low + view.high);
    const Vec2 foot = wall.point + dot(middle - wall.point, along) * along, reach = 4 * norm(view.size()) * along;
    wall.shape = Wall::Shape::segment;
    wall.point = foot - reach;
    wall.end = foot + reach;
  }
  wall.move_x = wall.move_y = {};
  std::vector<double> values;
  for (const Vec2 point : outline(wall, 0)) values.insert(values.end(), {point.x, point.y});
  return values;
}

Results frame_results(const GrainFrame& frame, const std::vector<bool>& shown, const GrainAnimation& animation,
                      const GrainView& view, double unit) {
  std::vector<std::int64_t> bodies;
  for (std::size_t g = 0; g < frame.places.size(); ++g) {
    if (!shown[g]) {
      bodies.insert(bodies.end(), {0, 0, -1});
      continue;
    }
    const Vec2 place = frame.places[g] - view.low;
    const double turns = frame.angles[g] / (2 * std::numbers::pi);
    for (const double value : {place.x / unit, place.y / unit, levels * (turns - std::floor(turns))})
      bodies.push_back(std::llround(value));
  }
  std::vector<double> moves;
  for (const Wall& wall : walls_of(animation, frame)) {
    const Vec2 move = wall.displacement(frame.time);
    moves.insert(moves.end(), {move.x, move.y});
  }
  return Results().set("time", frame.time).set("bodies", bodies).set("moves", moves);
}

constexpr const char* player_page = R"(<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>{0}</title></head>
<body style="font-family: sans-serif">
<h1>{0}</h1>
{1}</body>
</html>
)";

constexpr const char* player_elements = R"(<div class="player">
<canvas width="{2:.0f}" height="{3:.0f}" style="max-width: 100%; max-height: 75vh" role="img" aria-label="{0}"></canvas>
<p class="controls"><button type="button">pause</button> <input type="range" min="0" value="0" aria-label="frame">
<span></span></p>
<p>{1}</p>
<script>
{{
const data = {4};
)";

constexpr const char* player_script = R"(
const fills = ['#add4ed', '#f7d494', '#a8dec7', '#f0b899', '#e6c2d9', '#f7f0a6'];
const inks = ['#0073b3', '#bf8000', '#00805e', '#b34d00', '#a65985', '#8c8500'];
const player = document.currentScript.parentElement;
const [canvas, button, slider, clock] = ['canvas', 'button', 'input', 'span'].map(tag => player.querySelector(tag));
const draw = canvas.getContext('2d'), scale = canvas.width / data.size[0], frames = data.frames;
const shapes = data.bodies.map(body => {
  const shape = new Path2D();
  for (let p = 0; p < body.length; p += 4) {
    shape.moveTo(body[p] + body[p + 2], body[p + 1]);
    shape.ellipse(body[p], body[p + 1], body[p + 2], body[p + 3], 0, 0, 2 * Math.PI);
  }
  return shape;
});
const way = (bodies, g) =>
  Math.hypot(bodies[3 * g] - frames[0].bodies[3 * g], bodies[3 * g + 1] - frames[0].bodies[3 * g + 1]);
const farthest = frames.reduce(
  (far, frame) => data.bodies.reduce((most, _, g) => Math.max(most, way(frame.bodies, g)), far), 1);
const shade = (bodies, g) => {
  const part = way(bodies, g) / farthest;
  return `hsl(207, ${40 + 35 * part}%, ${94 - 66 * part}%)`;
};
const radii = data.bodies.map(body => new Path2D(`M${body[0]} ${body[1]}h${body[2]}`));  // show the rotation
function show(f) {
  const frame = frames[f], bodies = frame.bodies;
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.clearRect(0, 0, canvas.width, canvas.height);
  draw.setTransform(scale, 0, 0, -scale, 0, canvas.height);
  shapes.forEach((shape, g) => {
    if (bodies[3 * g + 2] < 0) return;  // not there
    draw.save();
    draw.translate(bodies[3 * g] * data.unit, bodies[3 * g + 1] * data.unit);
    draw.rotate(bodies[3 * g + 2] * data.turn);
    draw.fillStyle = data.by_motion ? shade(bodies, g) : fills[data.groups[g] % 6];
    draw.strokeStyle = data.by_motion ? '#6f8496' : inks[data.groups[g] % 6];
    draw.lineWidth = 1.6 / scale;  // the fill covers its inner half and the edges between discs of one body
    draw.stroke(shape);
    draw.fill(shape);
    draw.lineWidth = 0.8 / scale;
    if (!data.by_motion) draw.stroke(radii[g]);
    draw.restore();
  });
  draw.lineWidth = 2 / scale;
  data.walls.forEach((points, w) => {
    if (frame.moves[2 * w] === null) return;  // not there
    draw.beginPath();
    for (let p = 0; p < points.length; p += 2)
      draw.lineTo(points[p] - data.low[0] + frame.moves[2 * w], points[p + 1] - data.low[1] + frame.moves[2 * w + 1]);
    draw.stroke();
  });
  slider.value = f;
  clock.textContent = 't = ' + frame.time.toPrecision(4) + ' s; the picture is ' + data.size[0].toPrecision(3) +
    ' m wide' + (data.speed == 1 ? '' : ', shown at ' + data.speed.toPrecision(2) + ' of its speed');
}
let playing, time = frames[0].time, last = performance.now(), f = 0;
function play(now) {
  if (playing) {
    time += (now - last) / 1000 * data.speed;
    if (time > frames[frames.length - 1].time + data.speed) time = frames[f = 0].time;
    while (f + 1 < frames.length && frames[f + 1].time <= time) ++f;
    show(f);
  }
  last = now;
  requestAnimationFrame(play);
}
function set_playing(on) {
  playing = on;
  button.textContent = on ? 'pause' : 'play';
}
slider.max = frames.length - 1;
button.onclick = () => set_playing(!playing);
slider.oninput = () => {
  set_playing(false);
  f = Number(slider.value);
  time = frames[f].time;
  show(f);
};
set_playing(!matchMedia('(prefers-reduced-motion: reduce)').matches);
show(0);
requestAnimationFrame(play);
}
</script>
</div>
)";

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
  return fmt::format(player_page, escape_xml(animation.title), grain_animation_player(animation));
}

std::string grain_animation_player(const GrainAnimation& animation) {
  check(animation);
  const ShownBodies shown(animation);
  const GrainView view = view_of(animation, shown);
  const Vec2 size = view.size();
  const double unit = std::max(size.x, size.y) / levels;
  std::vector<std::int64_t> groups(animation.groups.begin(), animation.groups.end());
  groups.resize(animation.shapes.size(), 0);
  std::vector<std::vector<double>> bodies, walls;
  for (const Grain& grain : animation.shapes) bodies.push_back(outlines(grain, animation.clumps));
  for (const Wall& wall : animation.walls) walls.push_back(wall_points(wall, view));
  std::vector<Results> frames;
  for (std::size_t f = 0; f < animation.frames.size(); ++f)
    frames.push_back(frame_results(animation.frames[f], shown.in[f], animation, view, unit));
  Results data;
  data.set("low", view.low).set("size", size).set("unit", unit).set("turn", 2 * std::numbers::pi / levels);
  data.set("speed", animation.speed)
      .set("by_motion", animation.by_motion)
      .set("groups", groups)
      .set("bodies", bodies)
      .set("walls", walls);
  data.set("frames", frames);
  const double scale = std::min(page_width / size.x, page_height / size.y);
  std::string caption = animation.caption;
  if (shown.some_fell) caption += (caption.empty() ? "B" : "; b") + std::string("odies far outside are left out");
  return fmt::format(player_elements, escape_xml(animation.title), escape_xml(caption), scale * size.x, scale * size.y,
                     data.json()) +
         player_script;
}

void write_grain_animation(const std::filesystem::path& path, const GrainAnimation& animation, bool overwrite) {
  write_file(path, grain_animation_html(animation), overwrite);
}

}  // namespace equidem
