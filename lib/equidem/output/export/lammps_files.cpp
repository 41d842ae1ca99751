// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// LAMMPS: bpm/rotational is kN and kT at the middle of the branch, linearized (measured: data/interop.md).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "equidem/contact/restitution.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/grains/scene/pair_options.hpp"
#include "equidem/output/export/engine_model.hpp"

namespace equidem {
namespace {

constexpr char axes[] = {'x', 'y'};

double along_axis(std::size_t axis, Vec2 vector) {
  return axis == 0 ? vector.x : vector.y;
}

class LammpsWriter {
 public:
  explicit LammpsWriter(const EngineModel& model) : model_(model) {
    for (const EngineBond& bond : model.bonds) bond_types_.try_emplace(coefficients_of(bond), 0);
    int type = 0;
    for (auto& [coefficients, number] : bond_types_) number = ++type;
    for (const EngineBody& body : model.bodies) types_.try_emplace(body.kind, 0);
    type = 0;
    for (auto& [kind, number] : types_) number = ++type;
  }

  [[nodiscard]] std::vector<EngineFile> files() {
    std::vector<EngineFile> all{{"in.equidem", input()}, {"assembly.data", data()}};
    all.insert(all.end(), tables_.begin(), tables_.end());
    all.push_back(readme_of(model_, Engine::lammps));
    return all;
  }

 private:
  [[nodiscard]] std::string data() const {
    std::string text = "assembly of equidem\n\n";
    line(text, "{} atoms\n{} atom types", model_.bodies.size(), types_.size());
    if (model_.bonded)
      line(text, "{} bonds\n{} bond types", model_.bonds.size(), std::max<std::size_t>(1, bond_types_.size()));
    text += bounds();
    line(text, "\nAtoms # {}\n", style());
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      if (k % rows_between_looks == 0) stop_if_interrupted();
      const EngineBody& body = model_.bodies[k];
      const double volume = 4.0 / 3 * std::numbers::pi * body.radius * body.radius * body.radius;
      line(text, "{} {}{} {} {} {} {} 0", k + 1, model_.bonded ? "1 " : "", types_.at(body.kind),
           exact(2 * body.radius), exact(body.inertia.mass / volume), exact(body.position.x), exact(body.position.y));
    }
    text += velocities();
    if (model_.bonds.empty()) return text;
    text += "\nBonds\n\n";
    for (std::size_t k = 0; k < model_.bonds.size(); ++k) {
      if (k % rows_between_looks == 0) stop_if_interrupted();
      const EngineBond& bond = model_.bonds[k];
      line(text, "{} {} {} {}", k + 1, bond_types_.at(coefficients_of(bond)), bond.i + 1, bond.j + 1);
    }
    return text;
  }

  [[nodiscard]] std::string input() {
    std::string text = head();
    text += model_.bonded ? bonds() : contacts();
    text += actions();
    line(text, "timestep {}", exact(model_.time_step));
    text += "run 0\n";
    text += "# Motion\n";
    text += displacements();
    line(text, "variable steps index {}", steps_of(model_));
    text += "variable interval equal ceil(v_steps/20)\nthermo ${interval}\n";
    if (model_.to_rest) text += stop_at_rest();
    text += "run ${steps}\n";
    line(text, "write_dump all custom end.dump id xu yu vx vy omegaz fx fy tqz{} modify format float %.17g sort id",
         model_.bonded ? " c_turn[1] c_turn[2]" : "");
    return text;
  }

  template <typename... Values>
  static void line(std::string& text, fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    text += '\n';
  }

  /// kN, kT, their dashpots and strengths.
  using Coefficients = std::array<double, 6>;
  [[nodiscard]] static Coefficients coefficients_of(const EngineBond& bond) {
    constexpr double never = 1e30;
    return {bond.springs.kN,
            bond.springs.kT,
            bond.dashpots.kN,
            bond.dashpots.kT,
            std::min(bond.tension, never),
            std::min(bond.shear, never)};
  }

  [[nodiscard]] const char* style() const { return model_.bonded ? "bpm/sphere" : "sphere"; }

  [[nodiscard]] double largest_radius() const {
    return std::ranges::max_element(model_.bodies, {}, &EngineBody::radius)->radius;
  }

  [[nodiscard]] double longest_bond() const {
    double longest = 2 * largest_radius();
    for (const EngineBond& bond : model_.bonds) longest = std::max(longest, bond.length);
    return longest;
  }

