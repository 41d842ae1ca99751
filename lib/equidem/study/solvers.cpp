// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// One linear system, many ways: direct solvers with and without refinement, and relaxation to a tolerance.
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "equidem/assembly/lattices.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/relaxation.hpp"
#include "equidem/homogenize/tension_test.hpp"
#include "equidem/study/built_in.hpp"

namespace equidem {
namespace {

/// The block of Abe (1996), Fig. 6, in tension, and its true motions.
struct Block {
  explicit Block(int rows)
      : assembly(hexagonal_lattice({.columns = rows, .rows = rows, .radius = 0.005})),
        setup(tension_setup(assembly, {})),
        truth(solve(SolverMethod::cholmod, 10)),
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

  [[nodiscard]] std::vector<DiscMotion> solve(SolverMethod method, int refinements) const {
    EquilibriumOptions options;
    options.solver.method = method;
    options.solver.max_refinements = refinements;
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
  std::vector<DiscMotion> motions;
  double unbalanced = std::numeric_limits<double>::quiet_NaN();  ///< relative force that relaxation leaves
};
using Solve = std::function<Solved(const Block&)>;

StudyTask task_of(const std::shared_ptr<LazyBlock>& lazy, Setting setting, Solve solve) {
  return task_on(
      std::move(setting), [lazy] { return static_cast<void>(lazy->get()), Solved{}; },
      [lazy, solve = std::move(solve)](Solved& solved) { solved = solve(lazy->get()); },
      [lazy](const Solved& solved) {
        return std::vector{lazy->get().error(solved.motions), solved.unbalanced};
      });
}

}  // namespace

Study solvers_study(bool quick) {
  Study study{.name = "solvers",
              .title = "A hexagonal block in tension",
              .quantities = {{.name = "displacements",
                              .label = "relative error of the displacements",
                              .source = "direct solution refined with the forces of contacts in twice the digits",
                              .rounding = 1.1e-16},
                             {.name = "unbalanced",
                              .label = "relative unbalanced force that is left",
                              .fact = true,
                              .resolution = true}},
              .tasks = {}};
  for (const int rows : quick ? std::vector{15, 31} : std::vector{21, 101, 201}) {
    const auto lazy = std::make_shared<LazyBlock>(rows);
    const std::string problem = fmt::format("{} x {} discs", rows, rows);
    for (const auto& solver : EnumNames<SolverMethod>::list) {
      const SolverMethod method = solver.value;
      if (method == SolverMethod::automatic) continue;
      for (const int refinements : {0, 4}) {
        study.tasks.push_back(
            task_of(lazy,
                    {.problem = problem,
                     .method = to_string(method),
                     .values = {{"refinements", static_cast<double>(refinements)}}},
                    [=](const Block& block) { return Solved{.motions = block.solve(method, refinements)}; }));
      }
    }
    for (int digits = 3; digits <= 12; digits += rows < 100 ? 1 : 3) {
      const double tolerance = std::pow(10.0, -digits);
      study.tasks.push_back(task_of(lazy,
                                    {.problem = problem, .method = "relaxation", .values = {{"tolerance", tolerance}}},
                                    [=](const Block& block) {
                                      RelaxationOptions options;
                                      options.tolerance = tolerance;
                                      const Relaxation rest = relax(block.scene, options);
                                      return Solved{rest.motions, rest.relative_unbalanced};
                                    }));
    }
  }
  study.orders = {
      {.method = "relaxation", .order = 1, .why = "the error is K^-1 times the unbalanced force that is left"}};
  study.notes = {
      "The order of relaxation is that of the error over the unbalanced force that is left, not over the tolerance: "
      "the force is checked every 25 steps and may be 10,000 times smaller than at the check before, so that several "
      "tolerances end in the same state."};
  return study;
}

}  // namespace equidem
