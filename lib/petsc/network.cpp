// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/network.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem::petsc {
namespace {

/// A rotation of the whole that is free: every held component is left at rest by a turn about one point.
constexpr double negligible = 1e-12;

[[noreturn]] void refuse_free(bool held, const std::string& motions, const std::string& remedy) {
  bad_input(held ? fmt::format("the supports leave a rigid motion of the assembly free: {}", motions)
                 : fmt::format("no support holds the assembly: {} are free", motions),
            "no contact resists a rigid motion, so that equilibrium has no single answer", remedy);
}

}  // namespace

Effects effects_of(const Ranks& ranks, const Part& part, const ContactSprings& springs, Rotation rotation) {
  const bool tangential = ranks.any(springs.any_tangential());
  const bool resisted = ranks.any(resists_rotation_without_tangential(part.assembly, springs));
  ContactSprings alike(SpringConstants{1, tangential ? 1.0 : 0.0});
  if (ranks.any(springs.bends())) alike = alike.with_bending({1});
  Effects effects = derive_effects(alike, rotation, resisted);
  effects.prestress = ranks.any(springs.prestressed());
  return effects;
}

Network::Network(const Ranks& all, const Part& own, const Whole& sums, const ContactSprings& of_part,
                 const Effects& of_whole, std::span<const Support> supports)
    : ranks(all),
      part(own),
      assembly(own.assembly),
      whole(sums),
      springs(of_part),
      effects(of_whole),
      halo(all, own),
      graph(own.assembly),
      may_be_indefinite(all.any(of_part.may_be_indefinite())),
      stiffest(all.largest(of_part.largest())) {
  unknowns.per_disc = effects.unknowns_per_disc();
  unknowns.rotation_scale = whole.mean_radius;
  unknowns.held.assign(size(), DegreesOfFreedom::free);
  unknowns.prescribed.assign(size(), 0.0);
  ranks.together([&] {
    for (const Support& support : supports) apply(support);
  });
  if (effects.rotation) hold_inert_rotations();
  count();
}

void Network::apply(const Support& support) {
  const auto found = whole.groups.find(support.group);
  if (found == whole.groups.end()) static_cast<void>(group(assembly, support.group));  // refuses the name
  if (found->second == 0) {
    bad_input(fmt::format("the support acts on the group '{}', which is empty", support.group), "it would hold nothing",
              "Choose a group with discs or mend its definition");
  }
  hold_group(group(assembly, support.group), support, effects, unknowns);
}

void Network::hold_inert_rotations() {
  const std::vector<std::uint8_t> here = resisted_rotations(assembly, springs);
  std::vector<double> resisted(here.begin(), here.end());
  halo.add(resisted, 1);
  for (std::size_t disc = 0; disc < static_cast<std::size_t>(part.owned); ++disc) {
    std::uint8_t& held = unknowns.held[3 * disc + 2];
    if (resisted[disc] != 0 || held != DegreesOfFreedom::free) continue;
    held = DegreesOfFreedom::without_stiffness;
    ++unknowns.rotations_without_stiffness;
  }
}

void Network::hold(std::span<const std::int64_t> components) {
  std::vector<std::int64_t> wanted(components.begin(), components.end());
  std::ranges::sort(wanted);
  for (std::size_t d = 0; d < static_cast<std::size_t>(part.owned); ++d) {
    for (std::size_t k = 0; k < block(); ++k) {
      const std::int64_t component = 3 * part.names[d] + static_cast<std::int64_t>(k);
      if (std::ranges::binary_search(wanted, component)) unknowns.held[d * block() + k] = DegreesOfFreedom::supported;
    }
  }
  count();
}

