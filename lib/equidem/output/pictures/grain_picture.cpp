// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/grain_picture.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/grain_shapes.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/vtk.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/pictures/canvas.hpp"
#include "equidem/output/results.hpp"
#include "equidem/output/texts.hpp"

namespace equidem {

namespace {

struct GrainView : Bounds {
  /// \throws Error (bad_input) where position or angle of the grain are not finite
  void include_grain(std::size_t grain, Vec2 centre, double angle, double radius) {
    if (!std::isfinite(centre.x + centre.y + angle))
      bad_input(fmt::format("grain {} at ({}, {}) cannot be drawn", grain, centre.x, centre.y),
                "its place is not finite", "Check the run that it comes from");
    include(centre, radius);
  }
  /// Segments; lines cross the view.
  void include_walls(std::span<const Wall> walls, double time) {
    for (const Wall& wall : walls) {
      if (wall.shape == Wall::Shape::line) continue;
      for (const Vec2 end : {wall.point, wall.end}) include(end + wall.displacement(time), 0);
    }
  }
  /// Adds a margin, and room where the view is very narrow or flat.
  void widen() {
    const double edge = 0.04 * larger_side();
    low -= Vec2{edge, edge};
    high += Vec2{edge, edge};
    const Vec2 missing{std::max(0.0, 0.5 * size().y - size().x), std::max(0.0, 0.25 * size().x - size().y)};
    low -= 0.5 * missing;
    high += 0.5 * missing;
  }
  [[nodiscard]] Vec2 size() const { return high - low; }
};

/// Which of the places of grains at a time belong to an open scene: they lie no farther from the box round the
/// segments and the grains that started than half its larger side. Others have fallen out of it. Empty: all
/// belong, because there are lines alone or no grain is known to have started.
std::vector<bool> near_the_scene(std::span<const Vec2> places, std::span<const Grain> started,
                                 std::span<const Wall> walls, double time) {
  const auto is_finite = [](const Wall& wall) { return wall.shape != Wall::Shape::line; };
  if (started.empty() || std::ranges::none_of(walls, is_finite)) return {};
  GrainView scene;
  for (const Grain& grain : started) scene.include(grain.position, grain.radius);
  scene.include_walls(walls, time);
  const double reach = 0.5 * scene.larger_side();
  std::vector<bool> near;
  for (const Vec2 place : places) {
    const Vec2 above = place - scene.low, below = scene.high - place;
    near.push_back(!(std::min({above.x, above.y, below.x, below.y}) < -reach));
  }
  return near;
}

constexpr double smallest_marked = 6;  // units, radius
constexpr Colour wall_colour{0.25, 0.25, 0.28}, pale_colour{0.62, 0.62, 0.66};

/// Light tones of Okabe and Ito (2008), and the same darker for outlines, marks and paths.
constexpr std::array fills = {Colour{0.68, 0.83, 0.93}, Colour{0.97, 0.83, 0.58}, Colour{0.66, 0.87, 0.78},
                              Colour{0.94, 0.72, 0.60}, Colour{0.90, 0.76, 0.85}, Colour{0.97, 0.94, 0.65}};
constexpr std::array inks = {Colour{0.00, 0.45, 0.70}, Colour{0.75, 0.50, 0.00}, Colour{0.00, 0.50, 0.37},
                             Colour{0.70, 0.30, 0.00}, Colour{0.65, 0.35, 0.52}, Colour{0.55, 0.52, 0.00}};

bool is_there(Vec2 place) {
  return !std::isnan(place.x);
}

/// The grains that a picture shows.
struct ShownGrains {
  std::vector<Grain> grains;
  std::vector<int> groups;
  std::vector<GrainBond> bonds;  ///< between grains that are shown, by their numbers here

