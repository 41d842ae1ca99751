// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/bond_breaking.hpp"
#include "equidem/grains/grain_simulation_implementation.hpp"

namespace equidem {
namespace {

Effects::Entry entry(std::string name, bool active, std::string why_active, std::string why_not) {
  return {std::move(name), active, active ? std::move(why_active) : std::move(why_not)};
}

std::string law_of_ellipses(GrainOptions::EllipseLaw law) {
  switch (law) {
    case GrainOptions::EllipseLaw::exact:
      return "contact by closest points and common normal";
    case GrainOptions::EllipseLaw::enlarged:
      break;
  }
  return "contact by the enlarged ellipse: misses shallow contacts, does not keep the energy";
}

}  // namespace

Effects effects_of(const GrainScene& scene, const GrainOptions& options) {
  const auto any_pair = [&](auto has) { return std::any_of(scene.pairs.begin(), scene.pairs.end(), has); };
  const bool friction = any_pair([](const PairProperties& pair) { return pair.friction > 0; });
  const bool springs = any_pair([](const PairProperties& p) { return p.friction > 0 && p.tangential_ratio > 0; });
  const bool losses = any_pair([](const PairProperties& pair) { return pair.restitution < 1; });
  const bool moving = std::any_of(scene.walls.begin(), scene.walls.end(), [](const Wall& w) { return w.moves(); });
  const bool servo = std::ranges::any_of(scene.walls, [](const Wall& w) { return w.servo.has_value(); });
  const auto any_shape = [&](GrainShape shape) {
    return std::any_of(scene.grains.begin(), scene.grains.end(), [&](const Grain& g) { return g.shape() == shape; });
  };
  const std::size_t blocks = BodyBlocks(scene.grains.size(), options.bodies_per_block).count();
  const bool ellipses = any_shape(GrainShape::ellipse), clumps = any_shape(GrainShape::clump);
  Effects effects;
  effects.tangential_springs = springs;
  const auto any_bond = [&](const auto& test) { return std::any_of(scene.bonds.begin(), scene.bonds.end(), test); };
  const bool sprung = any_bond([](const GrainBond& b) { return b.normal_spring > 0 || b.tangential_spring > 0; });
  const bool bending = any_bond([](const GrainBond& b) { return b.bending_spring > 0; });
  const bool turning = any_bond([](const GrainBond& b) {
                         return b.tangential_dashpot > 0 || b.rolling_dashpot > 0 || b.tangential_spring > 0;
                       }) ||
                       bending;
  effects.rotation = friction || turning || ellipses || clumps;
  effects.entries = {
      entry(fmt::format("normal contact by {}", to_string(options.law)), true, "grains rebound", ""),
      entry("loss at impacts", losses, "restitution below 1", "restitution 1: impacts keep the energy"),
      entry("friction", friction, "a friction coefficient above 0", "friction 0 everywhere"),
      entry("tangential springs", springs, "tangential_ratio above 0", friction ? "tangential_ratio 0" : "no friction"),
      entry("ellipses", ellipses, law_of_ellipses(options.ellipse_law), "the scene has none"),
      entry("clumps", clumps, "discs that are tied rigidly", "the scene has none"),
      entry("rotation", effects.rotation,
            friction  ? "friction turns grains"
            : turning ? "bonds turn grains"
                      : "normal forces turn ellipses and clumps",
            "no friction: nothing can turn a grain"),
      entry("bonds", !scene.bonds.empty(),
            sprung ? "grains are tied by dashpots and springs" : "grains are tied by dashpots", "no grains are tied"),
      entry("bending springs", bending, "bonds resist the relative rotation of their discs", "no bond has one"),
      entry("breaking", scene.strengths.has_value(), "bonds have strengths", "no bond has a strength"),
      entry("gravity", scene.weighs(), "it is not 0", "it is 0"),
      entry("walls", !scene.walls.empty(), "the scene has some", "the scene has none"),
      entry("periodic cell", scene.cell.has_value(), "the bodies repeat", "nothing repeats"),
      entry("deformation of the cell", scene.cell && scene.cell->deforms(), "it has rates or keeps a stress",
            scene.cell ? "it keeps its size" : "there is no cell"),
      entry("motion of walls", moving, "a wall has a schedule", "no wall moves by a schedule"),
      entry("servo walls", servo, "a wall follows a force or a stress", "no wall follows a force or a stress"),
      entry("several threads", blocks > 1, fmt::format("the grains are stepped in {} blocks", blocks),
            "few grains: threads would wait for one another longer than they work"),
  };
  return effects;
}

double GrainSimulation::bytes_per_body() const {
  const GrainSystem& system = implementation_->system;
  const double bytes = static_cast<double>(
      system.contacts.near.bytes() + system.contacts.near_parts.bytes() +
      system.bodies.constants.capacity() * sizeof(GrainBody) + system.bodies.moments.capacity() * sizeof(Vec2) +
      2 * system.bodies.motions.capacity() * sizeof(GrainMotion) +
      (system.bodies.impulses.capacity() + system.bodies.impulses_before.capacity()) * sizeof(BodyImpulse) +
      system.contacts.candidates.capacity() * sizeof(Candidate) +
      system.contacts.part_pairs.capacity() * sizeof(PartPair) + system.shapes.parts.capacity() * sizeof(GrainPart) +
      system.shapes.axes.capacity() * sizeof(Vec2) + system.bonds.tied.capacity() * sizeof(TiedPair) +
      system.bonds.packed.bytes() + system.contacts.exact_pairs.capacity() * sizeof(ExactPair) +
      (system.cell.images.capacity() + system.cell.crossed.capacity()) * sizeof(PeriodicImage) +
      (system.bonds.breakable ? system.bonds.breakable->bytes() : 0) + system.scene.grains.capacity() * sizeof(Grain));
  return bytes / static_cast<double>(system.bodies.constants.size());
}

}  // namespace equidem
