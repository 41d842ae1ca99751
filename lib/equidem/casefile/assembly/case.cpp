// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case.hpp"

#include <algorithm>
#include <limits>

#include "equidem/casefile/assembly/case_tables.hpp"
#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/grains/grain_case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

using namespace casefile;

void check_radii(const TomlValue& table, const RadiusDistribution& radii) {
  if (table.find("radii") != nullptr && radii.smallest > radii.largest)
    fail_at(*table.find("radii"), "assembly.radii",
            fmt::format("smallest = {} is larger than largest = {}", radii.smallest, radii.largest), "",
            "Exchange them");
}

void check_support(const TomlValue& table, const Support& support) {
  if (support.ux || support.uy || support.rotation) return;
  fail_at(table, "support", fmt::format("the support of '{}' holds nothing", support.group),
          "ux, uy and rotation are all left out", "Add one, such as uy = true");
}

void check_load(const TomlValue& table, const Load& load) {
  check_plain_name(*table.find("case"), "load.case", "a load case", "it becomes part of the names of files");
  const TomlValue* moment = table.find("moment");
  if (table.find("force") == nullptr && moment == nullptr)
    fail_at(table, "load", fmt::format("the load on '{}' has neither force nor moment", load.group),
            "it would do nothing", "Add one, such as force = [1.0e3, 0.0]");
  if (moment != nullptr && load.kind == LoadKind::traction)
    fail_at(*moment, "load.moment", "a traction has no moment", "it is a force per area of a side",
            "Give the moment in a [[load]] of its own");
}

/// Loads with a name act in the case of that name, loads without in every case.
std::vector<NamedLoads> load_cases_of(const std::vector<LoadTable>& tables) {
  std::vector<NamedLoads> cases;
  for (const LoadTable& table : tables)
    if (!table.load_case.empty() && std::ranges::find(cases, table.load_case, &NamedLoads::name) == cases.end())
      cases.push_back({table.load_case, {}});
  if (cases.empty()) cases.push_back({});
  for (const LoadTable& table : tables)
    for (NamedLoads& loads : cases)
      if (table.load_case.empty() || table.load_case == loads.name) loads.loads.push_back(table.load);
  return cases;
}

/// Before keys are checked: of two tables that exclude each other neither misses a key.
void check_one_source_of_springs(const TomlValue& root) {
  const TomlValue* material = root.find("material");
  if (root.find("springs") == nullptr || material == nullptr) return;
  fail_at(*material, "material", "springs and [material] are both given", "[material] says which springs to take",
          "Remove one of them");
}

void check_contradictions(const TomlValue& root, const AssemblyCase& assembly) {
  const TomlValue* springs = root.find("springs");
  const TomlValue* material = root.find("material");
  const bool springs_in_file = assembly.kind == AssemblyKind::file;
  if (springs == nullptr && material == nullptr && !springs_in_file) {
    fail_at(root, "springs", "the springs are missing",
            "every contact has a normal spring kN and a tangential spring kT",
            "Add [springs] with kN and kT, or [material], or springs = \"FILE\"");
  }
  if (const TomlValue* ensemble = root.find("ensemble"); ensemble != nullptr && !assembly.random()) {
    fail_at(*ensemble, "ensemble", "an ensemble needs random assemblies",
            fmt::format("kind = \"{}\" makes the same one every time", root.find("assembly")->find("kind")->text),
            "Set kind = \"delaunay\" or \"packing\", or remove [ensemble]");
  }
  const TomlValue* test = root.find("test");
  for (const char* other : {"support", "load"}) {
    if (test == nullptr || repeated(root, other).empty()) continue;
    fail_at(repeated(root, other).front(), other, fmt::format("[test] and [[{}]] are both given", other),
            "the test brings its own supports and loads", "Remove one of them");
  }
  if (test != nullptr && (assembly.lattice.periodic || assembly.delaunay.periodic)) {
    fail_at(*root.find("assembly")->find("periodic"), "assembly.periodic", "a periodic assembly has no sides to pull",
            "[test] pulls at the left and right sides", "Set periodic = false, or remove [test]");
  }
  if (test != nullptr && assembly.packing && assembly.packing->box.periodic()) {
    fail_at(*root.find("packing")->find("sides"), "packing.sides", "a periodic assembly has no sides to pull",
            "[test] pulls at the left and right sides", "Set sides = \"walls\", or remove [test]");
  }
}

