// SPDX-License-Identifier: GPL-3.0-or-later
#include "petsc/solver.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"

namespace equidem::petsc {
namespace {

/// The matrix of a rank by coordinates. Blocks in the order: on the diagonal of each owned disc; for every contact
/// those of (i, j) and (j, i) and, where j is a ghost, of (j, j). Entries of rows of other ranks are sent there by
/// PETSc and added. Rows and columns of held components are those of the unit matrix times the stiffest spring.
class Coordinates {
 public:
  explicit Coordinates(const Network& network) : network_(network), b_(network.block()) {
    const auto owned = static_cast<std::int32_t>(network.part.owned);
    for (std::int32_t d = 0; d < owned; ++d) blocks_.emplace_back(d, d);
    for (const Contact& contact : network.assembly.contacts) {
      if (contact.i == contact.j) continue;
      blocks_.emplace_back(contact.i, contact.j);
      blocks_.emplace_back(contact.j, contact.i);
      if (contact.j >= owned) blocks_.emplace_back(contact.j, contact.j);
    }
  }

  /// Calls visit(p, q, r, c) for every entry: row r of disc p, column c of disc q.
  template <typename Visit>
  void for_each_entry(const Visit& visit) const {
    for (const auto& [p, q] : blocks_)
      for (std::size_t r = 0; r < b_; ++r)
        for (std::size_t c = 0; c < b_; ++c) visit(static_cast<std::size_t>(p), static_cast<std::size_t>(q), r, c);
  }
  void preallocate(Mat matrix) const {
    std::vector<PetscInt> rows, columns;
    rows.reserve(blocks_.size() * b_ * b_);
    columns.reserve(rows.capacity());
    const auto& places = network_.part.places;
    const auto b = static_cast<PetscInt>(b_);
    for_each_entry([&](std::size_t p, std::size_t q, std::size_t r, std::size_t c) {
      rows.push_back(b * places[p] + static_cast<PetscInt>(r));
      columns.push_back(b * places[q] + static_cast<PetscInt>(c));
    });
    check(MatSetPreallocationCOO(matrix, static_cast<PetscCount>(rows.size()), rows.data(), columns.data()));
  }
  [[nodiscard]] std::vector<double> values() const {
    std::vector<double> values = b_ == 3 ? tangents<3>() : tangents<2>();
    const auto& held = network_.unknowns.held;
    std::size_t entry = 0;
    const std::size_t diagonal = network_.owned() * b_;  // entries of the blocks on it
    for_each_entry([&](std::size_t p, std::size_t q, std::size_t r, std::size_t c) {
      double& value = values[entry];
      if (held[p * b_ + r] != 0 || held[q * b_ + c] != 0) value = entry < diagonal && r == c ? network_.stiffest : 0.0;
      ++entry;
    });
    return values;
  }

 private:
  template <int B>
  [[nodiscard]] std::vector<double> tangents() const {
    constexpr std::size_t entries = std::size_t{B} * B;
    const auto owned = static_cast<std::int32_t>(network_.part.owned);
    std::vector<double> values(blocks_.size() * entries, 0.0);
    auto next = static_cast<std::size_t>(owned);
    for (std::size_t c = 0; c < network_.assembly.contacts.size(); ++c) {
      const Contact& contact = network_.assembly.contacts[c];
      const ContactStiffness k =
          contact_stiffness(network_.springs, c, frame_of(network_.assembly, c), network_.unknowns.rotation_scale);
      const auto add = [&](const EndGradient& p, const EndGradient& q, std::size_t block) {
        k.add<B>(p, q, &values[block * entries]);
      };
      const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
      const auto& ends = k.ends;
      if (i == j) {
        const EndGradient both = ends.as_one(1);
        add(both, both, i);
        continue;
      }
      add(ends.i, ends.i, i);
      add(ends.i, ends.j, next++);
      add(ends.j, ends.i, next++);
      add(ends.j, ends.j, contact.j >= owned ? next++ : j);
    }
    return values;
  }

