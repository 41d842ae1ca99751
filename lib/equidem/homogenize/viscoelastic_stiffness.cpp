// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/viscoelastic_stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/sample_solver.hpp"
#include "equidem/linear/ordering/symbolic_factor.hpp"
#include "equidem/linear/umfpack_factorization.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
namespace {

void check_harmonic(const ContactSprings& springs, const Viscoelasticity& viscoelasticity,
                    std::span<const double> frequencies, const HomogenizeOptions& options) {
  check(viscoelasticity.normal, "normal");
  check(viscoelasticity.tangential, "tangential");
  if (springs.any_negative()) {
    bad_input("some kT is negative, and the springs are viscoelastic",
              "an assembly with kT < 0 rests in a balance that no dashpot keeps: every rotation grows",
              "Use kT >= 0, or elastic springs");
  }
  if (springs.bends()) {
    bad_input("bonds resist bending, and the springs are viscoelastic",
              "the relaxation of the normal and the tangential spring does not determine that of bending",
              "Take kM and bond_width out, or [viscoelastic]");
  }
  for (const ViscoelasticSpring* spring : {&viscoelasticity.normal, &viscoelasticity.tangential}) {
    if (!springs.prestressed() || keeps_forces(*spring)) continue;
    bad_input(fmt::format("forces at rest count, and a spring is of the model \"{}\"", to_string(spring->model)),
              spring->model == SpringModel::maxwell ? "its dashpot flows until it carries none"
                                                    : "its stiffness at rest is not known, nor what it carries then",
              "Use kelvin_voigt or standard_solid, or effects.prestress = \"off\"");
  }
  if (options.boundary == Boundary::traction) {
    bad_input("the boundary is traction, and the springs are viscoelastic",
              "complex stiffness is computed from mean strains", "Use boundary = \"periodic\" or \"displacement\"");
  }
  for (const double frequency : frequencies) {
    if (frequency > 0 && std::isfinite(frequency)) continue;
    bad_input(
        fmt::format("a frequency is {} Hz", frequency),
        frequency == 0 ? "at rest a Maxwell spring has flowed and carries nothing, and others are elastic"
                       : "motions change as exp(i 2 pi frequency t)",
        frequency == 0 ? "Use a small frequency, or elastic springs of the relaxed stiffness" : "Give frequencies > 0");
  }
}

using Complex = std::complex<double>;

constexpr std::size_t numbers_at_once = 1 << 14;

double norm_of(std::span<const Complex> x) {
  return std::sqrt(sums_over<1>(x.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (const Complex& value : x.subspan(begin, end - begin)) sum += std::norm(value);
    return std::array{sum};
  })[0]);
}

/// Complex amplitudes of the motion that balances one mean strain: `in_phase` + i `out_of_phase`.
struct HarmonicMotion {
  PreciseMotion in_phase, out_of_phase;
  double residual = 0;  // 2-norm over the unknowns, N/m
  double scale = 0;     // N/m, reference of relative residuals: the forces that the mean strain causes by itself

  explicit HarmonicMotion(std::size_t components) : in_phase(components), out_of_phase(components) {}
  [[nodiscard]] double relative_residual() const { return scale > 0 ? residual / scale : 0.0; }
  void add(std::span<const Complex> x) {
    std::vector<double> part(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) part[k] = x[k].real();
    in_phase.add(part);
    for (std::size_t k = 0; k < x.size(); ++k) part[k] = x[k].imag();
    out_of_phase.add(part);
  }
};

/// Complex amplitudes of a contact, m and rad.
struct ContactAmplitudes {
  DeformationOf<Complex> deformation;
  Complex theta_i, theta_j;
};

