// SPDX-License-Identifier: GPL-3.0-or-later
#include "hard_cases/ledger.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include <nlohmann/json.hpp>

#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/statics/number_unknowns.hpp"

#include "hard_cases/oracle.hpp"
#include "support/catch.hpp"

namespace equidem::test {
namespace {

DegreesOfFreedom unknowns_of(const Problem& problem) {
  return number_unknowns(problem.assembly, problem.springs, derive_effects(problem.springs, problem.rotation),
                         problem.supports);
}

std::vector<double> forces_of(const Problem& problem, const DegreesOfFreedom& unknowns) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<double> force(problem.assembly.size() * b, 0.0);
  for (const Load& load : problem.loads) {
    const auto& discs = group(problem.assembly, load.group).discs;
    const double share = load.kind == LoadKind::total ? 1 / static_cast<double>(discs.size()) : 1;
    for (const std::int32_t d : discs) {
      force[d * b] += share * load.force.x;
      force[d * b + 1] += share * load.force.y;
      if (b == 3) force[d * b + 2] += share * load.moment / unknowns.rotation_scale;
    }
  }
  return force;
}

template <typename Number>
double error_of(const Equilibrium& state, const DegreesOfFreedom& unknowns, const std::vector<Number>& exact) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  Number off = 0, size = 0;
  for (std::size_t d = 0; d < state.motions.size(); ++d) {
    const DiscMotion& m = state.motions[d];
    const double motion[3] = {m.u.x, m.u.y, unknowns.rotation_scale * m.theta};
    for (std::size_t k = 0; k < b; ++k) {
      const Number e = exact[d * b + k];
      off += (motion[k] - e) * (motion[k] - e);
      size += e * e;
    }
  }
  return std::sqrt(static_cast<double>(off / size));
}

Equilibrium state_of(const Problem& problem, Answer& answer) {
  Equilibrium state =
      solve_equilibrium(problem.assembly, problem.springs, problem.supports, problem.loads,
                        {.rotation = problem.rotation, .solver = {.method = problem.method}, .error_bound = true});
  answer.bound = state.error_bound;
  answer.condition = state.condition;
  answer.residual = state.relative_residual;
  answer.unstable_modes = state.unstable_modes;
  return state;
}

std::string rounded(double x) {
  return fmt::format("{:.1e}", x);
}

}  // namespace

Answer attempt(const std::function<void()>& call) {
  Answer answer;
  answer.refusal = refusal_of(call);
  return answer;
}

Answer solve(const Problem& problem) {
  Answer answer;
  answer.refusal = refusal_of([&] {
    const Equilibrium state = state_of(problem, answer);
    const DegreesOfFreedom unknowns = unknowns_of(problem);
    answer.error = error_of(state, unknowns,
                            exact_motion(problem.assembly, problem.springs, unknowns, forces_of(problem, unknowns)));
  });
  return answer;
}

Answer solve(const Problem& problem, const std::vector<double>& exact) {
  Answer answer;
  answer.refusal = refusal_of([&] { answer.error = error_of(state_of(problem, answer), unknowns_of(problem), exact); });
  return answer;
}

Answer solve_by_multigrid(Problem problem) {
  Answer eliminated, answer;
  std::vector<double> motions;
  problem.method = SolverMethod::multifrontal;
  eliminated.refusal = refusal_of([&] {
    const Equilibrium state = state_of(problem, eliminated);
    const DegreesOfFreedom unknowns = unknowns_of(problem);
    for (const DiscMotion& m : state.motions) {
      motions.insert(motions.end(), {m.u.x, m.u.y});
      if (unknowns.per_disc == 3) motions.push_back(unknowns.rotation_scale * m.theta);
    }
  });
  problem.method = SolverMethod::multigrid;
  answer = solve(problem, motions);
  answer.bound += eliminated.bound;
  return answer;
}

Answer homogenize(const Assembly& cell, const ContactSprings& springs, Rotation rotation, const Matrix3& exact,
                  SolverMethod method) {
  Answer answer;
  answer.refusal = refusal_of([&] {
    const EffectiveStiffness result =
        effective_stiffness(cell, springs, {.rotation = rotation, .solver = {.method = method}});
    const double size = largest_entry(exact);
    answer.error = largest_entry(result.stiffness + (-1.0) * exact) / size;
    answer.bound = result.error_bound / size;
    answer.condition = result.condition;
    answer.residual = result.relative_residual;
    answer.unstable_modes = result.unstable_modes;
  });
  return answer;
}

Answer homogenize(const Assembly& cell, const ContactSprings& springs, Rotation rotation) {
  Answer answer = homogenize(cell, springs, rotation, isotropic_stiffness(1, 1));
  return answer.refusal.message.empty() ? homogenize(cell, springs, rotation, exact_stiffness(cell, springs, rotation))
                                        : answer;
}

HardCase::HardCase(Words words) : words_(std::move(words)) {
  const char* threads = std::getenv("EQUIDEM_HARD_CASES_THREADS");
  if (threads != nullptr) set_thread_count(std::atoi(threads));
}

void HardCase::right(const std::string& task, const Answer& answer, double promised) {
  CAPTURE(words_.name, task, answer.error, answer.bound, answer.condition, answer.residual, promised,
          answer.refusal.message);
  CHECK(answer.refusal.message.empty());
  CHECK(answer.error <= answer.bound);
  CHECK(answer.bound <= promised);
  Accuracy& a = accuracies_[task];
  ++a.runs;
  a.error = std::max(a.error, answer.error);
  a.bound = std::max(a.bound, answer.bound);
  a.condition = std::max(a.condition, answer.condition);
  a.promised = std::max(a.promised, promised);
}

void HardCase::refused(const std::string& task, const Answer& answer, const std::vector<std::string>& words) {
  CAPTURE(words_.name, task, answer.error, answer.bound, answer.refusal.message);
  CHECK_FALSE(answer.refusal.remedy.empty());
  for (const std::string& part : words) {
    CAPTURE(part);
    CHECK(answer.refusal.says(part));
  }
  const bool known = std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) { return row.task == task; });
  if (!known) note(task, "refused", answer.refusal.message);  // the first of several
}

void HardCase::note(const std::string& task, const std::string& promised, const std::string& measured) {
  rows_.push_back({task, promised, measured});
}

HardCase::~HardCase() {
  const char* path = std::getenv("EQUIDEM_HARD_CASES");
  if (path == nullptr) return;
  std::ofstream file(path, std::ios::app);
  const auto write = [&](const Row& row) {
    file << nlohmann::json{{"case", words_.name},
                           {"why", words_.why},
                           {"task", row.task},
                           {"promised", row.promised},
                           {"measured", row.measured}}
         << '\n';
  };
  for (const auto& [task, a] : accuracies_) {
    const std::string condition = a.condition > 0 ? ", condition " + rounded(a.condition) : "";  // not of iterations
    write({task, "error <= bound <= " + rounded(a.promised),
           fmt::format("error {}, bound {}{}{}", rounded(a.error), rounded(a.bound), condition,
                       a.runs > 1 ? fmt::format(" (worst of {})", a.runs) : "")});
  }
  for (const Row& row : rows_) write(row);
}

}  // namespace equidem::test
