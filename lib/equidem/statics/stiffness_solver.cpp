// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/stiffness_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/large_buffer.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

constexpr std::size_t components_at_once = 1 << 14;
constexpr double of_one_pass = 2e-6;  // accuracy of iterations, which multiply by a matrix in single precision

double norm_of(std::span<const double> x) {
  return std::sqrt(sums_over<1>(x.size(), components_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (const double value : x.subspan(begin, end - begin)) sum += value * value;
    return std::array{sum};
  })[0]);
}

}  // namespace

/// K d = f - f_int(u), u := u + d, until the residual no longer falls. The first pass is the solution itself; the
/// residual comes from the contact law, the motion is kept to twice the digits.
///
/// Round-off of a factor in double precision hides the softest motions first, of which a correction then brings only a
/// part, and always the same one: where corrections shrink slowly, each is scaled to the least energy,
/// u := u + (d.r / d.K d) d, which brings all of one such motion.
struct StiffnessSolver::Refinement {
  StiffnessSolver& solver;
  const RightHandSide& given;
  double good_enough;
  Solution solution;
  bool done = false;
  Factorization::Energies energies{};  ///< of the correction that comes next, where the method is iterative

  /// \param residual becomes f - f_int of the start, in which held components move and no other
  Refinement(StiffnessSolver& solver, const RightHandSide& given, std::span<double> residual, double good_enough);

  /// Adds the correction x, which a pass with the factor made of the residual, and replaces x by the new residual.
  void correct(std::span<double> x, int pass);

  /// Solves for the residual x to a relative accuracy in the norm of energy, and ends there. x becomes the residual.
  void solve_to(double accuracy, std::span<double> x);

  /// \throws Error where the solution is worth nothing
  Solution finish();

 private:
  void add_correction(std::span<double> x, int pass);
  double evaluate(std::span<double> residual) const;
  bool scale_to_least_energy(std::span<double> x) const;
  [[nodiscard]] double affine_length() const;
  [[nodiscard]] double affine_force() const;
  template <typename Square>
  [[nodiscard]] double norm_of_affine(const Square& square) const;

  PreciseMotion previous_{0};
  int corrections_ = 0;
  double last_step_ = 0;  // size of the last correction, m
};

StiffnessSolver::Refinement::Refinement(StiffnessSolver& solver_in, const RightHandSide& given_in,
                                        std::span<double> residual, double good_enough_in)
    : solver(solver_in), given(given_in), good_enough(good_enough_in) {
  const auto& unknowns = solver.unknowns_;
  solution.motion = PreciseMotion(unknowns.held.size());
  bool moves = given.gradient.has_value();
  for (std::size_t k = 0; k < given.prescribed.size(); ++k) {
    if (unknowns.held[k] == 0 || given.prescribed[k] == 0) continue;
    solution.motion.high[k] = given.prescribed[k];
    moves = true;
  }
  if (moves) {
    evaluate(residual);
  } else {
    parallel_ranges(residual.size(), components_at_once, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        residual[k] = unknowns.held[k] != 0 || given.force.empty() ? 0 : given.force[k];
      }
    });
  }
  solution.residual = solver.norm_of_free(residual);
  solution.scale = std::max(solution.residual, affine_force());
  done = solution.residual == 0;
}

void StiffnessSolver::Refinement::correct(std::span<double> x, int pass) {
  parallel_ranges(x.size(), components_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (solver.unknowns_.held[k] != 0) x[k] = 0;
    }
  });
  ++corrections_;
  add_correction(x, pass);
}

void StiffnessSolver::Refinement::solve_to(double accuracy, std::span<double> x) {
  double energy = 0, reached = 1;
  do {
    reached = std::max(accuracy, of_one_pass * reached);
    energies = solver.factor_->solve_to(reached, energy, x);
    solution.motion.add(x);
    solution.residual = evaluate(x);
    solution.energy_error = energies.error;
    energy = std::max(energy, energies.solution);
  } while (reached > accuracy);
  done = true;
}