/// The matrix K = K' + i K'' of one frequency on the unknowns of the elastic one, which hold all zero-energy modes. All
/// springs lie in one quarter of the complex plane, so that exp(-i pi/4) K has a positive definite real part wherever
/// no mechanism is, and K is singular for mechanisms alone. Forces at rest add their geometric stiffness to K': with
/// springs that keep them K' is at least the elastic matrix, which is positive definite then.
class HarmonicSystem {
 public:
  HarmonicSystem(const Assembly& assembly, const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                 const ContactSprings& elastic, Complex normal, Complex tangential, double unit)
      : storage_(parts(elastic, normal.real() / unit, tangential.real() / unit)
                     .with_prestress(elastic.scaled_prestress(1 / unit))),
        loss_(parts(elastic, normal.imag() / unit, tangential.imag() / unit).with_prestress({})),
        stored_{assembly, graph, storage_, unknowns},
        lost_{assembly, graph, loss_, unknowns},
        rows_(row_sums(stored_)) {
    const std::vector<double> of_loss = row_sums(lost_);
    for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k] += of_loss[k];
  }

  void factorize(StageTimes& times) {
    Stopwatch watch;
    const auto columns = [](const SpringNetwork& n) {
      return compress(assemble_stiffness(n.assembly, n.graph, n.springs, n.unknowns), n.assembly, n.graph, n.unknowns);
    };
    const CompressedColumns storage = columns(stored_), loss = columns(lost_);
    times.add("assemble", watch.lap());
    lu_ = umfpack_complex_lu(storage, loss);
    times.add("factorize", watch.lap());
  }
  [[nodiscard]] double factor_bytes() const { return lu_.bytes; }

  /// Solves and refines against the contact law, evaluated in extended precision.
  [[nodiscard]] HarmonicMotion solve(const Tensor2& gradient, int max_refinements) const {
    constexpr double good_enough = 1e-15, worthless = 1e-3;
    std::vector<Complex> x(rows_.size());
    HarmonicMotion motion(x.size());
    evaluate_residual(gradient, motion, x);
    motion.residual = norm_of(x);
    motion.scale = std::max(motion.residual, affine_force(gradient));
    for (int pass = 0; pass <= max_refinements && motion.residual > 0; ++pass) {
      lu_.solve(x);
      const HarmonicMotion before = motion;
      motion.add(x);
      evaluate_residual(gradient, motion, x);
      motion.residual = norm_of(x);
      if (pass > 0 && !(motion.residual < before.residual)) {  // no better: keep the previous motion
        motion = before;
        break;
      }
      if (motion.residual <= good_enough * motion.scale || (pass > 0 && motion.residual > 0.5 * before.residual)) break;
    }
    if (!(motion.relative_residual() <= worthless)) {
      computation_failed(fmt::format("the solution leaves a relative residual of {:.1e}", motion.relative_residual()),
                         "the complex stiffness matrix is too close to singular for the digits of a double",
                         "Choose another frequency, or springs less different in size");
    }
    return motion;
  }

  [[nodiscard]] ContactAmplitudes motion_of_contact(const Tensor2& gradient, const HarmonicMotion& motion,
                                                    std::size_t contact) const {
    const ContactMotion x = motion_of(stored_, motion.in_phase, gradient, contact);
    const ContactMotion y = motion_of(stored_, motion.out_of_phase, {}, contact);
    return {{{x.deformation.normal, y.deformation.normal}, {x.deformation.tangential, y.deformation.tangential}},
            {x.theta_i, y.theta_i},
            {x.theta_j, y.theta_j}};
  }
  [[nodiscard]] const ContactPrestress* prestress(std::size_t contact) const { return storage_.prestress(contact); }
  [[nodiscard]] SpringConstantsOf<Complex> springs_of(std::size_t contact) const {
    const SpringConstants storage = storage_[contact], loss = loss_[contact];
    return {{storage.kN, loss.kN}, {storage.kT, loss.kT}};
  }

  /// |D^-1/2 r|, square root of N, of the residual force r of a motion: D = diag(sum_j |K'_ij| + |K''_ij|).
  [[nodiscard]] double scaled_residual(const Tensor2& gradient, const HarmonicMotion& motion) const {
    std::vector<Complex> residual(rows_.size());
    evaluate_residual(gradient, motion, residual);
    for (std::size_t k = 0; k < residual.size(); ++k) residual[k] /= std::sqrt(rows_[k]);
    return norm_of(residual);
  }

  /// |A| of the symmetric matrix A = S K^-1 S, S = D^1/2, by powers of A^H A, where A^H x = conj(A conj(x)), from
  /// `start`: a lower bound, mostly within a factor of 2.
  [[nodiscard]] double scaled_inverse_norm(const HarmonicMotion& start) const {
    std::vector<Complex> x(rows_.size());
    const auto scale = [&] {
      for (std::size_t k = 0; k < x.size(); ++k) x[k] *= is_held(k) ? 0.0 : std::sqrt(rows_[k]);
    };
    const auto conjugate = [&] { std::ranges::transform(x, x.begin(), [](const Complex& v) { return std::conj(v); }); };
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = {start.in_phase.high[k], start.out_of_phase.high[k]};
    scale();
    if (norm_of(x) == 0) {
      for (std::size_t k = 0; k < x.size(); ++k) x[k] = is_held(k) ? 0.0 : 1.0 / static_cast<double>(k + 1);
    }
    double largest = 0;
    constexpr int passes = 4;
    for (int pass = 0; pass < passes; ++pass) {
      const double size = norm_of(x);
      if (!(size > 0)) break;
      for (Complex& value : x) value /= size;
      if (pass % 2 == 1) conjugate();
      scale();
      lu_.solve(x);
      scale();
      if (pass % 2 == 1) conjugate();
      largest = std::max(largest, norm_of(x));
    }
    return largest;
  }

 private:
  static ContactSprings parts(const ContactSprings& elastic, double normal, double tangential) {
    return elastic.changed([&](const SpringConstants& k) { return SpringConstants{normal * k.kN, tangential * k.kT}; });
  }
  [[nodiscard]] bool is_held(std::size_t component) const { return stored_.unknowns.held[component] != 0; }

  /// -K (motion + mean strain) per component, 0 where held, with (K' + i K'')(x + i y) = K' x - K'' y + i (K' y +
  /// K'' x): four evaluations of the law of real springs. The mean strain is in phase.
  void evaluate_residual(const Tensor2& gradient, const HarmonicMotion& motion, std::span<Complex> residual) const {
    std::vector<double> part(residual.size());
    const auto add = [&](const SpringNetwork& network, const PreciseMotion& moved,
                         const std::optional<Tensor2>& strained, Complex factor) {
      residual_force(network, moved, strained, {}, part);
      for (std::size_t k = 0; k < part.size(); ++k) residual[k] += factor * part[k];
    };
    std::ranges::fill(residual, 0.0);
    constexpr Complex i{0, 1};
    add(stored_, motion.in_phase, gradient, 1);
    add(lost_, motion.out_of_phase, {}, -1);
    add(stored_, motion.out_of_phase, {}, i);
    add(lost_, motion.in_phase, gradient, i);
  }

  [[nodiscard]] double affine_force(const Tensor2& gradient) const {
    const Assembly& a = stored_.assembly;
    return std::sqrt(2 * sums_over<1>(a.contacts.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
                       double sum = 0;
                       for (std::size_t c = begin; c < end; ++c) {
                         const auto d = affine_deformation(frame_of(a, c), a.branch(a.contacts[c]), gradient);
                         const SpringConstantsOf<Complex> k = springs_of(c);
                         sum += std::norm(k.kN * d.normal) + std::norm(k.kT * d.tangential);
                       }
                       return std::array{sum};
                     })[0]);
  }

  ContactSprings storage_, loss_;
  SpringNetwork stored_, lost_;
  std::vector<double> rows_;  // diagonal of D, Pa
  ComplexLu lu_;
};

