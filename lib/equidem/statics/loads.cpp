// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/loads.hpp"

#include <cassert>
#include <cmath>

#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// From the centre of a disc to the point of one of its contacts.
Vec2 arm(const Assembly& assembly, std::int32_t disc, std::size_t contact) {
  const ContactFrame frame = frame_of(assembly, contact);
  return assembly.contacts[contact].i == disc ? frame.lever_i * frame.normal : -frame.lever_j * frame.normal;
}

std::int32_t shared_disc(const Contact& a, const Contact& b) {
  assert(a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j);
  return a.i == b.i || a.i == b.j ? a.i : a.j;
}

}  // namespace

bool points_in_line(const Assembly& assembly, const std::array<std::size_t, 3>& contacts) {
  constexpr double in_line = 1e-6;
  const auto chord = [&](std::size_t from, std::size_t to) {
    const std::int32_t disc = shared_disc(assembly.contacts[from], assembly.contacts[to]);
    return arm(assembly, disc, to) - arm(assembly, disc, from);
  };
  const Vec2 a = chord(contacts[0], contacts[1]), b = chord(contacts[1], contacts[2]);
  return std::abs(cross(a, b)) <= in_line * norm(a) * norm(b);
}

namespace {

void check_load(const Load& load) {
  for (const double value : {load.force.x, load.force.y, load.moment}) {
    if (!std::isfinite(value)) {
      bad_input(fmt::format("the load on '{}' has the value {}", load.group, value), "a load must be finite",
                "Give a number");
    }
  }
}

}  // namespace

void add_load(const Load& load, const DiscGroup& discs, std::int64_t count, const DegreesOfFreedom& unknowns,
              std::span<double> f) {
  check_load(load);
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  if (count == 0) {
    bad_input(fmt::format("a load acts on the group '{}', which is empty", load.group), "there is no disc to carry it",
              "Choose a group with discs or mend its definition");
  }
  if (load.kind == LoadKind::traction && !discs.discs.empty() && discs.tributary_lengths.empty()) {
    bad_input(fmt::format("a traction acts on the group '{}'", load.group),
              "it is no side of the assembly and has no length",
              "Use kind = \"per_disc\" or \"total\", or one of the groups left, right, bottom, top");
  }
  if (load.moment != 0 && b != 3) {
    bad_input(fmt::format("a moment acts on the group '{}'", load.group), "rotations are no unknowns of this scene",
              "Remove the moment, or let rotation = \"free\" with tangential springs");
  }
  const double share = load.kind == LoadKind::total ? 1.0 / static_cast<double>(count) : 1.0;
  for (std::size_t k = 0; k < discs.discs.size(); ++k) {
    const double weight = load.kind == LoadKind::traction ? discs.tributary_lengths[k] : share;
    const std::size_t disc = discs.discs[k];
    f[disc * b] += weight * load.force.x;
    f[disc * b + 1] += weight * load.force.y;
    if (b == 3) f[disc * b + 2] += share * load.moment / unknowns.rotation_scale;
  }
}

std::vector<double> assemble_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, const LoadCase& loads) {
  std::vector<double> f(assembly.size() * static_cast<std::size_t>(unknowns.per_disc), 0.0);
  for (const Load& load : loads) {
    const DiscGroup& discs = group(assembly, load.group);
    add_load(load, discs, std::ssize(discs.discs), unknowns, f);
  }
  return f;
}

std::vector<double> assemble_loads(const DegreesOfFreedom& unknowns, std::span<const DiscForce> loads) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<double> f(loads.size() * b, 0.0);
  for (std::size_t d = 0; d < loads.size(); ++d) {
    const auto& [force, moment] = loads[d];
    if (!std::isfinite(force.x) || !std::isfinite(force.y) || !std::isfinite(moment))
      bad_input(fmt::format("the load on disc {} is not finite", d), "no motion could balance it", "Give a number");
    if (moment != 0 && b != 3)
      bad_input(fmt::format("a moment acts on disc {}", d), "rotations are no unknowns of this scene",
                "Remove the moment, or let rotation = \"free\" with tangential springs");
    f[d * b] = force.x;
    f[d * b + 1] = force.y;
    if (b == 3) f[d * b + 2] = moment / unknowns.rotation_scale;
  }
  return f;
}

void check_inert_loads(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> f) {
  if (unknowns.per_disc != 3 || unknowns.rotations_without_stiffness == 0) return;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    if (f[3 * d + 2] == 0 || unknowns.held[3 * d + 2] != DegreesOfFreedom::without_stiffness) continue;
    bad_input(
        fmt::format("a moment acts on disc {}", d),
        "none of its contacts has a tangential spring and a lever arm, or lies off the line of centres, to resist it",
        "Remove the moment, hold the rotation of the disc, or give a contact of it kT != 0");
  }
}

}  // namespace equidem