/// Mirrors what is held and prescribed, and counts the unknowns.
void Network::count() {
  std::vector<double> held(unknowns.held.begin(), unknowns.held.end());
  halo.mirror(held, unknowns.per_disc);
  std::ranges::transform(held, unknowns.held.begin(), [](double h) { return static_cast<std::uint8_t>(h); });
  halo.mirror(unknowns.prescribed, unknowns.per_disc);
  unknowns.unknowns = unknowns.free_rotations = 0;
  for (std::size_t k = 0; k < owned(); ++k) {
    if (unknowns.held[k] != 0) continue;
    ++unknowns.unknowns;
    if (block() == 3 && k % 3 == 2) ++unknowns.free_rotations;
  }
  free_count = ranks.sum(unknowns.unknowns);
}

void Network::residual(const PreciseMotion& motion, const std::optional<Tensor2>& gradient, std::span<const double> f,
                       std::span<double> result) const {
  residual_force(local(), motion, gradient, f, result);
  halo.add(result, unknowns.per_disc);
  for (std::size_t k = 0; k < owned(); ++k) {
    if (unknowns.held[k] != 0) result[k] = 0;
  }
}

std::vector<double> Network::internal(const PreciseMotion& motion) const {
  std::vector<double> result(size(), 0.0);
  internal_force(local(), motion, {}, result);
  halo.add(result, unknowns.per_disc);
  return result;
}

double Network::norm(std::span<const double> x) const {
  double sum = 0;
  for (std::size_t k = 0; k < owned(); ++k) sum += x[k] * x[k];
  return std::sqrt(ranks.sum(sum));
}

void check_held(const Network& network) {
  const Assembly& assembly = network.assembly;
  const DegreesOfFreedom& unknowns = network.unknowns;
  const auto& [low, high] = network.whole.extents;
  const Vec2 centre = 0.5 * (low + high);
  const double size = std::max({high.x - low.x, high.y - low.y, network.whole.mean_radius});
  const std::size_t b = network.block();
  // Held components times the rigid motions: x, y, and the rotation about the centre.
  std::array<double, 6> gram{};  // xx, xr, rr; yy, yr; rotations that are held
  for (std::size_t d = 0; d < static_cast<std::size_t>(network.part.owned); ++d) {
    const Vec2 at = (assembly.centres[d] - centre) / size;
    if (unknowns.held[d * b] != 0) gram[0] += 1, gram[1] -= at.y, gram[2] += at.y * at.y;
    if (unknowns.held[d * b + 1] != 0) gram[3] += 1, gram[4] += at.x, gram[2] += at.x * at.x;
    if (b == 3 && unknowns.held[d * b + 2] == DegreesOfFreedom::supported) gram[5] += 1;
  }
  network.ranks.sum(gram);
  const bool x = gram[0] > 0, y = gram[3] > 0;
  const auto square_over = [](double a, double n) { return n > 0 ? a * a / n : 0.0; };
  const double left = gram[2] - square_over(gram[1], gram[0]) - square_over(gram[4], gram[3]);
  const bool turns = !assembly.periodic() && gram[5] == 0 && !network.effects.restrained &&
                     left <= negligible * std::max(gram[2], 1.0) * std::max(1.0, gram[0] + gram[3]);
  if (!x && !y)
    refuse_free(false, "translation along x and along y, and rotation",
                "Hold one disc in x and y, and another one across the line that joins them");
  if (!x) refuse_free(true, "translation along x", "Hold a disc in x");
  if (!y) refuse_free(true, "translation along y", "Hold a disc in y");
  if (turns) refuse_free(true, "rotation", "Hold one more disc, along a line that does not pass through that point");
  const bool rolls = assembly.kind == "square" && b == 3 && gram[5] == 0 && !network.effects.bending;
  if (rolls) {
    bad_input(
        fmt::format("{} around disc 0 have a zero-energy mode in which they counter-rotate like gears",
                    counted(network.whole.discs, "disc")),
        "their graph of contacts is bipartite: no odd ring of contacts makes neighbours slip",
        "Hold the rotation of one of them, restrain rotation, give the contacts bending springs, or add a contact that "
        "closes an odd ring");
  }
}

}  // namespace equidem::petsc