/// Memory of a complex LU in UMFPACK's own order.
SolveEstimate estimate_complex(const SymbolicFactor& symbolic, const DegreesOfFreedom& unknowns) {
  SolveEstimate size = estimate(symbolic, unknowns, false);
  const double times = 2 * memory_factor(SolverMethod::umfpack, CholmodOrdering::equidem);  // numbers of two doubles
  size.factor_bytes *= times;
  size.peak_bytes *= times;
  return size;
}

/// Adds the energies of pairs of unit strains, N, and bounds their rounding as `EffectiveStiffness` is bounded.
void sum_harmonic(const SampleSolver& sample, const HarmonicSystem& system, const std::vector<HarmonicMotion>& motions,
                  HarmonicStiffness& result) {
  constexpr std::size_t pairs = 6;
  const Assembly& assembly = sample.assembly();
  using Sums = std::array<double, 2 * pairs + 1>;
  const Sums sums = contact_sums<std::tuple_size_v<Sums>>(assembly.contacts.size(), [&](std::size_t c, Sums& total) {
    const Contact& contact = assembly.contacts[c];
    const SpringConstantsOf<Complex> k = system.springs_of(c);
    const ContactPrestress* const prestress = system.prestress(c);
    std::array<ContactAmplitudes, 3> m;
    double largest_force = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      m[a] = system.motion_of_contact(unit_gradients[a], motions[a], c);
      const DeformationOf<Complex>& d = m[a].deformation;
      largest_force = std::max(largest_force, std::abs(k.kN * d.normal) + std::abs(k.kT * d.tangential));
    }
    const auto energy = [&](std::size_t a, std::size_t b) {
      const DeformationOf<Complex>&d = m[a].deformation, &e = m[b].deformation;
      const Complex of_springs = k.kN * d.normal * e.normal + k.kT * d.tangential * e.tangential;
      return prestress == nullptr ? of_springs
                                  : of_springs + prestress_form(*prestress, d, m[a].theta_i, m[a].theta_j, e,
                                                                m[b].theta_i, m[b].theta_j);
    };
    add_triangle(total.data(), [&](std::size_t a, std::size_t b) { return energy(a, b).real(); });
    add_triangle(total.data() + pairs, [&](std::size_t a, std::size_t b) { return energy(a, b).imag(); });
    total.back() += normal_rounding(assembly, contact) * largest_force * norm(assembly.branch(contact));
  });
  result.storage = symmetric(sums.data());
  result.loss = symmetric(sums.data() + pairs);
  result.error_bound += 2 * std::numeric_limits<double>::epsilon() * sums.back();
}

