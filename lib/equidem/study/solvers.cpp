// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One linear system, many ways: direct solvers with and without refinement, multigrid and relaxation to a tolerance.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/relaxation.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

/// Discs of a block that CHOLMOD takes 1.3 GB and 3 s for. Beyond, the truth is by our own factor, of half the memory,
/// and direct solvers are timed with refinement alone.
constexpr std::size_t large = 200000;

/// The block of Abe (1996), Fig. 6, in tension, and its true motions.
struct Block {
  explicit Block(int rows)
      : assembly(hexagonal_lattice({.columns = rows, .rows = rows, .radius = 0.005})),
        setup(tension_setup(assembly, {})),
        truth(solve({.method = assembly.size() > large ? SolverMethod::multifrontal : SolverMethod::cholmod,
                     .max_refinements = 10})),
        scene(assembly, springs, inertia_of(assembly.radii, 2000, Body::disc)) {
    const auto always = [](double value) {
      Schedule schedule;
      schedule.value = value;
      return schedule;
    };
    bool corner = false;  // the bottom row holds uy of its first disc already
    for (const Support& support : setup.supports) {
      TimedSupport& timed = scene.supports.emplace_back();
      timed.group = support.group;
      if (support.ux) timed.ux = always(*support.ux);
      if (support.uy && !corner) timed.uy = always(*support.uy);
      corner = corner || support.uy.has_value();
    }
    for (const Load& load : setup.loads) scene.loads.push_back({load, always(1)});
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  [[nodiscard]] std::vector<DiscMotion> solve(const SolverOptions& solver) const {
    EquilibriumOptions options;
    options.solver = solver;
    return solve_equilibrium(assembly, springs, setup.supports, setup.loads, options).motions;
  }

  /// Relative error of displacements, 2-norm.
  [[nodiscard]] double error(const std::vector<DiscMotion>& motions) const {
    double off = 0, size = 0;
    for (std::size_t d = 0; d < motions.size(); ++d) {
      off += squared(motions[d].u - truth[d].u);
      size += squared(truth[d].u);
    }
    return std::sqrt(off / size);
  }

  Assembly assembly;
  ContactSprings springs{study_springs};
  TensionSetup setup;
  std::vector<DiscMotion> truth;
  Scene scene;
};

/// Built when it is first needed.
struct LazyBlock {
  explicit LazyBlock(int rows_of_block) : rows(rows_of_block) {}
  int rows;
  std::optional<Block> block = {};
  const Block& get() {
    if (!block) block.emplace(rows);
    return *block;
  }
};

struct Solved {
  std::vector<DiscMotion> motions = {};
  double unbalanced = std::numeric_limits<double>::quiet_NaN();  ///< relative force that relaxation leaves
};
using Solve = std::function<Solved(const Block&)>;

struct MeasuredSolution {
  PeakMemory memory;
  Solved solved;
};

/// Adds the settings of one block.
class BlockTasks {
 public:
  BlockTasks(int rows, std::vector<StudyTask>& tasks)
      : block_(std::make_shared<LazyBlock>(rows)), discs_(static_cast<double>(rows) * rows), tasks_(tasks) {}

  void add(const std::string& method, std::vector<std::pair<std::string, double>> values, Solve solve) {
    const std::string problem = fmt::format("{0} x {0} discs", block_->rows);
    tasks_.push_back(task_on(
        {.problem = problem, .method = method, .values = std::move(values), .size = discs_},
        [block = block_] { return static_cast<void>(block->get()), MeasuredSolution{}; },
        [block = block_, solve = std::move(solve)](MeasuredSolution& result) { result.solved = solve(block->get()); },
        [block = block_](const MeasuredSolution& result) {
          const double megabytes = 1e-6 * result.memory.bytes();
          return std::vector{block->get().error(result.solved.motions), result.solved.unbalanced, megabytes};
        }));
  }

