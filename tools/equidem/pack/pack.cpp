// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// equidem pack: an assembly of bodies in a box.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "equidem/assembly/files.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/packing/pack_case.hpp"
#include "equidem/contact/prestress/forces_at_rest.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/memory.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/pictures/grain_picture.hpp"
#include "equidem/packing/measures.hpp"

#include "command.hpp"
#include "problem.hpp"
#include "verbs.hpp"

namespace equidem {
namespace {

const char* name_of(PackingBox::Sides sides) {
  using enum PackingBox::Sides;
  return sides == walls ? "walls" : sides == open_top ? "walls and an open top" : "periodic";
}

void add_rest(Results& out, const GrainPacking& packing, const std::string& noun) {
  const SettlingReport& settling = packing.settling;
  out.line("rest")
      .add("time", "after", settling.time, "s in", {.digits = 4})
      .note(" ")
      .add("steps", "", settling.steps, "step", {Shown::count})
      .note(" of ")
      .add("time_step", "", settling.time_step, "s by velocity_verlet", {.digits = 4});
  out.line("", "unbalanced force ")
      .add("unbalanced_force_ratio", "", settling.unbalanced, "of the mean contact force", {.digits = 2})
      .add("largest_unbalanced_force_ratio", "of one " + noun, settling.largest_unbalanced, "", {.digits = 2});
  out.set("energy_error", settling.ledger.error() / settling.ledger.lost());
}

/// Contacts of bodies that touch, and bodies that fewer hold than they need.
void add_contacts(Results& out, const PackingMeasures& measures, const Assembly& network, const std::string& noun) {
  if (measures.contacts == 0) {
    const char* const bonded = network.contacts.empty() ? ", and none are bonded" : "; bonds join them across gaps";
    out.line("contacts", fmt::format("no two {}s touch{}", noun, bonded));
    if (measures.wall_contacts > 0) out.add("", "", measures.wall_contacts, "touch a wall", {Shown::number});
    out.set("contacts", 0)
        .set("wall_contacts", measures.wall_contacts)
        .set("coordination_number", measures.coordination);
    out.set("coordination_number_without_rattlers", 0.0).set("rattlers", measures.rattlers);
    return;
  }
  out.line("contacts")
      .add("contacts", "", measures.contacts, "of " + noun + "s", {Shown::number})
      .add("wall_contacts", "", measures.wall_contacts, "with walls")
      .note("; ")
      .add("coordination_number", "", measures.coordination, "of each", {.digits = 4})
      .add("coordination_number_without_rattlers", "", measures.coordination_without_rattlers, "without", {.digits = 4})
      .note(" ")
      .add("rattlers", "", measures.rattlers, "rattler", {Shown::count});
}

/// The contacts of the assembly that is written, and those of other tolerances.
void add_bonds(Results& out, const GrainPacking& packing, const Assembly& network) {
  out.line("bonds")
      .add("bonds", "", network.contacts.size(), "", {Shown::count})
      .note(fmt::format(" in the assembly, z = {:.3g}; ", network.coordination_number()))
      .add("gap_tolerance", "gap_tolerance =", *network.gap_tolerance);
  std::vector<std::string> others;
  for (const BondCount& count : bond_counts(packing))
    if (count.gap_tolerance > 0)
      others.push_back(fmt::format("{}: {} (z = {:.3g})", count.gap_tolerance, count.contacts, count.coordination));
  out.line("", "with other values of it: " + joined(others));
}

/// The forces that go with the contacts of the assembly, and what walls and weight balance besides.
void add_forces_at_rest(Results& out, const Assembly& network) {
  const RestBalance balance = balance_at_rest(network);
  out.set("forces_at_rest/contacts", balance.loaded);
  if (balance.loaded == 0) return;
  out.line("forces at rest")
      .add("", "of", balance.loaded, "contact", {Shown::count})
      .add("forces_at_rest/mean", "", balance.mean_force, "N/m in the mean", {.digits = 3})
      .note("; ")
      .add("forces_at_rest/imbalance", "on one body they lack up to", balance.relative,
           "of it, without walls and weight", {.digits = 2});
}

/// \param density kg/m³, of the bodies
void add_density(Results& out, const PackCase& resolved, double density, const std::string& noun) {
  out.line("density");
  if (resolved.of_continuum) out.add("density/continuum", "", *resolved.of_continuum, "kg/m³ of the continuum");
  out.add("density/discs", "", density, "kg/m³ of the " + noun + "s");
  if (!resolved.of_continuum && !resolved.density)
    out.note(resolved.has_density() ? ", the default, since the case gives none: the bodies fell with it"
                                    : ", the default, since the case gives none; grains.csv has no density");
}

/// Bodies, box, method and springs of the case; the report alone.
Results pack_case_results(const PackCase& resolved) {
  const PackingOptions& options = resolved.packing;
  const auto [low, high] = std::ranges::minmax(options.radii);
  const bool open = options.box.sides == PackingBox::Sides::open_top;
  Results out;
  if (!resolved.title.empty()) out.block(resolved.title + "\n\n");
  out.line(noun_of(options.shape.kind) + "s")
      .add("", "", options.radii.size(), "", {Shown::count})
      .add("", "radius", low, "to")
      .note(fmt::format(" {:.6g} m", high));
  out.line("box", open ? fmt::format("{:.6g} m wide, {}", options.box.size.x, name_of(options.box.sides))
                       : fmt::format("{:.6g} m by {:.6g} m, {}", options.box.size.x, options.box.size.y,
                                     name_of(options.box.sides)));
  out.line("method", to_string(options.method));
  add_effects(out, {});
  if (!resolved.network.springs) return out;
  const SpringConstants& springs = *resolved.network.springs;
  return out.line("springs").add("", "kN =", springs.kN, "Pa").add("", "kT =", springs.kT, "Pa");
}

/// Every k-th of the bodies in a box that is smaller by as much.
PackingOptions sample_of(const PackingOptions& options) {
  constexpr std::size_t few = 500;
  PackingOptions sample = options;
  const std::size_t stride = std::max<std::size_t>(1, options.radii.size() / few);
  sample.radii.clear();
  for (std::size_t k = 0; k < options.radii.size(); k += stride) sample.radii.push_back(options.radii[k]);
  const double share = static_cast<double>(sample.radii.size()) / static_cast<double>(options.radii.size());
  sample.box.size = std::sqrt(share) * options.box.size;
  return sample;
}

struct SampledTime {
  double seconds = 0;
  double looser = 0;  ///< the share by which the solid fraction of the sample had to be reduced
};

/// Time from a packing of a few of the bodies. Few of them jam earlier than many: then their box is widened, and the
/// mean time of all trials is taken, since just below jamming times of equal packings differ by a factor of four.
/// \throws Error (interrupted); (computation_failed) where no sample can be packed
SampledTime sampled_time(const PackingOptions& options) {
  constexpr double growth_of_time = 1.2;  // power of the number of bodies; measured from 400 to 25,600 that grow
  constexpr double widening = 0.01, widest = 0.1;  // of the solid fraction
  PackingOptions sample = sample_of(options);
  const Vec2 size = sample.box.size;
  const double larger = static_cast<double>(options.radii.size()) / static_cast<double>(sample.radii.size());
  const Stopwatch watch;
  for (int trials = 1;; ++trials) {
    const double looser = (trials - 1) * widening;
    sample.box.size = size / std::sqrt(1 - looser);
    try {
      static_cast<void>(pack(sample));
      return {watch.seconds() / trials * std::pow(larger, growth_of_time), looser};
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::computation_failed || looser + widening > widest) throw;
    }
  }
}

/// Steps and time that are expected of bodies that fall; empty for other methods, which have no steps.
Results pack_estimate_results(const PackCase& resolved) {
  Results out;
  if (resolved.packing.method != PackingMethod::falling) {
    try {
      const SampledTime time = sampled_time(resolved.packing);
      out.line("time").add("estimated_seconds", "about", time.seconds, "s, from a packing of some of these bodies",
                           {.digits = 2});
      if (time.looser > 0) out.note(fmt::format(" at a solid fraction smaller by {}", percent(time.looser)));
    } catch (const Error& error) {
      if (!error.failed()) throw;
      out.set("refusal", error.what())
          .line("time", fmt::format("not predicted: a packing of some of these bodies fails: {}", error.what()));
    }
    return out;
  }
  const PackingOptions& options = resolved.packing;
  GrainPacking packing;
  const std::size_t bodies = options.radii.size();
  make_grains(options.shape, {std::vector<Vec2>(bodies), options.radii, std::vector<double>(bodies)},
              options.settling.density, packing);
  GrainScene scene;
  scene.grains = std::move(packing.grains);
  scene.clumps = std::move(packing.clumps);
  const double step = settling_step(scene, options.settling);
  return out.line("steps")
      .add("most_steps", "at most", static_cast<std::int64_t>(std::ceil(options.settling.longest / step)), "",
           {Shown::count})
      .note(" of ")
      .add("time_step", "", step, "s", {.digits = 4});
}

/// \param network of the packing, as it is written
/// \param density kg/m³, of the bodies
Results packing_results(const PackCase& resolved, const GrainPacking& packing, const Assembly& network, double density,
                        const PackingMeasures& measures) {
  const PackingOptions& options = resolved.packing;
  const std::string noun = noun_of(options.shape.kind);
  Results out = pack_case_results(resolved);
  out.set("title", resolved.title).set("method", to_string(options.method)).set("shape", to_string(packing.shape));
  out.set("grains", packing.size()).set("complete", !packing.failure).set("box", packing.box.size);
  if (packing.size() < options.radii.size()) {
    out.line("packed", fmt::format("{} of {}", packing.size(), options.radii.size()));
  } else if (grows_to_any_size(options) || (options.method == PackingMethod::growth && packing.failure)) {
    const auto [smallest, largest] = std::ranges::minmax(packing.radii);
    out.line("packed", fmt::format("all radii scaled by {:.6g}: {:.6g} to {:.6g} m",
                                   packing.radii[0] / options.radii[0], smallest, largest));
  }
  const Rectangle& region = measures.region;
  out.line("solid fraction")
      .add("solid_fraction", "", measures.solid_fraction)
      .add("porosity", "porosity", measures.porosity)
      .add("void_ratio", "void ratio", measures.void_ratio);
  out.line("", fmt::format("measured from ({:.4g}, {:.4g}) to ({:.4g}, {:.4g}) m", region.low.x, region.low.y,
                           region.high.x, region.high.y));
  out.set("region", std::vector<double>{region.low.x, region.low.y, region.high.x, region.high.y});
  add_contacts(out, measures, network, noun);
  if (std::ranges::all_of(packing.grains, [](const Grain& grain) { return grain.shape() == GrainShape::disc; }))
    add_largest_void(out, network);
  add_bonds(out, packing, network);
  add_forces_at_rest(out, network);
  add_density(out, resolved, density, noun);
  out.line("overlap").add("largest_overlap", "at most", measures.largest_overlap, "of the smaller radius",
                          {.digits = 3});
  if (!packing.contacts.empty()) add_rest(out, packing, noun);
  return out.line("work").add("work", "", packing.work, entry_of(options.method).unit_of_work);
}

struct Packed {
  PackCase resolved;
  GrainPacking packing = {};
  Assembly network = {};
  double density = 0;  ///< kg/m³, of the bodies
};

void draw(const CommonOptions& into, const Packed& packed) {
  const auto& [resolved, packing, network, density] = packed;
  if (!resolved.picture) return;
  const std::vector<Wall> walls = walls_of(packing.box);
  write_grain_picture(*into.out, "picture",
                      {.title = resolved.title,
                       .time = packing.settling.time,
                       .grains = packing.grains,
                       .clumps = packing.clumps,
                       .bonds = packing.bonds,
                       .walls = walls},
                      into.overwrite);
}

/// The density is not written where the case leaves it open.
void write_tables(const CommonOptions& into, const Packed& packed) {
  const auto& [resolved, packing, network, density] = packed;
  if (!resolved.csv) return;
  const auto& folder = *into.out;
  const std::vector<std::string> groups(packing.grains.size(), "grains");
  const std::vector<double> densities(resolved.has_density() ? packing.grains.size() : 0, density);
  const auto period = packing.box.periodic() ? std::optional(packing.box.size) : std::nullopt;
  write_grain_csv(folder / "grains.csv", {packing.grains, packing.clumps, groups, densities, period}, into.overwrite);
  if (!packing.bonds.empty()) write_bond_csv(folder / "bonds.csv", packing.bonds, {}, into.overwrite);
}

void write_assemblies(const CommonOptions& into, const Packed& packed) {
  const auto& [resolved, packing, network, density] = packed;
  const auto place = [&](const char* stem) { return *into.out / assembly_file_name(stem, resolved.assembly); };
  write_assembly(place("assembly"), network, into.overwrite);
  if (!packing.box.periodic()) {
    const HeldNetwork held = held_network_of(packing, resolved.network);
    if (!held.bodies.empty()) write_assembly(place("assembly_with_walls"), held.assembly, into.overwrite);
  }
}

std::vector<OutputPart> output_parts(const std::shared_ptr<const Packed>& packed) {
  const PackCase& resolved = packed->resolved;
  std::vector<std::string> tables, assemblies{assembly_file_name("assembly", resolved.assembly)}, pictures;
  if (!resolved.packing.box.periodic())
    assemblies.push_back(assembly_file_name("assembly_with_walls", resolved.assembly));
  if (resolved.csv) tables.emplace_back("grains.csv");
  if (resolved.csv && resolved.packing.shape.kind == PackingShape::Kind::bonded_pair) tables.emplace_back("bonds.csv");
  if (resolved.picture) pictures = {"picture.svg", "picture.png"};
  const auto part = [&](const char* name, auto write, OutputPart::Place place, const std::vector<std::string>& files) {
    return OutputPart{name, [=](const CommonOptions& into) { write(into, *packed); }, place, files};
  };
  return {case_part([=]() -> const TomlValue& { return packed->resolved.document; }),
          part("the tables", write_tables, OutputPart::folder, tables),
          part("the assembly", write_assemblies, OutputPart::folder, assemblies),
          part("the picture", draw, OutputPart::page, pictures)};
}

/// Adds the line of the key at fault to the errors of a task. \param usual the key of an error that names none
template <typename Task>
auto located(const PackCase& resolved, const char* usual, const Task& task) {
  return casefile::at_key(*resolved.document.find("packing"), task, usual);
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

void run(const CommonOptions& common) {
  prepare(common);
  const auto packed = std::make_shared<Packed>(Packed{read_pack_case(common.case_file, overrides_of(common))});
  const PackCase& resolved = packed->resolved;
  const std::vector<OutputPart> parts = output_parts(packed);
  expect_results(common, parts);
  located(resolved, "method", [&] { check(resolved.packing); });
  if (resolved.region) located(resolved, "region", [&] { check_region(resolved.packing.box, *resolved.region); });
  const double bodies = static_cast<double>(resolved.packing.radii.size()), resident = resident_memory();
  const double needed = entry_of(resolved.packing.method).bytes_of_body * bodies;
  if (common.dry_run) {
    const Results estimate = located(resolved, "method", [&] { return pack_estimate_results(resolved); });
    Results out = pack_case_results(resolved).set("grains", resolved.packing.radii.size());
    out.line("memory").add("peak_bytes", "about", resident + needed, "at the peak", {Shown::bytes});
    return deliver(common, "dry_run", out.append(estimate), {});
  }
  require_memory(needed, "packing needs about", "Pack fewer bodies, or take a machine with more memory");
  const auto lock = lock_out(common);
  StageTimes times;
  Stopwatch watch;
  GrainPacking& packing = packed->packing = located(resolved, "method", [&] { return try_to_pack(resolved.packing); });
  times.add("packing", watch.lap());
  const StopsHeldBack held_back(packing.failure);
  const Assembly& network = packed->network = network_of(packing, resolved.network);
  const double density = packed->density = body_density(resolved, network);
  times.add("network", watch.lap());
  const PackingMeasures measures = measured(resolved, packing);
  times.add("measures", watch.lap());
  std::optional<Error> failure;
  if (packing.failure) failure = failure_of([&] { located(resolved, "method", [&] { throw *packing.failure; }); });
  deliver(common, "done", packing_results(resolved, packing, network, density, measures), std::move(times), parts,
          failure);
  if (arrays_wanted()) hand_over(std::make_shared<const Assembly>(with_cells(network)));
}

}  // namespace

Run declare_pack(CLI::App& command) {
  auto common = std::make_shared<CommonOptions>();
  add_common_options(command, *common);
  return [common] { return run(*common); };
}

}  // namespace equidem
