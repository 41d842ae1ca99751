// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_waves.hpp"

#include <cmath>
#include <utility>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

Vec2 mean_velocity(const std::vector<DiscMotion>& velocities, const std::vector<std::int32_t>& bodies) {
  Vec2 sum;
  for (const std::int32_t body : bodies) sum += velocities[static_cast<std::size_t>(body)].u;
  return sum / static_cast<double>(bodies.size());
}

/// Speeds of the plane waves along x and y whose bodies move along a component, beside a measured one. The stiffness is
/// that of long waves: c² = C_11/rho of the P wave along x, C_22/rho along y, C_33/rho of S waves.
void add_theory(Results& out, const std::string& key, double speed, bool along_x, const WaveStiffness& wave) {
  const double stiffness = wave.stiffness[along_x ? 0 : 1][along_x ? 0 : 1];
  const double pressure = std::sqrt(stiffness / wave.density), shear = std::sqrt(wave.stiffness[2][2] / wave.density);
  if (!(pressure > 0 && shear >= 0)) return;
  const bool is_pressure = std::abs(speed - pressure) <= std::abs(speed - shear);
  const double theory = is_pressure ? pressure : shear;
  out.line("")
      .note("long waves by the stiffness of the cell: ")
      .add(key + "theory/pressure", fmt::format("Vp along {} =", along_x ? 'x' : 'y'), pressure, "m/s")
      .add(key + "theory/shear", "Vs =", shear, "m/s")
      .note("; ")
      .add(key + "speed_over_theory", "measured", speed / theory, is_pressure ? "of Vp" : "of Vs");
  out.set(key + "theory/speed", theory);
}

}  // namespace

StandingWaves::StandingWaves(const AnySimulation& simulation, const std::vector<Probe>& probes)
    : simulation_(simulation) {
  for (const Probe& probe : probes)
    if (probe.wavelength) waves_.push_back({.probe = probe});
}

void StandingWaves::open(const std::filesystem::path& /*folder*/, bool /*overwrite*/, const Checkpoint* from) {
  if (from == nullptr) return;
  const SavedState saved{.step = 0, .arrays = {from->record.recorded.front()}};
  const auto rows = rows_in<SavedWave>(saved, saved.arrays.front().name, SavedWave::numbers);
  for (std::size_t k = 0; k < waves_.size() && k < rows.size(); ++k) {
    last_step_ = rows[k].last_step;
    waves_[k].component = rows[k].component;
    waves_[k].oscillation = rows[k].oscillation;
  }
}

void StandingWaves::record(std::int64_t step, double time, bool regular) {
  if (!regular) return;
  last_step_ = step;
  const std::vector<DiscMotion> velocities = simulation_.velocities();
  for (Wave& wave : waves_) {
    const Vec2 v = mean_velocity(velocities, wave.probe.bodies);
    if (wave.component == Component::none && (v.x != 0 || v.y != 0))
      wave.component = std::abs(v.x) >= std::abs(v.y) ? Component::x : Component::y;
    if (wave.component != Component::none) wave.oscillation.add(time, wave.component == Component::x ? v.x : v.y);
  }
}

void StandingWaves::save(Checkpoint& checkpoint) {
  std::vector<SavedWave> rows;
  for (const Wave& wave : waves_) rows.push_back({last_step_, wave.component, wave.oscillation});
  checkpoint.record.recorded.push_back(saved_rows("waves", std::move(rows), SavedWave::numbers));
}

Results StandingWaves::results(const std::optional<WaveStiffness>& stiffness) const {
  Results out;
  for (const Wave& wave : waves_) {
    const std::string key = fmt::format("waves/{}/", wave.probe.name);
    const auto period = wave.oscillation.period();
    out.line("wave " + wave.probe.name).set(key + "wavelength", *wave.probe.wavelength);
    if (!period) {
      out.note(last_step_ < 1 ? "not measured: [output] has no probe_interval"
                              : "not measured: the velocity passes through zero fewer than two times in this run; give "
                                "a longer duration, or start the wave with velocities of both signs");
      out.set(key + "period", nullptr).set(key + "speed", nullptr);
      continue;
    }
    out.add(key + "speed", "", *wave.probe.wavelength / *period, "m/s")
        .note(fmt::format(", wavelength {:.6g} m over a ", *wave.probe.wavelength))
        .add(key + "period", "period of", *period, "s")
        .note(fmt::format(" ({} through zero of {}, ", counted(wave.oscillation.passages(), "passage"),
                          wave.component == Component::x ? "vx" : "vy"))
        .add(key + "spread_of_half_periods", "half periods within", *wave.oscillation.spread(), "of their mean",
             {Shown::percent, 2})
        .note(")");
    out.set(key + "passages", wave.oscillation.passages());
    if (stiffness) add_theory(out, key, *wave.probe.wavelength / *period, wave.component == Component::x, *stiffness);
  }
  return out;
}

}  // namespace equidem
