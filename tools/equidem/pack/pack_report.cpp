// SPDX-License-Identifier: GPL-3.0-or-later
#include "pack/pack_report.hpp"

#include <algorithm>

#include "equidem/core/text.hpp"

#include "solve/report.hpp"

namespace equidem {
namespace {

const PackingMethodEntry& entry_of(PackingMethod method) {
  const auto table = packing_methods();
  return *std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.method == method; });
}

const char* name_of(PackingBox::Sides sides) {
  switch (sides) {
    case PackingBox::Sides::walls:
      return "walls";
    case PackingBox::Sides::open_top:
      return "walls and an open top";
    case PackingBox::Sides::periodic:
      return "periodic";
  }
  return "";
}

}  // namespace

std::string describe_pack_case(const PackCase& resolved) {
  const PackingOptions& options = resolved.packing;
  std::string out;
  if (!resolved.title.empty()) out += resolved.title + "\n\n";
  const auto [low, high] = std::minmax_element(options.radii.begin(), options.radii.end());
  out += report_line(noun_of(options.shape.kind) + "s",
                     fmt::format("{}, radius {:.6g} to {:.6g} m",
                                 grouped(static_cast<std::int64_t>(options.radii.size())), *low, *high));
  const bool open = options.box.sides == PackingBox::Sides::open_top;
  out += report_line("box", open ? fmt::format("{:.6g} m wide, {}", options.box.size.x, name_of(options.box.sides))
                                 : fmt::format("{:.6g} m by {:.6g} m, {}", options.box.size.x, options.box.size.y,
                                               name_of(options.box.sides)));
  out += report_line("method", to_string(options.method));
  const SpringConstants springs = options.settling.springs;
  return out + report_line("springs", fmt::format("kN = {:.6g} Pa, kT = {:.6g} Pa", springs.kN, springs.kT));
}

std::string describe_packing(const PackCase& resolved, const GrainPacking& packing, const PackingMeasures& measures,
                             const std::optional<ConfirmedRest>& rest, const StageTimes& times) {
  const PackingOptions& options = resolved.packing;
  const std::string noun = noun_of(options.shape.kind);
  std::string out;
  if (!packing.complete) {
    out += report_line("packed",
                       packing.size() < options.radii.size()
                           ? fmt::format("{} of {}", packing.size(), options.radii.size())
                           : fmt::format("radii {:.6g} of those asked for", packing.radii[0] / options.radii[0]));
  }
  const Region& region = measures.region;
  out += report_line("solid fraction", fmt::format("{:.6g}, porosity {:.6g}, void ratio {:.6g}",
                                                   measures.solid_fraction, measures.porosity, measures.void_ratio));
  out += report_line("", fmt::format("measured from ({:.4g}, {:.4g}) to ({:.4g}, {:.4g}) m", region.low.x, region.low.y,
                                     region.high.x, region.high.y));
  out += report_line(
      "contacts", fmt::format("{} of {}s, {} with walls; {:.4g} of each, {:.4g} without {}", grouped(measures.contacts),
                              noun, grouped(measures.wall_contacts), measures.coordination,
                              measures.coordination_without_rattlers, counted(measures.rattlers, "rattler")));
  out += report_line("overlap", fmt::format("at most {:.3g} of the smaller radius", measures.largest_overlap));
  if (rest) {
    const SettlingReport& settling = packing.settling;
    out += report_line(
        "rest",
        fmt::format(
            "after {:.4g} s in {} steps of {:.4g} s by corrected_verlet; unbalanced force {:.2g} of the mean contact "
            "force, of one {} {:.2g}",
            settling.time, grouped(settling.steps), settling.time_step, settling.unbalanced, noun,
            settling.largest_unbalanced));
    out += report_line(
        "", rest->confirmation
                ? fmt::format("statics on the same contacts would move nothing further than {:.2g} of the mean overlap",
                              rest->confirmation->share())
                : fmt::format("statics does not confirm it: {}", rest->why_not));
    const BondReport& bonds = settling.bonds;
    if (bonds.number > 0) {
      out += report_line(
          "bonds", fmt::format("the dashpots let pairs drift by {:.2g} of their length in the mean, {:.2g} at most; "
                               "surfaces slipped by {:.2g} at most",
                               bonds.distance.mean, bonds.distance.largest, bonds.slip.largest));
    }
  }
  out += report_line("work", fmt::format("{} {}", grouped(packing.work), entry_of(options.method).unit_of_work));
  std::string stages;
  for (const auto& [stage, seconds] : times.stages())
    if (seconds >= 0.02 * times.total()) stages += fmt::format(", {} {:.2g} s", stage, seconds);
  return out + report_line("times", fmt::format("{:.2g} s in all{}", times.total(), stages));
}

void add_packing(JsonObject& object, const PackCase& resolved, const GrainPacking& packing,
                 const PackingMeasures& measures, const std::optional<ConfirmedRest>& rest) {
  const Region& region = measures.region;
  object.set("title", resolved.title)
      .set("method", to_string(resolved.packing.method))
      .set("shape", to_string(packing.shape))
      .set("grains", packing.size())
      .set("complete", packing.complete)
      .set("box", std::vector<double>{packing.box.size.x, packing.box.size.y})
      .set("region", std::vector<double>{region.low.x, region.low.y, region.high.x, region.high.y})
      .set("solid_fraction", measures.solid_fraction)
      .set("void_ratio", measures.void_ratio)
      .set("porosity", measures.porosity)
      .set("contacts", measures.contacts)
      .set("wall_contacts", measures.wall_contacts)
      .set("coordination_number", measures.coordination)
      .set("coordination_number_without_rattlers", measures.coordination_without_rattlers)
      .set("rattlers", measures.rattlers)
      .set("largest_overlap", measures.largest_overlap)
      .set("work", packing.work);
  if (!rest) return;
  object.set("unbalanced_force_ratio", packing.settling.unbalanced)
      .set("largest_unbalanced_force_ratio", packing.settling.largest_unbalanced)
      .set("time_step", packing.settling.time_step)
      .set("time", packing.settling.time)
      .set("steps", packing.settling.steps)
      .set("energy_error", packing.settling.ledger.error() / packing.settling.ledger.lost());
  if (const BondReport& bonds = packing.settling.bonds; bonds.number > 0) {
    object.set("bond_drift", bonds.distance.mean)
        .set("largest_bond_drift", bonds.distance.largest)
        .set("largest_bond_slip", bonds.slip.largest);
  }
  if (rest->confirmation) {
    object.set("static_motion_over_overlap", rest->confirmation->share());
  } else {
    object.set_null("static_motion_over_overlap");
  }
}

}  // namespace equidem
