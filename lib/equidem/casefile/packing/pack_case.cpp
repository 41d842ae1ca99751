// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/packing/pack_case.hpp"

#include "equidem/assembly/delaunay.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/engine/value.hpp"
#include "equidem/casefile/packing/packing_tables.hpp"
#include "equidem/casefile/springs_table.hpp"
#include "equidem/contact/material_springs.hpp"
#include "equidem/core/file.hpp"
#include "equidem/material/wave_speed_springs.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

using namespace casefile;

/// [springs]: kN and kT, or the other two.
struct SpringsOrSpeeds {
  std::optional<double> kN, kT;            ///< Pa
  std::optional<double> shear_wave_speed;  ///< m/s
  std::optional<double> poisson_ratio;
  SpringWeighting weighting = SpringWeighting::uniform;
  std::optional<double> density;  ///< kg/m³
};

struct PackTables : PackCase {
  PackingTables tables;
  SpringsOrSpeeds springs;
};

void bind_springs_and_output(File<PackTables>& file) {
  using S = SpringsOrSpeeds;
  const std::string how_stiff =
      "two numbers say how stiff contacts are: kN and kT, or shear_wave_speed and poisson_ratio";
  file.table("springs", &PackTables::springs, required, "springs of contacts: kN and kT, or wave speeds")
      .keys({key("kN", &S::kN, unit("Pa"), positive, or_instead({"shear_wave_speed"}, how_stiff),
                 only_with({"kT"}, how_stiff), "of every contact, walls too; instead of the wave speeds"),
             key("kT", &S::kT, unit("Pa"), not_negative, only_with({"kN"}, how_stiff)),
             key("shear_wave_speed", &S::shear_wave_speed, unit("m/s"), positive,
                 only_with({"poisson_ratio"}, how_stiff), "Vs: kT = pi/4 rho Vs², kN = pi/4 rho Vp²"),
             key("poisson_ratio", &S::poisson_ratio, between(-1, 0.5), only_with({"shear_wave_speed"}, how_stiff),
                 "plane strain; with shear_wave_speed"),
             key("weighting", &S::weighting,
                 "as in [springs] of an assembly; bodies fall on uniform ones, and of others the assembly that is "
                 "written has none"),
             key("density", &S::density, unit("kg/m³"), positive, "of the bodies, as packing.density")});
  bind_springs_file(file);
  file.table("output", completed, "what is written with --out")
      .keys({key_with<PackTables, std::vector<OutputFile>>(
                 "files",
                 [](PackTables& tables, const std::vector<OutputFile>& wanted) {
                   tables.csv = std::ranges::find(wanted, OutputFile::csv) != wanted.end();
                   tables.picture = std::ranges::find(wanted, OutputFile::picture) != wanted.end();
                 },
                 choices(names_of<OutputFile>()), or_empty,
                 by_default(std::vector{OutputFile::csv, OutputFile::vtk, OutputFile::picture}),
                 "csv: grains.csv, for [grains] path; picture: picture.png; [] for none of them"),
             key_in<PackTables>("assembly", &PackCase::assembly,
                                "assembly.json or, read and written faster, assembly.h5 (HDF5)")});
}

const File<PackTables>& pack_file() {
  static const File<PackTables> file = [] {
    File<PackTables> made(case_schema, "case file of a packing");
    bind_packing(made, &PackTables::tables);
    bind_springs_and_output(made);
    return made;
  }();
  return file;
}

SpringConstants springs_of(const SpringsOrSpeeds& given, double density) {
  if (given.kN) return {*given.kN, *given.kT};
  return springs_of_wave_speeds(density, wave_speeds_from_shear(*given.shear_wave_speed, *given.poisson_ratio));
}

std::optional<SpringConstants> unweighted(const std::optional<SpringConstants>& springs, SpringWeighting weighting) {
  return weighting == SpringWeighting::uniform ? springs : std::nullopt;
}

/// The packing of a case whose [assembly] is one.
PackCase packing_of(Case whole) {
  if (!whole.assembly.packing)
    bad_input_at(whole.where("assembly.kind"), "the assembly is not a packing",
                 "'equidem pack' fills a box with bodies", "Set kind = \"packing\" and give [packing]");
  PackCase result;
  static_cast<CaseDocument&>(result) = whole;
  result.packing = *whole.assembly.packing;
  result.network = {.springs = unweighted(whole.springs, whole.weighting),
                    .gap_tolerance = whole.assembly.gap_tolerance};
  result.region = whole.assembly.region;
  result.density = whole.assembly.density;
  if (whole.material) result.of_continuum = whole.material->given.density;
  result.body = whole.assembly.body;
  result.csv = whole.output.csv;
  result.picture = whole.output.picture;
  result.assembly = whole.output.assembly.value_or(result.assembly);
  return result;
}

}  // namespace

double body_density(const PackCase& resolved, Assembly network) {
  if (resolved.of_continuum && !network.periodic()) measure_cells(network);
  return with_place(resolved.where("material.density"), [&] {
    return disc_density(resolved.density, resolved.of_continuum, resolved.body, network)
        .value_or(resolved.packing.settling.density);
  });
}

const casefile::FileSpec& pack_file_spec() {
  return pack_file().spec();
}

PackCase parse_pack_case(std::string_view content, const std::string& name, const fs::path& folder,
                         std::span<const std::string> overrides) {
  TomlValue root = parse_document(content, name, overrides);
  if (root.find("assembly") != nullptr) return packing_of(parse_case(content, name, folder, overrides));
  resolve_springs_file(root, folder);
  PackTables tables = pack_file().read(root, folder);
  tables.packing = packing_options(root, tables.tables);
  tables.region = tables.tables.region;
  tables.density = one_density(root, {{"springs", tables.springs.density}, {"packing", tables.tables.density}});
  SettlingOptions& settling = tables.packing.settling;
  settling.density = tables.density.value_or(settling.density);
  settling.springs = springs_of(tables.springs, settling.density);
  tables.network = {.springs = unweighted(settling.springs, tables.springs.weighting),
                    .gap_tolerance = tables.tables.gap_tolerance};
  tables.document = std::move(root);
  return tables;
}

PackCase read_pack_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_pack_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