/// All springs lie between the real and the imaginary axis: storage + loss is positive definite unless some strain
/// costs nothing.
void judge_harmonic(const HarmonicStiffness& result) {
  constexpr double nothing = 1e-13;
  const StiffnessEigen eigen = eigenstrains(result.storage + result.loss);
  if (eigen.values[0] > nothing * eigen.values[2] + 2 * result.error_bound) return;
  computation_failed(
      fmt::format("at {:.6g} Hz the mean strain (xx {:.3f}, yy {:.3f}, shear {:.3f}) costs no energy beyond rounding",
                  result.frequency, eigen.strains[0][0], eigen.strains[0][1], eigen.strains[0][2]),
      fmt::format("the springs are kN times {:.1e} and kT times {:.1e} there, too far apart for this network",
                  std::abs(result.normal), std::abs(result.tangential)),
      "Choose another frequency, add contacts, or give the contacts tangential springs that do not relax");
}

HarmonicStiffness at_frequency(const SampleSolver& sample, const Viscoelasticity& viscoelasticity, double frequency,
                               const HomogenizeOptions& options, double area, ViscoelasticStiffness& all) {
  HarmonicStiffness result;
  result.frequency = frequency;
  result.normal = viscoelasticity.normal.factor(frequency);
  result.tangential = viscoelasticity.tangential.factor(frequency);
  // Sizes near 1, so that no sum of squares leaves the range of a double.
  const double unit = std::exp2(std::ilogb(std::max(std::abs(result.normal), std::abs(result.tangential)))) *
                      spring_unit(sample.springs());
  const StiffnessSolver& elastic = sample.solver();
  DegreesOfFreedom unknowns = elastic.unknowns();
  for (const std::size_t k : elastic.factor().null_components()) unknowns.held[k] = DegreesOfFreedom::supported;
  check_memory(estimate_complex(*elastic.symbolic(), unknowns), options.solver.memory_limit);
  HarmonicSystem system(sample.assembly(), elastic.graph(), unknowns, sample.springs(), result.normal,
                        result.tangential, unit);
  system.factorize(all.times);
  Stopwatch watch;
  std::vector<HarmonicMotion> motions;
  for (std::size_t k = 0; k < 3; ++k)
    motions.push_back(system.solve(unit_gradients[k], options.solver.max_refinements));
  all.times.add("solve", watch.lap());
  result.condition = system.scaled_inverse_norm(motions[0]);
  double residual = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    residual = std::max(residual, system.scaled_residual(unit_gradients[k], motions[k]));
    result.relative_residual = std::max(result.relative_residual, motions[k].relative_residual());
  }
  constexpr double safety = 10;  // the norm of the inverse is estimated from below
  result.error_bound = safety * residual * residual * result.condition;
  sum_harmonic(sample, system, motions, result);
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  result.error_bound += rounding * (largest_entry(result.storage) + largest_entry(result.loss));
  const double scale = unit / area;
  result.storage = scale * result.storage;
  result.loss = scale * result.loss;
  result.error_bound *= scale;
  judge_harmonic(result);
  all.factor_bytes = system.factor_bytes();
  all.times.add("stiffness", watch.lap());
  return result;
}

}  // namespace

