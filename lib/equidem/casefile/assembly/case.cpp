// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/assembly/case.hpp"

#include <algorithm>
#include <sstream>

#include "equidem/casefile/assembly/case_tables.hpp"
#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/grains/grain_tables.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

using casefile::fail_at;
using casefile::repeated;

void check_radii(const TomlValue& table, const DelaunayOptions& options) {
  if (table.find("kind")->text != "delaunay") return;
  casefile::check_one_of(table, "assembly.radius", {"radius", "radii"}, "the size of the discs is missing",
                         "discs are of one radius, or of radii between two",
                         "Give either radius = ... or [assembly.radii]");
  if (options.radii.smallest > options.radii.largest) {
    fail_at(*table.find("radii"), "assembly.radii",
            fmt::format("smallest = {} is larger than largest = {}", options.radii.smallest, options.radii.largest), "",
            "Exchange them");
  }
}

void check_group(const TomlValue& table, const GroupCase& group) {
  casefile::check_one_of(table, fmt::format("group '{}'", group.name), {"discs", "box"}, "it has neither discs nor box",
                         "a group is a list of discs, or the discs in a box", "Give one of the two");
  if (group.box && (group.box->low.x >= group.box->high.x || group.box->low.y >= group.box->high.y)) {
    const TomlValue& box = *table.find("box");
    fail_at(box, "group.box", fmt::format("the box {} is empty", box.shown()), "it is [x_min, y_min, x_max, y_max]",
            "Put the smaller numbers first");
  }
}

void check_support(const TomlValue& table, const Support& support) {
  if (support.ux || support.uy || support.rotation) return;
  fail_at(table, "support", fmt::format("the support of '{}' holds nothing", support.group),
          "ux, uy and rotation are all left out", "Add one, such as uy = true");
}

void check_load(const TomlValue& table, const Load& load) {
  const TomlValue* moment = table.find("moment");
  if (table.find("force") == nullptr && moment == nullptr)
    fail_at(table, "load", fmt::format("the load on '{}' has neither force nor moment", load.group),
            "it would do nothing", "Add one, such as force = [1.0e3, 0.0]");
  if (moment != nullptr && load.kind == LoadKind::traction)
    fail_at(*moment, "load.moment", "a traction has no moment", "it is a force per area of a side",
            "Give the moment in a [[load]] of its own");
}

/// Loads with a name act in the case of that name, loads without in every case.
std::vector<NamedLoads> load_cases_of(const std::vector<casefile::LoadTable>& tables) {
  std::vector<NamedLoads> cases;
  for (const casefile::LoadTable& table : tables)
    if (!table.load_case.empty() && std::ranges::find(cases, table.load_case, &NamedLoads::name) == cases.end())
      cases.push_back({table.load_case, {}});
  if (cases.empty()) cases.push_back({});
  for (const casefile::LoadTable& table : tables)
    for (NamedLoads& loads : cases)
      if (table.load_case.empty() || table.load_case == loads.name) loads.loads.push_back(table.load);
  return cases;
}

/// A file of springs takes the place of the table [springs].
void resolve_springs_file(TomlValue& root, const fs::path& folder) {
  TomlValue* named = root.find("springs");
  if (named == nullptr || named->type != TomlValue::Type::text) return;
  const fs::path path = casefile::opened(named->text, folder);
  TomlValue document;
  try {
    document = parse_toml(read_file(path), path.string());
  } catch (const Error& error) {
    throw error.at(fmt::format("{}: springs", named->where()));
  }
  casefile::springs_file_format().check(document);
  *named = *document.find("springs");
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
            fmt::format("kind = \"{}\" makes the same one every time", root.find("assembly")->find("kind")->text),
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

void complete_springs(const TomlValue& root, casefile::CaseTables& tables) {
  if (const auto& springs = tables.springs_table) {
    tables.springs = springs->springs;
    tables.weighting = springs->weighting;
  }
  if (const auto& material = tables.material_table) {
    tables.weighting = material->weighting;
    tables.material = MaterialCase{{}, material->material.density, material->static_only};
    casefile::at_key(*root.find("material"), "material",
                     [&] { tables.material->moduli = moduli_of(material->material); });
  }
}

}  // namespace

std::string Case::where(std::string_view key) const {
  return fmt::format("{}: {}", value_at(document, key).where(), key);
}

Case parse_case(std::string_view content, const std::string& name, const fs::path& folder,
                std::span<const std::string> overrides) {
  TomlValue root = parse_toml(content, name);
  for (const std::string& assignment : overrides) casefile::apply_override(root, assignment);
  if (casefile::describes_grains(root)) {
    throw Error(ErrorKind::bad_input, "the case describes grains that collide, and this verb needs an [assembly]",
                "its contacts are there from the start and stay", "Use 'equidem run', or give an [assembly]",
                root.where());
  }
  check_one_source_of_springs(root);
  refuse_energy_of_probes(root);
  casefile::case_file().check(root);
  resolve_springs_file(root, folder);
  casefile::CaseTables tables;
  casefile::case_file().assign(root, folder, tables);

  check_radii(*root.find("assembly"), tables.assembly.delaunay);
  check_contradictions(root, tables.assembly);
  complete_springs(root, tables);
  casefile::check_names(root, "group");
  for (std::size_t k = 0; k < tables.groups.size(); ++k) check_group(repeated(root, "group")[k], tables.groups[k]);
  for (std::size_t k = 0; k < tables.support_tables.size(); ++k) {
    check_support(repeated(root, "support")[k], tables.support_tables[k].support);
    tables.supports.push_back(tables.support_tables[k].support);
  }
  for (std::size_t k = 0; k < tables.load_tables.size(); ++k) {
    const TomlValue& table = repeated(root, "load")[k];
    casefile::check_plain_name(*table.find("case"), "load.case", "a load case",
                               "it becomes part of the names of files");
    check_load(table, tables.load_tables[k].load);
  }
  tables.load_cases = load_cases_of(tables.load_tables);
  tables.schedules = read_schedules(root, tables.schedule_tables);
  casefile::complete_run(root, tables);
  tables.document = std::move(root);
  return tables;
}

std::string to_toml(const Case& resolved, const fs::path& folder) {
  return to_toml(resolved.document, folder);
}

std::string springs_file(const SpringConstants& springs, SpringWeighting weighting, const std::string& title,
                         const std::string& comment) {
  std::string out;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) {
    // TOML allows no control characters in a comment.
    for (char& c : line)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    out += line.empty() ? "#\n" : fmt::format("# {}\n", line);
  }
  return out + fmt::format("schema = \"{}\"\ntitle = {}\n\n[springs]\nkN = {}\nkT = {}\nweighting = {}\n",
                           casefile::springs_file_format().spec().schema, toml_text(title), toml_number(springs.kN),
                           toml_number(springs.kT), toml_text(to_string(weighting)));
}

bool is_case_key(std::string_view path) {
  return casefile::is_known_key(casefile::case_file().spec(), path);
}

Case read_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
