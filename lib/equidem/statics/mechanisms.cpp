// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/mechanisms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "equidem/core/text.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/rigid_growth.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/load_bearing.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/solver_choice.hpp"

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

namespace {

/// K with the zero-energy modes found from the graph held.
struct HeldSystem {
  ContactGraph graph;
  DegreesOfFreedom unknowns;
  HeldMotions held;
  StiffnessMatrix matrix{};
  std::shared_ptr<const SymbolicFactor> symbolic{};
  std::unique_ptr<Factorization> factor{};

  HeldSystem(const Assembly& assembly, const ContactSprings& springs, Rotation rotation,
             std::span<const Support> supports)
      : graph(assembly),
        unknowns(number_unknowns(assembly, springs, derive_effects(assembly, springs, rotation), supports)),
        held(hold_free_motions(assembly, graph, springs, unknowns)) {}

  /// Factorizes it as indefinite.
  void factorize(const Assembly& assembly, const ContactSprings& springs) {
    matrix = assemble_stiffness(assembly, graph, springs, unknowns);
    symbolic = std::make_shared<const SymbolicFactor>(analyze(dissect(assembly, graph), graph, unknowns.per_disc));
    check_memory(estimate(*symbolic, unknowns, true), 0);
    // With many mechanisms at once, a pivot that is zero would outgrow its round-off by the usual threshold, and be
    // missed.
    factor = multifrontal_ldlt(symbolic, MatrixOnGraph{matrix, assembly, graph}, {.threshold = 0.1});
  }
};

}  // namespace

MechanismReport find_mechanisms(const Assembly& assembly, const ContactSprings& springs, Rotation rotation,
                                std::span<const Support> supports) {
  // Without prestress the modes do not depend on the sizes of springs (zero_energy_modes.hpp).
  const ContactSprings positive = springs.prestressed() ? springs.changed([](SpringConstants k) {
    return SpringConstants{k.kN, std::abs(k.kT)};
  })
                                                        : equal_springs(springs, assembly.mean_radius());
  HeldSystem system(assembly, positive, rotation, supports);
  if (!grows_rigid(assembly, system.graph, positive, system.unknowns.per_disc)) system.factorize(assembly, positive);
  MechanismReport report;
  report.gears = static_cast<std::int64_t>(system.held.gears.size());
  // No spring is negative: without prestress a negative pivot is the round-off of a zero.
  if (system.factor) report.others = system.factor->report().zero_pivots;
  if (system.factor && !springs.prestressed()) report.others += system.factor->report().negative_pivots.value();
  const std::int64_t of_the_whole = !supports.empty() ? 0 : assembly.periodic() ? 2 : 3;
  report.rigid_motions = std::min(of_the_whole, system.held.rigid);
  report.free_pieces = system.held.rigid - report.rigid_motions;
  if (report.free_pieces > 0) {
    report.sentences.push_back(
        fmt::format("{} of pieces or single discs that nothing holds", counted(report.free_pieces, "rigid motion")));
  }
  if (report.gears > 0) {
    const GearMode& first = system.held.gears.front();
    report.sentences.push_back(fmt::format(
        "{} of discs that counter-rotate like gears, since every ring of contacts is even; the first has {} "
        "around {}",
        counted(report.gears, "group"), counted(first.discs, "disc"),
        describe_disc(assembly, static_cast<std::size_t>(first.first_disc))));
  }
  if (report.others > 0) {
    const auto motion = system.factor->softest_motion();
    report.sentences.push_back(
        fmt::format("{} {}{}", counted(report.others, "motion"),
                    springs.prestressed() ? "that springs and forces at rest together do not resist"
                                          : "in which no contact stretches or slips",
                    motion ? ", such as " + describe_motion(assembly, disc_motions(system.unknowns, *motion)) : ""));
  }
  if (assembly.periodic() && supports.empty()) {
    const ContactSprings equal(SpringConstants{1, 1});  // contacts without slip carry no load, but join their discs
    report.unjoined =
        2 - load_bearing_network(assembly, equal, derive_effects(assembly, equal, Rotation::restrained)).spanned;
    if (report.unjoined > 0) {
      report.sentences.push_back(
          report.unjoined == 1
              ? "chains that contacts join to their images along one direction only, so that those of the infinite "
                "assembly slide past each other and part"
              : "pieces that no contact joins to any of their images, so that those of the infinite assembly move "
                "freely");
    }
  }
  return report;
}

InertiaReport find_inertia(const Assembly& assembly, const ContactSprings& springs, Rotation rotation,
                           std::span<const Support> supports) {
  if (!springs.may_be_indefinite()) return {};
  HeldSystem system(assembly, springs, rotation, supports);
  system.factorize(assembly, springs);
  InertiaReport report;
  report.negative_pivots = system.factor->report().negative_pivots.value();
  const MatrixOnGraph k{system.matrix, assembly, system.graph};
  report.unstable_modes = negative_rotations({k, springs, system.unknowns, system.symbolic});
  if (report.unstable_modes) report.unstable_modes = report.negative_pivots - *report.unstable_modes;
  return report;
}

std::int64_t count_self_stresses(const Assembly& assembly, const ContactSprings& springs, const Effects& effects,
                                 std::int64_t unknowns, std::int64_t free_motions) {
  std::int64_t constraints = 0;
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    constraints += (springs[k].kN > 0 ? 1 : 0) + (springs[k].kT != 0 ? 1 : 0);
    constraints += effects.bending && springs.bending(k) > 0 ? 1 : 0;
  }
  return constraints - unknowns + free_motions;
}

}  // namespace equidem
