// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs in a box moved by Sukegawa (2010), sections 2.4 and 3, as printed: forces that grow by increments, the
/// integrator (3.16)-(3.17), the damping c_i of (3.13) and the margin beta of (3.1) in the force law.
#pragma once

#include <cstdint>
#include <vector>

#include "equidem/grains/grain_simulation.hpp"
#include "equidem/grains/neighbours/neighbours.hpp"

namespace equidem::sukegawa2010 {

struct PrintedOptions {
  enum class Integrator {
    printed,        ///< v' = v + a dt, x' = x + (v + v')/2 dt (3.16)-(3.17)
    semi_implicit,  ///< v' = v + a dt, x' = x + v' dt
  } integrator = Integrator::printed;
  double beta = 1;          ///< of (3.1): two discs touch at the distance beta (r_i + r_j); >= 1
  double mass_damping = 0;  ///< c_i/m_i of (3.13), 1/s; of rotations c_i R²/I (printed: c_i R, which is a force)
  double damping = 1;       ///< h of (2.27)
  double time_step = 0;     ///< s, > 0
};

/// The step from t to t + dt: with the motions of the last step (3.11) the spring of a contact grows by kN du_n (2.3)
/// and kT du_s (2.10), the dashpot has C_n du_n/dt and C_s du_s/dt (2.5), (2.12); where the normal spring would pull,
/// all four are 0 (2.8), (2.15); friction limits the tangential spring (2.16), or spring and dashpot where the scene
/// says so. The normal force may pull while its spring pushes. C = 2 h sqrt(m k) (2.27) with m the harmonic mean of
/// the masses of two discs, the mass of the disc at a wall. Walls have the margin beta too.
class PrintedDiscs final : public AnySimulation {
 public:
  /// \param scene discs without bonds between walls that are lines; stiffnesses in N/m
  PrintedDiscs(const GrainScene& scene, const PrintedOptions& options);
  PrintedDiscs(const PrintedDiscs&) = delete;
  PrintedDiscs& operator=(const PrintedDiscs&) = delete;

  [[nodiscard]] const Effects& effects() const override { return effects_; }
  /// \throws Error (computation_failed) where motions are not finite
  void advance(std::int64_t steps) override;
  [[nodiscard]] std::int64_t step() const override { return step_; }
  [[nodiscard]] std::vector<DiscMotion> motions() const override;
  [[nodiscard]] std::vector<DiscMotion> velocities() const override;
  [[nodiscard]] std::vector<BodyContact> body_contacts() const override { return {}; }  ///< none: see contacts()
  [[nodiscard]] EnergyLedger energy() const override;                                   ///< kinetic and potential alone
  [[nodiscard]] double bytes_per_body() const override;
  [[nodiscard]] SavedState save() const override;
  void restore(const SavedState& state) override;

  [[nodiscard]] std::vector<Grain> grains() const;
  [[nodiscard]] std::vector<GrainContact> contacts() const;  ///< those whose normal spring pushes

 private:
  struct Body {
    double radius = 0, inverse_mass = 0, inverse_moment = 0;
    DiscMotion place, velocity, increment = {};  ///< increment: motion in the last step
    DiscMotion force = {};                       ///< and moment
  };
  /// Two discs, or a disc and the wall ~j.
  struct Near {
    std::int32_t i = 0, j = 0;
    const PairProperties* pair = nullptr;
    double normal_dashpot = 0, tangential_dashpot = 0;  ///< C_n, C_s, N s/m
    double normal = 0, tangential = 0;                  ///< forces of the springs, N
    double overlap = 0;                                 ///< r_i + r_j less the distance, m
  };

  [[nodiscard]] const PairProperties& properties(const Near& near) const;
  void find_near();
  void add_forces(Near& near);
  void move();
  void make_step();

  GrainScene scene_;
  PrintedOptions options_;
  Effects effects_;
  std::vector<Body> bodies_;
  std::vector<Near> near_;  ///< ordered by i, then j, walls first
  NeighbourFinder finder_;
  double margin_ = 0, moved_ = 0;                    ///< of the list; motion since it was made, at most; m
  std::vector<Vec2> wall_places_, wall_increments_;  ///< displacement of each wall, and in the last step, m
  std::int64_t step_ = 0;
  double potential_at_start_ = 0;
};

}  // namespace equidem::sukegawa2010
