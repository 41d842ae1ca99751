// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// YADE: ScGeom6D has its contact point at the radius of the first body less half the overlap. With
/// avoidGranularRatcheting = False its slip is that of the material points there, our law for small motions.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <utility>

#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/output/export/engine_model.hpp"
#include "equidem/output/texts.hpp"

namespace equidem {
namespace {

/// The part of run_equidem.py.in behind the line "#: NAME".
std::string_view part(std::string_view name) {
  const std::string_view all = run_equidem_py_in, mark = "#: ";
  const std::string heading = fmt::format("{}{}\n", mark, name);
  const std::size_t begin = all.find(heading) + heading.size();
  return all.substr(begin, all.find(mark, begin) - begin);
}

class YadeWriter {
 public:
  explicit YadeWriter(const EngineModel& model) : model_(model) {}

  [[nodiscard]] std::string script() const {
    std::string text = fmt::format(
        "# Written by equidem. SI units, {}.\n# yade -n -x run_equidem.py\nimport math\nfrom math import cos, "
        "sin\n\nfrom yade import utils\n\n",
        model_.body == Body::disc ? "masses and forces per metre of depth" : "spheres");
    text += fmt::format("STEPS = {}\n", steps_of(model_));
    text += fmt::format("DAMPING = {}  # share of the resultant that acts against the velocity\n",
                        exact(model_.local_damping));
    text += fmt::format("GRAVITY = ({}, {}, 0.0)\n", exact(model_.gravity.x), exact(model_.gravity.y));
    if (model_.to_rest)
      text += fmt::format("TOLERANCE = {}  # N/m, of the unbalanced force\n", exact(1e-10 * force_scale(model_)));
    if (model_.bonded) text += cell();
    text += bodies();
    if (model_.bonded) text += bonds();
    text += model_.bonded ? std::string(part("materials of bonds")) : damped() ? damped_materials() : materials();
    text += part("bodies");
    if (!model_.bonded) text += walls();
    if (!model_.bonded) text += part(damped() ? "damped law" : "elastic law");
    text += part(model_.bonded ? "bonds" : "contacts");
    text += fmt::format("O.dt = {}\n", exact(model_.time_step));
    if (std::ranges::any_of(model_.walls, &Wall::moves)) text += moving_walls();
    if (!model_.motions.empty() || !model_.timed_loads.empty()) text += schedules();
    text += "# Motion\n";
    text += part(model_.to_rest ? "run to rest" : "run of steps");
    text += part("end");
    return text;
  }

 private:
  /// The period; that of z, in which nothing moves, is any.
  [[nodiscard]] std::string cell() const {
    if (!model_.period) return "PERIOD = (0.0, 0.0)\n";
    const Vec2 period = *model_.period;
    return fmt::format("PERIOD = ({0}, {1})  # m\nO.periodic = True\nO.cell.setBox({0}, {1}, {0})\n", exact(period.x),
                       exact(period.y));
  }

  /// The loops above split rows by '\n' and words by ' '.
  [[nodiscard]] std::string bodies() const {
    std::string text =
        "# x y radius mass moment_of_inertia vx vy spin Fx Fy moment material, held: ux uy rotation or -\nBODIES = "
        "\"\"\"\n";
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      if (k % rows_between_looks == 0) stop_if_interrupted();
      const EngineBody& body = model_.bodies[k];
      const double radius = model_.bonded ? model_.lever_radii[k] : body.radius;
      for (const double value :
           {body.position.x, body.position.y, radius, body.inertia.mass, body.inertia.moment, body.velocity.x,
            body.velocity.y, body.spin, body.load.force.x, body.load.force.y, body.load.moment})
        text += exact(value) + " ";
      text += fmt::format("{}", model_.bonded ? 0 : body.kind);
      for (const auto& held : body.held) text += fmt::format(" {}", held ? exact(*held) : "-");
      text += '\n';
    }
    return text + "\"\"\"\n";
  }

  [[nodiscard]] std::string bonds() const {
    std::string text = "# i j kn ks, periods to the image of j\nBONDS = \"\"\"\n";
    for (std::size_t k = 0; k < model_.bonds.size(); ++k) {
      if (k % rows_between_looks == 0) stop_if_interrupted();
      const EngineBond& bond = model_.bonds[k];
      fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {}\n", bond.i, bond.j, exact(bond.springs.kN),
                     exact(bond.springs.kT), bond.shift_x, bond.shift_y);
    }
    return text + "\"\"\"\n";
  }

