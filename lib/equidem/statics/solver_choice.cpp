// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/solver_choice.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/linear/multigrid/multigrid_solver.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

constexpr double suspicious = 1e-9;  // ratio of a pivot to its diagonal entry of K

constexpr double enough_digits = 1e11;  // springs further apart leave too few of the digits of a double

/// Discs across the shorter side of a rectangle around the sample.
double discs_across(const Assembly& assembly) {
  const auto [low, high] = assembly.period ? Rectangle{{}, *assembly.period} : upright_rectangle(assembly.centres);
  const Vec2 extent = high - low;
  const double longer = std::max(extent.x, extent.y), shorter = std::min(extent.x, extent.y);
  return std::max(2.0, std::sqrt(static_cast<double>(assembly.size()) * shorter / longer));
}

bool costs_no_energy(const System& system, const ContactSprings& springs, const std::vector<double>& motion) {
  return std::abs(softness(system.k.assembly, springs, disc_motions(system.unknowns, motion))) < softness_of_mechanisms;
}

/// Whether the negative energy of springs with kT < 0 nearly cancels that of the others.
bool springs_cancel(const System& system, const std::vector<DiscMotion>& motions) {
  if (!system.springs.any_negative()) return false;
  const Assembly& assembly = system.k.assembly;
  double sum = 0, size = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactDeformation d = deformation(frame_of(assembly, c), motions[contact.i], motions[contact.j]);
    const double normal = system.springs[c].kN * d.normal * d.normal;
    const double tangential = system.springs[c].kT * d.tangential * d.tangential;
    sum += normal + tangential;
    size += normal + std::abs(tangential);
  }
  return std::abs(sum) < 1e-3 * size;
}

}  // namespace

void report_singular(const System& system, const std::vector<double>& softest) {
  const double spread = spring_spread(system.k.assembly, system.springs);
  const std::vector<DiscMotion> motions = disc_motions(system.unknowns, softest);
  const std::string motion = describe_motion(system.k.assembly, motions);
  const bool far_apart = spread > enough_digits;
  const ContactSprings judged =
      far_apart ? equal_springs(system.springs, system.k.assembly.mean_radius()) : system.springs;
  if (far_apart && !costs_no_energy(system, judged, softest)) refuse_spread(spread);
  if (costs_no_energy(system, judged, softest)) {
    bad_input("the assembly is a mechanism", fmt::format("a motion has no energy: {}", motion),
              remedy_of_mechanisms(system.k.assembly, system.springs, system.unknowns.per_disc == 3,
                                   {"hold that motion by a support"}));
  }
  if (system.springs.prestressed()) {
    computation_failed("under its forces at rest the assembly is at its limit of stability",
                       fmt::format("a motion resists no more than round-off: {}", motion),
                       "Add contacts or supports, or give the contacts larger tangential springs (kT)");
  }
  if (springs_cancel(system, motions)) {
    computation_failed("at this kT/kN the assembly is at its limit of stability",
                       fmt::format("a motion resists no more than round-off: {}", motion),
                       "Choose another kT/kN; 'equidem stability' finds the limit");
  }
  computation_failed("the assembly is too soft for the digits of a double",
                     fmt::format("a motion resists no more than round-off does: {}", motion),
                     system.k.assembly.periodic()
                         ? "Give it more contacts, or larger tangential springs (kT)"
                         : "Hold that motion by a support; a slender assembly needs to be held in more places");
}