  /// Takes the grains for which `is_shown` holds.
  ShownGrains(const GrainPicture& picture, const std::vector<bool>& is_shown) {
    std::vector<std::size_t> numbers(picture.grains.size());
    for (std::size_t g = 0; g < picture.grains.size(); ++g) {
      if (!is_shown[g]) continue;
      numbers[g] = grains.size();
      grains.push_back(picture.grains[g]);
      if (!picture.groups.empty()) groups.push_back(picture.groups[g]);
    }
    for (GrainBond bond : picture.bonds) {
      if (!is_shown[bond.i] || !is_shown[bond.j]) continue;
      bond.i = numbers[bond.i], bond.j = numbers[bond.j];
      bonds.push_back(bond);
    }
  }
};

/// Whether each grain is shown; empty: all are.
std::vector<bool> shown_of(const GrainPicture& picture) {
  if (!picture.paths.empty()) return {};
  std::vector<Vec2> places;
  for (const Grain& grain : picture.grains) places.push_back(grain.position);
  std::vector<bool> near = near_the_scene(places, picture.started, picture.walls, picture.time);
  return std::ranges::count(near, true) == 0 ? std::vector<bool>{} : near;
}

/// Returns the periods along x and y; the latter is 0 where the cell repeats along x alone.
std::array<Vec2, 2> periods_of(const PeriodicCell& cell) {
  return {Vec2{cell.width, 0}, Vec2{cell.shift, cell.height}};
}

/// Returns the corners of the parallelogram, counter-clockwise.
std::array<Vec2, 4> corners_of(const PeriodicCell& cell) {
  const auto [a, b] = periods_of(cell);
  // the corner is that of the cell without shift about the same centre
  const Vec2 corner = cell.corner - Vec2{0.5 * cell.shift, 0};
  return {corner, corner + a, corner + a + b, corner + b};
}

/// The shortest of a branch and its images, of bodies less than half a period apart.
Vec2 nearest_image(const PeriodicCell& cell, Vec2 branch) {
  const auto [a, b] = periods_of(cell);
  if (cell.along == PeriodicCell::Along::xy) branch -= std::round(branch.y / b.y) * b;
  return branch - std::round(branch.x / a.x) * a;
}

/// Images of the grains whose circles reach into the cell, of which the grain is another place.
std::vector<Grain> images_of(const GrainPicture& picture, std::vector<int>& groups) {
  std::vector<Grain> images;
  if (!picture.cell) return images;
  const auto [a, b] = periods_of(*picture.cell);
  const Vec2 corner = corners_of(*picture.cell)[0];
  const bool both = picture.cell->along == PeriodicCell::Along::xy;
  const double slant = both ? norm(b) / b.y : 1;  // of a length along x over the distance from a slanting side
  for (std::size_t g = 0; g < picture.grains.size(); ++g)
    for (const int up : {-1, 0, 1})
      for (const int along : {-1, 0, 1}) {
        if ((up == 0 && along == 0) || (up != 0 && !both)) continue;
        Grain image = picture.grains[g];
        image.position += static_cast<double>(along) * a + static_cast<double>(up) * b;
        const Vec2 inside = image.position - corner;
        const double x = inside.x - (both ? inside.y * b.x / b.y : 0), reach = image.radius * slant;
        if (x < -reach || x > a.x + reach) continue;
        if (both && (inside.y < -image.radius || inside.y > b.y + image.radius)) continue;
        images.push_back(image);
        if (!picture.groups.empty()) groups.push_back(picture.groups[g]);
      }
  return images;
}

GrainView view_of(const GrainPicture& picture) {
  if (picture.grains.empty()) bad_input("the picture would be empty", "there are no grains", "Draw some");
  GrainView view;
  for (std::size_t g = 0; g < picture.grains.size(); ++g) {
    const Grain& grain = picture.grains[g];
    view.include_grain(g, grain.position, grain.angle, grain.radius);
    for (const std::vector<Vec2>& places : picture.paths)
      if (is_there(places[g])) view.include(places[g], grain.radius);
  }
  view.include_walls(picture.walls, picture.time);
  if (picture.cell)
    for (const Vec2 corner : corners_of(*picture.cell)) view.include(corner, 0);
  view.widen();
  return view;
}

PageFrame lay_out(const GrainPicture& picture) {
  return lay_out_page(view_of(picture), !picture.title.empty(), page_margin, 0);
}

/// The piece of the line through `point` along `along` that lies in the view.
std::optional<std::array<Vec2, 2>> clipped(const PageFrame& frame, Vec2 point, Vec2 along) {
  double from = -INFINITY, to = INFINITY;
  const Vec2 high = frame.corner + frame.extent;
  for (const auto& [at, speed, low, top] :
       {std::array{point.x, along.x, frame.corner.x, high.x}, std::array{point.y, along.y, frame.corner.y, high.y}}) {
    if (speed == 0) {
      if (at < low || at > top) return {};
      continue;
    }
    const double a = (low - at) / speed, b = (top - at) / speed;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (!(from < to)) return {};
  return std::array{point + from * along, point + to * along};
}

void draw_walls(Canvas& canvas, const PageFrame& frame, const GrainPicture& picture) {
  for (const Wall& wall : picture.walls) {
    const Vec2 moved = wall.displacement(picture.time);
    std::optional ends = std::array{wall.point + moved, wall.end + moved};
    if (wall.shape == Wall::Shape::line) ends = clipped(frame, wall.point + moved, perpendicular(wall.normal));
    if (ends) canvas.line(frame.to_page((*ends)[0]), frame.to_page((*ends)[1]), 2, wall_colour);
  }
}

std::size_t tone(const GrainPicture& picture, std::size_t grain) {
  return picture.groups.empty() ? 0 : static_cast<std::size_t>(picture.groups[grain]) % fills.size();
}

std::span<const Clump::Disc> discs_of(const GrainPicture& picture, const Grain& grain) {
  return picture.clumps[static_cast<std::size_t>(grain.clump)].discs;
}

/// One outline round all discs: first discs in the colour of the edge, then smaller ones in that of the fill.
void draw_clump(Canvas& canvas, const PageFrame& frame, const Grain& grain, std::span<const Clump::Disc> discs,
                const Colour& fill, const Colour& edge, double width) {
  for (const bool inside : {false, true}) {
    if (!inside && width == 0) continue;
    for (const Clump::Disc& disc : discs) {
      const Vec2 centre = frame.to_page(grain.position + turned(disc.offset, grain.angle));
      canvas.fill_circle(centre, disc.radius * frame.scale - (inside ? width : 0), inside ? fill : edge);
    }
  }
}

/// Lines that connect the discs of a clump: from its centre of mass to their centres.
void draw_ties(Canvas& canvas, const PageFrame& frame, const Grain& grain, std::span<const Clump::Disc> discs,
               const Colour& colour) {
  constexpr double width = 2;
  for (const Clump::Disc& disc : discs)
    canvas.line(frame.to_page(grain.position), frame.to_page(grain.position + turned(disc.offset, grain.angle)), width,
                colour);
}

/// The frame of the cell; along x alone its two sides.
void draw_cell(Canvas& canvas, const PageFrame& frame, const GrainPicture& picture) {
  if (!picture.cell) return;
  const auto corners = corners_of(*picture.cell);
  if (picture.cell->along == PeriodicCell::Along::xy) {
    for (std::size_t k = 0; k < corners.size(); ++k)
      canvas.line(frame.to_page(corners[k]), frame.to_page(corners[(k + 1) % corners.size()]), 1, wall_colour);
    return;
  }
  for (const Vec2 at : {corners[0], corners[1]})
    if (const auto ends = clipped(frame, at, {0, 1}))
      canvas.line(frame.to_page((*ends)[0]), frame.to_page((*ends)[1]), 1, wall_colour);
}

Colour paler(const Colour& colour) {
  constexpr double share = 0.6;  // of white
  return {colour.red + share * (1 - colour.red), colour.green + share * (1 - colour.green),
          colour.blue + share * (1 - colour.blue)};
}

/// A mark shows how far a grain has turned, where any has: of a disc from the centre to the edge, of an ellipse along
/// the long half-axis, of a clump in its first disc.
void draw_grains(Canvas& canvas, const PageFrame& frame, const GrainPicture& picture, bool pale = false) {
  constexpr double width = 0.8;
  const bool any_turned =
      std::any_of(picture.grains.begin(), picture.grains.end(), [](const Grain& g) { return g.angle != 0; });
  for (std::size_t g = 0; g < picture.grains.size(); ++g) {
    const Grain& grain = picture.grains[g];
    const double radius = grain.radius * frame.scale;
    const Vec2 centre = frame.to_page(grain.position);
    const Colour &full = fills[tone(picture, g)], &ink = inks[tone(picture, g)];
    const Colour fill = pale ? paler(full) : full, edge = pale ? paler(ink) : ink;
    const bool outlined = inscribed_radius(outline_of(grain, picture.clumps)) * frame.scale >= smallest_marked;
    Vec2 mark_from = centre;
    double mark = radius;
    if (grain.shape() == GrainShape::clump) {
      const auto discs = discs_of(picture, grain);
      draw_clump(canvas, frame, grain, discs, fill, edge, outlined ? width : 0);
      if (outlined) draw_ties(canvas, frame, grain, discs, edge);
      mark_from = frame.to_page(grain.position + turned(discs[0].offset, grain.angle));
      mark = discs[0].radius * frame.scale;
    } else {
      // The page has y down.
      const double other = grain.shape() == GrainShape::ellipse ? grain.short_half_axis * frame.scale : radius;
      canvas.fill_ellipse(centre, {radius, other}, -grain.angle, fill);
      const double inset = 0.5 * width;
      if (outlined) canvas.stroke_ellipse(centre, {radius - inset, other - inset}, -grain.angle, width, edge);
    }
    if (any_turned && outlined) {
      const Vec2 along = turned({1, 0}, grain.angle);
      canvas.line(mark_from, mark_from + mark * Vec2{along.x, -along.y}, width, edge);
    }
  }
}

void draw_bonds(Canvas& canvas, const PageFrame& frame, const GrainPicture& picture) {
  constexpr double widest = 4;  // units
  for (const GrainBond& bond : picture.bonds) {
    const Grain &i = picture.grains[bond.i], &j = picture.grains[bond.j];
    const double width = std::min(widest, 0.3 * frame.scale * std::min(i.radius, j.radius));
    Vec2 branch = j.position - i.position;
    if (picture.cell) branch = nearest_image(*picture.cell, branch);
    const Colour& ink = inks[tone(picture, bond.i)];
    canvas.line(frame.to_page(i.position), frame.to_page(i.position + branch), width, ink);
    if (picture.cell) canvas.line(frame.to_page(j.position - branch), frame.to_page(j.position), width, ink);
  }
}

/// For bodies that are not discs only the positions are known: a circle at the centre.
void draw_starts(Canvas& canvas, const PageFrame& frame, const GrainPicture& picture) {
  if (picture.paths.empty()) return;
  for (std::size_t g = 0; g < picture.grains.size(); ++g) {
    const Grain& grain = picture.grains[g];
    const double size =
        grain.shape() == GrainShape::disc ? grain.radius : 0.5 * inscribed_radius(outline_of(grain, picture.clumps));
    const auto first = std::ranges::find_if(picture.paths, [&](const auto& places) { return is_there(places[g]); });
    if (first == picture.paths.end()) continue;
    canvas.stroke_circle(frame.to_page((*first)[g]), std::max(1.5, size * frame.scale), 0.7, pale_colour);
  }
}

/// Whether the points between two of a path lie on their chord to within a visible width.
bool is_straight(const std::vector<Vec2>& path, std::size_t from, std::size_t to) {
  constexpr double visible = 0.15;  // units
  const Vec2 chord = path[to] - path[from];
  for (std::size_t k = from + 1; k < to; ++k) {
    const Vec2 out = path[k] - path[from];
    const double along = dot(out, chord);
    const bool beside = along >= 0 && along <= dot(chord, chord);
    const double distance = beside && chord != Vec2{} ? std::abs(cross(out, chord)) / norm(chord)
                                                      : std::min(norm(out), norm(path[k] - path[to]));
    if (distance > visible) return false;
  }
  return true;
}

/// Points that lie on a straight line to within a visible width are joined by one stroke.
void draw_paths(Canvas& canvas, const PageFrame& frame, const GrainPicture& picture) {
  if (picture.paths.empty()) return;
  for (std::size_t g = 0; g < picture.grains.size(); ++g) {
    std::vector<Vec2> path;
    for (const std::vector<Vec2>& places : picture.paths)
      if (is_there(places[g])) path.push_back(frame.to_page(places[g]));
    for (std::size_t from = 0; from + 1 < path.size();) {
      std::size_t to = from + 1;
      while (to + 1 < path.size() && is_straight(path, from, to + 1)) ++to;
      if (path[from] != path[to]) canvas.line(path[from], path[to], 1, inks[tone(picture, g)]);
      from = to;
    }
  }
}

std::string caption_of(const GrainPicture& picture, std::size_t whole) {
  std::string caption = counted(std::ssize(picture.grains), "grain");
  if (picture.grains.size() < whole) caption += fmt::format(" of {}: the others are far outside", whole);
  caption += fmt::format(", t = {:.6g} s", picture.time);
  if (!picture.paths.empty()) caption += ", paths from the pale circles";
  return caption;
}

std::string draw(const GrainPicture& picture, std::size_t whole, const PageFrame& frame, PageFormat format_of_page) {
  Canvas canvas(format_of_page, frame.height);
  draw_walls(canvas, frame, picture);
  draw_starts(canvas, frame, picture);
  GrainPicture around = picture;
  std::vector<int> groups;
  const std::vector<Grain> images = images_of(picture, groups);
  around.grains = images, around.groups = groups;
  draw_grains(canvas, frame, around, true);
  draw_grains(canvas, frame, picture);
  draw_cell(canvas, frame, picture);
  draw_bonds(canvas, frame, picture);
  draw_paths(canvas, frame, picture);
  draw_texts(canvas, frame, picture.title, caption_of(picture, whole));
  return canvas.finish();
}

constexpr double film_width = 900, film_height = 1260;  // pixels
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
          row.push_back(is_there(frame.places[g]) && (near.empty() || near[g]));
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

/// x and y of both ends of a wall at time 0; of a line, more than the view shows.
std::vector<double> wall_points(const Wall& wall, const GrainView& view) {
  Vec2 from = wall.point, to = wall.end;
  if (wall.shape == Wall::Shape::line) {
    const Vec2 along = perpendicular(wall.normal), middle = 0.5 * (view.low + view.high);
    const Vec2 foot = wall.point + dot(middle - wall.point, along) * along, reach = 4 * norm(view.size()) * along;
    from = foot - reach;
    to = foot + reach;
  }
  return {from.x, from.y, to.x, to.y};
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

}  // namespace

void write_grain_picture(const std::filesystem::path& folder, const std::string& name, const GrainPicture& whole,
                         bool overwrite) {
  GrainPicture picture = whole;
  std::optional<ShownGrains> shown;
  if (const std::vector<bool> near = shown_of(whole); !near.empty()) {
    shown.emplace(whole, near);
    picture.grains = shown->grains, picture.groups = shown->groups, picture.bonds = shown->bonds;
  }
  const PageFrame frame = lay_out(picture);
  const std::filesystem::path png = folder / (name + ".png");
  write_file(png, draw(picture, whole.grains.size(), frame, PageFormat::png), overwrite);
  DrawnFigures::add({.name = name,
                     .title = fmt::format("{}{}{} at t = {:.4g} s", picture.title, picture.title.empty() ? "" : ": ",
                                          counted(std::ssize(whole.grains), "body", "bodies"), picture.time),
                     .file = png});
  if (picture.grains.size() <= most_drawn_discs)
    write_file(folder / (name + ".svg"), draw(picture, whole.grains.size(), frame, PageFormat::svg), overwrite);
}

std::string grain_animation_player(const GrainAnimation& animation) {
  assert(!animation.shapes.empty() && !animation.frames.empty());
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
  const double scale = std::min(film_width / size.x, film_height / size.y);
  std::string caption = animation.caption;
  if (shown.some_fell) caption += (caption.empty() ? "B" : "; b") + std::string("odies far outside are left out");
  return fmt::format(player_html, fmt::arg("title", escape_xml(animation.title)),
                     fmt::arg("caption", escape_xml(caption)), fmt::arg("width", scale * size.x),
                     fmt::arg("height", scale * size.y), fmt::arg("data", data.json()), fmt::arg("script", player_js));
}

}  // namespace equidem
