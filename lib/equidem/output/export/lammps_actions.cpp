// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/export/lammps_actions.hpp"

#include <cstddef>
#include <optional>
#include <utility>

#include "equidem/core/text.hpp"
#include "equidem/output/export/engine_files.hpp"

namespace equidem {
namespace {

constexpr char axes[] = {'x', 'y'};

double along_axis(std::size_t axis, Vec2 vector) {
  return axis == 0 ? vector.x : vector.y;
}

/// The rows of an atomfile variable: numbers of atoms, which begin at 1, and their values other than 0.
class AtomTable {
 public:
  void add(std::size_t body, double value) {
    if (value == 0) return;
    rows_ += fmt::format("{} {}\n", body + 1, exact(value));
    ++count_;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::string text() const { return fmt::format("{}\n{}", count_, rows_); }

 private:
  std::string rows_;
  std::size_t count_ = 0;
};

/// Declares the variable; the term of a sum that it is, none where the table is empty.
std::optional<std::string> term_of(const AtomTable& table, const std::string& name, const std::string& factor,
                                   std::string& commands, std::vector<EngineFile>& files) {
  if (table.empty()) return std::nullopt;
  commands += fmt::format("variable {0} atomfile {0}.txt\n", name);
  files.push_back({name + ".txt", table.text()});
  return "v_" + name + factor;
}

void append_loads(const EngineModel& model, LammpsActions& actions) {
  std::string& text = actions.loads;
  for (std::size_t k = 0; k < model.timed_loads.size(); ++k)
    text += fmt::format("variable factor_{} equal {}\n", k, formula_of(model.timed_loads[k].factor, "v_t"));
  std::string forces;
  bool any = false;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<std::string> terms;
    const auto append = [&](const AtomTable& table, const std::string& name, const std::string& factor) {
      if (const auto term = term_of(table, name, factor, text, actions.tables)) terms.push_back(*term);
    };
    AtomTable constant;
    for (std::size_t k = 0; k < model.bodies.size(); ++k) constant.add(k, along_axis(axis, model.bodies[k].load.force));
    append(constant, fmt::format("load_{}", axes[axis]), "");
    for (std::size_t k = 0; k < model.timed_loads.size(); ++k) {
      AtomTable timed;
      for (const auto& [body, share] : model.timed_loads[k].shares)
        timed.add(static_cast<std::size_t>(body), along_axis(axis, share.force));
      append(timed, fmt::format("load_{}_{}", axes[axis], k), fmt::format("*v_factor_{}", k));
    }
    if (!terms.empty()) text += fmt::format("variable loads_{} atom {}\n", axes[axis], joined(terms, "+"));
    forces += terms.empty() ? "0 " : fmt::format("v_loads_{} ", axes[axis]);
    any = any || !terms.empty();
  }
  if (any) text += fmt::format("fix loads all addforce {}0\n", forces);
}

void append_supports(const EngineModel& model, LammpsActions& actions) {
  std::string& text = actions.supports;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<std::string> members, accelerations;
    for (std::size_t k = 0; k < model.motions.size(); ++k) {
      const EngineMotion& motion = model.motions[k];
      if (motion.component != axis) continue;
      for (const auto& [name, time] : {std::pair("next", "(v_t+dt)"), {"now", "v_t"}, {"last", "(v_t-dt)"}})
        text += fmt::format("variable {}_{} equal {}\n", name, k, formula_of(motion.displacement, time));
      text += fmt::format(
          "variable acceleration_{0} equal "
          "((step>0)*(v_next_{0}-2*v_now_{0}+v_last_{0})+(step==0)*2*(v_next_{0}-v_now_{0}))/(dt*dt)\n",
          k);
      AtomTable driven;
      for (const std::int32_t body : motion.bodies) driven.add(static_cast<std::size_t>(body), 1);
      const std::string name = fmt::format("driven_{}", k);
      const auto member = term_of(driven, name, "", text, actions.tables);
      if (!member) continue;
      members.push_back(*member);
      accelerations.push_back(fmt::format("{}*v_acceleration_{}", *member, k));
    }
    if (members.empty()) continue;
    text += fmt::format(
        "variable driven_{0} atom {1}\nvariable drive_{0} atom mass*({2})\ngroup driven_{0} variable driven_{0}\n"
        "fix drive_{0} driven_{0} setforce {3}\n",
        axes[axis], joined(members, "+"), joined(accelerations, "+"),
        axis == 0 ? "v_drive_x NULL NULL" : "NULL v_drive_y NULL");
  }
}

}  // namespace

LammpsActions lammps_actions(const EngineModel& model) {
  LammpsActions actions;
  append_loads(model, actions);
  append_supports(model, actions);
  return actions;
}

}  // namespace equidem
