// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/study/built_in.hpp"

#include <cmath>
#include <set>
#include <string>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/study/evaluate.hpp"

#include "support/catch.hpp"

using namespace equidem;

namespace {

/// The values of all settings, not timed.
StudyResult values_alone(const Study& study) {
  StudySamples samples;
  for (const StudyTask& task : study.tasks) {
    const Trial trial = task.prepare();
    trial.work();
    samples.tasks.push_back({trial.values(), "", {}});
  }
  return evaluate(study, samples);
}

}  // namespace

TEST_CASE("observed_orders_are_those_of_theory") {
  const std::string name = GENERATE("abe_lattice", "integrators", "ellipse_contact", "collision_laws", "solvers");
  const Study study = built_in_study(name, true);
  const StudyResult result = values_alone(study);
  std::string told;
  for (const StudyCurve& curve : result.curves) {
    if (!curve.order || !curve.expected) continue;
    told += fmt::format("{}, {}, {}: {:.3f} ± {:.2g} over {} levels, theory {:g}\n", curve.problem, curve.method,
                        study.quantities[curve.quantity].name, curve.order->order, curve.order->uncertainty,
                        curve.order->levels, curve.expected->order);
  }
  INFO(told);
  CHECK_FALSE(told.empty());
  for (const StudyCurve& curve : result.curves) {
    CAPTURE(curve.problem, curve.method, study.quantities[curve.quantity].name);
    if (curve.order && curve.expected) CHECK(curve.agrees);
  }
}

TEST_CASE("direct_solvers_and_the_exact_contact_are_exact") {
  for (const std::string name : {"solvers", "ellipse_contact"}) {
    const Study study = built_in_study(name, true);
    for (const StudyRow& row : values_alone(study).rows) {
      const bool direct =
          row.setting.method == "multifrontal" || row.setting.method == "cholmod" || row.setting.method == "umfpack";
      CAPTURE(name, row.setting.label(), row.errors);
      if (direct || row.setting.method == "exact") CHECK(row.errors[0] < 1e-11);
    }
  }
}

TEST_CASE("multigrid_ends_within_the_accuracy_of_its_setting_or_at_round_off") {
  for (const StudyRow& row : values_alone(built_in_study("solvers", true)).rows) {
    if (row.setting.method != "multigrid") continue;
    // The accuracy is that of the norm of energy; the error that of displacements.
    const double allowed = row.setting.values.empty() ? 1e-13 : 3 * row.setting.values[0].second;
    CAPTURE(row.setting.problem, row.setting.label(), row.errors);
    CHECK(row.errors[0] <= allowed);
  }
}

TEST_CASE("the_largest_block_of_the_solvers_has_the_discs_asked_for") {
  for (const double discs : {1e4, 1e6}) {
    std::set<double> sizes;
    for (const StudyTask& task : built_in_study("solvers", false, discs).tasks) sizes.insert(task.setting.size);
    CAPTURE(sizes);
    CHECK(*sizes.begin() == Approx(1e3).epsilon(0.1));
    CHECK(*sizes.rbegin() == Approx(discs).epsilon(0.03));
    CHECK(sizes.size() == (discs == 1e4 ? 2 : 4));
  }
  CHECK_THROWS_WITH(built_in_study("integrators", false, 1e4), Catch::Contains("Leave out --discs"));
}

TEST_CASE("a_margin_of_the_neighbour_lists_changes_no_motion") {
  const Study study = built_in_study("neighbour_margin", true);
  std::set<double> energies, rebuilds;
  for (const StudyRow& row : values_alone(study).rows) {
    rebuilds.insert(row.values[0]);
    energies.insert(row.values[1]);
  }
  CAPTURE(energies);
  CHECK(energies.size() == 1);
  CHECK(rebuilds.size() > 3);
}

TEST_CASE("built_in_studies_are_named_once_and_complete") {
  std::set<std::string> names;
  for (const BuiltInStudy& entry : built_in_studies()) {
    CHECK(names.insert(entry.name).second);
    for (const bool quick : {true, false}) {
      const Study study = entry.make(quick);
      CAPTURE(entry.name, quick);
      CHECK(study.name == entry.name);
      CHECK_FALSE(study.tasks.empty());
      std::set<std::string> settings;
      for (const StudyTask& task : study.tasks)
        CHECK(settings.insert(task.setting.problem + task.setting.label()).second);
    }
  }
}

TEST_CASE("a_misspelt_study_is_told_its_name") {
  CHECK_THROWS_WITH(built_in_study("integrator", true), Catch::Contains("Did you mean 'integrators'?"));
}
