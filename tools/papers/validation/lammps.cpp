// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The granular test programs of LAMMPS, replayed: trajectories that it recorded, and closed forms.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "equidem/contact/restitution.hpp"
#include "equidem/core/progress.hpp"
#include "equidem/core/text.hpp"

#include "validation/spheres.hpp"
#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

constexpr double their_tolerance = 1e-10;  // relative, of the comparison with a recorded trajectory

constexpr const char* attraction =
    "LAMMPS limits friction by the size of the normal force also while the dashpot attracts, before a contact ends; "
    "here friction needs pressure";
constexpr const char* segments =
    "LAMMPS runs the system in parts, at the start of which the dashpot sees velocities of the full step";
constexpr const char* first_step =
    "at the start of LAMMPS the tangential spring is not stretched yet, so that friction misses half of a step";

/// LAMMPS' dashpot of a wanted restitution ends its contact at zero overlap; shear springs have no dashpot.
PairProperties linear(double kN, double e, double kT = 0, double friction = 0) {
  return {.stiffness = kN,
          .restitution = e,
          .end = ContactEnd::at_zero_overlap,
          .friction = friction,
          .tangential_ratio = kT / kN};
}

/// One sphere on a floor by LAMMPS's rules, in which it differs: friction is limited by mu times the size of the normal
/// force, attraction included, and each of the runs starts with a force of the velocities of the full step, for which
/// the tangential spring is not stretched.
struct TheirSphere {
  double kN = 0, cN = 0, kT = 0, cT = 0, friction = 0, gravity = 0, time_step = 0;
  Vec2 position, velocity;
  double spin = 0, stretch = 0;  ///< spin counter-clockwise

  static constexpr double radius = 0.0025;
  Inertia inertia = inertia_of(radius, 2700, Body::sphere);
  Vec2 acceleration = {};
  double turning = 0;

  void evaluate(bool stretches) {
    acceleration = {0, -gravity};
    turning = 0;
    const double overlap = radius - position.y;
    if (overlap <= 0) {
      stretch = 0;
      return;
    }
    const double normal = kN * overlap - cN * velocity.y, slip = velocity.x + spin * radius;
    if (stretches) stretch += slip * time_step;
    double tangential = -kT * stretch - cT * slip;
    const double limit = friction * std::abs(normal);
    if (std::abs(tangential) > limit) {
      tangential = std::copysign(limit, tangential);
      stretch = -(tangential + cT * slip) / kT;
    }
    acceleration += Vec2{tangential, normal} / inertia.mass;
    turning = radius * tangential / inertia.moment;
  }
  void kick() {
    velocity += 0.5 * time_step * acceleration;
    spin += 0.5 * time_step * turning;
  }
  TheirSphere& run(std::int64_t steps) {
    evaluate(false);
    for (std::int64_t n = 0; n < steps; ++n) {
      kick();
      position += time_step * velocity;
      evaluate(true);
      kick();
    }
    return *this;
  }
};

class Replays {
 public:
  explicit Replays(Findings& findings) : findings_(findings) {}

  /// Compare with the recorded number of that key.
  void recorded(const std::string& key, double ours, const std::string& why = {}) {
    Comparison comparison = compare(key, key, {ours, 0}, why);
    comparison.allowance = their_tolerance * std::abs(comparison.theirs.value);
    findings_.comparisons.push_back(comparison);
  }
  /// Keep how far a sphere that followed their rules is from the recorded numbers.
  void by_their_rules(const std::string& velocity_key, const std::string& spin_key, const TheirSphere& sphere) {
    for (const auto& [key, found] : {std::pair{velocity_key, sphere.velocity.x}, std::pair{spin_key, -sphere.spin}})
      apart_ = std::max(apart_, std::abs(found / published(key).value - 1));
  }
  /// Whether their rules explain the differences.
  [[nodiscard]] Trend explanation() const {
    return {"with LAMMPS's two rules a plain loop repeats the recorded velocities and spins of dem04 and dem05",
            "LAMMPS 2026", apart_ < their_tolerance, fmt::format("to {:.1e} of their size", apart_)};
  }
  /// Compare with the closed form that the program checks. \param coarse, fine our number, with a finer step
  /// \param left_out relative size of what the closed form leaves out
  void closed_form(const std::string& quantity, double formula, double coarse, double fine, double left_out = 0) {
    Comparison comparison = compare_formula(quantity, formula, "LAMMPS 2026", with_step_error(coarse, fine));
    comparison.allowance = left_out * std::abs(formula);
    findings_.comparisons.push_back(comparison);
  }