void StiffnessSolver::Refinement::add_correction(std::span<double> x, int pass) {
  constexpr double slow = 0.05;  // share of the error that a pass leaves
  const double step = solver.norm_of_free(x);
  const bool scaled = pass > 0 && step > slow * last_step_ && scale_to_least_energy(x);
  last_step_ = step;
  if (pass > 0) previous_ = solution.motion;
  solution.motion.add(x);
  const double before = solution.residual;
  const double now = evaluate(x);
  if (pass > 0 && !scaled && !(now < before)) {  // no better: keep the previous motion
    solution.motion = std::move(previous_);
    done = true;
    return;
  }
  previous_ = PreciseMotion(0);
  solution.residual = now;
  solution.refinements = pass;
  solution.energy_error =
      scaled ? energies.solution : std::max(energies.error, of_one_pass * of_one_pass * energies.solution);
  done = now <= good_enough * solution.scale || (pass > 0 && !scaled && now > 0.5 * before);
}

Solution StiffnessSolver::Refinement::finish() {
  constexpr const char* too_soft = "the stiffness matrix is too close to singular for the digits of a double";
  constexpr const char* remedy =
      "Hold a slender assembly in more places, make springs less different in size, or use fewer discs";
  constexpr double worthless = 1e-3;
  const double relative = solution.relative_residual();
  if (!std::isfinite(relative)) {
    bad_input("the numbers of this case overflow a double", fmt::format("the residual comes out as {}", relative),
              "Check the units of sizes, springs and loads");
  }
  if (!(relative <= worthless) && (solver.options_.accuracy == 0 || solution.energy_error == 0)) {
    computation_failed(fmt::format("the solution leaves a relative residual of {:.1e}", relative), too_soft, remedy);
  }
  const double size = std::hypot(norm_of(solution.motion.high), affine_length());
  if (corrections_ > 1 && relative > 0 && !(last_step_ <= worthless * size)) {
    computation_failed(fmt::format("the last of {} refinements still changed the motions by {:.1e} of their size",
                                   corrections_ - 1, last_step_ / size),
                       too_soft, remedy);
  }
  return std::move(solution);
}

double StiffnessSolver::Refinement::evaluate(std::span<double> residual) const {
  solver.evaluate_residual(given, solution.motion, residual);
  return solver.norm_of_free(residual);
}

/// x := (x.r / x.K x) x, the multiple of x at which the energy is stationary; false where there is none.
bool StiffnessSolver::Refinement::scale_to_least_energy(std::span<double> x) const {
  std::vector<double> residual(x.size());
  evaluate(residual);
  DoubleDouble work;
  for (std::size_t k = 0; k < x.size(); ++k) work += DoubleDouble::product(x[k], residual[k]);
  const double factor = static_cast<double>(work) / solver.twice_energy(x);
  constexpr double most = 100;  // more: the motions of the factor are not those of K
  if (!(factor > 0 && factor < most)) return false;
  for (double& value : x) value *= factor;
  return true;
}

/// Root of the sum of square(contact, deformation by the mean strain) over the contacts.
template <typename Square>
double StiffnessSolver::Refinement::norm_of_affine(const Square& square) const {
  if (!given.gradient) return 0;
  const Assembly& assembly = solver.assembly_;
  return std::sqrt(sums_over<1>(assembly.contacts.size(), components_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t c = begin; c < end; ++c) {
      sum +=
          square(c, affine_deformation(frame_of(assembly, c), assembly.branch(assembly.contacts[c]), *given.gradient));
    }
    return std::array{sum};
  })[0]);
}

double StiffnessSolver::Refinement::affine_length() const {
  return norm_of_affine(
      [](std::size_t, const ContactDeformation& d) { return d.normal * d.normal + d.tangential * d.tangential; });
}

/// Size of the forces that the mean strain causes, before they cancel on each disc.
double StiffnessSolver::Refinement::affine_force() const {
  return std::sqrt(2.0) * norm_of_affine([&](std::size_t c, const ContactDeformation& d) {
           const ContactForce f = linear_spring_force(solver.springs_[c], d);
           return f.normal * f.normal + f.tangential * f.tangential;
         });
}

StiffnessSolver::StiffnessSolver(const Assembly& assembly, const ContactSprings& springs, ContactGraph graph,
                                 DegreesOfFreedom unknowns, const SolverOptions& options, Mechanisms mechanisms,
                                 StageTimes& times)
    : assembly_(assembly),
      springs_(springs),
      graph_(std::move(graph)),
      unknowns_(std::move(unknowns)),
      options_(options),
      mechanisms_(mechanisms),
      on_graph_{matrix_, assembly_, graph_} {
  const SolverMethod method = choose_method(assembly_, springs_, options_);
  if (!entry_of(method).back_end.iterative) {
    eliminate(method, times);
  } else if (options.method == method) {
    iterate(method, times);
  } else {
    try {
      iterate(method, times);
    } catch (const Error& error) {
      fall_back_to_elimination(error, times);
    }
  }
  const Stopwatch watch;
  unstable_modes_ = count_unstable_modes();
  times.add("inertia", watch.seconds());
}