namespace {

/// K is singular where the softest motion that elimination met costs, or with kT < 0 yields, no more energy than its
/// own round-off.
bool is_mechanism(const System& system, const Factorization& factor) {
  if (factor.report().smallest_pivot > suspicious) return false;
  const auto softest = factor.softest_motion();
  return softest && costs_no_energy(system, system.springs, *softest);
}

/// Unknowns may be held only against true zero-energy modes, even where springs differ by many orders of magnitude.
void check_null_motions(const System& system, const Factorization& factor) {
  constexpr std::int64_t most = 32;
  const Assembly& assembly = system.k.assembly;
  const bool far_apart = factor.report().zero_pivots > 0 && spring_spread(assembly, system.springs) > enough_digits;
  const ContactSprings judged = far_apart ? equal_springs(system.springs, assembly.mean_radius()) : system.springs;
  for (std::int64_t k = 0; k < std::min(most, factor.report().zero_pivots); ++k) {
    const std::vector<double> motion = factor.null_motion(k);
    if (!costs_no_energy(system, judged, motion)) report_singular(system, motion);
  }
}

std::unique_ptr<Factorization> indefinite(const System& system, Mechanisms mechanisms) {
  auto factor = multifrontal_ldlt(system.symbolic, system.k);
  if (mechanisms == Mechanisms::hold && is_mechanism(system, *factor)) {
    // By the usual threshold a pivot that is zero has outgrown its round-off, and was taken for one that is not.
    factor = multifrontal_ldlt(system.symbolic, system.k, {.threshold = 0.1});
  }
  if (factor->report().zero_pivots > 0) {
    if (mechanisms == Mechanisms::refuse) report_singular(system, factor->softest_motion().value());
    check_null_motions(system, *factor);
  } else if (is_mechanism(system, *factor)) {
    report_singular(system, factor->softest_motion().value());
  }
  return factor;
}

/// A share of a stiffness that is round-off where springs are far apart: elimination adds the soft ones to stiff ones.
double suspicious_share(const System& system) {
  constexpr double rounding = 1e-13;
  return std::max(suspicious, rounding * spring_spread(system.k.assembly, system.springs));
}

std::unique_ptr<Factorization> multifrontal(const System& system, Mechanisms mechanisms) {
  if (system.springs.may_be_indefinite()) return indefinite(system, mechanisms);
  auto factor = multifrontal_cholesky(system.symbolic, system.k);
  if (factor && factor->report().smallest_pivot > suspicious_share(system)) return factor;
  ZeroEnergyModes modes(system);
  if (modes.components().empty()) return factor ? std::move(factor) : indefinite(system, Mechanisms::refuse);
  if (mechanisms == Mechanisms::refuse) report_singular(system, modes.motion(0));
  factor.reset();
  const DegreesOfFreedom& held = modes.held_unknowns();
  const StiffnessMatrix matrix = assemble_stiffness(system.k.assembly, system.k.graph, system.springs, held);
  const MatrixOnGraph k{matrix, system.k.assembly, system.k.graph};
  const System rest{k, system.springs, held, system.symbolic, system.max_iterations, system.options};
  factor = multifrontal_cholesky(rest.symbolic, rest.k);
  if (!factor) factor = indefinite(rest, Mechanisms::refuse);
  return hold_modes(std::move(factor), std::move(modes));
}

/// The factorizations of other libraries do not name mechanisms: where one failed or met a pivot near zero, K is
/// factorized once more to name the mechanism, if there is one.
std::unique_ptr<Factorization> judged(std::unique_ptr<Factorization> factor, const System& system,
                                      Mechanisms mechanisms) {
  if (factor && factor->report().smallest_pivot > suspicious) return factor;
  auto judge = multifrontal(system, mechanisms);
  return factor && judge->report().zero_pivots == 0 ? std::move(factor) : std::move(judge);
}

std::unique_ptr<Factorization> by_back_end(SolverMethod method, const System& system, Mechanisms mechanisms) {
  const BackEnd& back_end = entry_of(method).back_end;
  if (back_end.definite_only && system.springs.may_be_indefinite()) {
    bad_input(fmt::format("method '{}' cannot solve this case", to_string(method)),
              fmt::format("{}, and the method needs a positive definite matrix",
                          system.springs.any_negative() ? "some kT is negative" : "forces at rest count"),
              "Use method = \"auto\"");
  }
  if (back_end.iterative) {
    return multigrid_solver({system.k.assembly, system.k.graph, system.springs, system.unknowns}, {},
                            system.max_iterations);
  }
  if (back_end.factorize == nullptr) return multifrontal(system, mechanisms);
  return judged(back_end.factorize(system.k, system.unknowns, *system.symbolic, system.options), system, mechanisms);
}

}  // namespace

SolverMethod choose_method(const Assembly& assembly, const ContactSprings& springs, const SolverOptions& options) {
  if (options.method != SolverMethod::automatic) return options.method;
  constexpr double many_discs = 2e4;  // up to here multigrid saves less than 50 ms
  constexpr double wide = 50;        // discs: the work of elimination grows with the width, that of iterations does not
  constexpr int few_solutions = 10;  // each costs as many iterations anew
  const bool iterate = static_cast<double>(assembly.size()) >= many_discs && !springs.may_be_indefinite() &&
                       options.right_hand_sides <= few_solutions && discs_across(assembly) >= wide;
  return iterate ? SolverMethod::multigrid : SolverMethod::multifrontal;
}