 private:
  Findings& findings_;
  double apart_ = 0;  // relative
};

/// Two equal spheres meet head on along x.
GrainScene pair(double radius, double density, double apart, double speed, const PairProperties& contact) {
  return spheres({sphere(radius, density, {-apart, 0}, {speed, 0}), sphere(radius, density, {apart, 0}, {-speed, 0})},
                 contact, false);
}

void head_on(Replays& replays) {
  const auto lj = after_steps(pair(0.5, 1, 0.55, 1, linear(1e4, 0.5)), NormalLaw::linear_dashpot, 1e-4, 947);
  replays.recorded("dem01, Hooke, 2-D: speed after 947 steps", -lj[0].velocity.x);
  replays.recorded("dem01, Hooke, 2-D: place after 947 steps", -lj[0].position.x);
  const auto si = after_steps(pair(0.0025, 2700, 0.00255, 2, linear(1e6, 0.8)), NormalLaw::linear_dashpot, 3e-8, 2068);
  replays.recorded("dem01, Hooke, e = 0.8: speed after 2068 steps, m/s", -si[0].velocity.x);
  const double modulus = 7e10 / (2 * (1 - squared(0.33)));
  const PairProperties tsuji{
      .stiffness = 4.0 / 3 * modulus * std::sqrt(0.00125), .restitution = 0.5, .end = ContactEnd::at_zero_overlap};
  const auto damped = after_steps(pair(0.0025, 2700, 0.00255, 2, tsuji), NormalLaw::hertz_dashpot, 1e-8, 4100);
  replays.recorded(
      "dem01, Hertz with Tsuji's dashpot, e = 0.5: speed after 4100 steps, m/s", -damped[0].velocity.x,
      "LAMMPS takes the dashpot from a polynomial fitted to e, here it is the exact one; e = 0.5 is 1 m/s");
}

void hertz(Replays& replays) {
  // Their k of F = k sqrt(R*) d^(3/2), without R*.
  const PairProperties two{.stiffness = 3.33333e10 * std::sqrt(0.005)};
  const GrainScene meeting = pair(0.01, 2800, 0.0101, 10, two);
  const auto deep = after_steps(meeting, NormalLaw::hertz_dashpot, 2e-8, 1508);
  replays.recorded("dem02, Hertz, two spheres: place after 1508 steps, m", -deep[0].position.x);
  replays.recorded("dem02, Hertz, two spheres: speed after 2508 steps, m/s",
                   -after_steps(meeting, NormalLaw::hertz_dashpot, 2e-8, 2508)[0].velocity.x);
  const PairProperties on_wall{.stiffness = 7.11111e10 * std::sqrt(0.0025)};
  const GrainScene falling = spheres({sphere(0.0025, 7000, {0, 0.00255}, {0, -3.9})}, on_wall, true);
  replays.recorded("dem03, Hertz, wall: place after 2138 steps, m",
                   after_steps(falling, NormalLaw::hertz_dashpot, 1e-8, 2138)[0].position.y);
  replays.recorded("dem03, Hertz, wall: speed after 3038 steps, m/s",
                   after_steps(falling, NormalLaw::hertz_dashpot, 1e-8, 3038)[0].velocity.y);
}

/// Their x, z and spin about y are our x, y and minus the spin.
GrainScene oblique(Vec2 velocity, const PairProperties& contact) {
  return spheres({sphere(0.0025, 2700, {0, 0.00255}, velocity)}, contact, true);
}

