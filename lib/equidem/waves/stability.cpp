// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/sensitivities.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

constexpr std::size_t most_discs_of_antiperiodic = 20000;
constexpr double no_critical_ratio = -std::numeric_limits<double>::infinity();

std::optional<double> common_ratio(const Assembly& assembly, const ContactSprings& springs) {
  const double first = springs[0].ratio();
  for (std::size_t c = 1; !springs.uniform() && c < assembly.contacts.size(); ++c)
    if (std::abs(springs[c].ratio() - first) > 1e-12 * std::abs(first)) return {};
  return first;
}

CriticalMotion critical_of_survey(const WaveSurvey& survey) {
  CriticalMotion critical{
      .ratio = survey.critical.value, .wave = survey.critical.at, .equivalent = survey.critical.points};
  if (critical.ratio <= -1) critical = {.ratio = no_critical_ratio};
  critical.searched = fmt::format(
      "all waves of the infinite assembly: {} wave vectors, all points of symmetry, long waves (q -> 0) along all "
      "directions, and a climb from the best",
      survey.critical.on_grid.size());
  return critical;
}

/// Motions that repeat with the cell, and those that change sign from one cell to the next.
CriticalMotion critical_of_large_cell(const Assembly& assembly, const ContactSprings& springs, bool rotation,
                                      bool derivatives) {
  CriticalMotion critical{.ratio = no_critical_ratio};
  const bool antiperiodic = assembly.size() <= most_discs_of_antiperiodic;
  std::vector<std::string> searched;
  for (const auto& [x, y] :
       {std::pair{false, false}, std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
    if ((x || y) && !antiperiodic) continue;
    const Vec2 q{x ? std::numbers::pi / assembly.period->x : 0, y ? std::numbers::pi / assembly.period->y : 0};
    const ZonePoint wave{x && y ? "S" : x ? "X" : y ? "Y" : "Gamma", q};
    CriticalRatio found;
    try {
      found = find_critical_ratio(
          assembly, springs, {},
          {.rotation = rotation, .antiperiodic_x = x, .antiperiodic_y = y, .derivatives = derivatives});
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::computation_failed || !(x || y)) throw;
      continue;  // gears that turn from cell to cell: this wave stays unsearched
    }
    searched.push_back(wave.name);
    constexpr double alike = 1e-6;
    if (std::abs(found.ratio - critical.ratio) <= alike) found.by_kN.clear(), critical.by_kN.clear();
    if (found.ratio <= critical.ratio) continue;
    critical.ratio = found.ratio;
    critical.by_kN = std::move(found.by_kN);
    critical.wave = wave;
    critical.equivalent = {wave};
  }
  critical.searched = fmt::format(
      "by inertia, of the waves of the given cell: {} (Gamma: repeats with the cell; X, Y, S: changes "
      "sign along x, y, both). Other waves were not searched",
      joined(searched));
  return critical;
}

CriticalMotion find_critical_motion(const Assembly& assembly, const ContactSprings& springs,
                                    std::span<const Support> supports, const std::optional<WaveSurvey>& survey,
                                    const StabilityOptions& options) {
  const bool rotation = options.rotation != Rotation::restrained;
  if (!on_lines_of_centres(assembly))
    return {.sought = false,
            .searched =
                "contacts lie off the lines of centres, where normal springs resist rotations too, so that no "
                "single kT/kN is critical"};
  if (springs.bends())
    return {.sought = false,
            .searched =
                "bending springs resist rotations too, so that no single kT/kN is critical; with kT of 0 or "
                "more and kM of 0 or more the assembly is stable"};
  if (survey) return critical_of_survey(*survey);
  if (assembly.periodic()) return critical_of_large_cell(assembly, springs, rotation, options.derivatives);
  CriticalRatio found =
      find_critical_ratio(assembly, springs, supports, {.rotation = rotation, .derivatives = options.derivatives});
  CriticalMotion critical{.ratio = found.ratio};
  critical.by_kN = std::move(found.by_kN);
  if (!found.motion.empty()) critical.motion = describe_motion(assembly, found.motion);
  critical.searched =
      supports.empty() ? "all motions of the free body, by inertia" : "all motions that the supports allow, by inertia";
  return critical;
}