  const Network& network_;
  std::size_t b_;
  std::vector<std::pair<std::int32_t, std::int32_t>> blocks_;  // discs of its rows and columns
};

constexpr const char* prefix = "equidem_";
/// Each pass of refinement gains so many digits; the last digits cost fewer iterations this way.
constexpr double tolerance_of_a_pass = 1e-8;
constexpr int most_iterations_of_a_pass = 1000;

std::atomic<bool> options_were_read{false};

/// PETSc passes over such an option without its value, and counts it as used.
void check_values_of_options() {
  for (const char* option : {"-ksp_rtol", "-ksp_atol", "-ksp_max_it", "-ksp_type", "-pc_type"}) {
    const std::string name = fmt::format("-{}{}", prefix, option + 1);
    const char* value = nullptr;
    PetscBool given = PETSC_FALSE;
    check(PetscOptionsFindPair(nullptr, nullptr, name.c_str(), &value, &given));
    if (given == PETSC_FALSE || (value != nullptr && *value != '\0')) continue;
    bad_input(fmt::format("{} has no value", name), "PETSc would pass over it", "Give one after it, or leave it out");
  }
}

/// Whether options asked for what PETSc does not have.
bool is_choice(PetscErrorCode code) {
  return code == PETSC_ERR_SUP || code == PETSC_ERR_MISSING_FACTOR || code == PETSC_ERR_ARG_UNKNOWN_TYPE;
}

/// PETSc 3.18 does not hand the size of blocks on to the part of a matrix by coordinates that a rank holds; its inverse
/// of the diagonal blocks (PCPBJACOBI) reads it there.
void set_block_size_of_own_rows(Mat matrix, PetscInt block) {
  PetscBool parallel = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATMPIAIJ, &parallel));
  if (parallel == PETSC_FALSE) return;
  Mat own = nullptr;
  check(MatMPIAIJGetSeqAIJ(matrix, &own, nullptr, nullptr));
  check(MatSetBlockSize(own, block));
}

}  // namespace

/// Ends the iterations of all ranks where one of them was asked to stop.
struct PetscSolver::Interruption {
  const Ranks& ranks;
  void* by_tolerance = nullptr;
  bool stopped = false;

  static PetscErrorCode test(KSP solver, PetscInt iteration, PetscReal residual, KSPConvergedReason* reason,
                             void* context) {
    auto& self = *static_cast<Interruption*>(context);
    const PetscErrorCode code = KSPConvergedDefault(solver, iteration, residual, reason, self.by_tolerance);
    if (code != 0 || *reason != KSP_CONVERGED_ITERATING) return code;
    bool asked = false;
    try {
      equidem::stop_if_interrupted();
    } catch (const Error&) {
      asked = true;
    }
    self.stopped = self.ranks.any(asked);
    if (self.stopped) *reason = KSP_DIVERGED_NULL;
    return 0;
  }
};

PetscSolver::PetscSolver(const Network& network, SolverMethod method, StageTimes& times) : network_(network) {
  Stopwatch watch;
  assemble();
  set_near_null_space();
  times.add("assemble", watch.lap());
  set_up(method);
  times.add("set up", watch.lap());
}

PetscSolver::~PetscSolver() {
  KSPDestroy(&solver_);
  VecDestroy(&load_);
  VecDestroy(&solution_);
  MatDestroy(&matrix_);
  if (interruption_ != nullptr) KSPConvergedDefaultDestroy(interruption_->by_tolerance);
  delete interruption_;
}

void PetscSolver::assemble() {
  const Network& n = network_;
  const auto b = static_cast<PetscInt>(n.block());
  const auto rows = static_cast<PetscInt>(n.owned());
  check(MatCreate(n.ranks.communicator(), &matrix_));
  check(MatSetSizes(matrix_, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetBlockSize(matrix_, b));
  check(MatSetType(matrix_, MATAIJ));
  check(MatSetOptionsPrefix(matrix_, prefix));
  {
    const Coordinates coordinates(n);
    coordinates.preallocate(matrix_);
    check(MatSetValuesCOO(matrix_, coordinates.values().data(), INSERT_VALUES));
  }
  // A copy does not keep the places of the coordinates, which take more memory than the matrix.
  Mat copy = nullptr;
  check(MatDuplicate(matrix_, MAT_COPY_VALUES, &copy));
  check(MatDestroy(&matrix_));
  matrix_ = copy;
  set_block_size_of_own_rows(matrix_, b);
  check(MatSetOption(matrix_, MAT_SYMMETRIC, PETSC_TRUE));
  if (!n.may_be_indefinite) check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(matrix_, &solution_, &load_));
}