SolveEstimate estimate(const SymbolicFactor& symbolic, const DegreesOfFreedom& unknowns, bool indefinite) {
  SolveEstimate result;
  result.unknowns = unknowns.unknowns;
  result.factor_nonzeros = symbolic.nonzeros;
  result.factor_bytes = sizeof(double) * symbolic.panel_entries();
  result.operations = symbolic.operations;
  // Beside the factor: update matrices on their way up, of which buffers are kept; L D L^T works in whole fronts.
  double waiting = 0, largest = 0;
  std::vector<double> of_children(symbolic.fronts(), 0.0);
  for (std::size_t t = 0; t < symbolic.fronts(); ++t) {
    const auto pivots = static_cast<double>(symbolic.pivots(t)), updates = static_cast<double>(symbolic.updates(t));
    const double update = updates * updates, front = indefinite ? (pivots + updates) * (pivots + updates) : 0;
    largest = std::max(largest, waiting + update + front);
    waiting += update - of_children[t];
    const std::int32_t parent = symbolic.tree.nodes[t].parent;
    if (parent >= 0) of_children[parent] += update;
  }
  // K on the discs and about three contacts each, and the vectors of a solution.
  const double b = symbolic.block, discs = static_cast<double>(symbolic.position.size());
  const double system = sizeof(double) * discs * (4 * b * b + 12 * b);
  // Fronts of L D L^T come in many sizes, and idle buffers are kept: measured.
  result.peak_bytes = result.factor_bytes + sizeof(double) * (indefinite ? 2.5 : 1) * largest + system;
  return result;
}

SolveEstimate estimate_iterations(const Assembly& assembly, const DegreesOfFreedom& unknowns) {
  SolveEstimate result;
  result.unknowns = unknowns.unknowns;
  result.peak_bytes =
      bytes_of_multigrid(static_cast<double>(assembly.size()), static_cast<double>(assembly.contacts.size()));
  return result;
}

void check_memory(const SolveEstimate& estimate, double memory_limit) {
  // OpenBLAS maps one for each thread that calls it, and tries for ever where the limit of the process forbids it.
  constexpr double blas_buffer = 128.0 * (1 << 20);
  require_address_space(estimate.peak_bytes + blas_buffer * thread_count(),
                        fmt::format("solving for {} unknowns on {} needs about", grouped(estimate.unknowns),
                                    counted(thread_count(), "thread")));
  require_memory(estimate.peak_bytes, fmt::format("solving for {} unknowns needs about", grouped(estimate.unknowns)),
                 "Use fewer discs, restrain rotation, raise the limit, or take a machine with more memory",
                 memory_limit);
}

std::unique_ptr<Factorization> factorize(const System& system, SolverMethod method, Mechanisms mechanisms,
                                         StageTimes& times) {
  const Stopwatch watch;
  std::unique_ptr<Factorization> factor = by_back_end(method, system, mechanisms);
  times.add(entry_of(method).back_end.iterative ? "grids" : "factorize", watch.seconds());
  return factor;
}

std::optional<std::int64_t> negative_rotations(const System& system) {
  if (system.unknowns.per_disc != 3 || !system.springs.any_negative()) return 0;
  StiffnessMatrix rotations;
  rotations.block = 1;
  rotations.diagonal.reserve(system.k.graph.size());
  for (std::size_t d = 0; d < system.k.graph.size(); ++d)
    rotations.diagonal.push_back(system.k.matrix.diagonal_block(d)[8]);
  rotations.coupling.reserve(system.k.assembly.contacts.size());
  for (std::size_t c = 0; c < system.k.assembly.contacts.size(); ++c) {
    rotations.coupling.push_back(system.k.matrix.coupling_block(c)[8]);
  }
  SymbolicFactor symbolic = *system.symbolic;
  symbolic.block = 1;
  const MatrixOnGraph matrix{rotations, system.k.assembly, system.k.graph};
  const auto factor = multifrontal_ldlt(std::make_shared<const SymbolicFactor>(std::move(symbolic)), matrix);
  return factor->report().zero_pivots > 0 ? std::nullopt : factor->report().negative_pivots;
}

namespace {

class WithoutModes final : public Factorization {
 public:
  WithoutModes(std::unique_ptr<Factorization> rest, ZeroEnergyModes modes)
      : rest_(std::move(rest)), modes_(std::move(modes)), report_(rest_->report()) {
    report_.zero_pivots = std::ssize(modes_.components());
  }

  void solve(std::span<double> x, int right_hand_sides) override {
    const std::size_t n = x.size() / static_cast<std::size_t>(right_hand_sides);
    for (std::size_t begin = 0; begin < x.size(); begin += n) {
      for (const std::size_t component : modes_.components()) x[begin + component] = 0;
    }
    rest_->solve(x, right_hand_sides);
  }
  [[nodiscard]] std::optional<std::vector<double>> softest_motion() const override { return modes_.motion(0); }
  [[nodiscard]] std::vector<double> null_motion(std::int64_t k) const override {
    return modes_.motion(static_cast<std::size_t>(k));
  }
  [[nodiscard]] std::vector<std::size_t> null_components() const override { return modes_.components(); }
  [[nodiscard]] const FactorReport& report() const override { return report_; }