TimedSupport timed(const Support& support, const TomlValue& table, std::span<const NamedSchedule> schedules) {
  const auto motion = [&](const std::optional<double>& value) -> std::optional<Schedule> {
    if (!value) return {};
    return scheduled(table, "support", *value, schedules);
  };
  return {support.group, motion(support.ux), motion(support.uy), motion(support.rotation)};
}

void check_one_load_case(const std::vector<TomlValue>& tables, const std::string& first) {
  for (const TomlValue& table : tables) {
    const TomlValue& name = *table.find("case");
    if (!name.text.empty() && name.text != first)
      fail_at(name, "load.case", fmt::format("[run] has the load cases '{}' and '{}'", first, name.text),
              "a run is one motion, in which all loads act", "Keep one, or remove [run]");
  }
}

/// Nothing that acts in a run alone is passed over in silence.
void check_no_run_needed(const TomlValue& root) {
  for (const char* list : {"wall", "velocity", "probe"}) {
    if (repeated(root, list).empty()) continue;
    fail_at(repeated(root, list).front(), list, fmt::format("[[{}]] is given and [run] is not", list),
            "it belongs to motion in time", "Add [run] with a duration, or remove it");
  }
}

/// Complete [run] by the tables that act in a run, with their schedules.
void complete_run(const TomlValue& root, CaseTables& tables) {
  std::vector<TimedSupport> supports;
  for (std::size_t k = 0; k < tables.supports.size(); ++k)
    supports.push_back(timed(tables.supports[k], repeated(root, "support")[k], tables.schedules));
  std::vector<Schedule> factors;
  for (const TomlValue& table : repeated(root, "load"))
    factors.push_back(scheduled(table, "load", 1, tables.schedules));
  const TomlValue* table = root.find("run");
  if (table == nullptr) return check_no_run_needed(root);
  RunCase& run = *tables.run;
  run.supports = std::move(supports);
  check_one_load_case(repeated(root, "load"), tables.load_cases.front().name);
  for (std::size_t k = 0; k < factors.size(); ++k)
    run.loads.push_back({tables.load_cases.front().loads[k], factors[k]});
  run.walls = read_walls(root, tables.wall_tables, tables.schedules);
  check_probes(root);
  check_step(*table, run.time_step.step, run.duration);
  run.time_step.duration = run.duration.value_or(0);
  if (run.damping.stiffness > 0 && run.damping.contact > 0)
    fail_at(*table->find("damping")->find("contact"), "run.damping.contact", "stiffness and contact are both given",
            "each says which dashpots stand at the contacts", "Set one of them to 0");
}

/// The packing of an assembly that is one: its contacts have the springs of the case.
void complete_packing(const TomlValue& root, CaseTables& tables) {
  AssemblyCase& assembly = tables.assembly;
  assembly.gap_tolerance = tables.packing_tables.gap_tolerance;
  assembly.region = tables.packing_tables.region;
  PackingAmount& amount = tables.packing_tables.amount;
  if (tables.ensemble && !amount.grains && !amount.box) amount.grains = tables.ensemble->plan.discs.front();
  ScalablePacking packing = packing_options(root, tables.packing_tables);
  if (assembly.density) packing.settling.density = *assembly.density;
  if (tables.springs) packing.settling.springs = *tables.springs;
  if (entry_of(packing.method).open_top && !tables.springs)
    fail_at(*root.find("packing")->find("method"), "packing.method", "bodies fall, and the case gives no springs",
            "they collide by kN and kT; [material] gives springs only for an assembly that is there",
            "Give [springs], or pack by growth");
  assembly.packing = std::move(packing);
}

