// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/choice/zero_energy_modes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "equidem/linear/multifrontal/multifrontal_ldlt.hpp"
#include "equidem/linear/stiffness_matrix.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

class WithoutModes final : public Factorization {
 public:
  WithoutModes(std::unique_ptr<Factorization> rest, ZeroEnergyModes modes)
      : rest_(std::move(rest)), modes_(std::move(modes)), report_(rest_->report()) {
    report_.zero_pivots = std::ssize(modes_.components());
  }

  void solve(std::span<double> x, int right_hand_sides) const override {
    const std::size_t n = x.size() / static_cast<std::size_t>(right_hand_sides);
    for (std::size_t begin = 0; begin < x.size(); begin += n) {
      for (const std::size_t component : modes_.components()) x[begin + component] = 0;
    }
    rest_->solve(x, right_hand_sides);
  }
  [[nodiscard]] std::vector<double> softest_motion() const override { return modes_.motion(0); }
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
      const std::vector<double> softest = stage.factor->softest_motion();
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
  if (factor.report().zero_pivots == 0) return factor.softest_motion();
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
