// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/assembly/delaunay.hpp"
#include "equidem/assembly/lattices.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::bench {
namespace {

ContactSprings springs_for(const Assembly& assembly, const Variant& variant) {
  if (!variant.own_springs) return ContactSprings(variant.springs);
  return ContactSprings(std::vector<SpringConstants>(assembly.contacts.size(), variant.springs));
}

Simulation simulation_of(const Assembly& assembly, const ContactSprings& springs, const Variant& variant) {
  Scene scene{
      .assembly = assembly, .springs = springs, .inertia = std::vector<Inertia>(assembly.size(), scene_inertia)};
  if (variant.own_masses) {
    for (std::size_t d = 0; d < assembly.size(); ++d) scene.inertia[d].mass += 0.1 * static_cast<double>(d % 7);
  }
  if (variant.driven_sides) {
    scene.supports.push_back({.group = "left", .ux = Schedule{}, .uy = Schedule{}, .rotation = Schedule{}});
    scene.loads.push_back({.load = {.group = "right", .kind = LoadKind::per_disc, .force = {1e-3, 0}},
                           .factor = {.kind = Schedule::Kind::ramp, .value = 1, .start = 0, .end = 100}});
  }
  Simulation simulation(scene, variant.options);
  SavedState state = simulation.save();
  state["motions"] = state["previous"] = numbers_of(start_motions(assembly));
  simulation.restore(state);
  return simulation;
}

std::vector<Variant> list_variants() {
  std::vector<Variant> list(13);
  list[0].name = "springs, rotation";
  list[1].name = "normal springs only";
  list[1].springs.kT = 0;
  list[2].name = "rotation restrained";
  list[2].options.rotation = Rotation::restrained;
  list[3].name = "springs of every contact";
  list[3].own_springs = true;
  list[4].name = "masses of every disc";
  list[4].own_masses = true;
  list[5].name = "gravity";
  list[5].options.gravity = {0, -1e-6};
  list[6].name = "mass damping";
  list[6].options.damping.mass = 1e-3;
  list[7].name = "local damping";
  list[7].options.damping.local = 0.1;
  list[8].name = "dashpots";
  list[8].options.damping.stiffness = 1e-3;
  list[9].name = "driven sides";
  list[9].driven_sides = true;
  list[10].name = "fourth-order integrator";
  list[10].options.integrator = Integrator::fourth_order;
  list[11].name = "finite motions";
  list[11].options.motion = LoopKind::Motion::finite;
  list[12].name = "finite motions, dashpots";
  list[12].options.motion = LoopKind::Motion::finite;
  list[12].options.damping.stiffness = 1e-3;
  return list;
}

}  // namespace

std::vector<std::string> assembly_kinds() {
  return {"hexagonal", "delaunay"};
}

Assembly build_assembly(const std::string& kind, std::int64_t discs) {
  if (kind == "delaunay") return delaunay_assembly({.discs = discs, .radii = {1, 1}});
  if (kind != "hexagonal")
    bad_input(fmt::format("there is no kind '{}'", kind), "they are hexagonal and delaunay", "Choose one");
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(discs))));
  return hexagonal_lattice({.columns = side, .rows = side, .radius = 1});
}

std::vector<DiscMotion> start_motions(const Assembly& assembly) {
  double width = 1;
  for (const Vec2 x : assembly.centres) width = std::max(width, x.x);
  std::vector<DiscMotion> motions(assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    const double phase = 6.0 * assembly.centres[d].x / width;
    motions[d] = {{0.01 * std::sin(phase), 0.01 * std::cos(phase)}, 0.001 * std::sin(phase)};
  }
  return motions;
}

const std::vector<Variant>& variants() {
  static const std::vector<Variant> list = list_variants();
  return list;
}

Scenery::Scenery(const Assembly& assembly, const Variant& variant)
    : springs_(springs_for(assembly, variant)), simulation_(simulation_of(assembly, springs_, variant)) {}

}  // namespace equidem::bench