/// A triangulation in a box: the number of discs follows from their size.
void complete_delaunay(const TomlValue& root, DelaunayOptions& options) {
  if (!options.box) return;
  options.discs =
      with_key(*root.find("assembly"), "assembly", "box", [&] { return discs_that_fill(*options.box, options.radii); });
  options.aspect = options.box->x / options.box->y;
}

/// Samples take the seeds first, first + 1, ..., each of which a case can have.
void check_seeds(const TomlValue& root, const std::string& key, std::uint64_t first, std::int64_t samples) {
  constexpr auto most = std::numeric_limits<std::int64_t>::max();
  if (first <= static_cast<std::uint64_t>(most - samples + 1)) return;
  fail_at(value_at(root, key), key, fmt::format("{} take the seeds from {} on", counted(samples, "sample"), first),
          fmt::format("the largest seed is {}", most), fmt::format("Give at most {}", most - samples + 1));
}

void check_seeds(const TomlValue& root, const CaseTables& tables) {
  const std::string of_assembly = tables.assembly.packing ? "packing.seed" : "assembly.seed";
  if (tables.ensemble) check_seeds(root, of_assembly, tables.assembly.seed(), tables.ensemble->plan.samples);
  if (!tables.strength_target) return;
  const std::int64_t samples = tables.strength_target->samples;
  if (tables.assembly.random()) check_seeds(root, of_assembly, tables.assembly.seed(), samples);
  if (tables.strength) check_seeds(root, "strength.seed", tables.strength->seed, samples);
}

}  // namespace

Case parse_case(std::string_view content, const std::string& name, const fs::path& folder,
                std::span<const std::string> overrides) {
  TomlValue root = parse_document(content, name, overrides);
  if (describes_grains(root))
    bad_input_at(root.where(), "the case describes grains that collide, and this verb needs an [assembly]",
                 "its contacts are there from the start and stay", "Use 'equidem run', or give an [assembly]");
  if (root.find("packing") != nullptr && root.find("assembly") == nullptr)
    bad_input_at(root.where(), "the case fills a box, and this verb needs an [assembly]", "",
                 "Use 'equidem pack', or add [assembly] with kind = \"packing\"");
  check_one_source_of_springs(root);
  resolve_springs_file(root, folder);
  resolve_strength_file(root, folder);
  CaseTables tables = case_file().read(root, folder);

  const std::optional<SpringsTable>& springs = tables.springs_table;
  if (springs) {
    tables.springs = springs->constants;
    tables.weighting = springs->weighting;
    tables.bending = springs->bending;
  }
  if (tables.viscoelastic) complete_viscoelastic(root, *tables.viscoelastic);
  tables.assembly.density = one_density(root, {{"assembly", tables.assembly.density},
                                               {"springs", springs ? springs->density : std::nullopt},
                                               {"packing", tables.packing_tables.density}});
  check_radii(*root.find("assembly"), tables.assembly.delaunay.radii);
  if (tables.assembly.kind == AssemblyKind::packing) complete_packing(root, tables);
  if (tables.assembly.kind == AssemblyKind::delaunay) complete_delaunay(root, tables.assembly.delaunay);
  check_contradictions(root, tables.assembly);
  check_strength_target(root);
  check_seeds(root, tables);
  if (tables.material)
    tables.material->moduli =
        at_key(*root.find("material"), "material", [&] { return moduli_of(tables.material->given); });
  check_names(root, "group");
  for (std::size_t k = 0; k < tables.groups.size(); ++k)
    if (const auto& box = tables.groups[k].box)
      check_box(*repeated(root, "group")[k].find("box"), "group.box", box->low, box->high);
  for (std::size_t k = 0; k < tables.supports.size(); ++k)
    check_support(repeated(root, "support")[k], tables.supports[k]);
  for (std::size_t k = 0; k < tables.load_tables.size(); ++k)
    check_load(repeated(root, "load")[k], tables.load_tables[k].load);
  tables.load_cases = load_cases_of(tables.load_tables);
  tables.schedules = read_schedules(root, tables.schedule_tables);
  complete_run(root, tables);
  tables.document = std::move(root);
  return tables;
}

std::string to_toml(const Case& resolved, const fs::path& folder) {
  return to_toml(resolved.document, folder);
}

Case read_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
