// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/output/pictures/scene.hpp"

namespace equidem {
namespace {

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

}  // namespace

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

}  // namespace equidem
