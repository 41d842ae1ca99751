// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/zero_energy_modes.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/unwrapped_pieces.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_described = 8;

/// Discs that a motion moves by more than rounding.
std::vector<std::uint8_t> movers(const std::vector<DiscMotion>& motions, double radius) {
  std::vector<double> size(motions.size());
  double largest = 0;
  for (std::size_t d = 0; d < motions.size(); ++d) {
    size[d] = std::max(norm(motions[d].u), radius * std::abs(motions[d].theta));
    largest = std::max(largest, size[d]);
  }
  std::vector<std::uint8_t> moves(motions.size());
  for (std::size_t d = 0; d < moves.size(); ++d) moves[d] = size[d] > 1e-6 * largest ? 1 : 0;
  return moves;
}

/// Whether the discs that move, with the contacts between them, reach around the period; or, in a free sample, whether
/// they are more than a quarter of all.
bool runs_through(const Assembly& assembly, const std::vector<std::uint8_t>& moves) {
  if (!assembly.periodic()) {
    const auto count = std::count(moves.begin(), moves.end(), std::uint8_t{1});
    return 4 * count > static_cast<std::ptrdiff_t>(moves.size());
  }
  Assembly moving;
  moving.period = assembly.period;
  moving.centres = assembly.centres;
  moving.radii = assembly.radii;
  for (const Contact& contact : assembly.contacts) {
    if (moves[contact.i] != 0 && moves[contact.j] != 0) moving.contacts.push_back(contact);
  }
  const UnwrappedPieces pieces = unwrap_pieces(moving, ContactGraph(moving));
  return std::any_of(pieces.winds.begin(), pieces.winds.end(), [](std::uint8_t winds) { return winds != 0; });
}

}  // namespace

std::vector<ZeroEnergyMode> zero_energy_modes(const Assembly& assembly, const StiffnessSolver& solver,
                                              const HeldMotions& held, const std::string& name) {
  std::vector<ZeroEnergyMode> result;
  for (const GearMode& gear : held.gears) {
    if (result.size() == most_described) break;
    result.push_back({"gear", fmt::format("{} around {} counter-rotate like gears: their contacts form no odd ring",
                                          counted(gear.discs, "disc"),
                                          describe_disc(assembly, static_cast<std::size_t>(gear.first_disc)))});
  }
  const std::int64_t mechanisms = solver.factor().report().zero_pivots;
  constexpr std::int64_t too_many = 1000;
  for (std::int64_t k = 0; k < std::min(mechanisms, too_many); ++k) {
    const std::vector<DiscMotion> motion = disc_motions(solver.unknowns(), solver.factor().null_motion(k));
    const bool floppy = runs_through(assembly, movers(motion, assembly.mean_radius()));
    if (floppy || mechanisms > too_many) {
      bad_input(mechanisms == 1 ? fmt::format("{} is a mechanism", name)
                                : fmt::format("{} is floppy: it has {} mechanisms", name, mechanisms),
                fmt::format("it can move at no cost: {}", describe_motion(assembly, motion)),
                "It has no modulus. Add contacts, or give the contacts tangential springs (kT > 0)");
    }
    if (static_cast<std::size_t>(k) < most_described) result.push_back({"local", describe_motion(assembly, motion)});
  }
  return result;
}

}  // namespace equidem