/// The frequencies of the assembly as it is given.
void add_frequencies(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                     const std::vector<Inertia>& inertia, const StabilityOptions& options, Stability& s) {
  Stopwatch watch;
  const DegreesOfFreedom unknowns = number_unknowns(assembly, springs, s.effects, supports);
  if (unknowns.unknowns == 0)
    bad_input("the supports hold every disc", "nothing can move, so that nothing can be lost", "Hold fewer discs");
  s.element_bound = element_bound(assembly, springs, inertia, s.effects.rotation);
  s.highest = extreme_squared_frequency(assembly, springs, unknowns, inertia, SpectrumEnd::largest);
  constexpr double round_off = 1e-14;  // of the bound, in motions without energy
  if (s.highest.converged && s.highest.value <= round_off * s.element_bound) {
    s.highest.value = s.highest.residual = 0;  // a cell of discs that touch only their own images
  } else if (!(s.highest.value > 0)) {
    computation_failed("the highest frequency was not found",
                       fmt::format("{} products with the matrix did not separate it from the next", s.highest.products),
                       "Take a smaller assembly; --dry-run tells the time step that is guaranteed");
  }
  if (springs.any_negative())
    s.lowest = extreme_squared_frequency(assembly, springs, unknowns, inertia, SpectrumEnd::smallest);
  s.rules = time_step_rules(assembly, springs, inertia, s.effects.rotation);
  s.times.add("highest frequency", watch.lap());
  s.reached = StabilityStage::time_step;
  if (springs.any_negative() || options.natural_frequencies == 0) return;
  s.natural = natural_frequencies(
      assembly, springs, unknowns, inertia,
      {.count = options.natural_frequencies, .solver = options.solver, .derivatives = options.derivatives});
  s.times.add("natural frequencies", watch.lap());
  s.reached = StabilityStage::natural_frequencies;
}

void add_waves(const Assembly& assembly, const ContactSprings& springs, const std::vector<Inertia>& inertia,
               Rotation rotation, Stability& s) {
  const PrimitiveCell cell = primitive_cell(assembly, springs);
  s.cell_discs = static_cast<std::int64_t>(cell.size());
  if (cell.size() <= most_discs_of_survey) s.survey = survey_waves(cell, inertia, rotation);
  double mass = 0;
  for (const Inertia& body : inertia) mass += body.mass;
  s.mass_per_area = mass / assembly.area();
}

/// By the Voigt strain e of the gradient u n^T of a wave along n with the motion u, v² = e . C e/rho.
SoundDerivatives derivatives_of_sound(const SpringSensitivities& by_springs, double mass_per_area, double angle,
                                      Vec2 motion, double speed, bool transverse) {
  const Vec2 n{std::cos(angle), std::sin(angle)};
  const double e[] = {motion.x * n.x, motion.y * n.y, motion.x * n.y + motion.y * n.x};
  const auto each = [&](const std::vector<Matrix3>& changes) {
    std::vector<double> found;
    found.reserve(changes.size());
    for (const Matrix3& change : changes) {
      double sum = 0;
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) sum += e[a] * change[a][b] * e[b];
      found.push_back(sum / (2 * mass_per_area * speed));
    }
    return found;
  };
  return {{each(by_springs.by_kN), each(by_springs.by_kT), each(by_springs.by_kM)}, angle, transverse, speed};
}

void add_sound_derivatives(const Assembly& assembly, const ContactSprings& springs, const EffectiveStiffness& result,
                           Stability& s) {
  if (springs.prestressed() || result.effects.restrained ||
      result.unstable_modes.value_or(springs.any_negative() ? 1 : 0) != 0)
    return;
  const SpringSensitivities by_springs = spring_sensitivities(assembly, springs, result);
  constexpr double alike = 1e-6;
  for (const double angle : {0.0, std::numbers::pi / 2}) {
    const auto [p, q, motion] =
        plane_waves(result.gradient_stiffness, s.mass_per_area, {std::cos(angle), std::sin(angle)});
    const double apart = alike * std::max(std::abs(p), std::abs(q));
    if (!(std::abs(p - q) > apart)) continue;
    const auto add = [&](double squared, Vec2 along, bool transverse) {
      if (squared > apart)
        s.sound_derivatives.push_back(
            derivatives_of_sound(by_springs, s.mass_per_area, angle, along, std::sqrt(squared), transverse));
    };
    add(p, motion, false), add(q, {-motion.y, motion.x}, true);
  }
}

/// Sound of the homogenized continuum, or why there is none.
void add_continuum(const Assembly& assembly, const ContactSprings& springs, const StabilityOptions& options,
                   Stability& s) {
  EffectiveStiffness homogenized;
  try {
    homogenized = effective_stiffness(
        assembly, springs, {.boundary = Boundary::periodic, .rotation = options.rotation, .solver = options.solver});
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    s.no_continuum = error.problem();
    return;
  }
  std::vector<double> angles{0, std::numbers::pi / 2};
  if (s.survey) {
    angles.clear();
    for (const SoundAlong& along : s.survey->sound) angles.push_back(along.angle);
  }
  for (const double angle : angles)
    s.sound.push_back(plane_waves(homogenized.gradient_stiffness, s.mass_per_area, {std::cos(angle), std::sin(angle)}));
  if (options.derivatives) add_sound_derivatives(assembly, springs, homogenized, s);
}

