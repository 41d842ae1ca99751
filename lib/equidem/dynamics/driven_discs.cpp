// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/driven_discs.hpp"

#include <cmath>
#include <map>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/scene_check.hpp"

namespace equidem {
namespace {

/// The values of schedules at one time. The last one asked for is kept: discs that follow one another often share
/// theirs.
class ValuesAt {
 public:
  ValuesAt(const std::vector<Schedule>& schedules, double time) : schedules_(schedules), time_(time) {}
  double of(std::int32_t schedule) {
    if (schedule != last_) value_ = schedules_[schedule].at(time_);
    last_ = schedule;
    return value_;
  }

 private:
  const std::vector<Schedule>& schedules_;
  double time_, value_ = 0;
  std::int32_t last_ = -1;
};

/// Cundall's damping of an acceleration, and back: damping leaves the sign of the resultant.
double with_damping(double free, double v, double share) {
  const double taken = share * std::abs(free);
  return free - (v > 0 ? taken : v < 0 ? -taken : 0.0);
}
double without_damping(double a, double v, double share) {
  if (v == 0) return a;
  return a / (1 - ((a > 0) == (v > 0) ? share : -share));
}

}  // namespace

DrivenDiscs::DrivenDiscs(const Scene& scene, const DiscLayout& layout, const LoopKind& kind)
    : unknowns_(kind.unknowns()),
      width_(kind.width()),
      local_(kind.resistance == LoopKind::Resistance::local),
      walls_(scene.walls) {
  std::map<std::int32_t, Disc> discs;  // by place
  const auto disc_of = [&](std::int32_t disc) -> Disc& {
    Disc& driven = discs[layout.place_of[disc]];
    driven.place = layout.place_of[disc];
    const Inertia& inertia = scene.inertia[disc];
    driven.inertia[0] = driven.inertia[1] = inertia.mass;
    driven.inertia[2] = inertia.moment;
    for (int c = 0; c < 3; ++c) driven.inverse_inertia[c] = 1 / driven.inertia[c];
    return driven;
  };
  DegreesOfFreedom components;
  components.per_disc = unknowns_;
  std::vector<std::vector<DiscLoad>> loads(scene.assembly.size());
  for (const auto& [load, factor] : scene.loads) {
    const std::vector<double> forces = assemble_loads(scene.assembly, components, {load});
    const std::int32_t schedule = add(factor);
    for (const std::int32_t disc : group(scene.assembly, load.group).discs) {
      DiscLoad& on_disc = loads[disc].emplace_back();
      on_disc.schedule = schedule;
      for (int c = 0; c < unknowns_; ++c) on_disc.force[c] = forces[static_cast<std::size_t>(disc) * unknowns_ + c];
    }
  }
  for (std::size_t disc = 0; disc < loads.size(); ++disc) {
    if (loads[disc].empty()) continue;
    Disc& driven = disc_of(static_cast<std::int32_t>(disc));
    driven.first_load = static_cast<std::int32_t>(loads_.size());
    driven.loads = static_cast<std::int32_t>(loads[disc].size());
    loads_.insert(loads_.end(), loads[disc].begin(), loads[disc].end());
  }
  for (const TimedSupport& support : scene.supports) {
    const std::int32_t motions[] = {add(support.ux), add(support.uy), add(support.rotation)};
    const DiscGroup& held = group(scene.assembly, support.group);
    if (held.discs.empty()) {
      bad_input(fmt::format("the support acts on the group '{}', which is empty", support.group),
                "it would hold nothing", "Choose a group with discs or mend its definition");
    }
    for (const std::int32_t disc : held.discs) {
      Disc& driven = disc_of(disc);
      for (int c = 0; c < unknowns_; ++c)
        if (motions[c] >= 0) driven.held[c] = motions[c];
    }
  }
  for (std::size_t disc = 0; !walls_.empty() && disc < scene.assembly.size(); ++disc) {
    disc_of(static_cast<std::int32_t>(disc));
  }
  // std::map keeps places, and so strips, in order.
  const auto strips = static_cast<std::size_t>(layout.strips());
  strip_first_.assign(strips + 1, 0);
  work_.resize(strips);
  wall_motions_.resize(strips * walls_.size());
  std::size_t strip = 0;
  for (const auto& [place, disc] : discs) {
    while (place >= layout.strip_first[strip + 1] * DiscLayout::lanes) {
      strip_first_[++strip] = static_cast<std::int32_t>(discs_.size());
    }
    discs_.push_back(disc);
    const std::int32_t number = layout.disc_at[place];
    places_.push_back({.centre = scene.assembly.centres[number],
                       .radius = scene.assembly.radii[number],
                       .place = place,
                       .always = disc.loads > 0 || disc.any_held()});
  }
  acting_.resize(strips);
  while (strip < strips) strip_first_[++strip] = static_cast<std::int32_t>(discs_.size());
}

/// The place of a schedule among all, -1 for none.
std::int32_t DrivenDiscs::add(const std::optional<Schedule>& schedule) {
  if (!schedule) return -1;
  check(*schedule);
  schedules_.push_back(*schedule);
  return static_cast<std::int32_t>(schedules_.size()) - 1;
}

std::span<const DrivenDiscs::WallMotion> DrivenDiscs::move_walls(std::int32_t strip, double time, double time_after) {
  WallMotion* motions = wall_motions_.data() + static_cast<std::size_t>(strip) * walls_.size();
  for (std::size_t k = 0; k < walls_.size(); ++k) {
    const Wall& wall = walls_[k];
    motions[k] = {wall.displacement_along_normal(time), 0.5 * (wall.displacement_along_normal(time_after) -
                                                               wall.displacement_along_normal(2 * time - time_after))};
  }
  return {motions, walls_.size()};
}

bool DrivenDiscs::touches_wall(const Place& disc, Vec2 u, std::span<const WallMotion> motions) const {
  for (std::size_t k = 0; k < walls_.size(); ++k) {
    if (!(gap_to(walls_[k], motions[k].moved, disc.centre + u, disc.radius) >= 0)) return true;
  }
  return false;
}

DrivenDiscs::Push DrivenDiscs::push_of_walls(const Place& disc, Vec2 u, std::span<const WallMotion> motions) const {
  Push push;
  for (std::size_t k = 0; k < walls_.size(); ++k) {
    const Wall& wall = walls_[k];
    const double gap = gap_to(wall, motions[k].moved, disc.centre + u, disc.radius);
    if (gap >= 0) continue;
    push.force += force_of(wall, gap);
    push.work -= wall.kN * gap * motions[k].way;
  }
  return push;
}

void DrivenDiscs::before(std::int32_t strip, const LoopData& data, int parity, double time) {
  const std::span<const WallMotion> walls = move_walls(strip, time, time);
  std::vector<std::int32_t>& acting = acting_[strip];
  acting.clear();
  for (std::int32_t k = strip_first_[strip]; k < strip_first_[strip + 1]; ++k) {
    const Place& place = places_[k];
    const double* u = data.motion[parity] + static_cast<std::ptrdiff_t>(place.place) * width_;
    if (place.always || touches_wall(place, {u[0], u[1]}, walls)) acting.push_back(k);
  }
  for (const std::int32_t k : acting) {
    Disc& disc = discs_[k];
    const double* velocity =
        data.velocity + static_cast<std::ptrdiff_t>(disc.place / 4) * 4 * unknowns_ + disc.place % 4;
    for (int c = 0; c < unknowns_; ++c) disc.before[c] = velocity[4 * c];
  }
}

// The loop has made v' = keep v + kick a with the acceleration a of contacts and dampers: add what acts on this disc
// beyond that, and make the stage anew. A prescribed motion asks for the velocity that reaches it; the force that this
// takes is the support's.
void DrivenDiscs::after(std::int32_t strip, const LoopData& data, const Stage& stage, int parity, double time,
                        double time_after, Dissipation& dissipation) {
  if (acting_[strip].empty()) return;
  DrivingWork& work = work_[strip];
  const double over_kick = stage.kick != 0 ? 1 / stage.kick : 0.0,
               over_drift = stage.drift != 0 ? 1 / stage.drift : 0.0;
  const bool damped = local_ || data.mass_damping != 0 || data.dashpot != nullptr;
  const std::span<const WallMotion> walls = move_walls(strip, time, time_after);
  ValuesAt factors(schedules_, time);
  ValuesAt held[] = {{schedules_, time_after}, {schedules_, time_after}, {schedules_, time_after}};
  for (const std::int32_t k : acting_[strip]) {
    const Disc& disc = discs_[k];
    const double* u = data.motion[parity] + static_cast<std::ptrdiff_t>(disc.place) * width_;
    double* u_after = data.motion[1 - parity] + static_cast<std::ptrdiff_t>(disc.place) * width_;
    double* velocity = data.velocity + static_cast<std::ptrdiff_t>(disc.place / 4) * 4 * unknowns_ + disc.place % 4;
    double load[] = {0, 0, 0}, wall[] = {0, 0, 0};
    for (std::int32_t l = disc.first_load; l < disc.first_load + disc.loads; ++l) {
      const double factor = factors.of(loads_[l].schedule);
      for (int c = 0; c < 3; ++c) load[c] += loads_[l].force[c] * factor;
    }
    const Push push = push_of_walls(places_[k], {u[0], u[1]}, walls);
    wall[0] = push.force.x;
    wall[1] = push.force.y;
    work.walls += push.work;
    for (int c = 0; c < unknowns_; ++c) {
      const double v = disc.before[c], with_loop = velocity[4 * c], force = load[c] + wall[c];
      double v_after = with_loop + stage.kick * force * disc.inverse_inertia[c];
      double undamped_loop = 0, undamped = 0, accelerated = 0, accelerated_loop = 0;
      if (local_) {
        accelerated_loop = (with_loop - stage.keep * v) * over_kick;
        undamped_loop = without_damping(accelerated_loop, v, data.local_damping);
        undamped = undamped_loop + force * disc.inverse_inertia[c];
        accelerated = with_damping(undamped, v, data.local_damping);
        v_after = stage.keep * v + stage.kick * accelerated;
      }
      if (disc.held[c] >= 0) {
        u_after[c] = held[c].of(disc.held[c]);
        const double v_free = v_after;
        v_after = stage.drift != 0 ? (u_after[c] - u[c] - stage.drift_before * v) * over_drift : v;
        work.supports += stage.duration * over_kick * (v_after - v_free) * disc.inertia[c] * 0.5 * (v + v_after);
      } else {
        u_after[c] = u[c] + stage.drift * v_after + stage.drift_before * v;
      }
      velocity[4 * c] = v_after;
      const double mean = 0.5 * (v + v_after);
      work.loads += stage.duration * load[c] * mean;
      if (!damped) continue;
      const double mean_loop = 0.5 * (v + with_loop), mass = disc.inertia[c];  // with which the loop counted
      dissipation.mass += data.mass_damping * stage.duration * mass * (mean * mean - mean_loop * mean_loop);
      if (local_) {
        dissipation.local +=
            stage.duration * mass * ((undamped - accelerated) * mean - (undamped_loop - accelerated_loop) * mean_loop);
      }
      if (data.dashpot != nullptr) {
        const double drag =
            data.dashpot[static_cast<std::ptrdiff_t>(disc.place / 4) * 4 * unknowns_ + 4 * c + disc.place % 4];
        dissipation.contact -= stage.duration * drag * (mean - mean_loop);
        data.velocity_at[1 - parity][static_cast<std::ptrdiff_t>(disc.place) * width_ + c] = v_after;
      }
    }
  }
}

void DrivenDiscs::prescribe(double* motion, double time) const {
  for (const Disc& disc : discs_) {
    for (int c = 0; c < unknowns_; ++c) {
      if (disc.held[c] >= 0) {
        motion[static_cast<std::ptrdiff_t>(disc.place) * width_ + c] = schedules_[disc.held[c]].at(time);
      }
    }
  }
}

DrivingWork DrivenDiscs::work() const {
  DrivingWork sum;
  for (const DrivingWork& of_strip : work_) sum += of_strip;
  return sum;
}

}  // namespace equidem