  /// The box: the period, or the extent with two diameters around.
  [[nodiscard]] std::string bounds() const {
    Vec2 low = model_.bodies.front().position, high = low;
    for (const EngineBody& body : model_.bodies) {
      low = {std::min(low.x, body.position.x), std::min(low.y, body.position.y)};
      high = {std::max(high.x, body.position.x), std::max(high.y, body.position.y)};
    }
    const double around = 4 * largest_radius();
    low = low - Vec2{around, around}, high = high + Vec2{around, around};
    if (model_.period) {
      // Lattices have discs at 0 and at less than the period.
      low = {low.x + around, low.y + around};
      low = {std::min(0.0, low.x), std::min(0.0, low.y)};
      high = low + *model_.period;
    }
    std::string text;
    line(text, "{} {} xlo xhi\n{} {} ylo yhi\n{} {} zlo zhi", exact(low.x), exact(high.x), exact(low.y), exact(high.y),
         exact(-largest_radius()), exact(largest_radius()));
    return text;
  }

  [[nodiscard]] std::string velocities() const {
    const bool any = std::ranges::any_of(
        model_.bodies, [](const EngineBody& body) { return body.velocity != Vec2{} || body.spin != 0; });
    if (!any) return "";
    std::string text = "\nVelocities\n\n";
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      const EngineBody& body = model_.bodies[k];
      line(text, "{} {} {} 0 0 0 {}", k + 1, exact(body.velocity.x), exact(body.velocity.y), exact(body.spin));
    }
    return text;
  }

  [[nodiscard]] std::string head() const {
    std::string text;
    line(text, "# Written by equidem. SI units, {}.",
         model_.body == Body::disc ? "masses and forces per metre of depth" : "spheres");
    text += "# Densities of the data file are those by which a sphere has the mass of the body.\n";
    line(text, "units si\ndimension 2\nboundary {} p\natom_style {}", model_.period ? "p p" : "m m", style());
    line(text, "newton {}", model_.bonded ? "on off" : "off");
    text += "comm_modify vel yes\n";
    if (model_.bonded) line(text, "comm_modify cutoff {}", exact(2 * longest_bond()));
    if (model_.bonded) text += "special_bonds lj 0 1 1 coul 1 1 1\n";
    text += "read_data assembly.data\n";
    return text;
  }

  [[nodiscard]] std::string bonds() const {
    const bool breaks = model_.found.contains(EngineFeature::strengths);
    std::string text;
    line(text, "bond_style bpm/rotational break {} smooth no", breaks ? "yes" : "no");
    for (const auto& [k, type] : bond_types_)
      line(text, "bond_coeff {} {} {} 0 0 {} {} 1e30 1e30 {} {} 0 0", type, exact(k[0]), exact(k[1]), exact(k[4]),
           exact(k[5]), exact(k[2]), exact(k[3]));
    if (bond_types_.empty()) text += "bond_coeff 1 1 0 0 0 1e30 1e30 1e30 1e30 0 0 0 0\n";
    line(text, "pair_style zero {}\npair_coeff * *", exact(1.2 * longest_bond()));
    line(text, "neighbor {} bin", exact(0.2 * longest_bond()));
    text += "compute turn all property/atom quatw quatk\n";
    return text;
  }

  /// Whether one pair of coefficients per mass holds for all contacts, as gran/hooke/history takes it.
  [[nodiscard]] bool by_mass() const {
    if ((!equal_masses(model_) && model_.graded_dashpots) || model_.found.contains(EngineFeature::rolling))
      return false;
    const PairProperties& first = model_.between(types_.begin()->first, types_.begin()->first);
    for (const auto& [a, type_a] : types_)
      for (const auto& [b, type_b] : types_)
        if (!(model_.between(a, b) == first)) return false;
    return true;
  }

  /// Dashpots over the reduced mass.
  struct Dashpots {
    double normal = 0, along = 0;  ///< 1/s
  };
  [[nodiscard]] Dashpots dashpots_by_mass(const PairProperties& pair, double mass) const {
    const double normal = 2 * damping_ratio(NormalLaw::linear_dashpot, pair) * std::sqrt(pair.stiffness / mass);
    const double along =
        2 * pair.tangential_damping * std::sqrt(tangential_mass_share() * stiffness_along(pair) / mass);
    return {std::max(normal, smallest_dashpot), pair.friction > 0 ? along : 0};
  }

  /// The mass at a contact across its normal, 1/(1/m_i + 1/m_j + r_i²/I_i + r_j²/I_j), over the reduced mass.
  [[nodiscard]] double tangential_mass_share() const { return 1 / (1 + 1 / inertia_factor(model_.body)); }