void StiffnessSolver::iterate(SolverMethod method, StageTimes& times) {
  method_ = method;
  check_memory(estimate_iterations(assembly_, unknowns_), options_.memory_limit);
  factor_ = factorize(system(), method, mechanisms_, times);
}

void StiffnessSolver::fall_back_to_elimination(const Error& error, StageTimes& times) {
  if (error.kind() != ErrorKind::computation_failed) throw;
  why_method_ = error.problem();
  factor_.reset();
  eliminate(SolverMethod::multifrontal, times);
}

void StiffnessSolver::eliminate(SolverMethod method, StageTimes& times) {
  method_ = method;
  Stopwatch watch;
  DissectionTree tree = dissect(assembly_, graph_);
  times.add("order", watch.lap());
  symbolic_ = std::make_shared<const SymbolicFactor>(analyze(std::move(tree), graph_, unknowns_.per_disc));
  times.add("analyze", watch.lap());
  SolveEstimate size = estimate(*symbolic_, unknowns_, springs_.may_be_indefinite());
  size.peak_bytes *= memory_factor(method, options_.ordering);
  check_memory(size, options_.memory_limit);
  watch.lap();
  matrix_ = assemble_stiffness(assembly_, graph_, springs_, unknowns_);
  times.add("assemble", watch.lap());
  factor_ = factorize(system(), method, mechanisms_, times);
}

System StiffnessSolver::system() const {
  constexpr int given_up = 60;  // by "auto": elimination takes no longer
  const bool automatic = options_.method == SolverMethod::automatic;
  return {on_graph_, springs_, unknowns_, symbolic_, automatic ? given_up : most_iterations, options_};
}

std::string StiffnessSolver::solver_name() const {
  std::string name = factor_->report().name;
  if (!why_method_.empty()) name += fmt::format(" ({})", why_method_);
  return name;
}

SolverFindings StiffnessSolver::findings() const {
  const FactorReport& report = factor_->report();
  return {.solver = solver_name(),
          .unknowns = unknowns_.unknowns,
          .mechanisms = report.zero_pivots,
          .negative_pivots = report.negative_pivots,
          .unstable_modes = unstable_modes_,
          .iterations = report.iterations,
          .pivot_growth = report.growth,
          .factor_nonzeros = report.nonzeros,
          .factor_bytes = report.bytes};
}

/// A mechanism deforms no contact: prescribed motions and mean strains do no work on it, loads may.
std::optional<std::vector<double>> StiffnessSolver::driven_mechanism(std::span<const double> force) const {
  for (std::int64_t k = 0; !force.empty() && k < factor_->report().zero_pivots; ++k) {
    std::vector<double> motion = factor_->null_motion(k);
    if (does_work(force, motion, unknowns_.per_disc)) return motion;
  }
  return {};
}

std::string StiffnessSolver::describe_mechanism(std::int64_t k) const {
  return describe_motion(assembly_, disc_motions(unknowns_, factor_->null_motion(k)));
}

void StiffnessSolver::refuse_floppy(const std::string& name) const {
  constexpr std::int64_t most = 1000;
  const std::int64_t mechanisms = factor_->report().zero_pivots;
  if (mechanisms <= most) return;
  bad_input(fmt::format("{} is floppy: it has {} mechanisms", name, mechanisms),
            fmt::format("a motion has no energy: {}", describe_mechanism(0)),
            remedy_of_mechanisms(assembly_, springs_, unknowns_.per_disc == 3));
}

std::optional<std::int64_t> StiffnessSolver::count_unstable_modes() const {
  if (!springs_.may_be_indefinite()) return 0;
  const auto negative = factor_->report().negative_pivots;
  const auto of_rotations = negative ? negative_rotations(system()) : std::nullopt;
  return of_rotations ? std::optional(*negative - *of_rotations) : std::nullopt;
}

double StiffnessSolver::norm_of_free(std::span<const double> x) const {
  return std::sqrt(sums_over<1>(x.size(), components_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) {
      if (unknowns_.held[k] == 0) sum += x[k] * x[k];
    }
    return std::array{sum};
  })[0]);
}

