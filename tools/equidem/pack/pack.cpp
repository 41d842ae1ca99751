// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/assembly/files.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/packing/measures.hpp"

#include "command.hpp"
#include "pack/pack_results.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

void check_outputs(const CommonOptions& common, const PackCase& resolved) {
  const OutputPlan plan(common);
  plan.expect_results();
  plan.expect(assembly_file_name("assembly", resolved.assembly));
  if (!resolved.packing.box.periodic()) plan.expect(assembly_file_name("assembly_with_walls", resolved.assembly));
  if (resolved.csv) {
    plan.expect("grains.csv");
    if (resolved.packing.shape.kind == PackingShape::Kind::bonded_pair) plan.expect("bonds.csv");
  }
  if (resolved.picture) plan.expect("picture.png");
}

void draw(const CommonOptions& common, const PackCase& resolved, const GrainPacking& packing) {
  if (!resolved.picture) return;
  const std::vector<Wall> walls = walls_of(packing.box);
  write_grain_picture(*common.out, "picture",
                      {.title = resolved.title,
                       .time = packing.settling.time,
                       .grains = packing.grains,
                       .clumps = packing.clumps,
                       .bonds = packing.bonds,
                       .walls = walls},
                      common.overwrite);
}

/// \param density kg/m³, of the bodies; not written where the case leaves it open
void write_tables(const CommonOptions& common, const PackCase& resolved, const GrainPacking& packing, double density) {
  if (!resolved.csv) return;
  const auto& folder = *common.out;
  const std::vector<std::string> groups(packing.grains.size(), "grains");
  const std::vector<double> densities(resolved.has_density() ? packing.grains.size() : 0, density);
  const auto period = packing.box.periodic() ? std::optional(packing.box.size) : std::nullopt;
  write_grain_csv(folder / "grains.csv", {packing.grains, packing.clumps, groups, densities, period}, common.overwrite);
  if (!packing.bonds.empty()) write_bond_csv(folder / "bonds.csv", packing.bonds, {}, common.overwrite);
}

void write_assemblies(const CommonOptions& common, const PackCase& resolved, const GrainPacking& packing,
                      const Assembly& network) {
  const auto place = [&](const char* stem) { return *common.out / assembly_file_name(stem, resolved.assembly); };
  write_assembly(place("assembly"), network, common.overwrite);
  if (!packing.box.periodic()) {
    const HeldNetwork held = held_network_of(packing, resolved.network);
    if (!held.bodies.empty()) write_assembly(place("assembly_with_walls"), held.assembly, common.overwrite);
  }
}

/// Adds the line of the key at fault to the errors of a task. \param usual the key of an error that names none
template <typename Task>
auto located(const PackCase& resolved, const char* usual, const Task& task) {
  return casefile::at_key(*resolved.document.find("packing"), "packing", task, usual);
}

/// In the region of the case; if no body has come into it that is noted in the packing, which stays.
PackingMeasures measured(const PackCase& resolved, GrainPacking& packing) {
  try {
    return measure(packing, resolved.region);
  } catch (const Error& error) {
    if (!resolved.region) throw;
    if (!packing.failure)
      packing.failure.emplace(ErrorKind::computation_failed, error.problem(), error.why(), error.remedy(), "region");
    return measure(packing);
  }
}

int run(const CommonOptions& common) {
  prepare(common);
  const auto shared_case = std::make_shared<const PackCase>(read_pack_case(common.case_file, overrides_of(common)));
  const PackCase& resolved = *shared_case;
  check_outputs(common, resolved);
  located(resolved, "method", [&] { check(resolved.packing); });
  if (resolved.region) located(resolved, "region", [&] { check_region(resolved.packing.box, *resolved.region); });
  if (common.dry_run) {
    const Results estimate = located(resolved, "method", [&] { return pack_estimate_results(resolved); });
    deliver(common, "dry_run",
            pack_case_results(resolved).set("grains", resolved.packing.radii.size()).append(estimate), {});
    return 0;
  }
  const auto lock = lock_out(common);
  StageTimes times;
  Stopwatch watch;
  const auto shared_packing =
      std::make_shared<GrainPacking>(located(resolved, "method", [&] { return try_to_pack(resolved.packing); }));
  GrainPacking& packing = *shared_packing;
  times.add("packing", watch.lap());
  Assembly network = network_of(packing, resolved.network);
  const double density = body_density(resolved, network);
  times.add("network", watch.lap());
  const PackingMeasures measures = measured(resolved, packing);
  times.add("measures", watch.lap());
  std::optional<Error> failure;
  if (packing.failure) failure = failure_of([&] { located(resolved, "method", [&] { throw *packing.failure; }); });
  std::vector<OutputPart> parts;
  if (common.out) {
    parts.push_back({"case.toml", [&] { write_case(common, resolved.document); }});
    parts.push_back({"the tables", [&] { write_tables(common, resolved, packing, density); }});
    parts.push_back({"the assembly", [&] { write_assemblies(common, resolved, packing, network); }});
    parts.push_back({"the picture", [&] { draw(common, resolved, packing); }});
  }
  deliver(common, "done", packing_results(resolved, packing, network, density, measures), std::move(times), parts,
          failure);
  hand_over(std::make_shared<const Assembly>(std::move(network)));
  hand_over([shared_case, shared_packing](const CommonOptions& into) {
    draw(into, *shared_case, *shared_packing);
    write_case(into, shared_case->document);
  });
  return 0;
}

}  // namespace

Run declare_pack(CLI::App& command) {
  auto common = std::make_shared<CommonOptions>();
  add_common_options(command, *common);
  command.footer(
      "With --out: grains.csv for 'equidem run', and assembly.json, the contacts with their springs for homogenize,\n"
      "stability, calibrate and solve; where walls hold the bodies also assembly_with_walls.json, whose group "
      "\"walls\"\n"
      "is to be held. A pair tied by dashpots counts there as one rigid body.\n"
      "Examples:\n"
      "  equidem pack data/cases/pack_jammed.toml --out jammed   a cell for homogenize, stability\n"
      "  equidem pack data/cases/pack_soil.toml --set packing.grains=300 --out soil      discs that fell\n"
      "  equidem pack data/cases/pack_ellipses.toml --out ellipses\n"
      "  equidem pack data/cases/pack_pairs.toml --set packing.shape.kind=bonded_pair --out pairs");
  return [common] { return run(*common); };
}

}  // namespace equidem
