// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/contact/frame.hpp"
#include "equidem/output/pictures/scene.hpp"

namespace equidem {
namespace {

/// From a pale colour for the first to a dark one for the last.
Colour of_order(CrackKind kind, double order) {
  if (kind == CrackKind::cut) return ink;
  const bool shear = kind == CrackKind::shear;
  const Colour pale = shear ? Colour{0.55, 0.78, 0.95} : Colour{0.98, 0.72, 0.45};
  const Colour dark = shear ? Colour{0.02, 0.16, 0.45} : Colour{0.55, 0.03, 0.03};
  const auto between = [&](double a, double b) { return a + (b - a) * std::clamp(order, 0.0, 1.0); };
  return {between(pale.red, dark.red), between(pale.green, dark.green), between(pale.blue, dark.blue)};
}

}  // namespace

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

}  // namespace equidem