void StiffnessSolver::evaluate_residual(const RightHandSide& given, const PreciseMotion& motion,
                                        std::span<double> residual) const {
  residual_force({assembly_, graph_, springs_, unknowns_}, motion, given.gradient, given.force, residual);
}

void StiffnessSolver::refine(std::span<const RightHandSide> cases, std::vector<Solution>& solutions,
                             StageTimes& times) {
  const double good_enough = entry_of(method_).back_end.good_enough;
  const std::size_t n = unknowns_.held.size();
  LargeVector<double> x(n * cases.size());
  const auto column = [&](std::size_t k) { return std::span(x).subspan(k * n, n); };
  std::vector<Refinement> all;
  all.reserve(cases.size());
  for (std::size_t k = 0; k < cases.size(); ++k) all.emplace_back(*this, cases[k], column(k), good_enough);
  Stopwatch watch;
  if (options_.accuracy > 0 && iterative()) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!all[k].done) all[k].solve_to(options_.accuracy, column(k));
    }
    times.add("solve", watch.lap());
  }
  for (int pass = 0; pass <= options_.max_refinements; ++pass) {
    stop_if_interrupted();
    std::vector<Refinement*> open;  // their residuals stand one after another at the front of x
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].done) continue;
      if (k != open.size()) std::ranges::copy(column(k), column(open.size()).begin());
      open.push_back(&all[k]);
    }
    if (open.empty()) break;
    if (iterative()) {
      constexpr double rough = 0.1;  // for rounding: lattices are at rest under a mean strain
      for (std::size_t k = 0; k < open.size(); ++k) {
        const Solution& now = open[k]->solution;
        open[k]->energies = factor_->solve_to(now.residual <= good_enough * now.scale ? rough : 0, 0, column(k));
      }
    } else {
      factor_->solve(std::span(x).first(open.size() * n), static_cast<int>(open.size()));
    }
    for (std::size_t k = open.size(); k-- > 0;) {
      const auto position = static_cast<std::size_t>(open[k] - all.data());
      if (position != k) std::ranges::copy(column(k), column(position).begin());
      all[position].correct(column(position), pass);
    }
    times.add(pass == 0 ? "solve" : "refine", watch.lap());
  }
  for (Refinement& one : all) solutions.push_back(one.finish());
}

std::vector<Solution> StiffnessSolver::solve(std::span<const RightHandSide> cases, StageTimes& times) {
  std::vector<Solution> solutions;
  const auto solve_all = [&] {
    // Iterations one after another: vectors of one case take as much memory as the grids.
    const std::size_t at_once = iterative() ? 1 : cases.size();
    for (std::size_t k = 0; k < cases.size(); k += at_once) refine(cases.subspan(k, at_once), solutions, times);
  };
  try {
    solve_all();
  } catch (const Error& error) {
    if (method_ == options_.method || !iterative()) throw;
    fall_back_to_elimination(error, times);
    solutions.clear();
    solve_all();
  }
  return solutions;
}

double StiffnessSolver::rounded_residual(const RightHandSide& given, const PreciseMotion& motion) const {
  PreciseMotion rounded(0);
  rounded.high = motion.high;
  std::vector<double> residual(motion.high.size());
  evaluate_residual(given, rounded, residual);
  return norm_of_free(residual);
}

ContactMotion StiffnessSolver::contact_motion(const RightHandSide& given, const PreciseMotion& motion,
                                              std::size_t contact) const {
  return motion_of({assembly_, graph_, springs_, unknowns_}, motion, given.gradient, contact);
}

double StiffnessSolver::twice_energy(std::span<const double> x) const {
  return 2 * elastic_energy(assembly_, springs_, disc_motions(unknowns_, x));
}

SoftestMotion StiffnessSolver::softest_motion(std::span<const double> start) {
  return iterate_inverse(start, {});
}

double StiffnessSolver::scaled_inverse_norm(std::span<const double> start) {
  std::vector<double> root = row_sums();
  for (double& value : root) value = std::sqrt(value);
  return iterate_inverse(start, std::move(root)).inverse_norm;
}