  /// A material for each kind; their stiffness and friction are those of PAIRS.
  [[nodiscard]] std::string materials() const {
    std::string text = "# material material kn ks angle_of_friction\nPAIRS = [\n";
    for (int a = 0; a < model_.kinds; ++a)
      for (int b = a; b < model_.kinds; ++b) {
        const PairProperties& pair = model_.between(a, b);
        const double ratio = pair.friction > 0 ? pair.tangential_ratio : 2.0 / 7;
        text += fmt::format("    ({}, {}, {}, {}, {}),\n", a, b, exact(pair.stiffness), exact(ratio * pair.stiffness),
                            exact(std::atan(pair.friction)));
      }
    text += fmt::format("]\nfor _ in range({}):\n", model_.kinds);
    return text + "    O.materials.append(FrictMat(young=1, poisson=1, density=1, frictionAngle=0))\n";
  }

  [[nodiscard]] const PairProperties& of_bodies() const {
    const int kind = model_.bodies.front().kind;
    return model_.between(kind, kind);
  }
  [[nodiscard]] bool damped() const { return damping_ratio(NormalLaw::linear_dashpot, of_bodies()) > 0; }

  /// Springs and dashpots of two materials act one after another: k = k_i k_j/(k_i + k_j), and c likewise. Bodies of
  /// one mass m take twice c = 2 zeta sqrt(k m/2), walls what makes it 2 zeta sqrt(k m).
  [[nodiscard]] std::string damped_materials() const {
    const PairProperties& pair = of_bodies();
    const double mass = model_.bodies.front().inertia.mass;
    const double zeta = damping_ratio(NormalLaw::linear_dashpot, pair);
    const double at_wall = 2 * zeta * std::sqrt(pair.stiffness * mass), of_body = std::numbers::sqrt2 * at_wall;
    const double ratio = pair.friction > 0 ? pair.tangential_ratio : 2.0 / 7;
    std::string text;
    for (int kind = 0; kind < model_.kinds; ++kind) {
      text += fmt::format("O.materials.append(ViscElMat(kn={}, ks={}, cn={}, cs=0, frictionAngle={}, density=1))\n",
                          exact(2 * pair.stiffness), exact(2 * ratio * pair.stiffness),
                          exact(model_.has_bodies(kind) ? of_body : at_wall * of_body / (of_body - at_wall)),
                          exact(std::atan(pair.friction)));
    }
    return text;
  }

  [[nodiscard]] std::string walls() const {
    std::string text;
    for (const Wall& wall : model_.walls) {
      const bool along_x = wall.normal.x != 0;
      const Vec2 start = wall.point + wall.displacement(0);
      const double place = along_x ? start.x : start.y;
      const int sense = (along_x ? wall.normal.x : wall.normal.y) > 0 ? 1 : -1;
      text += fmt::format("O.bodies.append(utils.wall({}, {}, sense={}, material={}))\n", exact(place), along_x ? 0 : 1,
                          sense, wall.kind);
    }
    return text;
  }

  /// Walls follow the bodies.
  [[nodiscard]] std::string moving_walls() const {
    std::string text = "# number, place at the time t\nMOVING_WALLS = [\n";
    for (std::size_t k = 0; k < model_.walls.size(); ++k) {
      const Wall& wall = model_.walls[k];
      if (!wall.moves()) continue;
      text += fmt::format("    ({}, lambda t: ({}, {})),\n", model_.bodies.size() + k, formula_of(wall.move_x, "t"),
                          formula_of(wall.move_y, "t"));
    }
    return text + "]\n" + std::string(part("motion of walls"));
  }

  [[nodiscard]] std::string schedules() const {
    std::string text = "# component (0: x, 1: y, 2: rotation), displacement at the time t, bodies\nSUPPORTS = [\n";
    for (const EngineMotion& motion : model_.motions)
      text += fmt::format("    ({}, lambda t: {}, [{}]),\n", motion.component, formula_of(motion.displacement, "t"),
                          fmt::join(motion.bodies, ", "));
    text += "]\n# factor at the time t; body, Fx, Fy, moment\nLOADS = [\n";
    for (const EngineLoad& load : model_.timed_loads) {
      text += fmt::format("    (lambda t: {}, [\n", formula_of(load.factor, "t"));
      for (const auto& [body, share] : load.shares)
        text += fmt::format("        ({}, {}, {}, {}),\n", body, exact(share.force.x), exact(share.force.y),
                            exact(share.moment));
      text += "    ]),\n";
    }
    return text + "]\n" + std::string(part("schedules"));
  }

  const EngineModel& model_;
};

}  // namespace

std::vector<EngineFile> yade_files(const EngineModel& model) {
  return {{"run_equidem.py", YadeWriter(model).script()}, readme_of(model, Engine::yade)};
}

}  // namespace equidem
