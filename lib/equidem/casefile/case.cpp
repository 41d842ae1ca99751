// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/case.hpp"

#include <algorithm>

#include "equidem/casefile/grain_keys.hpp"
#include "equidem/casefile/keys.hpp"
#include "equidem/casefile/read_value.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

AssemblyCase read_assembly_table(TomlValue& table, const fs::path& folder) {
  AssemblyCase result;
  if (const TomlValue* density = table.find("density")) result.density = density->real;
  result.body = enum_from<Body>(text(table, "body"));
  const std::string& kind = text(table, "kind");
  if (kind == "file") {
    result.kind = AssemblyKind::file;
    TomlValue& path = *table.find("path");
    result.path = opened(path.text, folder);
    path.text = result.path.string();
    result.own_springs = flag(table, "own_springs");
    return result;
  }
  result.arrangement = find_lattice(kind);
  if (result.arrangement != nullptr) {
    result.kind = AssemblyKind::lattice;
    result.lattice = {.columns = whole(table, "columns"),
                      .rows = whole(table, "rows"),
                      .radius = number(table, "radius"),
                      .periodic = flag(table, "periodic")};
    return result;
  }
  result.kind = AssemblyKind::delaunay;
  DelaunayOptions& options = result.delaunay;
  options.discs = table.find("discs")->integer;
  options.points = enum_from<PointProcess>(text(table, "points"));
  if (const TomlValue* disorder = table.find("disorder")) options.disorder = disorder->real;
  options.seed = static_cast<std::uint64_t>(table.find("seed")->integer);
  options.aspect = number(table, "aspect");
  options.periodic = flag(table, "periodic");
  const TomlValue* radius = table.find("radius");
  const TomlValue* radii = table.find("radii");
  if ((radius == nullptr) == (radii == nullptr)) {
    fail_at(radius != nullptr ? *radii : table, "assembly.radius",
            radius != nullptr ? "radius and radii are both given" : "the size of the discs is missing",
            "discs are of one radius, or of radii between two", "Give either radius = ... or [assembly.radii]");
  }
  if (radius != nullptr) {
    options.radii = {radius->real, radius->real};
  } else {
    options.radii = {number(*radii, "smallest"), number(*radii, "largest")};
    if (options.radii.smallest > options.radii.largest) {
      fail_at(*radii, "assembly.radii",
              fmt::format("smallest = {} is larger than largest = {}", options.radii.smallest, options.radii.largest),
              "", "Exchange them");
    }
  }
  return result;
}

GroupCase read_group(const TomlValue& table) {
  GroupCase result{.name = text(table, "name"), .discs = {}, .box_low = {}, .box_high = {}};
  const TomlValue* discs = table.find("discs");
  const TomlValue* box = table.find("box");
  if ((discs == nullptr) == (box == nullptr)) {
    fail_at(box != nullptr ? *box : table, fmt::format("group '{}'", result.name),
            box != nullptr ? "discs and box are both given" : "it has neither discs nor box",
            "a group is a list of discs, or the discs in a box", "Give one of the two");
  }
  if (discs != nullptr) {
    for (const TomlValue& item : discs->items) result.discs.push_back(static_cast<std::int32_t>(item.integer));
    return result;
  }
  result.box_low = Vec2{box->items[0].real, box->items[1].real};
  result.box_high = Vec2{box->items[2].real, box->items[3].real};
  if (result.box_low->x >= result.box_high->x || result.box_low->y >= result.box_high->y) {
    fail_at(*box, "group.box", fmt::format("the box {} is empty", box->shown()), "it is [x_min, y_min, x_max, y_max]",
            "Put the smaller numbers first");
  }
  return result;
}

std::optional<double> held(const TomlValue* value) {
  if (value == nullptr) return {};
  return value->type == TomlValue::Type::boolean ? 0.0 : value->real;
}

Support read_support(const TomlValue& table) {
  Support result{.group = text(table, "group"),
                 .ux = held(table.find("ux")),
                 .uy = held(table.find("uy")),
                 .rotation = held(table.find("rotation"))};
  if (!result.ux && !result.uy && !result.rotation) {
    fail_at(table, "support", fmt::format("the support of '{}' holds nothing", result.group),
            "ux, uy and rotation are all left out", "Add one, such as uy = true");
  }
  return result;
}

Load read_load(const TomlValue& table) {
  const std::string& kind = text(table, "kind");
  Load result{.group = text(table, "group"),
              .kind = kind == "total"      ? LoadKind::total
                      : kind == "traction" ? LoadKind::traction
                                           : LoadKind::per_disc,
              .force = {},
              .moment = 0};
  const TomlValue* force = table.find("force");
  const TomlValue* moment = table.find("moment");
  if (force == nullptr && moment == nullptr)
    fail_at(table, "load", fmt::format("the load on '{}' has neither force nor moment", result.group),
            "it would do nothing", "Add one, such as force = [1.0e3, 0.0]");
  if (moment != nullptr && result.kind == LoadKind::traction)
    fail_at(*moment, "load.moment", "a traction has no moment", "it is a force per area of a side",
            "Give the moment in a [[load]] of its own");
  if (force != nullptr) result.force = {force->items[0].real, force->items[1].real};
  if (moment != nullptr) result.moment = moment->real;
  return result;
}

