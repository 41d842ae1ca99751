// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/page/page.hpp"
#include "equidem/output/pictures/canvas.hpp"

namespace equidem {
namespace {

constexpr double colour_bar_room = 124;      // units
constexpr double shortest_drawing = 250;     // units, so that the colour bar has room
constexpr double shown_displacement = 0.05;  // of the larger side, at most
constexpr double finest_chained = 5;         // units, mean radius
constexpr double arrow_length = 0.075;       // of the larger side

void check(const AssemblyState& state) {
  const Assembly& assembly = state.assembly;
  if (assembly.size() == 0) {
    bad_input("the picture would be empty", "the assembly has no disc", "Draw an assembly with discs");
  }
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const Vec2 u = state.motions.empty() ? Vec2{} : state.motions[disc].u;
    const Vec2 c = assembly.centres[disc];
    if (!std::isfinite(c.x + c.y + u.x + u.y + assembly.radii[disc])) {
      bad_input(fmt::format("disc {} at ({}, {}) with displacement ({}, {}) cannot be drawn", disc, c.x, c.y, u.x, u.y),
                "its place is not finite", "Check the solution that it comes from");
    }
  }
}

double choose_displacement_scale(const AssemblyState& state, const PictureOptions& options, double side) {
  if (options.displacement_scale) return *options.displacement_scale;
  double largest = 0;
  for (const DiscMotion& motion : state.motions) largest = std::max(largest, norm(motion.u));
  return visible_scale(largest, side);
}

void colour_discs(PictureScene& scene) {
  const AssemblyState& state = scene.state;
  if (state.stresses.empty() || scene.options.colour == DiscColour::none) return;
  const bool shear = scene.options.colour == DiscColour::stress_xy;
  for (const Tensor2& stress : state.stresses) scene.values.push_back(shear ? stress.xy : mean_stress(stress));
  const ColourScale pure = colour_scale(scene.values);
  const UnitPrefix unit = unit_prefix(std::max(std::abs(pure.low), std::abs(pure.high)));
  for (double& value : scene.values) value *= unit.factor;
  scene.colours = colour_scale(scene.values);
  scene.colour_label = shear ? "stress σxy" : "mean stress";
  scene.colour_unit = fmt::format("({}Pa)", unit.prefix);
}

/// Widths are taken from the force below which 99.5 % of the contacts lie, so that one loaded corner does not thin
/// all others.
void plan_force_chains(PictureScene& scene, double mean_radius) {
  const auto forces = scene.state.contact_forces;
  const double radius = mean_radius * scene.frame.scale;  // units
  if (forces.empty() || scene.as_image || radius < finest_chained) return;
  std::vector<double> sizes;
  for (const ContactForce& force : forces) {
    if (std::isfinite(force.normal)) sizes.push_back(std::abs(force.normal));
  }
  if (sizes.empty()) return;
  const auto index = static_cast<std::size_t>(0.995 * static_cast<double>(sizes.size() - 1) + 0.5);
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(index), sizes.end());
  scene.widest_force = sizes[index];
  scene.widest_line = std::clamp(0.45 * radius, 1.0, 9.0);
  scene.force_chains = scene.widest_force > 0;
}

std::string caption_of(const PictureScene& scene) {
  const Assembly& assembly = scene.state.assembly;
  std::string text = fmt::format(
      "{}, {}",
      assembly.sections.empty()
          ? counted(static_cast<long long>(assembly.size()), "disc")
          : counted(static_cast<long long>(assembly.size()), "body", "bodies") + ", drawn as discs of equal area",
      counted(static_cast<long long>(assembly.contacts.size()), "contact"));
  if (!scene.state.motions.empty()) {
    text += scene.displacement_scale == 1 ? ", displacements to scale"
                                          : fmt::format(", displacements × {:.6g}", scene.displacement_scale);
  }
  if (scene.colours.clipped_below || scene.colours.clipped_above) text += ", extremes beyond the colour bar";
  if (!scene.force_chains && !scene.state.contact_forces.empty()) {
    text += ", force chains too fine to draw";
  }
  if (!scene.options.cracks.empty())
    text += fmt::format("; {} broken or cut: red in tension, blue in shear, the later the darker, black at the start",
                        scene.options.cracks.size());
  return text;
}