  /// kn kt gamma_n gamma_t xmu dampflag.
  [[nodiscard]] std::string coefficients_by_mass(const PairProperties& pair, double mass) const {
    const Dashpots dashpots = dashpots_by_mass(pair, mass);
    return fmt::format("{} {} {} {} {} 1{}", exact(pair.stiffness), exact(stiffness_along(pair)),
                       exact(dashpots.normal), exact(dashpots.along), exact(pair.friction), limit(pair));
  }

  /// The law of coefficients_by_mass in the words of the style granular, which takes the tangential dashpot as a
  /// multiple of the normal one. With the style hooke/history walls of LAMMPS 4 Feb 2025 have no friction: they begin
  /// its spring anew in every step.
  [[nodiscard]] std::string wall_by_mass(const PairProperties& pair, double mass) const {
    const Dashpots dashpots = dashpots_by_mass(pair, mass);
    return fmt::format("granular hooke {} {} damping mass_velocity tangential linear_history {} {} {}{}",
                       exact(pair.stiffness), exact(dashpots.normal), exact(stiffness_along(pair)),
                       exact(dashpots.along / dashpots.normal), exact(pair.friction), limit(pair));
  }

  /// A contact without friction has a tangential spring that carries nothing: LAMMPS divides by its stiffness.
  [[nodiscard]] static double stiffness_along(const PairProperties& pair) {
    return pair.stiffness * (pair.friction > 0 ? pair.tangential_ratio : 2.0 / 7);
  }

  /// Rolling resistance as a pseudo-force at the reduced radius, which is that of LAMMPS's rolling sds; its dashpot is
  /// that of bodies that are all equal.
  [[nodiscard]] std::string rolling(const PairProperties& pair, bool wall) const {
    if (!(pair.rolling_friction > 0)) return "";
    const EngineBody& body = model_.bodies.front();
    const double lever = wall ? body.radius : 0.5 * body.radius, stiffness = pair.rolling_ratio * pair.stiffness;
    const double inverse = lever * lever * (wall ? 1 : 2) / body.inertia.moment;
    const double dashpot = 2 * pair.rolling_damping * std::sqrt(stiffness / inverse);
    return fmt::format(" rolling sds {} {} {}", exact(stiffness), exact(dashpot), exact(pair.rolling_friction));
  }

  /// The style granular: the normal dashpot 2 zeta sqrt(m k) by the restitution of zeta at zero overlap, the tangential
  /// one as a multiple of it.
  [[nodiscard]] std::string coefficients_by_restitution(const PairProperties& pair, bool wall) const {
    const double zeta = damping_ratio(NormalLaw::linear_dashpot, pair);
    const double along = zeta == 0 ? 0
                                   : pair.tangential_damping / zeta *
                                         std::sqrt(tangential_mass_share() * stiffness_along(pair) / pair.stiffness);
    return fmt::format("hooke {} {} tangential linear_history {} {} {}{} damping coeff_restitution{}",
                       exact(pair.stiffness), exact(restitution_of(zeta, ContactEnd::at_zero_overlap)),
                       exact(stiffness_along(pair)), exact(along), exact(pair.friction), rolling(pair, wall),
                       limit(pair));
  }

  [[nodiscard]] static const char* limit(const PairProperties& pair) {
    return pair.end == ContactEnd::at_zero_force && pair.restitution < 1 ? " limit_damping" : "";
  }

  [[nodiscard]] std::string contacts() const {
    std::string text;
    if (by_mass()) {
      const PairProperties& pair = model_.between(types_.begin()->first, types_.begin()->first);
      line(text, "pair_style gran/hooke/history {}",
           coefficients_by_mass(pair, 0.5 * model_.bodies.front().inertia.mass));
      text += "pair_coeff * *\n";
    } else {
      text += "pair_style granular\n";
      for (const auto& [a, type_a] : types_)
        for (const auto& [b, type_b] : types_)
          if (type_a <= type_b)
            line(text, "pair_coeff {} {} {}", type_a, type_b, coefficients_by_restitution(model_.between(a, b), false));
    }
    line(text, "neighbor {} bin\nneigh_modify delay 0 every 1 check yes", exact(0.3 * largest_radius()));
    return text;
  }

