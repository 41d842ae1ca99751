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

#include "equidem/core/text.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/output/export/engine_files.hpp"

namespace equidem {
namespace {

constexpr std::string_view bodies_of_bonds = R"(
O.materials.append(CohFrictMat(young=1, poisson=1, density=1, frictionAngle=0, isCohesive=True, normalCohesion=1e30,
                               shearCohesion=1e30, momentRotationLaw=False, fragile=False))
)";

constexpr std::string_view make_bodies = R"(
PRESCRIBED, VELOCITIES = [], []
for number, row in enumerate(BODIES.strip().split("\n")):
    words = row.split()
    x, y, radius, mass, moment, vx, vy, spin, fx, fy, torque = map(float, words[:11])
    body = utils.sphere((x, y, 0), radius, material=int(words[11]))
    body.state.mass, body.state.inertia = mass, (moment, moment, moment)
    held = words[12:]
    body.state.blockedDOFs = "zXY" + "".join(letter for letter, value in zip("xyZ", held) if value != "-")
    O.bodies.append(body)
    if vx or vy or spin:
        VELOCITIES.append((number, Vector3(vx, vy, 0), spin))
    if fx or fy:
        O.forces.setPermF(number, (fx, fy, 0))
    if torque:
        O.forces.setPermT(number, (0, 0, torque))
    given = [0.0 if value == "-" else float(value) for value in held]
    if any(given):
        PRESCRIBED.append((number, given))
)";

constexpr std::string_view make_bonds = R"(
O.engines = [
    ForceResetter(),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom6D(avoidGranularRatcheting=False)],
        [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=True)],
        [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=False)],
    ),
    NewtonIntegrator(damping=DAMPING, gravity=GRAVITY),
]
for row in BONDS.strip().split("\n") if BONDS.strip() else []:
    i, j, kn, ks, across, up = row.split()
    bond = utils.createInteraction(int(i), int(j))
    bond.phys.kn, bond.phys.ks = float(kn), float(ks)
    bond.phys.normalAdhesion = bond.phys.shearAdhesion = 1e30 * float(kn)
    bond.phys.unp = bond.geom.penetrationDepth  # no force at the start
    if O.periodic:  # YADE guesses the image, and not always the bonded one
        bond.cellDist = (int(across), int(up), 0)
        first, second = O.bodies[int(i)], O.bodies[int(j)]
        branch = second.state.pos - first.state.pos + Vector3(int(across) * PERIOD[0], int(up) * PERIOD[1], 0)
        bond.phys.unp = first.shape.radius + second.shape.radius - branch.norm()
)";

constexpr std::string_view elastic_law = R"(
PHYSICS = [
    Ip2_FrictMat_FrictMat_FrictPhys(
        kn=MatchMaker(matches=[(a, b, kn) for a, b, kn, ks, angle in PAIRS]),
        ks=MatchMaker(matches=[(a, b, ks) for a, b, kn, ks, angle in PAIRS]),
        frictAngle=MatchMaker(matches=[(a, b, angle) for a, b, kn, ks, angle in PAIRS]),
    )
]
LAWS = [Law2_ScGeom_FrictPhys_CundallStrack()]
)";

constexpr std::string_view damped_law = R"(
PHYSICS = [Ip2_ViscElMat_ViscElMat_ViscElPhys()]
LAWS = [Law2_ScGeom_ViscElPhys_Basic()]
)";

constexpr std::string_view make_contacts = R"(
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(avoidGranularRatcheting=False), Ig2_Wall_Sphere_ScGeom()],
        PHYSICS,
        LAWS,
    ),
    NewtonIntegrator(damping=DAMPING, gravity=GRAVITY),
]
)";

constexpr std::string_view move_walls = R"(

def move_walls():
    """The velocity by which each wall is in its place after the step."""
    for number, place_at in MOVING_WALLS:
        now, then = (place_at(step * O.dt) for step in (O.iter, O.iter + 1))
        O.bodies[number].state.vel = ((then[0] - now[0]) / O.dt, (then[1] - now[1]) / O.dt, 0)


O.engines = O.engines[:-1] + [PyRunner(command='move_walls()', iterPeriod=1, initRun=True)] + O.engines[-1:]
)";

constexpr std::string_view follow_schedules = R"(

def follow_schedules():
    """The velocity by which each support is in its place after the step, and the loads."""
    now, then = O.iter * O.dt, (O.iter + 1) * O.dt
    for component, place_at, numbers in SUPPORTS:
        speed = (place_at(then) - place_at(now)) / O.dt
        for number in numbers:
            state = O.bodies[number].state
            if component == 2:
                state.angVel = (0, 0, speed)
            else:
                velocity = state.vel
                velocity[component] = speed
                state.vel = velocity
    for factor_at, shares in LOADS:
        factor = factor_at(now)
        for number, fx, fy, torque in shares:
            O.forces.addF(number, (factor * fx, factor * fy, 0))
            O.forces.addT(number, (0, 0, factor * torque))


O.engines = O.engines[:-1] + [PyRunner(command='follow_schedules()', iterPeriod=1, initRun=True)] + O.engines[-1:]
)";