/// Whether a load points away from the middle of the assembly: its arrow then starts at the disc, else it ends there.
bool pulls(const PictureScene& scene, const DrawnLoad& load) {
  return dot(load.force, scene.centres[load.disc] - scene.middle) >= 0;
}

}  // namespace

double visible_scale(double largest, double side) {
  if (largest == 0) return 1;
  return std::max(1.0, scale_bar_length(shown_displacement * side / largest));
}

PictureScene plan_scene(const AssemblyState& state, const PictureOptions& options) {
  assert_consistent(state);
  check(state);
  const Assembly& assembly = state.assembly;
  PictureScene scene{.state = state, .options = options};
  scene.as_image = assembly.size() > most_drawn_discs;
  colour_discs(scene);

  Bounds rest;
  double radius_sum = 0;
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    rest.include(assembly.centres[disc], assembly.radii[disc]);
    radius_sum += assembly.radii[disc];
  }
  scene.displacement_scale = choose_displacement_scale(state, options, rest.larger_side());
  Bounds shown = rest;
  scene.centres = assembly.centres;
  for (std::size_t disc = 0; disc < state.motions.size(); ++disc) {
    scene.centres[disc] += scene.displacement_scale * state.motions[disc].u;
    shown.include(scene.centres[disc], assembly.radii[disc]);
  }
  const double mean_radius = radius_sum / static_cast<double>(assembly.size());
  for (const Vec2 centre : scene.centres) scene.middle += centre / static_cast<double>(assembly.size());
  scene.longest_arrow = arrow_length * rest.larger_side();
  for (const DrawnLoad& load : options.loads) {
    const double size = norm(load.force);
    if (!(size > 0) || !std::isfinite(size)) continue;
    const double reach = assembly.radii[load.disc] + 1.05 * scene.longest_arrow;
    const Vec2 end = (pulls(scene, load) ? reach : -reach) / size * load.force;
    shown.include(scene.centres[load.disc] + end, 0);
  }
  for (const DrawnSupport& support : options.supports) {
    const double reach = assembly.radii[support.disc] + 0.35 * scene.longest_arrow;
    shown.include(scene.centres[support.disc] - (support.y ? Vec2{0, reach} : Vec2{reach, 0}), 0);
  }
  scene.frame = lay_out_page(shown, !options.title.empty(), scene.values.empty() ? page_margin : colour_bar_room,
                             shortest_drawing);
  plan_force_chains(scene, mean_radius);
  scene.caption = caption_of(scene);
  return scene;
}

