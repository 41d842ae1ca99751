// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/hold_free_motions.hpp"

#include <array>
#include <cmath>

namespace equidem {
namespace {

/// Coefficients of up to three motions.
using Row = std::array<double, 3>;

double dot(const Row& a, const Row& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Component k of a disc in each free motion of its piece.
Row motion_of(const PieceMotions& piece, Vec2 centre, int k) {
  Row row{};
  for (std::size_t m = 0; m < piece.free.size(); ++m) {
    const RigidMotion& motion = piece.free[m];
    const Vec2 turned = piece.size > 0 ? (motion.rotation / piece.size) * perpendicular(centre - piece.centre) : Vec2{};
    const Vec2 u = motion.t + turned;
    row[m] = k == 0 ? u.x : u.y;
  }
  return row;
}

class Holder {
 public:
  Holder(DegreesOfFreedom& unknowns, HeldMotions& held) : unknowns_(unknowns), held_(held) {}

  void hold(std::size_t component) {
    unknowns_.held[component] = DegreesOfFreedom::supported;
    unknowns_.prescribed[component] = 0;
    --unknowns_.unknowns;
    if (unknowns_.per_disc == 3 && component % 3 == 2) --unknowns_.free_rotations;
    held_.components.push_back(component);
  }

  /// One component after another, always the one that the remaining motions move most (Gram-Schmidt with pivoting).
  void hold_piece(const PieceMotions& piece, const std::vector<std::int32_t>& discs, const std::vector<Vec2>& centres) {
    std::vector<Row> done;
    for (std::size_t m = 0; m < piece.free.size(); ++m) {
      std::size_t best = 0;
      Row best_row{};
      double largest = 0;
      for (const std::int32_t disc : discs) {
        for (int k = 0; k < 2; ++k) {
          const std::size_t component = static_cast<std::size_t>(disc) * unknowns_.per_disc + k;
          if (unknowns_.held[component] != 0) continue;
          Row row = motion_of(piece, centres[disc], k);
          for (const Row& other : done) {
            const double part = dot(row, other);
            for (int e = 0; e < 3; ++e) row[e] -= part * other[e];
          }
          const double size = dot(row, row);
          if (size > largest * (1 + 1e-9)) largest = size, best = component, best_row = row;  // of equals the first
        }
      }
      if (!(largest > 1e-18)) return;  // a single disc that only turns: no contact resists that
      for (double& entry : best_row) entry /= std::sqrt(largest);
      done.push_back(best_row);
      hold(best);
      ++held_.rigid;
    }
  }

 private:
  DegreesOfFreedom& unknowns_;
  HeldMotions& held_;
};

}  // namespace

HeldMotions hold_free_motions(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                              DegreesOfFreedom& unknowns) {
  HeldMotions held;
  const FreeMotions free = find_free_motions(assembly, graph, springs, unknowns);
  const UnwrappedPieces& pieces = free.unwrapped;
  std::vector<std::vector<std::int32_t>> discs(pieces.count());
  for (std::size_t d = 0; d < assembly.size(); ++d) discs[pieces.piece[d]].push_back(static_cast<std::int32_t>(d));
  Holder holder(unknowns, held);
  for (const PieceMotions& piece : free.pieces) {
    if (!piece.free.empty()) holder.hold_piece(piece, discs[pieces.piece[piece.first_disc]], pieces.centres);
  }
  for (const GearMode& gear : free.gears) {
    holder.hold(static_cast<std::size_t>(gear.first_disc) * unknowns.per_disc + 2);
    held.gears.push_back(gear);
  }
  return held;
}

}  // namespace equidem
