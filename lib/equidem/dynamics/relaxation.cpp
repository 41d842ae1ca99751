// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/contact/finite_bond.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/dynamics/layout.hpp"
#include "equidem/dynamics/scene_check.hpp"
#include "equidem/linear/contact_graph.hpp"
#include "equidem/linear/stiffness_matrix.hpp"

namespace equidem {
namespace {

using Vector = std::vector<double>;  // per component: u_x, u_y[, a theta] or the forces that work on them

constexpr int steps_between_looks = 25;  // at the true residual, which recursion follows to round-off only
constexpr double furthest = 0.2;         // mean radii that a disc moves in a step of finite motion

constexpr int most_halves = 60;
constexpr std::int64_t longest_fall = 20000;  // steps in which nothing carries a force

/// x + c y.
void add(Vector& x, double c, const Vector& y) {
  for (std::size_t k = 0; k < x.size(); ++k) x[k] += c * y[k];
}

/// A scene that stands still, and its forces as functions of the motion.
class StillScene {
 public:
  StillScene(const Scene& scene, const RelaxationOptions& options)
      : scene_(scene),
        motion_(options.motion),
        time_(options.time),
        effects_(derive_effects(scene.assembly, scene.springs, options.rotation)),
        unknowns_(unknowns_at(scene, effects_, options.time)),
        contacts_(unloaded(scene, options.time),
                  {.motion = options.motion, .rotation = options.rotation, .time_step = 1}) {
    find_loads();
    find_masses();
  }

  [[nodiscard]] bool linear() const { return motion_ == LoopKind::Motion::small && scene_.walls.empty(); }
  [[nodiscard]] bool any_negative() const { return scene_.springs.any_negative(); }
  [[nodiscard]] double radius() const { return unknowns_.rotation_scale; }
  [[nodiscard]] const Vector& masses() const { return masses_; }
  [[nodiscard]] std::vector<DiscMotion> motions(const Vector& u) const { return disc_motions(unknowns_, u); }

  [[nodiscard]] Vector start(const std::vector<DiscMotion>& given) const {
    Vector u = unknowns_.prescribed;
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    for (std::size_t k = 0; k < u.size() && !given.empty(); ++k) {
      const DiscMotion& disc = given[k / b];
      if (unknowns_.held[k] != DegreesOfFreedom::free) continue;
      u[k] = k % b == 0 ? disc.u.x : k % b == 1 ? disc.u.y : disc.theta * radius();
    }
    return u;
  }

  /// Forces of contacts and walls; 0 for components that are not free.
  [[nodiscard]] Vector internal(const Vector& u) const { return components(contacts_.unbalanced_forces(motions(u))); }
  [[nodiscard]] Vector unbalanced(const Vector& u) const {
    Vector f = internal(u);
    add(f, 1, loads_);
    return f;
  }
  [[nodiscard]] double relative(const Vector& u, const Vector& f) const {
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    std::vector<DiscForce> forces(scene_.assembly.size());
    for (std::size_t d = 0; d < forces.size(); ++d) {
      forces[d] = {{f[d * b], f[d * b + 1]}, b == 3 ? f[d * b + 2] * radius() : 0.0};
    }
    return relative_unbalanced_force(scene_, motion_, forces, motions(u), time_);
  }

 private:
  /// Contacts, and walls where they stand at a time.
  static Scene unloaded(const Scene& scene, double time) {
    Scene still(scene.assembly, scene.springs, std::vector<Inertia>(scene.assembly.size(), {1, 1}));
    still.walls = scene.walls;
    for (Wall& wall : still.walls)
      wall.move_x = {.value = wall.move_x.at(time)}, wall.move_y = {.value = wall.move_y.at(time)};
    return still;
  }

  [[nodiscard]] Vector components(const std::vector<DiscForce>& forces) const {
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    Vector f(unknowns_.held.size());
    for (std::size_t k = 0; k < f.size(); ++k) {
      const DiscForce& disc = forces[k / b];
      if (unknowns_.held[k] != DegreesOfFreedom::free) continue;
      f[k] = k % b == 0 ? disc.force.x : k % b == 1 ? disc.force.y : disc.moment / radius();
    }
    return f;
  }

  void find_loads() {
    loads_.assign(unknowns_.held.size(), 0.0);
    for (const TimedLoad& load : scene_.loads) {
      check(load.factor);
      add(loads_, load.factor.at(time_), assemble_loads(scene_.assembly, unknowns_, {load.load}));
    }
    const auto b = static_cast<std::size_t>(unknowns_.per_disc);
    for (std::size_t d = 0; scene_.weighs() && d < scene_.assembly.size(); ++d) {
      loads_[b * d] += scene_.inertia[d].mass * scene_.gravity.x;
      loads_[b * d + 1] += scene_.inertia[d].mass * scene_.gravity.y;
    }
    for (std::size_t k = 0; k < loads_.size(); ++k)
      if (unknowns_.held[k] != DegreesOfFreedom::free) loads_[k] = 0;
  }