namespace {

constexpr Colour tension_colour{0.45, 0.02, 0.02}, compression_colour{0.02, 0.10, 0.33};
constexpr Colour uncoloured{0.84, 0.86, 0.88};
constexpr Colour disc_outline{0.45, 0.45, 0.45};
constexpr Colour rest_outline{0.72, 0.72, 0.72};
constexpr double smallest_outlined = 5;  // units, radius
constexpr double per_unit = 2;           // image pixels
/// On the hexagonal lattice every point is within 2/sqrt3 radii of a centre.
constexpr double cell_reach = 1.1547005383792517;
constexpr double irregular_reach = 1.35;  // of the radius of a circle as large as the cell
constexpr double largest_reach = 2.5;     // radii
constexpr double too_small_to_see = 0.6;  // image pixels, radius: below it a pixel takes the mean of its discs

Colour colour_of(const PictureScene& scene, std::size_t disc) {
  return scene.values.empty() ? uncoloured : scene.colours.colour_of(scene.values[disc]);
}

/// Reach of a disc's cell from its centre, m.
double reach_of(const Assembly& assembly, std::size_t disc) {
  double reach = cell_reach * assembly.radii[disc];
  if (!assembly.cell_areas.empty()) {
    const double as_circle = std::sqrt(std::max(assembly.cell_areas[disc], 0.0) / std::numbers::pi);
    reach = std::max(reach, std::min(irregular_reach * as_circle, largest_reach * assembly.radii[disc]));
  }
  return reach;
}

/// Rows of an image that are painted at once: what a pixel needs while it is painted takes six times the image.
constexpr int rows_at_once = 64;

/// A pixel while it is painted.
struct Pixel {
  float nearest = std::numeric_limits<float>::infinity();  ///< the smallest power distance
  std::int32_t owner = -1;                                 ///< the disc that has it
  float red = 0, green = 0, blue = 0, count = 0;           ///< sums over discs smaller than pixels
};

/// Each pixel shows the disc with the smallest power distance d² - r²; where discs are smaller than pixels, the mean
/// of those in it.
Raster paint_cells(const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  const Assembly& assembly = scene.state.assembly;
  const double scale = frame.scale * per_unit;
  const int width = std::max(1, static_cast<int>(std::ceil(frame.extent.x * scale)));
  const int height = std::max(1, static_cast<int>(std::ceil(frame.extent.y * scale)));
  Raster raster(width, height);
  std::vector<Pixel> pixels;
  for (int first = 0; first < height; first += rows_at_once) {
    const int last = std::min(first + rows_at_once, height) - 1;
    pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(last - first + 1), {});
    const auto pixel = [&](int column, int row) -> Pixel& {
      return pixels[static_cast<std::size_t>(row - first) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column)];
    };
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      const double x = (scene.centres[disc].x - frame.corner.x) * scale;
      const double y = (frame.corner.y + frame.extent.y - scene.centres[disc].y) * scale;
      const double radius = assembly.radii[disc] * scale;
      if (radius < too_small_to_see) {
        const int row = std::clamp(static_cast<int>(y), 0, height - 1);
        if (row < first || row > last) continue;
        Pixel& at = pixel(std::clamp(static_cast<int>(x), 0, width - 1), row);
        const Colour colour = colour_of(scene, disc);
        at.red += static_cast<float>(colour.red);
        at.green += static_cast<float>(colour.green);
        at.blue += static_cast<float>(colour.blue);
        at.count += 1;
        continue;
      }
      if (y + largest_reach * radius < first || y - largest_reach * radius > last + 1) continue;
      const double reach = reach_of(assembly, disc) * scale;
      const int left = std::max(0, static_cast<int>(x - reach));
      const int right = std::min(width - 1, static_cast<int>(x + reach));
      const int top = std::max(first, static_cast<int>(y - reach));
      const int bottom = std::min(last, static_cast<int>(y + reach));
      for (int row = top; row <= bottom; ++row) {
        for (int column = left; column <= right; ++column) {
          const double dx = column + 0.5 - x, dy = row + 0.5 - y;
          const double squared = dx * dx + dy * dy;
          if (squared > reach * reach) continue;
          const auto power = static_cast<float>(squared - radius * radius);
          if (Pixel& at = pixel(column, row); power < at.nearest) {
            at.nearest = power;
            at.owner = static_cast<std::int32_t>(disc);
          }
        }
      }
    }
    for (int row = first; row <= last; ++row) {
      for (int column = 0; column < width; ++column) {
        const Pixel& at = pixel(column, row);
        if (at.owner >= 0) {
          raster.set(column, row, colour_of(scene, static_cast<std::size_t>(at.owner)));
        } else if (at.count > 0) {
          raster.set(column, row, {at.red / at.count, at.green / at.count, at.blue / at.count});
        }
      }
    }
  }
  return raster;
}

void draw_discs(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  const Assembly& assembly = scene.state.assembly;
  if (scene.as_image) {
    const Raster raster = paint_cells(scene);
    canvas.image(raster, frame.origin, raster.width / per_unit, raster.height / per_unit);
    return;
  }
  if (scene.options.undeformed && !scene.state.motions.empty()) {
    for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
      canvas.stroke_circle(frame.to_page(assembly.centres[disc]), assembly.radii[disc] * frame.scale, 0.7,
                           rest_outline);
    }
  }
  for (std::size_t disc = 0; disc < assembly.size(); ++disc) {
    const double radius = assembly.radii[disc] * frame.scale;
    const Vec2 centre = frame.to_page(scene.centres[disc]);
    canvas.fill_circle(centre, radius, colour_of(scene, disc));
    if (radius >= smallest_outlined) canvas.stroke_circle(centre, radius - 0.3, 0.6, disc_outline);
  }
}

