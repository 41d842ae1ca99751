// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Discs with supports, loads or wall contacts: stepped with all others, then corrected.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "equidem/dynamics/layout.hpp"
#include "equidem/dynamics/simulation.hpp"

namespace equidem {

/// Work done on the discs since the start, N.
struct DrivingWork {
  double loads = 0, supports = 0, walls = 0;

  DrivingWork& operator+=(const DrivingWork& other) {
    loads += other.loads;
    supports += other.supports;
    walls += other.walls;
    return *this;
  }
};

/// Supports, loads and walls that act on single discs, stored by strip. Other discs cost nothing.
class DrivenDiscs {
 public:
  /// \param scene checked (layout.hpp)
  /// \throws Error (bad_input) on a group that does not exist or is empty, a load that is not finite
  DrivenDiscs(const Scene& scene, const DiscLayout& layout, const LoopKind& kind);

  /// Find the discs that are acted upon and store their velocities, which the loop overwrites. `time` is that of the
  /// motions read.
  void before(std::int32_t strip, const LoopData& data, int parity, double time);
  /// Add forces, prescribe motions, sum up work, and correct the dissipation that the loop counted for the discs found
  /// by before(). `time_after` is that of the motions written.
  void after(std::int32_t strip, const LoopData& data, const Stage& stage, int parity, double time, double time_after,
             Dissipation& dissipation);

  [[nodiscard]] std::size_t bytes() const {
    return discs_.size() * (sizeof(Disc) + sizeof(Place)) + loads_.size() * sizeof(DiscLoad);
  }
  /// Set the prescribed components at the start.
  void prescribe(double* motion, double time) const;
  [[nodiscard]] DrivingWork work() const;
  /// The sums of work of every strip, for the continuation of a run.
  [[nodiscard]] const std::vector<DrivingWork>& sums() const { return work_; }
  void set_sums(std::vector<DrivingWork> sums) { work_ = std::move(sums); }

 private:
  struct Disc {
    std::int32_t place = 0;
    double inertia[3] = {0, 0, 0}, inverse_inertia[3] = {0, 0, 0};
    std::int32_t held[3] = {-1, -1, -1};  // schedule of each component
    std::int32_t first_load = 0, loads = 0;
    double before[3] = {0, 0, 0};  // velocities
    [[nodiscard]] bool any_held() const { return held[0] >= 0 || held[1] >= 0 || held[2] >= 0; }
  };
  /// Data that decide whether a wall touches a disc, stored contiguously, since most discs are far from every wall.
  struct Place {
    Vec2 centre;
    double radius = 0;
    std::int32_t place = 0;
    bool always = false;  ///< acted upon by a support or load
  };
  struct DiscLoad {
    double force[3] = {0, 0, 0};  // N/m, N/m, N
    std::int32_t schedule = -1;
  };
  std::int32_t add(const std::optional<Schedule>& schedule);
  /// Displacement of a wall, and the displacement over which it does work, m.
  struct WallMotion {
    double moved = 0, way = 0;
  };
  /// Motions of all walls, stored for the strip. `way` follows from the velocities before and after the kick, as for
  /// loads.
  [[nodiscard]] std::span<const WallMotion> move_walls(std::int32_t strip, double time, double time_after);
  /// Force of all walls on a disc displaced by u, and the work that their motion does.
  struct Push {
    Vec2 force;
    double work = 0;
  };
  [[nodiscard]] bool touches_wall(const Place& disc, Vec2 u, std::span<const WallMotion> motions) const;
  [[nodiscard]] Push push_of_walls(const Place& disc, Vec2 u, std::span<const WallMotion> motions) const;

  int unknowns_ = 2, width_ = 2;
  bool local_ = false;
  std::vector<Disc> discs_;    // by strip
  std::vector<Place> places_;  // of discs_
  std::vector<std::int32_t> strip_first_;
  std::vector<std::vector<std::int32_t>> acting_;  // discs_ that are acted upon in this stage, by strip
  std::vector<DiscLoad> loads_;
  std::vector<Schedule> schedules_;
  std::vector<Wall> walls_;
  std::vector<WallMotion> wall_motions_;  // by strip
  std::vector<DrivingWork> work_;         // per strip
};

}  // namespace equidem