void oblique_on_wall(Replays& replays) {
  const auto sliding =
      after_steps(oblique({2.5069, -2.9876}, linear(2e7, 0.98, 5.7e6, 0.092)), NormalLaw::linear_dashpot, 1e-8, 2857);
  replays.recorded("dem04, oblique impact on a wall: tangential velocity, m/s", sliding[0].velocity.x, attraction);
  replays.recorded("dem04, oblique impact on a wall: normal velocity, m/s", sliding[0].velocity.y, segments);
  replays.recorded("dem04, oblique impact on a wall: spin, rad/s", -sliding[0].spin, attraction);
  const double mass = inertia_of(0.0025, 2700, Body::sphere).mass;
  TheirSphere theirs{.kN = 2e7,
                     .cN = 2 * damping_ratio_of(0.98, ContactEnd::at_zero_overlap) * std::sqrt(mass * 2e7),
                     .kT = 5.7e6,
                     .friction = 0.092,
                     .time_step = 1e-8,
                     .position = {0, 0.00255},
                     .velocity = {2.5069, -2.9876}};
  replays.by_their_rules("dem04, oblique impact on a wall: tangential velocity, m/s",
                         "dem04, oblique impact on a wall: spin, rad/s", theirs.run(1724).run(1133));

  // The classic model: c_n = m gamma, c_t = c_n/2, kT = 2/7 kN.
  constexpr double k = 2e7, gamma = 4300;
  const double tangential_mass = mass * 2 / 7;
  PairProperties classic =
      linear(k, restitution_of(gamma / 2 * std::sqrt(mass / k), ContactEnd::at_zero_overlap), 2.0 / 7 * k, 0.5);
  classic.tangential_damping = 0.5 * mass * gamma / (2 * std::sqrt(tangential_mass * 2 / 7 * k));
  const auto grazing = after_steps(oblique({3.7839, -0.94345}, classic), NormalLaw::linear_dashpot, 1e-8, 6400);
  replays.recorded("dem04, grazing impact, classic model: tangential velocity, m/s", grazing[0].velocity.x, attraction);
  replays.recorded("dem04, grazing impact, classic model: normal velocity, m/s", grazing[0].velocity.y, segments);
  replays.recorded("dem04, grazing impact, classic model: spin, rad/s", -grazing[0].spin, attraction);
  theirs = {.kN = k,
            .cN = mass * gamma,
            .kT = 2.0 / 7 * k,
            .cT = 0.5 * mass * gamma,
            .friction = 0.5,
            .time_step = 1e-8,
            .position = {0, 0.00255},
            .velocity = {3.7839, -0.94345}};
  replays.by_their_rules("dem04, grazing impact, classic model: tangential velocity, m/s",
                         "dem04, grazing impact, classic model: spin, rad/s", theirs.run(5400).run(1000));
}

void slide_and_roll(Replays& replays) {
  GrainScene scene = spheres({sphere(0.0025, 2700, {0, 0.002499982}, {1.4, 0})}, linear(1e4, 1, 2.8e3, 0.4), true);
  scene.gravity = {0, -1};
  const auto early = after_steps(scene, NormalLaw::linear_dashpot, 1e-5, 40000);
  const auto late = after_steps(scene, NormalLaw::linear_dashpot, 1e-5, 100000);
  replays.recorded("dem05, sliding to rolling: velocity at 0.4 s, m/s", early[0].velocity.x, first_step);
  replays.recorded("dem05, sliding to rolling: spin at 0.4 s, rad/s", -early[0].spin, first_step);
  replays.recorded("dem05, sliding to rolling: velocity at 1 s, m/s", late[0].velocity.x, first_step);
  replays.recorded("dem05, sliding to rolling: spin at 1 s, rad/s", -late[0].spin, first_step);
  TheirSphere theirs{.kN = 1e4,
                     .kT = 2.8e3,
                     .friction = 0.4,
                     .gravity = 1,
                     .time_step = 1e-5,
                     .position = {0, 0.002499982},
                     .velocity = {1.4, 0}};
  replays.by_their_rules("dem05, sliding to rolling: velocity at 0.4 s, m/s",
                         "dem05, sliding to rolling: spin at 0.4 s, rad/s", theirs.run(40000));
}

void spinning(Replays& replays) {
  // Their z and x are our y and x; the large sphere lies below.
  const GrainScene scene = spheres({sphere(0.1, 2700, {0, 0.60001}, {0, -0.2}, -22.86), sphere(0.5, 2.7e6, {0, 0}, {})},
                                   linear(1.2e8, 0.5, 3.4e7, 0.4), false);
  const auto after = after_steps(scene, NormalLaw::linear_dashpot, 1e-6, 1300);
  replays.recorded("dem06, spinning sphere: tangential velocity, m/s", after[0].velocity.x, attraction);
  replays.recorded("dem06, spinning sphere: normal velocity, m/s", after[0].velocity.y, segments);
  replays.recorded("dem06, spinning sphere: spin, rad/s", -after[0].spin, attraction);
}