/// From a pale colour for the first to a dark one for the last.
Colour of_order(CrackKind kind, double order) {
  if (kind == CrackKind::cut) return ink;
  const bool shear = kind == CrackKind::shear;
  const Colour pale = shear ? Colour{0.55, 0.78, 0.95} : Colour{0.98, 0.72, 0.45};
  const Colour dark = shear ? Colour{0.02, 0.16, 0.45} : Colour{0.55, 0.03, 0.03};
  const auto between = [&](double a, double b) { return a + (b - a) * std::clamp(order, 0.0, 1.0); };
  return {between(pale.red, dark.red), between(pale.green, dark.green), between(pale.blue, dark.blue)};
}

void draw_cracks(Canvas& canvas, const PictureScene& scene) {
  constexpr double share = 0.85, thinnest = 1.6;  // of the smaller diameter; units
  const Assembly& assembly = scene.state.assembly;
  for (const DrawnCrack& crack : scene.options.cracks) {
    const auto index = static_cast<std::size_t>(crack.contact);
    const Contact& contact = assembly.contacts[index];
    const ContactFrame frame = frame_of(assembly, index);
    const double radius = std::min(assembly.radii[contact.i], assembly.radii[contact.j]);
    const Vec2 along = share * radius * frame.tangent();
    const double width = std::max(thinnest, 0.3 * radius * scene.frame.scale);
    const auto draw = [&](Vec2 at) {
      canvas.line(scene.frame.to_page(at - along), scene.frame.to_page(at + along), width,
                  of_order(crack.kind, crack.order));
    };
    draw(scene.centres[contact.i] + arm_of_i(frame));
    if (contact.shift_x != 0 || contact.shift_y != 0) draw(scene.centres[contact.j] - arm_to_j(frame));
  }
}

/// A line with a thin white border, which parts it from discs of its own colour.
struct Chain {
  Vec2 from, to;  // units
  double width = 0;
  bool tension = false;
};

constexpr double thinnest = 0.12;  // units
constexpr double border = 0.7;     // units
constexpr double bordered = 2.2;   // units, width

std::vector<Chain> chains_of(const PictureScene& scene) {
  const Assembly& assembly = scene.state.assembly;
  std::vector<Chain> chains;
  for (std::size_t index = 0; index < assembly.contacts.size(); ++index) {
    const double force = scene.state.contact_forces[index].normal;
    if (!std::isfinite(force)) continue;
    const double width = scene.widest_line * std::min(1.0, std::abs(force) / scene.widest_force);
    if (width < thinnest) continue;
    const auto add = [&](Vec2 from, Vec2 to) {
      chains.push_back({scene.frame.to_page(from), scene.frame.to_page(to), width, force > 0});
    };
    const Contact& contact = assembly.contacts[index];
    const Vec2 i = scene.centres[contact.i];
    const Vec2 j = scene.centres[contact.j];
    if (contact.shift_x == 0 && contact.shift_y == 0) {
      add(i, j);
    } else {
      const Vec2 stretch = (j - i) - (assembly.centres[contact.j] - assembly.centres[contact.i]);
      const Vec2 half = 0.5 * (assembly.branch(contact) + stretch);
      add(i, i + half);
      add(j, j - half);
    }
  }
  return chains;
}

void draw_force_chains(Canvas& canvas, const PictureScene& scene) {
  if (!scene.force_chains) return;
  const std::vector<Chain> chains = chains_of(scene);
  for (const Chain& chain : chains) {
    if (chain.width >= bordered) canvas.line(chain.from, chain.to, chain.width + 2 * border, {1, 1, 1});
  }
  for (const Chain& chain : chains) {
    canvas.line(chain.from, chain.to, chain.width, chain.tension ? tension_colour : compression_colour);
  }
}

constexpr Colour load_colour{0.0, 0.45, 0.32};