  void add_direct(const std::string& method, SolverOptions solver) {
    for (const int refinements : {0, 4}) {
      if (refinements == 0 && discs_ > large) continue;
      solver.max_refinements = refinements;
      add(method, {{"refinements", static_cast<double>(refinements)}},
          [solver](const Block& block) { return Solved{.motions = block.solve(solver)}; });
    }
  }

  void add_multigrid() {
    for (const double accuracy : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
      add("multigrid", {{"accuracy", accuracy}}, [accuracy](const Block& block) {
        return Solved{.motions = block.solve({.method = SolverMethod::multigrid, .accuracy = accuracy})};
      });
    }
    add("multigrid", {},
        [](const Block& block) { return Solved{.motions = block.solve({.method = SolverMethod::multigrid})}; });
  }

  /// \param step of the digits from one tolerance to the next
  void add_relaxation(int step) {
    for (int digits = 3; digits <= 12; digits += step) {
      const double tolerance = std::pow(10.0, -digits);
      add("relaxation", {{"tolerance", tolerance}}, [tolerance](const Block& block) {
        RelaxationOptions options;
        options.tolerance = tolerance;
        const Relaxation rest = relax(block.scene, options);
        return Solved{rest.motions, rest.relative_unbalanced};
      });
    }
  }

 private:
  std::shared_ptr<LazyBlock> block_;
  double discs_;
  std::vector<StudyTask>& tasks_;
};

Study study_of_blocks(const std::vector<int>& rows_of_blocks) {
  Study study{.name = "solvers",
              .title = "A hexagonal block in tension",
              .quantities = {{.name = "displacements",
                              .label = "relative error of the displacements",
                              .source = "direct solution refined with the forces of contacts in twice the digits",
                              .rounding = 1.1e-16},
                             {.name = "unbalanced",
                              .label = "relative unbalanced force that is left",
                              .fact = true,
                              .resolution = true},
                             {.name = "memory", .label = "memory beyond that of the block, MB", .fact = true}},
              .tasks = {}};
  study.size = "discs";
  study.compared = {1e-6, 1e-12};
  for (const int rows : rows_of_blocks) {
    BlockTasks tasks(rows, study.tasks);
    for (const auto& solver : EnumNames<SolverMethod>::list) {
      const SolverMethod method = solver.value;
      if (method == SolverMethod::automatic || solver.back_end.iterative) continue;
      if (method == SolverMethod::umfpack && static_cast<std::size_t>(rows) * rows > large) continue;
      tasks.add_direct(solver.name, {.method = method});
    }
    tasks.add_multigrid();
    if (rows < 400) tasks.add_relaxation(rows < 100 ? 1 : rows < 200 ? 3 : 9);
  }
  study.orders = {
      {.method = "relaxation", .order = 1, .why = "the error is K^-1 times the unbalanced force that is left"}};
  study.notes = {
      "The order of relaxation is that of the error over the unbalanced force that is left, not over the tolerance: "
      "the force is checked every 25 steps and may be 10,000 times smaller than at the check before, so that several "
      "tolerances end in the same state.",
      "The accuracy of multigrid is that of the norm of energy, which it estimates; without one its residual is that "
      "of round-off. Its time grows as the number of discs, that of relaxation as its power 1.5: relaxation is left "
      "out of blocks of more than 1.6e5 discs, UMFPACK, which would take some 20 GB for 1e6, out of those of more "
      "than 2e5.",
      "Memory is the peak of the solution, of the whole process, beyond what the block takes."};
  return study;
}

}  // namespace

Study solvers_study(bool quick) {
  return quick ? study_of_blocks({15, 31}) : solvers_study_up_to(1e5);
}

Study solvers_study_up_to(double discs) {
  std::vector<int> rows;
  for (double size = discs; size >= 999; size /= 10)
    rows.push_back(static_cast<int>(std::lround(std::sqrt(size))) | 1);  // odd: a disc is in the middle
  std::ranges::reverse(rows);
  return study_of_blocks(rows);
}

}  // namespace equidem