  void find_masses() {
    const ContactGraph graph(scene_.assembly);
    const StiffnessMatrix k = assemble_stiffness(scene_.assembly, graph, scene_.springs, unknowns_);
    const auto b = static_cast<std::size_t>(k.block);
    masses_.assign(unknowns_.held.size(), 0.0);
    for (std::size_t r = 0; r < b; ++r) {
      for (std::size_t s = 0; s < b; ++s) {
        for (std::size_t d = 0; d < scene_.assembly.size(); ++d) {
          masses_[d * b + r] += std::abs(k.diagonal_block(d)[r * b + s]);
        }
        for (std::size_t c = 0; c < scene_.assembly.contacts.size(); ++c) {
          const double entry = std::abs(k.coupling_block(c)[r * b + s]);
          masses_[scene_.assembly.contacts[c].i * b + r] += entry;
          masses_[scene_.assembly.contacts[c].j * b + s] += entry;
        }
      }
    }
    double walls = 0;
    for (const Wall& wall : scene_.walls) walls += wall.kN;
    for (double& mass : masses_) mass = mass > 0 ? mass + walls : scene_.springs.largest();
  }

  const Scene& scene_;
  LoopKind::Motion motion_;
  double time_;
  Effects effects_;
  DegreesOfFreedom unknowns_;
  Simulation contacts_;  // without loads, all discs free
  Vector loads_, masses_;
};

[[noreturn]] void no_minimum(bool negative) {
  computation_failed(
      "the discs do not come to rest",
      negative ? "a motion lowers the energy without end: some kT is negative"
               : "a motion that the load drives costs no energy: the discs move as a whole or as a mechanism",
      negative ? "Solve the stiffness matrix instead, which also finds states of rest that are no minimum"
               : "Add supports or springs that resist it");
}

/// Descent from u until the unbalanced force is small.
class Descent {
 public:
  Descent(const StillScene& scene, const RelaxationOptions& options, Relaxation& result)
      : scene_(scene),
        options_(options),
        result_(result),
        u_(scene.start(options.start)),
        f_(unbalanced(u_)),
        p_(f_.size()) {}

  void run() {
    Progress progress("relaxing");
    Vector z = over_masses(f_);
    double fz = dot(f_, z);
    p_ = z;
    double length = 1;  // K <= M: no step that is too long
    look();
    while (!(result_.relative_unbalanced <= options_.tolerance)) {
      if (result_.steps >= options_.max_steps) not_at_rest("");
      // Without rounding conjugate gradients end after as many steps as there are components.
      if (result_.relative_unbalanced < 0.5 * best_) best_ = result_.relative_unbalanced, best_step_ = result_.steps;
      const bool falls = result_.relative_unbalanced == 1;
      if (falls && result_.steps >= longest_fall) not_at_rest("");
      if (!falls && result_.steps - best_step_ > static_cast<std::int64_t>(f_.size()) + 1000) {
        not_at_rest("; rounding of the displacements seems to allow no less");
      }
      const Vector before = f_;
      if (scene_.linear()) {
        go_straight(fz);
      } else {
        length = go_by_secant(length);
      }
      ++result_.steps;
      if (scene_.linear() && result_.steps % steps_between_looks == 0) f_ = unbalanced(u_);
      z = over_masses(f_);
      if (!std::isfinite(dot(f_, z))) not_at_rest("; forces are no finite numbers any more");
      const double next = dot(f_, z), share = std::max(0.0, (next - dot(before, z)) / fz);
      for (std::size_t k = 0; k < p_.size(); ++k) p_[k] = z[k] + share * p_[k];
      if (dot(p_, f_) <= 0) p_ = z;
      fz = next;
      if (fz == 0 || result_.steps % steps_between_looks == 0) {
        look();
        progress.update(
            std::clamp(std::log(result_.relative_unbalanced) / std::log(std::min(0.1, options_.tolerance)), 0.0, 1.0));
      }
    }
    result_.motions = scene_.motions(u_);
  }

 private:
  [[nodiscard]] Vector unbalanced(const Vector& u) {
    ++result_.evaluations;
    return scene_.unbalanced(u);
  }
  [[nodiscard]] Vector over_masses(const Vector& f) const {
    Vector z(f.size());
    for (std::size_t k = 0; k < z.size(); ++k) z[k] = f[k] / scene_.masses()[k];
    return z;
  }

  void look() { result_.relative_unbalanced = scene_.relative(u_, f_); }