 private:
  std::unique_ptr<Factorization> rest_;
  ZeroEnergyModes modes_;
  FactorReport report_;
};

}  // namespace

ZeroEnergyModes::ZeroEnergyModes(const System& system)
    : assembly_(system.k.assembly),
      graph_(system.k.graph),
      equal_(equal_springs(system.springs, system.k.assembly.mean_radius())),
      unknowns_(system.unknowns) {
  constexpr std::size_t most_judged = 32;
  const auto is_mode = [&](const std::vector<double>& motion) {
    return softness(assembly_, equal_, disc_motions(unknowns_, motion)) < softness_of_mechanisms;
  };
  check_memory(estimate(*system.symbolic, unknowns_, true), system.options.memory_limit);
  for (;;) {
    const StiffnessMatrix matrix = assemble_stiffness(assembly_, graph_, equal_, unknowns_);
    // By the usual threshold a pivot that is zero may outgrow its round-off.
    Stage stage{unknowns_,
                multifrontal_ldlt(system.symbolic, MatrixOnGraph{matrix, assembly_, graph_}, {.threshold = 0.1}),
                components_.size()};
    std::vector<std::size_t> found = stage.factor->null_components();
    for (std::size_t k = 0; k < std::min(found.size(), most_judged); ++k) {
      std::vector<double> motion = corrected(stage, stage.factor->null_motion(static_cast<std::int64_t>(k)));
      if (!is_mode(motion)) report_singular(system, motion);
    }
    constexpr double suspicious = 1e-9;
    if (found.empty() && stage.factor->report().smallest_pivot < suspicious) {
      const std::vector<double> softest = stage.factor->softest_motion().value();
      const auto most = std::ranges::max_element(softest, {}, [](double x) { return std::abs(x); });
      if (is_mode(softest)) found.push_back(static_cast<std::size_t>(most - softest.begin()));
    }
    if (found.empty()) return;
    for (const std::size_t component : found) {
      unknowns_.held[component] = DegreesOfFreedom::supported;
      --unknowns_.unknowns;
      if (unknowns_.per_disc == 3 && component % 3 == 2) --unknowns_.free_rotations;
      components_.push_back(component);
    }
    stages_.push_back(std::move(stage));
  }
}

std::vector<double> ZeroEnergyModes::corrected(const Stage& stage, std::vector<double> motion) const {
  PreciseMotion precise(0);
  std::vector<double> residual(motion.size());
  for (int pass = 0; pass < 2; ++pass) {
    precise.high = motion;
    residual_force({assembly_, graph_, equal_, stage.unknowns}, precise, {}, {}, residual);
    stage.factor->solve(residual, 1);
    for (std::size_t e = 0; e < motion.size(); ++e) motion[e] += residual[e];
  }
  return motion;
}

std::vector<double> ZeroEnergyModes::motion(std::size_t k) const {
  const auto stage = std::prev(std::ranges::upper_bound(stages_, k, {}, &Stage::first));
  const Factorization& factor = *stage->factor;
  if (factor.report().zero_pivots == 0) return factor.softest_motion().value();
  return corrected(*stage, factor.null_motion(static_cast<std::int64_t>(k - stage->first)));
}

std::unique_ptr<Factorization> hold_modes(std::unique_ptr<Factorization> rest, ZeroEnergyModes modes) {
  return std::make_unique<WithoutModes>(std::move(rest), std::move(modes));
}

bool does_work(std::span<const double> force, std::span<const double> motion, int per_disc) {
  constexpr double negligible = 1e-8, known = 1e-12;
  double work = 0, size = 0, largest_force = 0, largest_motion = 0;
  const auto b = static_cast<std::size_t>(per_disc);
  for (std::size_t d = 0; d < force.size(); d += b) {
    const double f = std::hypot(force[d], force[d + 1]), u = std::hypot(motion[d], motion[d + 1]);
    const double moment = b == 3 ? force[d + 2] : 0, turn = b == 3 ? motion[d + 2] : 0;
    work += force[d] * motion[d] + force[d + 1] * motion[d + 1] + moment * turn;
    size += f * u + std::abs(moment * turn);
    largest_force = std::max({largest_force, f, std::abs(moment)});
    largest_motion = std::max({largest_motion, u, std::abs(turn)});
  }
  return std::abs(work) > negligible * size + known * largest_force * largest_motion;
}

}  // namespace equidem
