// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/pictures/scene.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double margin_bottom = 92, title_room = 66, no_title_room = 26, colour_bar_room = 124;  // units
constexpr int narrowest = 400, widest = 5000;                                                     // pixels
constexpr double tallest = 1.4;              // drawing area, in its own widths
constexpr double shortest_drawing = 250;     // units, so that the colour bar has room
constexpr double shown_displacement = 0.05;  // of the larger side, at most
constexpr double finest_chained = 5;         // pixels, mean radius
constexpr double arrow_length = 0.075;       // of the larger side

void check(const AssemblyState& state, const PictureOptions& options) {
  const Assembly& assembly = state.assembly;
  if (assembly.size() == 0) {
    bad_input("the picture would be empty", "the assembly has no disc", "Draw an assembly with discs");
  }
  if (options.width < narrowest || options.width > widest) {
    bad_input(fmt::format("a picture {} pixels wide was asked for", options.width),
              fmt::format("{} to {} can be drawn", narrowest, widest), "Choose a width in that range");
  }
  const auto count = static_cast<std::int64_t>(assembly.size());
  const auto check_disc = [&](std::int32_t disc, const char* what) {
    if (disc < 0 || disc >= count) {
      bad_input(fmt::format("a {} is drawn at disc {}", what, disc),
                fmt::format("the assembly has {}, counted from 0", counted(count, "disc")), "Name one of them");
    }
  };
  for (const DrawnLoad& load : options.loads) check_disc(load.disc, "load");
  for (const DrawnSupport& support : options.supports) check_disc(support.disc, "support");
  for (const DrawnGauge& gauge : options.gauges) {
    check_disc(gauge.first, "gauge");
    check_disc(gauge.second, "gauge");
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

/// Label of a colouring, and the stress that it shows; null: another quantity.
struct Colouring {
  DiscColour colour;
  const char* label;
  double (*stress)(const Tensor2& stress);
};
constexpr Colouring colourings[] = {
    {DiscColour::none, "", nullptr},
    {DiscColour::mean_stress, "mean stress", [](const Tensor2& s) { return mean_stress(s); }},
    {DiscColour::stress_xx, "stress σxx", [](const Tensor2& s) { return s.xx; }},
    {DiscColour::stress_yy, "stress σyy", [](const Tensor2& s) { return s.yy; }},
    {DiscColour::stress_xy, "stress σxy", [](const Tensor2& s) { return s.xy; }},
    {DiscColour::displacement, "displacement", nullptr}};

void colour_discs(PictureScene& scene) {
  const AssemblyState& state = scene.state;
  const bool by_motion = scene.options.colour == DiscColour::displacement;
  const bool known = by_motion ? !state.motions.empty() : !state.stresses.empty();
  if (!known || scene.options.colour == DiscColour::none) return;
  scene.values.resize(state.assembly.size());
  const Colouring& colouring = *std::ranges::find(colourings, scene.options.colour, &Colouring::colour);
  for (std::size_t disc = 0; disc < scene.values.size(); ++disc)
    scene.values[disc] = by_motion ? norm(state.motions[disc].u) : colouring.stress(state.stresses[disc]);
  const ColourScale pure = colour_scale(scene.values);
  const UnitPrefix unit = unit_prefix(std::max(std::abs(pure.low), std::abs(pure.high)));
  for (double& value : scene.values) value *= unit.factor;
  scene.colours = colour_scale(scene.values);
  scene.colour_label = colouring.label;
  scene.colour_unit = fmt::format("({}{})", unit.prefix, by_motion ? "m" : "Pa");
}

/// Widths are taken from the force below which 99.5 % of the contacts lie, so that one loaded corner does not thin
/// all others.
void plan_force_chains(PictureScene& scene, double mean_radius) {
  const auto forces = scene.state.contact_forces;
  const double radius = mean_radius * scene.frame.scale;  // units
  if (!scene.options.force_chains || forces.empty() || scene.as_image || radius * scene.frame.pixels < finest_chained)
    return;
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
  if (!scene.force_chains && scene.options.force_chains && !scene.state.contact_forces.empty()) {
    text += ", force chains too fine to draw";
  }
  if (!scene.options.cracks.empty())
    text += fmt::format("; {} broken or cut: red in tension, blue in shear, the later the darker, black at the start",
                        scene.options.cracks.size());
  return text;
}

}  // namespace

void Bounds::include(Vec2 centre, double radius) {
  low = {std::min(low.x, centre.x - radius), std::min(low.y, centre.y - radius)};
  high = {std::max(high.x, centre.x + radius), std::max(high.y, centre.y + radius)};
}

PageFrame lay_out_page(const Bounds& bounds, bool titled, double right, double shortest, double pixels) {
  PageFrame frame;
  frame.corner = bounds.low;
  frame.extent = bounds.high - bounds.low;
  const double room = PageFrame::width - page_margin - right, top = titled ? title_room : no_title_room;
  frame.scale = std::min(room / frame.extent.x, tallest * room / frame.extent.y);
  const Vec2 size = frame.scale * frame.extent;
  frame.room = {room, std::max(size.y, shortest)};
  frame.origin = {page_margin + 0.5 * (room - size.x), top + 0.5 * (frame.room.y - size.y)};
  frame.height = top + frame.room.y + margin_bottom;
  frame.pixels = pixels;
  return frame;
}

double visible_scale(double largest, double side) {
  if (largest == 0) return 1;
  return std::max(1.0, scale_bar_length(shown_displacement * side / largest));
}

PictureScene plan_scene(const AssemblyState& state, const PictureOptions& options) {
  assert_consistent(state);
  check(state, options);
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
                             shortest_drawing, options.width / PageFrame::width);
  plan_force_chains(scene, mean_radius);
  scene.caption = caption_of(scene);
  return scene;
}

}  // namespace equidem