/// Frequencies about a state of rest that is stable under the forces that contacts carry there.
NaturalFrequencies frequencies_at_rest(const Assembly& assembly, const ContactSprings& springs,
                                       std::span<const Support> supports, const std::vector<Inertia>& inertia,
                                       const StabilityOptions& options, const Stability& s) {
  NaturalFrequencies none;
  none.why_none = "springs and forces at rest together are not stable";
  if (springs.any_negative() || s.inertia.unstable_modes != 0) return none;
  none.why_none = "the body is free to turn, and the forces at rest that count need not balance";
  if (s.mechanisms.rigid_motions > 2) return none;
  return natural_frequencies(
      assembly, springs, number_unknowns(assembly, springs, s.effects, supports), inertia,
      {.count = options.natural_frequencies, .solver = options.solver, .derivatives = options.derivatives});
}

/// Time steps are those of the springs: forces at rest change the highest frequency by a share of |N0|/(kN l).
void add_frequencies_at_rest(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                             const std::vector<Inertia>& inertia, const StabilityOptions& options, Stability& s) {
  StabilityOptions of_springs = options;
  of_springs.natural_frequencies = 0;
  add_frequencies(assembly, springs.with_prestress({}), supports, inertia, of_springs, s);
  if (options.natural_frequencies == 0) return;
  Stopwatch watch;
  s.natural = frequencies_at_rest(assembly, springs, supports, inertia, options, s);
  s.times.add("natural frequencies", watch.lap());
  s.reached = StabilityStage::natural_frequencies;
}

/// The stages behind the inertia.
void find_stages(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                 const std::vector<Inertia>& inertia, const StabilityOptions& options, Stability& s) {
  Stopwatch watch;
  if (springs.prestressed()) {
    s.critical_load = find_critical_load(assembly, springs, supports,
                                         {.rotation = options.rotation, .memory_limit = options.solver.memory_limit});
    s.times.add("critical load", watch.lap());
    s.reached = StabilityStage::critical_load;
    add_frequencies_at_rest(assembly, springs, supports, inertia, options, s);
  } else {
    add_frequencies(assembly, springs, supports, inertia, options, s);
  }
  watch.lap();
  if (assembly.periodic()) {
    add_waves(assembly, springs, inertia, options.rotation, s);
    s.times.add("waves", watch.lap());
    s.reached = StabilityStage::waves;
    add_continuum(assembly, springs, options, s);
    s.times.add("continuum", watch.lap());
    s.reached = StabilityStage::continuum;
  }
  s.critical = springs.prestressed()
                   ? CriticalMotion{.sought = false, .searched = "forces at rest count, and do not change with kT/kN"}
                   : find_critical_motion(assembly, springs, supports, s.survey, options);
  s.times.add("critical ratio", watch.lap());
  s.reached = StabilityStage::critical_ratio;
}

}  // namespace

std::string Stability::status() const {
  if (mechanisms.count() > 0 || (survey && !survey->free_waves.empty())) return "mechanism";
  const bool below = critical.sought && ratio && *ratio < 0 && *ratio <= critical.ratio;
  // With kT < 0 spins grow in motion where statics is stable.
  const bool buckles = critical_load && !lowest && growth_rate() > 0;
  return inertia.unstable_modes != 0 || below || buckles ? "unstable" : "stable";
}

double Stability::growth_rate() const {
  double squared = lowest ? std::max(0.0, -lowest->value) : 0;
  if (survey) squared = std::max(squared, survey->growing.value);
  constexpr double round_off = 1e-12;  // of the bound on omega², in motions without energy
  return squared > round_off * element_bound ? std::sqrt(squared) : 0;
}

Stability analyze_stability(const Assembly& assembly, const ContactSprings& springs, std::span<const Support> supports,
                            const StabilityOptions& options) {
  if (assembly.contacts.empty())
    bad_input("no contact joins any disc", "nothing resists any motion", "Give the assembly contacts");
  Stability s;
  s.effects = derive_effects(assembly, springs, options.rotation);
  s.ratio = common_ratio(assembly, springs);
  const std::vector<Inertia> inertia = inertia_of(assembly, options.density, options.body);
  check_magnitudes(assembly, springs, inertia);
  Stopwatch watch;
  s.mechanisms = find_mechanisms(assembly, springs, options.rotation, supports);
  s.inertia = find_inertia(assembly, springs, options.rotation, supports);
  s.times.add("inertia", watch.lap());
  try {
    find_stages(assembly, springs, supports, inertia, options, s);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::bad_input) throw;
    throw ErrorWith(error, fmt::format("found as far as the {}", to_string(s.reached)), std::move(s));
  }
  return s;
}

}  // namespace equidem