  /// Forces are linear in the motion: the one evaluation is K p.
  void go_straight(double fz) {
    const Vector q = scene_.internal(p_);
    ++result_.evaluations;
    const double stiffness = -dot(p_, q);
    if (!(stiffness > 0)) no_minimum(scene_.any_negative());
    const double length = fz / stiffness;
    add(u_, length, p_);
    add(f_, length, q);
  }

  /// Returns the length of the step. Where discs meet walls or part from them the secant may be far off: then halves,
  /// until the force along the way is less than half of what it was.
  double go_by_secant(double length) {
    double largest = 0;
    for (const double x : p_) largest = std::max(largest, std::abs(x));
    const double limit = furthest * scene_.radius() / largest, trial = std::min(length, limit);
    const Vector u = u_;
    const auto force_at = [&](double step) {
      u_ = u;
      add(u_, step, p_);
      f_ = unbalanced(u_);
      return dot(p_, f_);
    };
    const double force = dot(p_, f_), force_there = force_at(trial);
    const double wanted = force > force_there ? trial * force / (force - force_there) : 4 * trial;
    double step = std::min({wanted, 4 * trial, limit});
    double low = force_there > 0 ? std::min(trial, step) : 0;
    double high = force_there > 0 ? std::numeric_limits<double>::infinity() : trial;
    for (int halved = 0; halved < most_halves; ++halved) {
      const double left = force_at(step);
      if (left > 0.5 * force && std::isfinite(high)) {
        low = step;
      } else if (left < -0.5 * force) {
        high = step;
      } else {
        break;
      }
      step = 0.5 * (low + high);
    }
    return step;
  }

  [[noreturn]] void not_at_rest(const char* cause) const {
    const std::string left = result_.relative_unbalanced < 1
                                 ? fmt::format("relative unbalanced force {:.2g}", result_.relative_unbalanced)
                                 : std::string("no contact and no wall carries any of the force that acts");
    computation_failed(fmt::format("the discs are not at rest after {}", counted(result_.steps, "step")),
                       fmt::format("{}, wanted {:.2g}{}", left, options_.tolerance, cause),
                       "Allow more steps or a larger unbalanced force; where loads are held by no support, add one");
  }

  const StillScene& scene_;
  const RelaxationOptions& options_;
  Relaxation& result_;
  Vector u_, f_, p_;
  double best_ = std::numeric_limits<double>::infinity();  // relative unbalanced force
  std::int64_t best_step_ = 0;
};

}  // namespace

double relative_unbalanced_force(const Scene& scene, LoopKind::Motion motion, const std::vector<DiscForce>& unbalanced,
                                 const std::vector<DiscMotion>& motions, double time) {
  const double a = scene.assembly.mean_radius();
  double left = 0, carried = 0;
  for (const DiscForce& f : unbalanced) left += dot(f.force, f.force) + f.moment * f.moment / (a * a);
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const Contact& contact = scene.assembly.contacts[c];
    const DiscMotion &i = motions[contact.i], &j = motions[contact.j];
    const ContactDeformation d =
        motion == LoopKind::Motion::finite
            ? bond_deformation(bond_of(scene.assembly, contact, scene.springs[c]), bond_motion(i, j))
            : deformation(frame_of(scene.assembly, c), i, j);
    const ContactForce f = linear_spring_force(scene.springs[c], d);
    carried += f.normal * f.normal + f.tangential * f.tangential;
    const double bending = bending_moment(scene.springs.bending(c), i.theta, j.theta) / a;
    carried += bending * bending;
  }
  for (const Vec2 force : wall_pushes(scene, motions, time).forces) carried += dot(force, force);
  return left == 0 ? 0 : std::sqrt(left / (left + carried));
}

static void check(const Scene& scene, const RelaxationOptions& options) {
  check_positive(options.tolerance, "relative unbalanced force wanted");
  check_positive(static_cast<double>(options.max_steps), "largest number of steps");
  if (!options.start.empty())
    check_count(scene, options.start.size(), "in the start", "Start from a state of the same assembly");
  if (scene.weighs())
    check_count(scene, scene.inertia.size(), "with a mass, and gravity acts", "Give the inertia of every disc");
}

Relaxation relax(const Scene& scene, const RelaxationOptions& options) {
  check(scene, options);
  const Stopwatch watch;
  Relaxation result;
  const StillScene still(scene, options);
  Descent(still, options, result).run();
  result.seconds = watch.seconds();
  return result;
}

std::string Relaxation::report() const {
  const std::string work = fmt::format("{}, {} of the forces, {:.2g} s", counted(steps, "step"),
                                       counted(evaluations, "evaluation"), seconds);
  if (relative_unbalanced == 0) return fmt::format("at rest: no force is left unbalanced, after {}", work);
  return fmt::format("at rest: relative unbalanced force {:.2g} after {}", relative_unbalanced, work);
}

}  // namespace equidem