constexpr std::string_view run_to_rest = R"(

def unbalanced():
    """The largest force on a body in the directions in which it is free, N/m."""
    largest = 0.0
    for body in O.bodies:
        force, mass, blocked = O.forces.f(body.id), body.state.mass, body.state.blockedDOFs
        free = [force[k] + mass * GRAVITY[k] for k in (0, 1) if "xy"[k] not in blocked]
        largest = max(largest, math.hypot(*free)) if free else largest
    return largest


O.step()  # tangential forces follow velocities, and none count in the first step
RAMP = 1000  # steps over which prescribed displacements grow
for start in (True, False):
    for number, (ux, uy, turn) in PRESCRIBED:
        state, share = O.bodies[number].state, 1 / (RAMP * O.dt) if start else 0
        blocked, velocity = state.blockedDOFs, state.vel
        state.vel = (share * ux if "x" in blocked else velocity[0], share * uy if "y" in blocked else velocity[1], 0)
        if "Z" in blocked:
            state.angVel = (0, 0, share * turn)
    if start and PRESCRIBED:
        O.run(RAMP, True)
while O.iter < STEPS:
    O.run(500, True)
    if unbalanced() < TOLERANCE:
        break
)";

constexpr std::string_view run_steps = R"(
O.step()  # tangential forces follow velocities, and none count in the first step
for body in O.bodies:
    if isinstance(body.shape, Sphere):  # the velocities after half a step, which it took for those after a whole one
        state = body.state
        half = Vector3(*(0 if letter in state.blockedDOFs else speed / 2 for letter, speed in zip("xyz", state.vel)))
        turn = 0 if "Z" in state.blockedDOFs else state.angVel[2] / 2
        state.vel, state.angVel = state.vel - half, state.angVel - Vector3(0, 0, turn)
        state.pos -= O.dt * half
        state.ori = Quaternion((0, 0, 1), -O.dt * turn) * state.ori
for number, velocity, spin in VELOCITIES:
    state = O.bodies[number].state
    state.pos += O.dt * velocity
    state.ori = Quaternion((0, 0, 1), O.dt * spin) * state.ori
    state.vel, state.angVel = state.vel + velocity, state.angVel + Vector3(0, 0, spin)
if STEPS > 1:
    O.run(STEPS - 1, True)
)";

constexpr std::string_view write_end = R"(
with open("end.txt", "w") as file:
    file.write("# x y rotation ux uy vx vy spin, m, rad, s\n")
    for body in O.bodies:
        if not isinstance(body.shape, Sphere):
            continue
        state = body.state
        place, moved, velocity = state.pos, state.displ(), state.vel
        numbers = (place[0], place[1], state.rot()[2], moved[0], moved[1], velocity[0], velocity[1], state.angVel[2])
        file.write(" ".join("%.17g" % number for number in numbers) + "\n")
with open("end_contacts.txt", "w") as file:
    file.write("# i j overlap, m; forces on j: normal x y, tangential x y, N/m\n")
    for contact in O.interactions:
        if contact.isReal:
            along, across = contact.phys.normalForce, contact.phys.shearForce
            numbers = (contact.geom.penetrationDepth, along[0], along[1], across[0], across[1])
            file.write("%d %d " % (contact.id1, contact.id2) + " ".join("%.17g" % number for number in numbers) + "\n")
print("step", O.iter, "of", STEPS)
)";

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
    text += model_.bonded ? std::string(bodies_of_bonds) : damped() ? damped_materials() : materials();
    text += make_bodies;
    if (!model_.bonded) text += walls();
    if (!model_.bonded) text += damped() ? damped_law : elastic_law;
    text += model_.bonded ? make_bonds : make_contacts;
    text += fmt::format("O.dt = {}\n", exact(model_.time_step));
    if (std::ranges::any_of(model_.walls, &Wall::moves)) text += moving_walls();
    if (!model_.motions.empty() || !model_.timed_loads.empty()) text += schedules();
    text += "# Motion\n";
    text += model_.to_rest ? run_to_rest : run_steps;
    text += write_end;
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
    for (const EngineBond& bond : model_.bonds)
      fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {}\n", bond.i, bond.j, exact(bond.springs.kN),
                     exact(bond.springs.kT), bond.shift_x, bond.shift_y);
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
      const bool body = std::ranges::any_of(model_.bodies, [&](const EngineBody& b) { return b.kind == kind; });
      text +=
          fmt::format("O.materials.append(ViscElMat(kn={}, ks={}, cn={}, cs=0, frictionAngle={}, density=1))\n",
                      exact(2 * pair.stiffness), exact(2 * ratio * pair.stiffness),
                      exact(body ? of_body : at_wall * of_body / (of_body - at_wall)), exact(std::atan(pair.friction)));
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
    return text + "]\n" + std::string(move_walls);
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
    return text + "]\n" + std::string(follow_schedules);
  }

  const EngineModel& model_;
};

}  // namespace

std::vector<EngineFile> yade_files(const EngineModel& model) {
  return {{"run_equidem.py", YadeWriter(model).script()}, readme_of(model, Engine::yade)};
}

}  // namespace equidem