  /// The walls: each by a fix for each kind of bodies.
  [[nodiscard]] std::string walls() const {
    std::string text;
    for (std::size_t k = 0; k < model_.walls.size(); ++k) {
      const Wall& wall = model_.walls[k];
      if (wall.moves()) {
        line(text, "variable move_{}_x equal {}\nvariable move_{}_y equal {}", k, formula_of(wall.move_x, "v_t"), k,
             formula_of(wall.move_y, "v_t"));
      }
      line(text, "region wall_{} plane {} {} 0 {} {} 0 side in{}", k, exact(wall.point.x), exact(wall.point.y),
           exact(wall.normal.x), exact(wall.normal.y),
           wall.moves() ? fmt::format(" move v_move_{}_x v_move_{}_y NULL", k, k) : "");
      for (const auto& [kind, type] : types_) {
        line(text, "group kind_{} type {}", type, type);
        text += fmt::format("fix wall_{}_{} kind_{} wall/gran/region ", k, type, type);
        if (model_.bonded) {
          text += fmt::format("hooke/history {} {} {} 0 0 1", exact(wall.kN), exact(wall.kN), exact(smallest_dashpot));
        } else {
          const PairProperties& pair = model_.between(kind, wall.kind);
          text += by_mass() ? wall_by_mass(pair, model_.bodies.front().inertia.mass)
                            : "granular " + coefficients_by_restitution(pair, true);
        }
        line(text, " region wall_{}", k);
      }
    }
    return text;
  }

