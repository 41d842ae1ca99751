// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/run_bonds_report.hpp"

#include <utility>

#include "equidem/core/text.hpp"

#include "solve/report.hpp"

namespace equidem {

std::string describe_bonds(const GrainSetup& setup) {
  const std::vector<GrainBond>& bonds = setup.resolved.scene.bonds;
  if (bonds.empty()) return {};
  const bool exact = setup.resolved.options.bond_step == GrainOptions::BondStep::exact;
  std::string out = report_line("bonds", fmt::format("{}, {}", grouped(static_cast<std::int64_t>(bonds.size())),
                                                     exact ? "each decays exactly over a step"
                                                           : "dashpots by the velocities at the start of a step"));
  const double limit = setup.step.bond_limit;
  if (limit == 0) return out + report_line("", "they do not limit the step");
  return out + report_line("", fmt::format("they limit the step to {:.6g} s; it is {:.3g} of that", limit,
                                           setup.step.step / limit));
}

std::string describe_drift_of_bonds(const BondReport& bonds) {
  if (bonds.number == 0) return {};
  const auto drift = [](const char* what, const BondReport::Drift& of) {
    return fmt::format("{} {:.3g} (mean {:.3g})", what, of.largest, of.mean);
  };
  return report_line("drift of bonds", fmt::format("largest since the start: {}, {} of the sum of the radii",
                                                   drift("distance", bonds.distance), drift("slip", bonds.slip))) +
         report_line("", drift("roll", bonds.roll) + " rad");
}

void add_bonds(JsonObject& object, const GrainSetup& setup, const BondReport& bonds) {
  if (bonds.number == 0) return;
  JsonObject entry;
  entry.set("number", bonds.number);
  if (setup.step.bond_limit > 0) {
    entry.set("critical_time_step", setup.step.bond_limit);
  } else {
    entry.set("critical_time_step", nullptr);
  }
  for (const auto& [name, drift] : {std::pair{"distance_drift", &bonds.distance}, std::pair{"slip_drift", &bonds.slip},
                                    std::pair{"roll_drift", &bonds.roll}}) {
    JsonObject both;
    both.set("largest", drift->largest).set("mean", drift->mean);
    entry.set(name, both);
  }
  object.set("bonds", entry);
}

}  // namespace equidem