void stack(Replays& replays) {
  GrainScene scene =
      spheres({sphere(0.0005, 1e4, {0, 0.00045}, {}), sphere(0.0005, 1e4, {0, 0.00135}, {})}, linear(1e3, 1), true);
  scene.gravity = {0, -9.81};
  scene.walls.emplace_back();
  scene.walls.back().point = {0, 0.0018};
  scene.walls.back().normal = {0, -1};
  const auto after = after_steps(scene, NormalLaw::linear_dashpot, 2e-6, 1000);
  replays.recorded("dem10, compressed stack: lower place after 1000 steps, m", after[0].position.y);
  replays.recorded("dem10, compressed stack: upper place after 1000 steps, m", after[1].position.y);
  replays.recorded("dem10, compressed stack: lower velocity after 1000 steps, m/s", after[0].velocity.y);
  const GrainScene alone = [&] {
    GrainScene one = spheres({sphere(0.0005, 1e4, {0, 1}, {})}, linear(1e3, 1), true);
    one.gravity = {0, -9.81};
    return one;
  }();
  const auto fallen = [&](double step, std::int64_t steps) {
    return after_steps(alone, NormalLaw::linear_dashpot, step, steps)[0].position.y;
  };
  replays.closed_form("dem10, free fall: place after 0.1 s, m", 1 - 0.5 * 9.81 * 0.01, fallen(1e-4, 1000),
                      fallen(5e-5, 2000));
}

/// The closed forms of two programs whose recorded numbers could not be had, with numbers of our own.
void formulas(Replays& replays) {
  constexpr double e = 0.7, radius = 0.0025, normal = 2, tangential = 3, mu = 0.1, k = 1e10;
  PairProperties contact = linear(k, e, 0, mu);  // it slides throughout
  contact.end = ContactEnd::at_zero_force;
  const GrainScene on_wall = spheres({sphere(radius, 2700, {0, radius}, {0, -normal})}, contact, true);
  const double time = std::numbers::pi * std::sqrt(reduced_mass(on_wall) / k);
  const auto wall = [&](double share) {
    return collide(on_wall, NormalLaw::linear_dashpot, share * time).grains[0].velocity.y;
  };
  replays.closed_form("dem11, region wall: speed after, e = 0.7, m/s", e * normal, wall(1e-3), wall(2.5e-4));
  const GrainScene two = spheres({sphere(radius, 2700, {-radius, 0}, {normal, tangential}),
                                  sphere(radius, 2700, {radius, 0}, {-normal, -tangential})},
                                 contact, false);
  const auto pair_after = [&](double share) { return collide(two, NormalLaw::linear_dashpot, share * time).grains[0]; };
  // The closed form keeps the normal; in a contact of finite duration it turns by this angle.
  const double turned = 2 * tangential * time / (2 * radius);
  const double change = mu * (1 + e) * normal;
  const Grain coarse = pair_after(1e-3), fine = pair_after(2.5e-4);
  replays.closed_form("dem15, oblique impact of two spheres: spin after, rad/s", -2.5 * change / radius, coarse.spin,
                      fine.spin, turned);
  replays.closed_form("dem15, oblique impact of two spheres: tangential velocity after, m/s", tangential - change,
                      coarse.velocity.y, fine.velocity.y, turned);
}

}  // namespace

Findings lammps(bool /*quick*/) {
  Progress progress("programs of LAMMPS:");
  Findings findings;
  findings.text =
      "LAMMPS keeps fifteen programs, dem01 to dem15, each with systems whose trajectories it recorded to 17 digits "
      "and compares to 1e-10, or with closed forms. Those below are replayed with `velocity_verlet`, the linear or "
      "Hertz springs and the step of the system; *agrees* means to 1e-10. Where friction acts, two rules of LAMMPS "
      "differ from those here, as said in the rows.";
  Replays replays(findings);
  head_on(replays);
  hertz(replays);
  progress.update(0.2);
  oblique_on_wall(replays);
  slide_and_roll(replays);
  progress.update(0.7);
  spinning(replays);
  stack(replays);
  formulas(replays);
  findings.trends = {replays.explanation()};
  findings.notes = {
      "Not replayed, since this program lacks what they test: dem07 (rolling resistance), dem08 (cohesion), dem09 "
      "(drag of a fluid), dem12 (superellipsoids), dem13 (twisting friction), dem14 (conduction of heat).",
      "dem11 and dem15: their recorded numbers could not be had; the closed forms that they check are computed with "
      "numbers of our own."};
  return findings;
}

}  // namespace equidem::validation
