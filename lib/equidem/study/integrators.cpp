// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A damped plane wave in a bonded lattice: every disc moves as exp(-alpha t/2) sin(w t), w² = omega² - alpha²/4, omega
/// that of the Bloch wave.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "equidem/assembly/lattices.hpp"
#include "equidem/dynamics/simulation.hpp"
#include "equidem/study/built_in.hpp"
#include "equidem/waves/bloch.hpp"

namespace equidem {
namespace {

struct Wave {
  Wave()
      : assembly(hexagonal_lattice({.columns = columns, .rows = rows, .radius = 0.5, .periodic = true})),
        inertia(inertia_of(assembly.radii, 1, Body::disc)) {
    const BlochWaves waves(primitive_cell(assembly, springs), inertia, true);
    const Vec2 q{2 * std::numbers::pi / assembly.period->x, 2 * std::numbers::pi / assembly.period->y};
    const HermitianSpectrum modes = spectrum(waves.dynamic_matrix(q));
    omega = std::sqrt(modes.values[0]);
    alpha = 2 * damping * omega;
    damped = std::sqrt(omega * omega - 0.25 * alpha * alpha);
    shape.resize(assembly.size());
    for (std::size_t d = 0; d < shape.size(); ++d) {
      const Complex phase = std::polar(1.0, dot(q, assembly.centres[d]));
      const auto part = [&](std::size_t r, double mass) {
        return std::real(modes.vectors(r, 0) * phase) / std::sqrt(mass);
      };
      shape[d] = {{part(0, inertia[d].mass), part(1, inertia[d].mass)}, part(2, inertia[d].moment)};
      assembly.groups[std::to_string(d)] = {{static_cast<std::int32_t>(d)}, {}};
    }
  }

  /// Started with the velocities of the wave from the undeformed lattice.
  [[nodiscard]] Simulation start(Integrator integrator, double step) const {
    Scene scene(assembly, springs, inertia);
    for (std::size_t d = 0; d < shape.size(); ++d)
      scene.velocities.push_back({std::to_string(d), damped * shape[d].u, damped * shape[d].theta});
    SimulationOptions options{.integrator = integrator};
    options.damping.mass = alpha;
    options.time_step = step;
    return {scene, options};
  }

  /// 2-norm over all components, of the amplitude.
  [[nodiscard]] double error(const std::vector<DiscMotion>& motions, double time) const {
    const double now = std::exp(-0.5 * alpha * time) * std::sin(damped * time);
    double off = 0, size = 0;
    for (std::size_t d = 0; d < shape.size(); ++d) {
      const double turned = motions[d].theta - now * shape[d].theta;
      off += squared(motions[d].u - now * shape[d].u) + turned * turned;
      size += squared(shape[d].u) + shape[d].theta * shape[d].theta;
    }
    return std::sqrt(off / size);
  }

  static constexpr int columns = 8, rows = 4;
  static constexpr double damping = 0.05;
  Assembly assembly;
  ContactSprings springs{SpringConstants{1, 0.5}};
  std::vector<Inertia> inertia;
  double omega = 0, alpha = 0, damped = 0;
  std::vector<DiscMotion> shape;
};

struct Range {
  Integrator integrator;
  int coarsest, finest;  // 2^k steps in a period
};

}  // namespace

Study integrators_study(bool quick) {
  Study study{.name = "integrators",
              .title = "A plane wave in a bonded hexagonal lattice, 9/8 periods",
              .quantities = {{.name = "motion",
                              .label = "error of the motions, of the amplitude",
                              .source = "closed form: damped oscillation at the frequency of the Bloch wave",
                              .rounding = 1e-13}},
              .tasks = {}};
  constexpr double periods = 1.125;  // a whole number of steps of every setting
  const auto wave = std::make_shared<const Wave>();
  const int less = quick ? 2 : 0;
  // The thesis's scheme is stable for steps below 4 zeta/omega of every mode only, and the fastest ones are hardly
  // damped by alpha.
  for (const Range& range : {Range{Integrator::leapfrog, 5, 12}, Range{Integrator::velocity_verlet, 5, 12},
                             Range{Integrator::fourth_order, 4, 11}, Range{Integrator::thesis, 8, 13}}) {
    for (int k = range.coarsest; k <= range.finest - less; ++k) {
      const double fraction = std::pow(2.0, -k);
      const double step = fraction * 2 * std::numbers::pi / wave->omega;
      const auto steps = std::llround(periods / fraction);
      Setting setting{.method = to_string(range.integrator),
                      .values = {{"steps_per_period", 1 / fraction}},
                      .resolution = fraction};
      study.tasks.push_back(task_on(
          std::move(setting), [=] { return wave->start(range.integrator, step); },
          [=](Simulation& run) { run.advance(steps); },
          [=](const Simulation& run) { return std::vector{wave->error(run.motions(), run.time())}; }));
    }
    study.orders.push_back({.method = to_string(range.integrator),
                            .order = static_cast<double>(scheme_of(range.integrator).order),
                            .why = "of the scheme, with damping in proportion to mass"});
  }
  return study;
}

}  // namespace equidem