/// Loads with a name act in the case of that name, loads without in every case.
std::vector<NamedLoads> read_load_cases(const std::vector<TomlValue>& tables) {
  std::vector<NamedLoads> cases;
  for (const TomlValue& table : tables) {
    const std::string& name = text(table, "case");
    check_plain_name(*table.find("case"), "load.case", "a load case", "it becomes part of the names of files");
    const bool known =
        std::any_of(cases.begin(), cases.end(), [&](const NamedLoads& loads) { return loads.name == name; });
    if (!name.empty() && !known) cases.push_back({name, {}});
  }
  if (cases.empty()) cases.push_back({});
  for (const TomlValue& table : tables) {
    const Load load = read_load(table);
    const std::string& name = text(table, "case");
    for (NamedLoads& loads : cases)
      if (name.empty() || name == loads.name) loads.loads.push_back(load);
  }
  return cases;
}

/// A file of springs takes the place of the table [springs].
void resolve_springs_file(TomlValue& root, const fs::path& folder) {
  TomlValue* named = root.find("springs");
  if (named == nullptr || named->type != TomlValue::Type::text) return;
  const fs::path path = opened(named->text, folder);
  TomlValue document;
  try {
    document = parse_toml(read_file(path), path.string());
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: springs", named->where()));
  }
  check_and_complete(document, springs_file_spec());
  *named = *document.find("springs");
}

HomogenizeCase read_homogenize(const TomlValue& table) {
  HomogenizeCase result;
  if (const std::string& boundary = text(table, "boundary"); boundary != "auto")
    result.boundary = enum_from<Boundary>(boundary);
  const std::string& bounds = text(table, "bounds");
  if (bounds != "auto") result.bounds = bounds == "affine" ? BoundsWanted::affine : BoundsWanted::all;
  return result;
}

EnsembleCase read_ensemble(const TomlValue& table) {
  EnsembleCase result{
      .discs = {}, .samples = whole(table, "samples"), .accuracy = {}, .confidence = number(table, "confidence")};
  for (const TomlValue& item : table.find("discs")->items) result.discs.push_back(item.integer);
  if (const TomlValue* accuracy = table.find("accuracy")) result.accuracy = accuracy->real;
  return result;
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
  if (const TomlValue* ensemble = root.find("ensemble");
      ensemble != nullptr && assembly.kind != AssemblyKind::delaunay) {
    fail_at(*ensemble, "ensemble", "an ensemble needs random assemblies",
            fmt::format("kind = \"{}\" makes the same one every time", text(*root.find("assembly"), "kind")),
            "Set kind = \"delaunay\", or remove [ensemble]");
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
}

}  // namespace

std::string Case::where(std::string_view key) const {
  return fmt::format("{}: {}", value_at(document, key).where(), key);
}

Case parse_case(std::string_view content, const std::string& name, const fs::path& folder,
                std::span<const std::string> overrides) {
  TomlValue root = parse_toml(content, name);
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  if (describes_grains(root)) {
    throw Error(ErrorKind::bad_input, "the case describes grains that collide, and this verb needs an [assembly]",
                "its contacts are there from the start and stay", "Use 'equidem run', or give an [assembly]",
                root.where());
  }
  check_one_source_of_springs(root);
  check_and_complete(root, case_file_spec());
  resolve_springs_file(root, folder);

  Case result;
  result.title = text(root, "title");
  result.assembly = read_assembly_table(*root.find("assembly"), folder);
  check_contradictions(root, result.assembly);
  for (const char* source : {"springs", "material"})
    if (const TomlValue* table = root.find(source))
      result.weighting = enum_from<SpringWeighting>(text(*table, "weighting"));
  if (const TomlValue* springs = root.find("springs"))
    result.springs = SpringConstants{number(*springs, "kN"), number(*springs, "kT")};
  if (const TomlValue* material = root.find("material")) result.material = read_material(*material);
  if (const TomlValue* rotation = root.find("effects")->find("rotation"))
    result.rotation = rotation->text == "free" ? Rotation::free : Rotation::restrained;
  if (const TomlValue* test = root.find("test"))
    result.test =
        TensionTest{.stress = number(*test, "stress"), .gauge = enum_from<GaugePlacement>(text(*test, "gauge"))};
  for (const char* list : {"group", "schedule", "wall", "probe"}) check_names(root, list);
  for (const TomlValue& table : repeated(root, "group")) result.groups.push_back(read_group(table));
  for (const TomlValue& table : repeated(root, "support")) result.supports.push_back(read_support(table));
  result.load_cases = read_load_cases(repeated(root, "load"));
  result.schedules = read_schedules(root, folder);
  result.run = read_run(root, result.schedules, result.supports, result.load_cases.front().loads);
  result.homogenize = read_homogenize(*root.find("homogenize"));
  if (const TomlValue* ensemble = root.find("ensemble")) result.ensemble = read_ensemble(*ensemble);
  const TomlValue& solver = *root.find("solver");
  result.solver = {.method = enum_from<SolverMethod>(text(solver, "method")),
                   .max_refinements = whole(solver, "max_refinements"),
                   .memory_limit = *bytes_of(*solver.find("memory_limit"))};
  const TomlValue& output = *root.find("output");
  result.output = {.csv = flag(output, "csv"),
                   .vtk = flag(output, "vtk"),
                   .picture = flag(output, "picture"),
                   .frame_interval = optional_number(output, "frame_interval"),
                   .probe_interval = optional_number(output, "probe_interval"),
                   .checkpoint_interval = number(output, "checkpoint_interval")};
  result.document = std::move(root);
  return result;
}

Case read_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
