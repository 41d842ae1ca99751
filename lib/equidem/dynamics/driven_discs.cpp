// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/driven_discs.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr const char* component_names[] = {"ux", "uy", "rotation"};

const DiscGroup& group_with_discs(const Assembly& assembly, const std::string& name, const char* what) {
  const DiscGroup& discs = group(assembly, name);
  if (discs.discs.empty()) {
    bad_input(format("a {} acts on the group '{}', which is empty", what, name), "it would do nothing",
              "Choose a group with discs or mend its definition");
  }
  return discs;
}

/// Small motions stay small beside a radius: discs further than that from every wall never meet one.
bool may_touch_wall(const Scene& scene, std::size_t disc) {
  return std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Wall& wall) {
    const double gap = dot(wall.normal, scene.assembly.centres[disc] - wall.point) - scene.assembly.radii[disc];
    return gap < scene.assembly.radii[disc] || wall.displacement.changes();
  });
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
    driven.centre = scene.assembly.centres[disc];
    driven.radius = scene.assembly.radii[disc];
    const Inertia& inertia = scene.inertia[disc];
    driven.inverse_inertia[0] = driven.inverse_inertia[1] = 1 / inertia.mass;
    driven.inverse_inertia[2] = 1 / inertia.moment;
    return driven;
  };
  std::vector<std::vector<DiscLoad>> loads(scene.assembly.size());
  add_loads(scene, loads);
  for (const TimedLoad& load : scene.loads) schedules_.push_back(load.factor);
  for (std::size_t disc = 0; disc < loads.size(); ++disc) {
    if (loads[disc].empty()) continue;
    Disc& driven = disc_of(static_cast<std::int32_t>(disc));
    driven.first_load = static_cast<std::int32_t>(loads_.size());
    driven.loads = static_cast<std::int32_t>(loads[disc].size());
    loads_.insert(loads_.end(), loads[disc].begin(), loads[disc].end());
  }
  for (const TimedSupport& support : scene.supports) {
    for (const std::int32_t disc : group_with_discs(scene.assembly, support.group, "support").discs) {
      Disc& driven = disc_of(disc);
      if (support.ux) hold(driven, 0, *support.ux, support.group);
      if (support.uy) hold(driven, 1, *support.uy, support.group);
      if (support.rotation && unknowns_ == 3) hold(driven, 2, *support.rotation, support.group);
    }
  }
  for (std::size_t disc = 0; !walls_.empty() && disc < scene.assembly.size(); ++disc) {
    if (kind.motion == LoopKind::Motion::finite || may_touch_wall(scene, disc)) {
      disc_of(static_cast<std::int32_t>(disc)).near_walls = true;
    }
  }
  // std::map keeps places, and so strips, in order.
  const auto strips = static_cast<std::size_t>(layout.strips());
  strip_first_.assign(strips + 1, 0);
  work_.resize(strips);
  std::size_t strip = 0;
  for (const auto& [place, disc] : discs) {
    while (place >= layout.strip_first[strip + 1] * DiscLayout::lanes) {
      strip_first_[++strip] = static_cast<std::int32_t>(discs_.size());
    }
    discs_.push_back(disc);
  }
  while (strip < strips) strip_first_[++strip] = static_cast<std::int32_t>(discs_.size());
}

void DrivenDiscs::hold(Disc& disc, int component, const Schedule& schedule, const std::string& group) {
  check(schedule);
  std::int32_t& held = disc.held[component];
  if (held >= 0 && schedules_[held] == schedule) return;
  if (held >= 0) {
    bad_input(format("the support of '{}' prescribes {} of a disc a second time", group, component_names[component]),
              "another support gives it a different motion", "Prescribe each component of a disc once");
  }
  held = static_cast<std::int32_t>(schedules_.size());
  schedules_.push_back(schedule);
}

void DrivenDiscs::add_loads(const Scene& scene, std::vector<std::vector<DiscLoad>>& loads) const {
  for (std::size_t k = 0; k < scene.loads.size(); ++k) {
    const Load& load = scene.loads[k].load;
    check(scene.loads[k].factor);
    const DiscGroup& discs = group_with_discs(scene.assembly, load.group, "load");
    if (!std::isfinite(load.force.x + load.force.y + load.moment)) {
      bad_input(format("the load on '{}' is not finite", load.group), "a load must be a number", "Give a number");
    }
    if (load.moment != 0 && unknowns_ != 3) {
      bad_input(format("a moment acts on the group '{}'", load.group), "rotations are no unknowns of this scene",
                "Remove the moment, or let rotation = \"free\" with tangential springs");
    }
    if (load.kind == LoadKind::traction && discs.tributary_lengths.empty()) {
      bad_input(format("a traction acts on the group '{}'", load.group),
                "it is no side of the assembly and has no length",
                "Use kind = \"per_disc\" or \"total\", or one of the groups left, right, bottom, top");
    }
    const double share = load.kind == LoadKind::total ? 1.0 / static_cast<double>(discs.discs.size()) : 1.0;
    for (std::size_t d = 0; d < discs.discs.size(); ++d) {
      const double weight = load.kind == LoadKind::traction ? discs.tributary_lengths[d] : share;
      loads[discs.discs[d]].push_back(
          {{weight * load.force.x, weight * load.force.y, share * load.moment}, static_cast<std::int32_t>(k)});
    }
  }
}

