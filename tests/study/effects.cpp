// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <string>

#include "equidem/study/built_in.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

struct Cost {
  double bytes = 0, unknowns = 0, evaluations = 0;
  bool operator==(const Cost&) const = default;
};

/// Returns what the scenes of a problem of the study cost beside time, by their names.
std::map<std::string, Cost> costs_of(const std::string& word) {
  std::map<std::string, Cost> costs;
  for (const StudyTask& task : effects_study(true).tasks) {
    if (task.setting.problem.find(word) == std::string::npos) continue;
    const Trial trial = task.prepare();
    trial.work();
    const std::vector<double> values = trial.values();
    costs[task.setting.method] = {values[0], values[1], values[2]};
  }
  return costs;
}

}  // namespace

TEST_CASE("walls_that_follow_a_stress_or_a_record_add_nothing_to_the_discs") {
  const std::map<std::string, Cost> costs = costs_of("pressed");
  const Cost &plain = costs.at("between four walls"), &moved = costs.at("+ a moving wall");
  for (const auto& [name, cost] : costs) {
    CAPTURE(name, cost.evaluations, plain.evaluations);
    CHECK(cost.unknowns == 3);
    CHECK(cost.evaluations == Approx(plain.evaluations).epsilon(0.01));
  }
  for (const std::string name :
       {"+ a moving wall", "or shaken: all walls move alike", "or two servo walls, which keep a stress"}) {
    CAPTURE(name);
    CHECK(costs.at(name).bytes == plain.bytes);
  }
  // Histories read the state, and one stage is the plain case.
  CHECK(costs.at("+ histories of the walls, every 100 steps") == moved);
  CHECK(costs.at("+ one stage") == moved);
}

TEST_CASE("histories_of_a_cell_change_no_step_and_a_cell_in_place_of_walls_no_contact") {
  const std::map<std::string, Cost> costs = costs_of("cell");
  CHECK(costs.at("+ histories of the cell, every 100 steps") == costs.at("+ a stress that it keeps"));
  // Walls bear the contacts of the rim: each disc has six halves in a cell, those of the rim somewhat less than that in
  // a box.
  const double cell = costs.at("+ a cell in place of the walls").evaluations;
  CAPTURE(cell);
  CHECK(cell == Approx(3).epsilon(0.01));
}

TEST_CASE("only_bonds_that_turn_discs_give_them_a_rotation_and_only_strengths_are_kept") {
  const std::map<std::string, Cost> costs = costs_of("law C, bonded");
  const Cost &along = costs.at("+ bonds with springs along"), &across = costs.at("+ springs across"),
             &wide = costs.at("+ a width: springs against bending"),
             &breakable = costs.at("+ strengths, of which none is reached");
  CHECK(costs.at("normal contacts, no bonds").unknowns == 2);
  CHECK(along.unknowns == 2);
  CHECK(across.unknowns == 3);
  CAPTURE(along.bytes, across.bytes, wide.bytes, breakable.bytes);
  CHECK(along.bytes == across.bytes);
  CHECK(wide.bytes == across.bytes);
  CHECK(breakable.bytes > wide.bytes);
  CHECK(breakable.evaluations == wide.evaluations);
}