  /// The ids of bodies as `group NAME id ...` commands.
  template <typename Chosen>
  [[nodiscard]] std::string group_of(const std::string& name, const Chosen& chosen) const {
    constexpr int most = 16;  // ranges in a command
    std::string text;
    int written = 0;
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      if (!chosen(model_.bodies[k])) continue;
      const std::size_t first = k + 1;
      while (k + 1 < model_.bodies.size() && chosen(model_.bodies[k + 1])) ++k;
      if (written++ % most == 0) text += fmt::format("{}group {} id", text.empty() ? "" : "\n", name);
      text += first == k + 1 ? fmt::format(" {}", first) : fmt::format(" {}:{}", first, k + 1);
    }
    return text.empty() ? text : text + "\n";
  }

  /// Declares the variable NAME of a file of values of atoms, which are counted from 1; a value 0 is left out.
  /// \return whether there are others
  bool declare_atoms(std::string& text, const std::string& name, std::vector<std::pair<std::size_t, double>> values) {
    std::erase_if(values, [](const auto& entry) { return entry.second == 0; });
    if (values.empty()) return false;
    line(text, "variable {0} atomfile {0}.txt", name);
    std::string rows = fmt::format("{}\n", values.size());
    for (const auto& [body, value] : values) line(rows, "{} {}", body + 1, exact(value));
    tables_.push_back({name + ".txt", rows});
    return true;
  }

  /// Variable t is the time.
  [[nodiscard]] std::string loads() {
    std::string text, forces;
    for (std::size_t k = 0; k < model_.timed_loads.size(); ++k)
      line(text, "variable factor_{} equal {}", k, formula_of(model_.timed_loads[k].factor, "v_t"));
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::vector<std::string> terms;
      std::vector<std::pair<std::size_t, double>> values;
      for (const EngineBody& body : model_.bodies)
        values.emplace_back(values.size(), along_axis(axis, body.load.force));
      const std::string constant = fmt::format("load_{}", axes[axis]);
      if (declare_atoms(text, constant, values)) terms.push_back("v_" + constant);
      for (std::size_t k = 0; k < model_.timed_loads.size(); ++k) {
        values.clear();
        for (const auto& [body, share] : model_.timed_loads[k].shares)
          values.emplace_back(body, along_axis(axis, share.force));
        const std::string timed = fmt::format("load_{}_{}", axes[axis], k);
        if (declare_atoms(text, timed, values)) terms.push_back(fmt::format("v_{}*v_factor_{}", timed, k));
      }
      if (!terms.empty()) line(text, "variable loads_{} atom {}", axes[axis], joined(terms, "+"));
      forces += terms.empty() ? "0 " : fmt::format("v_loads_{} ", axes[axis]);
    }
    if (forces != "0 0 ") line(text, "fix loads all addforce {}0", forces);
    return text;
  }

  /// A support that follows a schedule u is driven by the force m (u(t + h) - 2 u(t) + u(t - h))/h², with which the
  /// step h of LAMMPS puts it into its place.
  [[nodiscard]] std::string driven_supports() {
    std::string text;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::vector<std::string> members, accelerations;
      for (std::size_t k = 0; k < model_.motions.size(); ++k) {
        const EngineMotion& motion = model_.motions[k];
        if (motion.component != axis) continue;
        for (const auto& [name, time] : {std::pair("next", "(v_t+dt)"), {"now", "v_t"}, {"last", "(v_t-dt)"}})
          line(text, "variable {}_{} equal {}", name, k, formula_of(motion.displacement, time));
        line(text,
             "variable acceleration_{0} equal "
             "((step>0)*(v_next_{0}-2*v_now_{0}+v_last_{0})+(step==0)*2*(v_next_{0}-v_now_{0}))/(dt*dt)",
             k);
        std::vector<std::pair<std::size_t, double>> driven;
        for (const std::int32_t body : motion.bodies) driven.emplace_back(body, 1);
        if (!declare_atoms(text, fmt::format("driven_{}", k), driven)) continue;
        members.push_back(fmt::format("v_driven_{}", k));
        accelerations.push_back(fmt::format("v_driven_{0}*v_acceleration_{0}", k));
      }
      if (members.empty()) continue;
      line(text,
           "variable driven_{0} atom {1}\nvariable drive_{0} atom mass*({2})\ngroup driven_{0} variable driven_{0}\n"
           "fix drive_{0} driven_{0} setforce {3}",
           axes[axis], joined(members, "+"), joined(accelerations, "+"),
           axis == 0 ? "v_drive_x NULL NULL" : "NULL v_drive_y NULL");
    }
    return text;
  }

  /// Gravity, loads, walls, supports, damping, motion, in the order in which they change the forces.
  [[nodiscard]] std::string actions() {
    std::string text;
    if (std::ranges::any_of(model_.walls, &Wall::moves) || !model_.motions.empty() || !model_.timed_loads.empty())
      text += "variable t equal step*dt\n";
    text += walls();
    if (model_.gravity != Vec2{})
      line(text, "fix gravity all gravity {} vector {} {} 0", exact(norm(model_.gravity)),
           exact(model_.gravity.x / norm(model_.gravity)), exact(model_.gravity.y / norm(model_.gravity)));
    text += loads();
    const std::string held_x = group_of("held_x", [](const EngineBody& body) { return body.held[0].has_value(); });
    const std::string held_y = group_of("held_y", [](const EngineBody& body) { return body.held[1].has_value(); });
    const std::string rigid = group_of("rigid", [](const EngineBody& body) { return body.held[2].has_value(); });
    text += held_x + held_y + rigid;
    if (!held_x.empty()) text += "fix hold_x held_x setforce 0 NULL NULL\n";
    if (!held_y.empty()) text += "fix hold_y held_y setforce NULL 0 NULL\n";
    if (model_.local_damping > 0)
      line(text, "fix damping all damping/cundall {} {}", exact(model_.local_damping), exact(model_.local_damping));
    text += driven_supports();
    const char* of_disc = model_.body == Body::disc ? " disc" : "";
    if (rigid.empty()) {
      line(text, "fix motion all nve/{}{}", style(), of_disc);
    } else {
      line(text, "group turning subtract all rigid\nfix motion turning nve/{}{}\nfix translation rigid nve", style(),
           of_disc);
    }
    text += "fix plane all enforce2d\n";
    return text;
  }

  /// The bonds have taken their reference; what supports prescribe is there from now on.
  [[nodiscard]] std::string displacements() const {
    std::string text;
    for (std::size_t c = 0; c < 3; ++c) {
      std::map<double, int> values;
      for (const EngineBody& body : model_.bodies)
        if (body.held[c].value_or(0) != 0) values.try_emplace(*body.held[c], 0);
      for (const auto& [value, unused] : values) {
        text += group_of("given", [&, given = value](const EngineBody& body) { return body.held[c] == given; });
        if (c == 2)
          line(text, "set group given quat 0 0 1 {}", exact(value * 180 / std::numbers::pi));
        else
          line(text, "displace_atoms given move {} {} 0 units box", exact(c == 0 ? value : 0),
               exact(c == 1 ? value : 0));
        text += "group given delete\n";
      }
    }
    return text;
  }

  [[nodiscard]] std::string stop_at_rest() const {
    std::string text = "variable unbalanced atom sqrt(fx*fx+fy*fy)\ncompute largest all reduce max v_unbalanced\n";
    text += "variable largest equal c_largest\nthermo_style custom step time ke v_largest\n";
    line(text, "fix rest all halt 100 v_largest < {} error continue message no", exact(1e-10 * force_scale(model_)));
    return text;
  }

  /// In place of 0, 1/s: walls of LAMMPS since 2022 divide the tangential dashpot by the normal one.
  static constexpr double smallest_dashpot = 1e-200;

  const EngineModel& model_;
  std::vector<EngineFile> tables_;  ///< of values of atoms, which the commands read
  std::map<Coefficients, int> bond_types_;
  std::map<int, int> types_;  // atom type of each kind of bodies
};

}  // namespace

std::vector<EngineFile> lammps_files(const EngineModel& model) {
  return LammpsWriter(model).files();
}

}  // namespace equidem