DrivenDiscs::Push DrivenDiscs::push_of_walls(const Disc& disc, Vec2 u, double time, double time_after) const {
  Push push;
  for (const Wall& wall : walls_) {
    const double moved = wall.displacement.at(time);
    const double gap = dot(wall.normal, disc.centre + u - wall.point) - moved - disc.radius;
    if (gap >= 0) continue;
    push.force -= wall.kN * gap * wall.normal;
    push.energy += 0.5 * wall.kN * gap * gap;
    push.work -= wall.kN * gap * (wall.displacement.at(time_after) - moved);
  }
  return push;
}

void DrivenDiscs::before(std::int32_t strip, const LoopData& data) {
  for (std::int32_t k = strip_first_[strip]; k < strip_first_[strip + 1]; ++k) {
    Disc& disc = discs_[k];
    const double* velocity =
        data.velocity + static_cast<std::ptrdiff_t>(disc.place / 4) * 4 * unknowns_ + disc.place % 4;
    for (int c = 0; c < unknowns_; ++c) disc.before[c] = velocity[4 * c];
  }
}

// The loop has made v' = keep v + kick a with the acceleration a of contacts and dampers: take a back out, add what acts on
// this disc, and make the stage anew. A prescribed motion asks for the velocity that reaches it; the force that this takes
// is the support's.
void DrivenDiscs::after(std::int32_t strip, const LoopData& data, const Stage& stage, int parity, double time,
                        double time_after, Dissipation& dissipation) {
  DrivingWork& work = work_[strip];
  for (std::int32_t k = strip_first_[strip]; k < strip_first_[strip + 1]; ++k) {
    const Disc& disc = discs_[k];
    const double* u = data.motion[parity] + static_cast<std::ptrdiff_t>(disc.place) * width_;
    double* u_after = data.motion[1 - parity] + static_cast<std::ptrdiff_t>(disc.place) * width_;
    double* velocity = data.velocity + static_cast<std::ptrdiff_t>(disc.place / 4) * 4 * unknowns_ + disc.place % 4;
    const Push push = disc.near_walls ? push_of_walls(disc, {u[0], u[1]}, time, time_after) : Push{};
    const bool held = disc.held[0] >= 0 || disc.held[1] >= 0 || disc.held[2] >= 0;
    if (!held && disc.loads == 0 && push.energy == 0) continue;
    work.walls += push.work;
    for (int c = 0; c < unknowns_; ++c) {
      double load = 0;
      for (std::int32_t l = disc.first_load; l < disc.first_load + disc.loads; ++l) {
        load += loads_[l].force[c] * schedules_[loads_[l].schedule].at(time);
      }
      const double wall = c == 0 ? push.force.x : c == 1 ? push.force.y : 0.0;
      const double v = disc.before[c];
      double& v_after = velocity[4 * c];
      const double mean_before = 0.5 * (v + v_after);  // with which the loop counted what dampers take
      const double damped = stage.kick != 0 ? (v_after - stage.keep * v) / stage.kick : 0.0;
      const double free_before = undamped(damped, v, data.local_damping);
      const double free = free_before + (load + wall) * disc.inverse_inertia[c];
      const double a = with_damping(free, v, data.local_damping);
      const double v_free = stage.keep * v + stage.kick * a;
      v_after = v_free;
      if (disc.held[c] >= 0) {
        u_after[c] = schedules_[disc.held[c]].at(time_after);
        v_after = stage.drift != 0 ? (u_after[c] - u[c] - stage.drift_before * v) / stage.drift : v;
        const double reaction = stage.kick != 0 ? (v_after - v_free) / (stage.kick * disc.inverse_inertia[c]) : 0.0;
        work.supports += stage.duration * reaction * 0.5 * (v + v_after);
      } else {
        u_after[c] = u[c] + stage.drift * v_after + stage.drift_before * v;
      }
      const double mean = 0.5 * (v + v_after), mass = 1 / disc.inverse_inertia[c];
      work.loads += stage.duration * load * mean;
      dissipation.mass += data.mass_damping * stage.duration * mass * (mean * mean - mean_before * mean_before);
      if (data.dashpot != nullptr) {
        const double force =
            data.dashpot[static_cast<std::ptrdiff_t>(disc.place / 4) * 4 * unknowns_ + 4 * c + disc.place % 4];
        dissipation.contact -= stage.duration * force * (mean - mean_before);
      }
      if (local_) {
        dissipation.local += stage.duration * mass * ((free - a) * mean - (free_before - damped) * mean_before);
      }
      if (data.velocity_at[0] != nullptr) {
        data.velocity_at[1 - parity][static_cast<std::ptrdiff_t>(disc.place) * width_ + c] = v_after;
      }
    }
  }
}

/// Cundall's damping of an acceleration, and back: damping leaves the sign of the resultant.
double DrivenDiscs::with_damping(double free, double v, double share) const {
  if (!local_) return free;
  const double taken = share * std::abs(free);
  return free - (v > 0 ? taken : v < 0 ? -taken : 0.0);
}

double DrivenDiscs::undamped(double a, double v, double share) const {
  if (!local_ || v == 0) return a;
  return a / (1 - ((a > 0) == (v > 0) ? share : -share));
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
  for (const DrivingWork& of_strip : work_) {
    sum.loads += of_strip.loads;
    sum.supports += of_strip.supports;
    sum.walls += of_strip.walls;
  }
  return sum;
}

double DrivenDiscs::wall_energy(const double* motion, double time) const {
  double energy = 0;
  for (const Disc& disc : discs_) {
    if (!disc.near_walls) continue;
    const double* u = motion + static_cast<std::ptrdiff_t>(disc.place) * width_;
    energy += push_of_walls(disc, {u[0], u[1]}, time, time).energy;
  }
  return energy;
}

}  // namespace equidem