SolveEstimate estimate_viscoelastic(const Assembly& assembly, const ContactSprings& springs, const Effects& effects) {
  const ContactGraph graph(assembly);
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, effects, {});
  return estimate_complex(analyze(dissect(assembly, graph), graph, unknowns.per_disc), unknowns);
}

HarmonicModuli harmonic_moduli(const HarmonicStiffness& stiffness) {
  const auto complex = [&](auto part) { return std::complex(part(stiffness.storage), part(stiffness.loss)); };
  const std::complex<double> K = complex([](const Matrix3& c) { return isotropic_part(c).bulk; });
  const std::complex<double> G = complex([](const Matrix3& c) { return isotropic_part(c).shear; });
  const std::complex<double> nu = (K - G) / (2.0 * K);
  return {.bulk_modulus_2d = K,
          .shear_modulus = G,
          .poisson_strain = nu,
          .poisson_stress = (K - G) / (K + G),
          .young_strain = 2.0 * G * (1.0 + nu),
          .young_stress = 4.0 * K * (G / (K + G))};
}

ViscoelasticStiffness viscoelastic_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                             const Viscoelasticity& viscoelasticity,
                                             std::span<const double> frequencies, const HomogenizeOptions& options) {
  check_sample(assembly, springs, options);
  check_harmonic(springs, viscoelasticity, frequencies, options);
  HomogenizeOptions of_fronts = options;
  of_fronts.solver.method = SolverMethod::multifrontal;
  of_fronts.solver.ordering = CholmodOrdering::equidem;
  EffectiveStiffness elastic;
  elastic.boundary = options.boundary;
  elastic.effects = derive_effects(assembly, springs, options.rotation);
  const SampleSolver sample = strain_sample(assembly, springs, of_fronts, elastic);
  if (springs.prestressed() && sample.solver().factor().report().negative_pivots.value_or(0) > 0)
    computation_failed("the forces at rest are larger than the springs keep in balance",
                       "motions would grow, not follow the strain",
                       "Use smaller forces at rest, stiffer springs, or see what 'equidem stability' finds");
  ViscoelasticStiffness result;
  result.times = elastic.times;
  result.solver = "UMFPACK LU of complex numbers";
  const Matrix3 change = springs.prestressed() ? change_to_cauchy(mean_stress_at_rest(assembly)) : Matrix3{};
  Progress progress("frequencies");
  try {
    for (std::size_t k = 0; k < frequencies.size(); ++k) {
      HarmonicStiffness& found = result.harmonic.emplace_back(
          at_frequency(sample, viscoelasticity, frequencies[k], options, assembly.area(), result));
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) found.storage[a][b] += 0.5 * (change[a][b] + change[b][a]);
      progress.update(static_cast<double>(k + 1) / static_cast<double>(frequencies.size()));
    }
  } catch (const Error& error) {
    if (result.harmonic.empty()) throw;
    const std::string done = fmt::format("{} of {} frequencies are done", result.harmonic.size(), frequencies.size());
    throw ErrorWith(error, done, std::move(result));
  }
  return result;
}

}  // namespace equidem
