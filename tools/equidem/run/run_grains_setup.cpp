// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_grains_setup.hpp"

#include <utility>

#include "equidem/casefile/engine/echo.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "run/run_case_text.hpp"

namespace equidem {
namespace {

/// Tells whether files that a case names are still what they were.
std::string checksum_of(const GrainCase& resolved) {
  Checksum sum;
  for (std::size_t g = 0; g < resolved.scene.grains.size(); ++g) {
    const Grain& grain = resolved.scene.grains[g];
    for (const double value : {grain.position.x, grain.position.y, grain.radius, grain.velocity.x, grain.velocity.y,
                               grain.spin, grain.angle, resolved.densities[g], static_cast<double>(grain.kind),
                               grain.short_half_axis, static_cast<double>(grain.clump)})
      sum.add(value);
  }
  for (const GrainBond& bond : resolved.scene.bonds)
    for (const double value :
         {static_cast<double>(bond.i), static_cast<double>(bond.j), bond.normal_dashpot, bond.tangential_dashpot,
          bond.rolling_dashpot, bond.normal_spring, bond.tangential_spring})
      sum.add(value);
  for (const Clump& clump : resolved.scene.clumps)
    for (const Clump::Disc& disc : clump.discs)
      for (const double value : {disc.offset.x, disc.offset.y, disc.radius}) sum.add(value);
  for (const Wall& wall : resolved.scene.walls) add(sum, wall.move_x), add(sum, wall.move_y);
  return sum.text();
}

}  // namespace

GrainSetup::GrainSetup(GrainCase given)
    : resolved(std::move(given)), step(choose_grain_step(resolved)), steps(count_steps(resolved, step.step)) {
  for (std::size_t k = 0; k < resolved.scene.walls.size(); ++k)
    for (const Schedule* motion : {&resolved.scene.walls[k].move_x, &resolved.scene.walls[k].move_y})
      check_event(*motion, step.step, resolved.duration, resolved.where(fmt::format("wall.{}.schedule", k)));
}

GrainSimulation GrainSetup::simulation() const {
  const GrainScene scene = build_grain_scene(resolved, step.step);
  const GrainOptions options = grain_options(resolved, step.step);
  try {
    check(scene, options, [this](std::size_t grain) { return resolved.where_grain(grain); });
  } catch (const Error& error) {
    throw error.at(resolved.where("collisions"));
  }
  return {scene, options};
}

std::string GrainSetup::fingerprint() const {
  TomlValue known = resolved.document;
  erase_keys(*known.find("run"), {"duration", "time_step", "steps_per_contact"});  // the step is below
  erase_keys(known, {"title", "output", "probe", "measures"});
  return to_toml(std::move(known), {}) + fmt::format("\n# step {} s\n# checksum of grains and schedules {}\n",
                                                     toml_number(step.step), checksum_of(resolved));
}

}  // namespace equidem