SoftestMotion StiffnessSolver::iterate_inverse(std::span<const double> start, std::vector<double> scale) {
  const auto scale_of = [&](std::size_t k) { return unknowns_.held[k] != 0 ? 0.0 : scale.empty() ? 1.0 : scale[k]; };
  std::vector<double> x(start.begin(), start.end());
  x.resize(unknowns_.held.size());
  const auto multiply_by_scale = [&] {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] *= scale_of(k);
  };
  multiply_by_scale();
  if (norm_of_free(x) == 0) {
    Random random(1);
    for (double& value : x) value = random.uniform() - 0.5;
  }
  SoftestMotion result;
  const auto make_unit = [&] {
    const double size = norm_of_free(x);
    if (size > 0) {
      for (double& value : x) value /= size;
    }
    return size;
  };
  if (!(make_unit() > 0)) return result;
  // Iterations cost as much as those of the solution: one pass, and the quotient of Rayleigh in place of its growth.
  const int passes = iterative() ? 1 : 2;
  for (int pass = 0; pass < passes; ++pass) {
    stop_if_interrupted();
    multiply_by_scale();
    factor_->solve_roughly(x);
    multiply_by_scale();
    result.inverse_norm = std::max(result.inverse_norm, make_unit());
  }
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = scale_of(k) > 0 ? x[k] / scale_of(k) : 0;
  // Round-off of the factor may make the motion stiffer than it is, and where the solutions are rough, softer, too. The
  // quotient of Rayleigh does not depend on them; for an exact factor it is at least the growth of the last pass.
  const double stiffness = springs_.may_be_indefinite() ? 0 : twice_energy(x);
  if (stiffness > 0) result.inverse_norm = std::max(iterative() ? 0.0 : result.inverse_norm, 1 / stiffness);
  result.motion = std::move(x);
  return result;
}

double StiffnessSolver::scaled_residual(const RightHandSide& given, const PreciseMotion& motion) const {
  const std::vector<double> scale = row_sums();
  std::vector<double> residual(unknowns_.held.size());
  evaluate_residual(given, motion, residual);
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (unknowns_.held[k] == 0) residual[k] /= std::sqrt(scale[k]);
  }
  return norm_of_free(residual);
}

double StiffnessSolver::scaled_residual_bound(std::span<const RightHandSide> cases,
                                              std::span<const Solution> solutions) const {
  const std::vector<double> rows = row_sums();
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (unknowns_.held[k] != 0) continue;
    least = std::min(least, rows[k]);
    most = std::max(most, rows[k]);
  }
  constexpr double alike = 100;
  const bool each = !(least > 0) || most > alike * least;
  double largest = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    largest = std::max(
        largest, each ? scaled_residual(cases[k], solutions[k].motion) : solutions[k].residual / std::sqrt(least));
  }
  return largest;
}

double normal_rounding(const Assembly& assembly, const Contact& contact) {
  if (!assembly.periodic()) return 2;
  const Vec2 shift{contact.shift_x * assembly.period->x, contact.shift_y * assembly.period->y};
  return 2 + norm(shift) / norm(assembly.branch(contact));
}

double StiffnessSolver::rounding_work(const RightHandSide& given, const PreciseMotion& motion,
                                      std::span<const double> v) const {
  constexpr double rounding = 0x1.0p-52;
  const auto b = static_cast<std::size_t>(unknowns_.per_disc);
  const SpringNetwork network{assembly_, graph_, springs_, unknowns_};
  PreciseMotion other(0);
  other.high.assign(v.begin(), v.end());
  constexpr std::size_t contacts_at_once = 1 << 13;
  return sums_over<1>(assembly_.contacts.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
    double work = 0;
    for (std::size_t c = begin; c < end; ++c) {
      const Contact& contact = assembly_.contacts[c];
      const std::size_t i = contact.i * b, j = contact.j * b;
      const auto distance = [&](std::span<const double> x) {
        return equidem::norm(Vec2{x[j] - x[i], x[j + 1] - x[i + 1]});
      };
      const auto force = [&](const PreciseMotion& m, const std::optional<Tensor2>& gradient) {
        const auto f = linear_spring_force(springs_[c], motion_of(network, m, gradient, c).deformation);
        return std::abs(f.normal) + std::abs(f.tangential);
      };
      work += rounding * normal_rounding(assembly_, contact) *
              (distance(motion.high) * force(other, {}) + distance(v) * force(motion, given.gradient));
    }
    return std::array{work};
  })[0];
}

std::vector<double> StiffnessSolver::row_sums() const {
  return equidem::row_sums({assembly_, graph_, springs_, unknowns_});
}

double StiffnessSolver::norm() const {
  const std::vector<double> sum = row_sums();
  double largest = 0;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (unknowns_.held[k] == 0) largest = std::max(largest, sum[k]);
  }
  return largest;
}

}  // namespace equidem
