// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <utility>

#include "equidem/contact/laws/visit.hpp"
#include "equidem/grains/grain_system.hpp"
#include "equidem/grains/neighbours/near_pairs.hpp"

namespace equidem {
namespace {

/// Normal and tangential. The energies of a group are found before they are added, pair by pair: the lists of a run
/// that is resumed have other groups and the same sum.
template <class Law>
std::pair<double, double> elastic_of_block(const GrainSystem& system, const PairBlock& block) {
  const NearPairs& near = system.contacts.near;
  const bool images = system.meets_images();
  const auto position_of = [&](std::int32_t j) {
    return images ? system.position_of(j) : system.bodies.motions[static_cast<std::size_t>(j)].position;
  };
  double normal = 0, tangential = 0;
  for (std::size_t g = 0; g < block.groups.size(); ++g) {
    const PairGroup& group = block.groups[g];
    PairLanes x, y, energy;
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      const Vec2 branch =
          position_of(group.j[k]) - system.bodies.motions[static_cast<std::size_t>(group.i[k])].position;
      x[k] = branch.x;
      y[k] = branch.y;
    }
    for (std::size_t k = 0; k < lanes_of_pairs; ++k) {
      const double overlap = group.reach[k] - std::sqrt(x[k] * x[k] + y[k] * y[k]);
      const double stiffness = near.equal ? near.law.stiffness : block.laws[g].stiffness[k];
      energy[k] = Law::energy(stiffness, overlap > 0 ? overlap : 0);
    }
    for (const double one : energy) normal += one;
    for (std::size_t k = 0; system.friction && k < lanes_of_pairs; ++k) {
      const double spring = near.equal ? near.law.tangential_stiffness : block.laws[g].tangential_stiffness[k];
      tangential += 0.5 * spring * block.slips[g].stretch[k] * block.slips[g].stretch[k];
    }
  }
  return {normal, tangential};
}

}  // namespace

std::pair<double, double> elastic_of_near_pairs(const GrainSystem& system) {
  const std::vector<PairBlock>& blocks = system.contacts.near.blocks;
  if (blocks.empty()) return {};
  return visit_law(system.options.law, [&]<class Law>(std::type_identity<Law>) -> std::pair<double, double> {
    if constexpr (Law::kind == LawKind::force) {
      return system.bodies.blocks.sum([&](std::size_t b) { return elastic_of_block<Law>(system, blocks[b]); });
    } else {
      return {};
    }
  });
}

}  // namespace equidem