/// Two translations and the rotation about the middle, in which discs turn too, orthonormal.
void PetscSolver::set_near_null_space() {
  const Network& n = network_;
  const Vec2 middle = 0.5 * (n.whole.extents.low + n.whole.extents.high);
  std::array<Vec, 3> motions{};
  for (std::size_t m = 0; m < motions.size(); ++m) {
    check(VecDuplicate(solution_, &motions[m]));
    double* values = nullptr;
    check(VecGetArray(motions[m], &values));
    for (std::size_t k = 0; k < n.owned(); ++k) {
      const std::size_t component = k % n.block();
      const Vec2 at = n.assembly.centres[k / n.block()] - middle;
      const double turn = component == 0 ? -at.y : component == 1 ? at.x : n.unknowns.rotation_scale;
      values[k] = m < 2 ? static_cast<double>(component == m) : turn;
    }
    check(VecRestoreArray(motions[m], &values));
    for (std::size_t l = 0; l < m; ++l) {
      double product = 0;
      check(VecDot(motions[m], motions[l], &product));
      check(VecAXPY(motions[m], -product, motions[l]));
    }
    check(VecNormalize(motions[m], nullptr));
  }
  MatNullSpace space = nullptr;
  check(MatNullSpaceCreate(n.ranks.communicator(), PETSC_FALSE, 3, motions.data(), &space));
  check(MatSetNearNullSpace(matrix_, space));
  check(MatNullSpaceDestroy(&space));
  for (Vec& motion : motions) check(VecDestroy(&motion));
}

void PetscSolver::set_up(SolverMethod method) {
  const Network& n = network_;
  const bool eliminates =
      method == SolverMethod::automatic ? n.may_be_indefinite : !entry_of(method).back_end.iterative;
  check(KSPCreate(n.ranks.communicator(), &solver_));
  check(KSPSetOptionsPrefix(solver_, prefix));
  check(KSPSetOperators(solver_, matrix_, matrix_));
  PC pc = nullptr;
  check(KSPGetPC(solver_, &pc));
  if (eliminates) {
    check(KSPSetType(solver_, KSPPREONLY));
    check(PCSetType(pc, PCCHOLESKY));
    check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  } else {
    check(KSPSetType(solver_, KSPCG));
    check(KSPSetNormType(solver_, KSP_NORM_UNPRECONDITIONED));
    check(PCSetType(pc, PCGAMG));
  }
  check(KSPSetTolerances(solver_, tolerance_of_a_pass, 0, PETSC_DEFAULT, most_iterations_of_a_pass));
  check_values_of_options();
  options_were_read = true;
  check_options(KSPSetFromOptions(solver_));
  interruption_ = new Interruption{n.ranks};
  check(KSPConvergedDefaultCreate(&interruption_->by_tolerance));
  PetscBool elimination = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(solver_), KSPPREONLY, &elimination));
  if (elimination == PETSC_FALSE) check(KSPSetConvergenceTest(solver_, Interruption::test, interruption_, nullptr));
  n.ranks.stop_if_interrupted();
  const PetscErrorCode made = KSPSetUp(solver_);
  if (is_choice(made)) check_options(made);
  check(made);
  n.ranks.stop_if_interrupted();
}

std::int64_t PetscSolver::solve(std::span<const double> r, std::span<double> d) {
  const Network& n = network_;
  double* values = nullptr;
  check(VecGetArrayWrite(load_, &values));
  std::copy_n(r.begin(), n.owned(), values);
  check(VecRestoreArrayWrite(load_, &values));
  check(KSPSolve(solver_, load_, solution_));
  if (interruption_->stopped) {
    throw Error(ErrorKind::interrupted, "stopped as asked", "nothing is kept of a solution that has not converged", "");
  }
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(solver_, &reason));
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(solver_, &iterations));
  if (reason == KSP_DIVERGED_PC_FAILED) {
    computation_failed("the factor or preconditioner of PETSc cannot be made",
                       "the matrix is singular: the assembly has a mechanism", "'equidem solve' names it");
  }
  if (reason < 0) {
    computation_failed(
        fmt::format("the solver of PETSc did not converge: {} after {}", KSPConvergedReasons[reason],
                    counted(iterations, "iteration")),
        n.may_be_indefinite
            ? "kT < 0, or forces at rest: the matrix need not be positive definite, and conjugate gradients need that"
            : "the assembly may have a mechanism, or be close to one",
        n.may_be_indefinite ? "Take MUMPS: --set solver.method=auto, without -equidem_ksp_type and -equidem_pc_type"
                            : "'equidem solve' names a mechanism; -equidem_ksp_max_it N allows more iterations, "
                              "--set solver.method=multifrontal takes MUMPS");
  }
  const double* found = nullptr;
  check(VecGetArrayRead(solution_, &found));
  std::copy_n(found, n.owned(), d.begin());
  check(VecRestoreArrayRead(solution_, &found));
  for (std::size_t k = 0; k < n.owned(); ++k) {
    if (n.unknowns.held[k] != 0) d[k] = 0;
  }
  n.halo.mirror(d, n.unknowns.per_disc);
  return iterations;
}