/// Beside the drawing area, its label above.
void draw_colours(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  constexpr double width = 18, tip = 14;
  const double area_top = frame.origin.y + 0.5 * (frame.scale * frame.extent.y - frame.room.y);
  const double length = std::min(frame.room.y - 2 * tip - 50, 420.0);
  const double left = page_width - 92;
  const double top = area_top + 0.5 * (frame.room.y - length) + 20;
  draw_colour_bar(canvas, scene.colours, {left, top}, width, length);
  canvas.text(scene.colour_label, {left, top - tip - 27}, small_text, TextAnchor::left, ink);
  canvas.text(scene.colour_unit, {left, top - tip - 11}, small_text, TextAnchor::left, ink);
}

void draw_arrow(Canvas& canvas, Vec2 tail, Vec2 tip) {
  const Vec2 along = tip - tail;
  const double length = norm(along);
  if (length < 1) return;
  const Vec2 direction = along / length;
  const double head = std::min(9.0, 0.6 * length);
  const Vec2 back = tip - head * direction;
  const Vec2 side = 0.38 * head * perpendicular(direction);
  canvas.line(tail, back, std::clamp(length / 30, 1.2, 2.2), load_colour);
  canvas.fill_polygon({tip, back + side, back - side}, load_colour);
}

/// The triangle points at the disc from below, or from the left where only x is held.
void draw_support(Canvas& canvas, Vec2 centre, double radius, const DrawnSupport& support) {
  const double size = std::clamp(1.1 * radius, 5.0, 16.0);
  const Vec2 out = support.y ? Vec2{0, 1} : Vec2{-1, 0};
  const Vec2 side = perpendicular(out);
  const Vec2 tip = centre + radius * out;
  const Vec2 base = tip + size * out;
  const std::vector<Vec2> triangle{tip, base + 0.6 * size * side, base - 0.6 * size * side};
  if (support.x && support.y) {
    canvas.fill_polygon(triangle, grey);
  } else {
    canvas.fill_polygon(triangle, {1, 1, 1});
    canvas.stroke_polygon(triangle, 1, grey);
    const Vec2 floor = base + 0.22 * size * out;
    canvas.line(floor + 0.7 * size * side, floor - 0.7 * size * side, 1.2, grey);
  }
}

void draw_supports_and_loads(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  const Assembly& assembly = scene.state.assembly;
  for (const DrawnSupport& support : scene.options.supports) {
    if (!support.x && !support.y) continue;
    draw_support(canvas, frame.to_page(scene.centres[support.disc]), assembly.radii[support.disc] * frame.scale,
                 support);
  }
  double largest = 0;
  for (const DrawnLoad& load : scene.options.loads) largest = std::max(largest, norm(load.force));
  if (!(largest > 0) || !std::isfinite(largest)) return;
  const double longest = scene.longest_arrow * frame.scale;  // units
  for (const DrawnLoad& load : scene.options.loads) {
    const double size = norm(load.force);
    if (size == 0) continue;
    const Vec2 direction = Vec2{load.force.x, -load.force.y} / size;
    const Vec2 centre = frame.to_page(scene.centres[load.disc]);
    const Vec2 edge = assembly.radii[load.disc] * frame.scale * direction;
    const Vec2 arrow = longest * size / largest * direction;
    if (pulls(scene, load)) {
      draw_arrow(canvas, centre + edge, centre + edge + arrow);
    } else {
      draw_arrow(canvas, centre - edge - arrow, centre - edge);
    }
  }
}

void draw_gauges(Canvas& canvas, const PictureScene& scene) {
  constexpr Colour white{1, 1, 1};
  constexpr double dot_radius = 4.5, halo = 2, label_distance = 15;
  for (const DrawnGauge& gauge : scene.options.gauges) {
    const Vec2 from = scene.frame.to_page(scene.centres[gauge.first]),
               to = scene.frame.to_page(scene.centres[gauge.second]);
    if (from == to) continue;
    const Vec2 direction = (to - from) / norm(to - from);
    canvas.line(from, to, 1.6 + 2 * halo, white);
    canvas.line(from, to, 1.6, ink);
    for (const auto& [at, outwards, label] :
         {std::tuple{from, -1.0, gauge.first_label}, {to, 1.0, gauge.second_label}}) {
      canvas.fill_circle(at, dot_radius + halo, white);
      canvas.fill_circle(at, dot_radius, ink);
      const Vec2 base = at + outwards * label_distance * direction + Vec2{0, 0.35 * small_text};
      canvas.fill_circle(base - Vec2{0, 0.35 * small_text}, 0.62 * small_text, white);
      canvas.text(label, base, small_text, TextAnchor::centre, ink, true);
    }
  }
}

