// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/contact/laws/normal_law.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/contacts/block_step.hpp"
#include "equidem/grains/contacts/contact_geometry.hpp"
#include "equidem/grains/contacts/crossing.hpp"
#include "equidem/grains/contacts/force_step.hpp"

namespace equidem {
namespace {

constexpr int most_sweeps = 400;
/// Tolerance of the sweeps: change of the impulse of a contact, relative.
constexpr double settled = 1e-14;
/// Below it, changes that do not shrink any more are rounding.
constexpr double sweep_rounding = 1e-12;

/// A candidate while its step is being solved.
struct Trial {
  std::size_t candidate = 0;
  double overlap = 0;  // at the start
  Vec2 branch;         // at the start: from i to j, or to the nearest point of the wall
  Vec2 normal;         // what the impulses below act along
  double lever_i = 0, lever_j = 0;
  double impulse = 0, moment = 0, tangential = 0;
  double closing = 0;  // at the start, along the normal
  ExactStep normal_step;
  SlidingStep<double> sliding;
};

/// All that pushes a body over the step but gravity, as it stands in the sweeps.
void give(GrainSystem& system, const Candidate& candidate, const Trial& trial, double sign) {
  const Vec2 tangent = perpendicular(trial.normal);
  const Vec2 impulse = sign * (trial.impulse * trial.normal + trial.tangential * tangent);
  const Vec2 moment = sign * (trial.moment * trial.normal + (0.5 * system.dt() * trial.tangential) * tangent);
  const auto i = static_cast<std::size_t>(candidate.i);
  system.bodies.impulses[i].impulse -= impulse;
  system.bodies.moments[i] -= moment;
  system.bodies.impulses[i].torque -= sign * trial.lever_i * trial.tangential;
  if (candidate.j < 0) return;
  const auto j = static_cast<std::size_t>(candidate.j);
  system.bodies.impulses[j].impulse += impulse;
  system.bodies.moments[j] += moment;
  system.bodies.impulses[j].torque -= sign * trial.lever_j * trial.tangential;
}

/// Change of a body's velocity and position in the step by impulses and gravity.
struct Gain {
  Vec2 velocity, way;
};

Gain gain_of(const GrainSystem& system, std::size_t body) {
  const double dt = system.dt();
  const double inverse = system.bodies.constants[body].inverse_mass;
  return {inverse * system.bodies.impulses[body].impulse + dt * system.scene.gravity,
          inverse * system.bodies.moments[body] + (0.5 * dt * dt) * system.scene.gravity};
}

/// Gain of j, or of the wall, over that of i.
Gain relative_gain(const GrainSystem& system, const Candidate& candidate) {
  const Gain of_i = gain_of(system, static_cast<std::size_t>(candidate.i));
  if (candidate.j < 0) return {-of_i.velocity, -of_i.way};
  const Gain of_j = gain_of(system, static_cast<std::size_t>(candidate.j));
  return {of_j.velocity - of_i.velocity, of_j.way - of_i.way};
}

/// The direction along which a contact acts over a step, and how the distance of the bodies follows it.
struct Line {
  Vec2 normal;       // unit
  double slope = 1;  // change of the distance over the way along the normal
};

/// From the way that the bodies go as the sweeps stand: the mean normal n = (r + r')/|r + r'|. The distance changes by
/// |r'| - |r| = slope n . (r' - r), slope = |r + r'|/(|r| + |r'|), the cosine of half the angle by which the branch
/// turns. Without it each
/// contact that begins in a step would lose energy, by the square of that angle.
Line line_of(const GrainSystem& system, const Candidate& candidate, const Trial& trial, Vec2 way) {
  if (candidate.j >= 0) {
    const Vec2 end = trial.branch + way;
    const Vec2 sum = trial.branch + end;
    const double length = norm(sum);
    if (!(length > 0)) return {trial.normal, 1};
    return {sum / length, std::max(0.5, length / (norm(trial.branch) + norm(end)))};
  }
  const auto w = static_cast<std::size_t>(~candidate.j);
  const Wall& wall = system.scene.walls[w];
  if (wall.shape == Wall::Shape::line) return {-wall.normal, 1};
  const Vec2 centre = system.bodies.motions[candidate.i].position;
  const auto normal_at = [&](double share) {
    return -nearest(wall, system.walls.places[w].displacement, centre - share * way).normal;
  };
  return {normal_at(0.5), std::max(0.5, 0.5 * norm(normal_at(0) + normal_at(1)))};
}

/// Speed of the two bodies and what the step adds to it: velocities are known to so many digits of it, however slowly
/// the bodies close.
double speed_of_bodies(const GrainSystem& system, const Candidate& candidate) {
  const auto speed = [&](std::int32_t body) {
    const auto b = static_cast<std::size_t>(body);
    return norm(system.bodies.motions[b].velocity) + norm(gain_of(system, b).velocity);
  };
  return speed(candidate.i) + (candidate.j >= 0 ? speed(candidate.j) : 0);
}

/// Solve one contact with all others as they stand.
/// \return change of its impulses, relative
template <class Law>
double solve(GrainSystem& system, Trial& trial) {
  const Candidate& candidate = system.contacts.candidates[trial.candidate];
  const double dt = system.dt();
  const Vec2 relative = relative_velocity(system, candidate);
  const bool acted = trial.impulse != 0 || trial.tangential != 0 || trial.moment != 0;
  if (!candidate.touching && !acted) {
    // neither by its own way nor by what others do can it come to touch
    const Gain gain = relative_gain(system, candidate);
    const double most = norm(relative) * dt + norm(gain.velocity) * dt + 4 * norm(gain.way);
    if (trial.overlap + most <= 0) return 0;
  }
  const Vec2 way = dt * relative + relative_gain(system, candidate).way;
  const double impulse_before = trial.impulse, tangential_before = trial.tangential, moment_before = trial.moment;
  if (acted) give(system, candidate, trial, -1);
  const auto [normal, slope] = line_of(system, candidate, trial, way);
  trial.normal = normal;
  const Gain outside = relative_gain(system, candidate);
  const double closing = -slope * dot(relative, normal);
  const double a = -slope * dot(outside.velocity, normal) / dt;
  const double b = -2 * slope * dot(outside.way, normal) / (dt * dt);
  trial.normal_step = Law::step(system.contacts.exact_pairs[trial.candidate], trial.overlap, closing,
                                candidate.touching, 3 * b - 2 * a, 6 * (a - b) / dt);
  trial.impulse = trial.normal_step.impulse / slope;
  trial.moment = trial.normal_step.moment / slope;
  trial.closing = closing;
  trial.tangential = 0;
  if (candidate.sliding.coefficient > 0 && trial.impulse != 0) {
    ContactGeometry geometry{trial.overlap, trial.normal, trial.lever_i, trial.lever_j};
    const double inverse_mass = inverse_tangential_mass(system, candidate, geometry);
    // The spring follows the way that the bodies go. Half the change of velocity is not that way where other forces
    // change within the step: a load that grows to an acceleration g would leave the stretch wrong by g dt²/12.
    const auto turned = [&](std::int32_t body, double lever) {
      const auto k = static_cast<std::size_t>(body);
      return lever * system.bodies.constants[k].inverse_moment * system.bodies.impulses[k].torque;
    };
    double turning = turned(candidate.i, trial.lever_i);
    if (candidate.j >= 0) turning += turned(candidate.j, trial.lever_j);
    const double velocity = slip_velocity(system, candidate, geometry, relative) +
                            dot(outside.way, perpendicular(trial.normal)) / dt - 0.5 * turning;
    trial.sliding = slide(candidate.sliding, candidate.stretch, velocity, inverse_mass, trial.impulse, dt);
    trial.tangential = -trial.sliding.impulse;
  }
  give(system, candidate, trial, 1);
  if (trial.impulse != 0) ++system.counters.evaluations;
  const double change = std::abs(trial.impulse - impulse_before) + std::abs(trial.tangential - tangential_before) +
                        std::abs(trial.moment - moment_before) / dt;
  const double scale = std::abs(trial.impulse) + std::abs(trial.tangential) +
                       candidate.reduced_mass * speed_of_bodies(system, candidate);
  return scale > 0 ? change / scale : 0;
}

std::vector<Trial> trials_of(GrainSystem& system) {
  std::vector<Trial> trials;
  trials.reserve(system.contacts.candidates.size());
  for (std::size_t c = 0; c < system.contacts.candidates.size(); ++c) {
    const Candidate& candidate = system.contacts.candidates[c];
    if (candidate.covered) continue;
    const ContactGeometry geometry = geometry_of(system, candidate);
    Trial trial;
    trial.candidate = c;
    trial.overlap = geometry.overlap;
    system.deepest = std::max(system.deepest, geometry.overlap);
    trial.lever_i = geometry.lever_i;
    trial.lever_j = geometry.lever_j;
    trial.normal = geometry.normal;
    if (candidate.j >= 0) trial.branch = (geometry.lever_i + geometry.lever_j) * geometry.normal;
    if (candidate.touching) {
      // what the last step gave is near to what this one will give
      trial.impulse = candidate.impulse;
      trial.moment = candidate.moment;
      trial.tangential = candidate.tangential_impulse;
    }
    trials.push_back(trial);
  }
  return trials;
}

/// Pushes from the contacts in their order: no trace of the way in which sweeps came to them.
void sum_impulses(GrainSystem& system, const std::vector<Trial>& trials) {
  std::fill(system.bodies.impulses.begin(), system.bodies.impulses.end(), BodyImpulse{});
  std::fill(system.bodies.moments.begin(), system.bodies.moments.end(), Vec2{});
  for (const Trial& trial : trials) {
    if (trial.impulse == 0 && trial.tangential == 0 && trial.moment == 0) continue;
    give(system, system.contacts.candidates[trial.candidate], trial, 1);
  }
}

/// When a trial was solved last, and whether that changed nothing.
struct Visit {
  std::int32_t i, j;
  bool quiet = false;
  std::int64_t when = 0;
};

template <class Law>
void sweep_until_settled(GrainSystem& system, std::vector<Trial>& trials) {
  double change = 0;
  // A trial that has settled is solved again when another contact has changed what pushes its bodies: contacts that
  // stand alone settle for themselves, whatever the clusters elsewhere take.
  std::vector<Visit> visits;
  visits.reserve(trials.size());
  for (const Trial& trial : trials) {
    const Candidate& candidate = system.contacts.candidates[trial.candidate];
    visits.push_back({candidate.i, candidate.j});
  }
  std::vector<std::int64_t> pushed(system.bodies.constants.size(), 0);
  std::int64_t now = 0;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const double before = change;
    change = 0;
    for (std::size_t t = 0; t < trials.size(); ++t) {
      Visit& visit = visits[t];
      std::int64_t& on_i = pushed[visit.i];
      std::int64_t& on_j = visit.j < 0 ? on_i : pushed[visit.j];
      if (visit.quiet && on_i <= visit.when && on_j <= visit.when) continue;
      const double own = solve<Law>(system, trials[t]);
      visit.quiet = own <= settled;
      visit.when = ++now;
      if (!visit.quiet) on_i = on_j = now;
      change = std::max(change, own);
    }
    ++system.counters.sweeps;
    if (change <= settled) return;
    if (change <= sweep_rounding && sweep > 8 && change > 0.5 * before) return;
  }
  // what oscillates in the last digits is settled as far as numbers go
  if (change <= 1e-9) return;
  computation_failed(
      fmt::format("step {}: the contacts find no common solution", system.step),
      fmt::format("after {} sweeps the impulses still change by {:.2g} of themselves", most_sweeps, change),
      "Use a smaller step: w dt below 1 for every pair, w² the stiffness over the reduced mass");
}

void move(GrainSystem& system) {
  const double dt = system.dt();
  move_bodies(system, [&](std::size_t i) {
    GrainMotion motion = system.bodies.motions[i];
    const Gain gain = gain_of(system, i);
    motion.position += dt * motion.velocity + gain.way;
    motion.velocity += gain.velocity;
    const double turn = system.bodies.constants[i].inverse_moment * system.bodies.impulses[i].torque;
    motion.angle += dt * (motion.spin + 0.5 * turn);
    motion.spin += turn;
    return motion;
  });
}

/// The step without any contact in reach.
void move_freely(GrainSystem& system) {
  const double dt = system.dt();
  const Vec2 fall = dt * system.scene.gravity, drop = (0.5 * dt * dt) * system.scene.gravity;
  move_bodies(system, [&](std::size_t i) {
    GrainMotion motion = system.bodies.motions[i];
    motion.position += dt * motion.velocity + drop;
    motion.velocity += fall;
    motion.angle += dt * motion.spin;
    return motion;
  });
}

/// Store the state of the contacts, and count their losses.
void remember(GrainSystem& system, const std::vector<Trial>& trials) {
  for (const Trial& trial : trials) {
    Candidate& candidate = system.contacts.candidates[trial.candidate];
    const ExactStep& normal = trial.normal_step;
    const bool touched = trial.impulse != 0 || normal.touching_at_end;
    system.counters.contacts += normal.beginnings;
    system.lost.lost_dashpot += normal.loss;
    system.lost.lost_release += normal.released;
    if (!touched) {
      if (candidate.touching) forget_contact(candidate, system.lost);
      continue;
    }
    candidate.overlap = trial.overlap;
    candidate.closing = trial.closing;
    candidate.normal = trial.normal;
    candidate.impulse = trial.impulse;
    candidate.moment = trial.moment;
    candidate.tangential_impulse = trial.tangential;
    if (candidate.sliding.coefficient > 0 && trial.impulse != 0) {
      candidate.stretch = trial.sliding.stretch;
      system.lost.lost_slip += trial.sliding.slip_loss;
      system.lost.lost_tangential_dashpot += trial.sliding.dashpot_loss;
    }
    if (candidate.j < 0) {
      const Vec2 impulse = trial.impulse * trial.normal + trial.tangential * perpendicular(trial.normal);
      const Vec2 point = system.bodies.motions[candidate.i].position + trial.lever_i * trial.normal;
      push_wall(system, candidate.j, point, impulse, system.walls.places[~candidate.j].velocity, system.sums());
    }
    ++candidate.steps;
    candidate.touching = true;
    if (!normal.touching_at_end) forget_contact(candidate, system.lost);
  }
}

/// Count contacts that share a body with others and whose step is not stable for every arrangement of them: w dt sqrt(1
/// + rho) must stay below pi (exact_contact.hpp), and 1 + rho is at most 1 + m ((z_i - 1)/m_i + (z_j - 1)/m_j), z
/// contacts on a body, m the reduced mass.
void count_doubtful(GrainSystem& system, const std::vector<Trial>& trials) {
  constexpr double pi = 3.14159265358979323846;
  constexpr double most_contacts = 9;  // so many discs no smaller than it a disc never touches
  const auto square_step = [&](const Trial& trial) {
    const double turn = system.contacts.exact_pairs[trial.candidate].frequency * system.dt();
    return turn * turn;
  };
  if (std::none_of(trials.begin(), trials.end(),
                   [&](const Trial& trial) { return square_step(trial) * most_contacts > pi * pi; })) {
    return;
  }
  std::vector<int> contacts(system.bodies.constants.size(), 0);
  const auto touches = [](const Trial& trial) { return trial.impulse != 0; };
  const auto count = [&](std::int32_t body) -> int& { return contacts[body]; };
  for (const Trial& trial : trials) {
    if (!touches(trial)) continue;
    const Candidate& candidate = system.contacts.candidates[trial.candidate];
    ++count(candidate.i);
    if (candidate.j >= 0) ++count(candidate.j);
  }
  for (const Trial& trial : trials) {
    if (!touches(trial)) continue;
    const Candidate& candidate = system.contacts.candidates[trial.candidate];
    const auto others = [&](std::int32_t body) {
      return body < 0 ? 0 : system.bodies.constants[body].inverse_mass * (count(body) - 1);
    };
    const double coupling = candidate.reduced_mass * (others(candidate.i) + others(candidate.j));
    if (coupling > 0 && square_step(trial) * (1 + coupling) > pi * pi) ++system.counters.doubtful;
  }
}

template <class Law>
void flow(GrainSystem& system) {
  std::vector<Trial> trials;
  double reach = 0;
  // once more where the bodies move further than the candidates allow for
  for (int attempt = 0; attempt < 3; ++attempt) {
    trials = trials_of(system);
    if (trials.empty()) {
      move_freely(system);
    } else {
      sum_impulses(system, trials);
      sweep_until_settled<Law>(system, trials);
      sum_impulses(system, trials);
      move(system);
    }
    reach = reach_of(system);
    refuse_runaway(system, reach);
    refuse_long_ways_in_cell(system, reach);
    if (!refresh_candidates(system, reach)) break;
  }
  if (system.options.refuse_crossing && may_cross(system, reach)) refuse_crossings(system);
  count_doubtful(system, trials);
  remember(system, trials);
}

}  // namespace

FlowFunction flow_function(NormalLaw law) {
  return visit_law(law, []<class Law>(std::type_identity<Law>) -> FlowFunction {
    if constexpr (Law::facts.kind == LawKind::simultaneous) {
      return flow<Law>;
    } else {
      return nullptr;
    }
  });
}

}  // namespace equidem