std::string PetscSolver::name() const {
  PC pc = nullptr;
  KSPType method = nullptr;
  PCType preconditioner = nullptr;
  check(KSPGetPC(solver_, &pc));
  check(KSPGetType(solver_, &method));
  check(PCGetType(pc, &preconditioner));
  std::string name = fmt::format("PETSc {}.{}.{}: {}, {}", PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR,
                                 PETSC_VERSION_SUBMINOR, method, preconditioner);
  MatSolverType package = nullptr;
  check(PCFactorGetMatSolverType(pc, &package));  // null where it does not factorize
  if (package != nullptr) name += fmt::format(" by {}", package);
  return fmt::format("{}, on {}", name, counted(network_.ranks.count(), "rank"));
}

double PetscSolver::grid_bytes() const {
  PC pc = nullptr;
  PetscBool gamg = PETSC_FALSE;
  check(KSPGetPC(solver_, &pc));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCGAMG, &gamg));
  if (gamg == PETSC_FALSE) return 0;
  PetscReal grids = 0, operators = 0;
  MatInfo info;
  check(PCMGGetGridComplexity(pc, &grids, &operators));
  check(MatGetInfo(matrix_, MAT_GLOBAL_SUM, &info));
  return operators * info.nz_used * (sizeof(double) + sizeof(PetscInt));
}

Counted counted_messages() {
  return {.messages = petsc_isend_ct + petsc_send_ct,
          .bytes = petsc_isend_len + petsc_send_len,
          .sums = petsc_allreduce_ct};
}

std::vector<std::string> unused_options() {
  if (!options_were_read) return {};
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::vector<std::string> unused;
  for (PetscInt k = 0; k < count; ++k) unused.push_back(fmt::format("-{}", names[k]));
  check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return unused;
}

Refined refine(const Network& network, PetscSolver& solver, std::span<const double> f,
               const std::optional<Tensor2>& gradient) {
  constexpr int most_passes = 12;
  constexpr double small_enough = 1e-12, rounding = 4e-16;  // of the motion
  Refined result;
  result.motion = PreciseMotion(network.size());
  result.motion.high = network.unknowns.prescribed;
  std::vector<double> residual(network.size()), change(network.size());
  const auto evaluate = [&](const PreciseMotion& motion) {
    network.residual(motion, gradient, f, residual);
    return network.norm(residual);
  };
  result.scale = result.residual = evaluate(result.motion);
  if (!std::isfinite(result.scale)) {
    bad_input("the forces overflow a double", "the largest is 1.8e308", "Check the units of sizes, springs and loads");
  }
  double before = 0;
  // Lattices are at rest under a mean strain but for rounding.
  const double at_rest = gradient ? 1e-13 * network.stiffest * network.whole.mean_branch *
                                        std::sqrt(static_cast<double>(network.whole.discs))
                                  : 0;
  // A first pass may reach the rest at once; only a second one shows how far the motion is from it.
  for (int pass = 0; pass < most_passes && (pass == 1 || result.residual > at_rest); ++pass) {
    result.iterations += solver.solve(residual, change);
    result.motion.add(change);
    const double last = result.residual;
    result.residual = evaluate(result.motion);
    result.refinements = pass;
    const double size = network.norm(result.motion.high), moved = network.norm(change);
    const double now = size > 0 ? moved / size : 0;
    result.error = pass == 0 ? now : now * std::min(1.0, before > 0 ? now / before : 0.0);
    before = now;
    if (pass > 0 && (result.error <= small_enough || now <= rounding)) break;
    if (pass > 0 && result.residual > 0.5 * last && result.residual > 1e-12 * result.scale) {
      computation_failed(
          fmt::format("the residual stays at {:.1e} of the forces", result.residual / result.scale),
          network.may_be_indefinite
              ? "kT < 0, or forces at rest: an iteration needs a positive definite matrix; MUMPS meets one "
                "that is singular or nearly so"
              : "the stiffness matrix is singular or nearly so: the assembly may have a mechanism",
          "'equidem solve' names a mechanism; --set solver.method=multifrontal, without -equidem_ksp_type "
          "and -equidem_pc_type, takes MUMPS");
    }
  }
  result.error = std::max(result.error, rounding);
  PreciseMotion rounded(0);
  rounded.high = result.motion.high;
  result.rounded_residual = evaluate(rounded);
  return result;
}

}  // namespace equidem::petsc