void draw_legends(Canvas& canvas, const PictureScene& scene) {
  const PageFrame& frame = scene.frame;
  if (!scene.values.empty()) draw_colours(canvas, scene);
  if (scene.force_chains)
    canvas.text(scene.options.lines + (scene.options.unit_of_lines.empty()
                                           ? fmt::format("{:.3g}", scene.widest_force)
                                           : with_unit(scene.widest_force, scene.options.unit_of_lines)),
                {page_margin + frame.room.x, frame.height - 46.0}, small_text, TextAnchor::right, ink);
  draw_texts(canvas, frame, scene.options.title, scene.caption);
}

std::string draw(const PictureScene& scene, PageFormat page) {
  Canvas canvas(page, scene.frame.height);
  draw_discs(canvas, scene);
  draw_force_chains(canvas, scene);
  draw_cracks(canvas, scene);
  draw_supports_and_loads(canvas, scene);
  draw_gauges(canvas, scene);
  draw_legends(canvas, scene);
  return canvas.finish();
}

}  // namespace

std::vector<DrawnLoad> drawn_loads(const Assembly& assembly, const LoadCase& loads) {
  std::map<std::int32_t, Vec2> forces;
  for (const Load& load : loads) {
    const DiscGroup& pulled = group(assembly, load.group);
    for (std::size_t k = 0; k < pulled.discs.size(); ++k) {
      double share = 1;
      if (load.kind == LoadKind::total) share = 1 / static_cast<double>(pulled.discs.size());
      if (load.kind == LoadKind::traction) share = pulled.tributary_lengths.at(k);
      forces[pulled.discs[k]] += share * load.force;
    }
  }
  std::vector<DrawnLoad> drawn;
  for (const auto& [disc, force] : forces) drawn.push_back({disc, force});
  return drawn;
}

std::vector<DrawnSupport> drawn_supports(const Assembly& assembly, std::span<const Support> supports) {
  std::map<std::int32_t, DrawnSupport> held;
  for (const Support& support : supports) {
    for (const std::int32_t disc : group(assembly, support.group).discs) {
      DrawnSupport& drawn = held[disc];
      drawn.disc = disc;
      drawn.x = drawn.x || support.ux.has_value();
      drawn.y = drawn.y || support.uy.has_value();
    }
  }
  std::vector<DrawnSupport> all;
  for (const auto& [disc, drawn] : held)
    if (drawn.x || drawn.y) all.push_back(drawn);
  return all;
}

double bytes_of_picture(const Assembly& assembly) {
  // Measured. The image stands in memory as it is painted and as cairo keeps it, and is compressed into the page.
  constexpr double of_pixel = 12, of_disc = 150, of_drawn_disc = 600;
  const auto discs = static_cast<double>(assembly.size());
  if (assembly.size() <= most_drawn_discs) return of_drawn_disc * discs;
  Bounds shown;
  for (std::size_t disc = 0; disc < assembly.size(); ++disc)
    shown.include(assembly.centres[disc], assembly.radii[disc]);
  const PageFrame frame = lay_out_page(shown, true, colour_bar_room, shortest_drawing);
  return of_pixel * squared(per_unit * frame.scale) * frame.extent.x * frame.extent.y + of_disc * discs;
}

void write_picture(const std::filesystem::path& folder, const std::string& name, const AssemblyState& state,
                   const PictureOptions& options, bool overwrite) {
  const PictureScene scene = plan_scene(state, options);
  const auto svg = folder / (name + ".svg");
  const auto png = folder / (name + ".png");
  check_writable(svg, overwrite);
  check_writable(png, overwrite);
  write_file(svg, draw(scene, PageFormat::svg), overwrite);
  write_file(png, draw(scene, PageFormat::png), overwrite);
  DrawnFigures::add({.name = name,
                     .title = fmt::format("{}{}{}", options.title, options.title.empty() ? "" : ": ", scene.caption),
                     .file = png});
}

}  // namespace equidem
