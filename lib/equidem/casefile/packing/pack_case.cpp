// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/packing/pack_case.hpp"

#include "equidem/assembly/delaunay.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/casefile/contact_tables.hpp"
#include "equidem/casefile/engine/bind.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/spring_relations.hpp"

namespace equidem::casefile {

using T = PackingTables;

std::vector<Key<PackingTables>> packing_keys() {
  using O = PackingOptions;
  return {
      key("method", &T::options, &O::method, help_of(EnumNames<PackingMethod>::list)),
      key("grains", &T::amount, &PackingAmount::grains, from(1, 10000000),
          "number of bodies; two of grains, box and solid_fraction give the third (falling: grains and box)"),
      key("box", &T::amount, &PackingAmount::box, unit("m"),
          "width and height from the origin; falling: the height is not used"),
      key("solid_fraction", &T::amount, &PackingAmount::solid_fraction, or_auto, optional, between(0, 1),
          "wanted; auto: as dense as the method gets, with grains and box (growth scales the radii, which are only "
          "ratios; rejection and insertion leave out what finds no place)"),
      key("sides", &T::sides, choices({"walls", "periodic"}), "of the box; falling: walls and an open top"),
      key("seed", &T::options, &O::seed, not_negative),
      key("overlap", &T::options, &O::overlap, range({.low = 0, .high = 0.1, .low_open = true}),
          "allowed, of the smaller radius; growth with auto: the mean overlap at which discs jam, 1e-3 is quick"),
      key("attempts", &T::options, &O::attempts, from(1, 1e12), "to place a disc; sweeps of local_moves"),
      key("gap_tolerance", &T::gap_tolerance, from(0, 1),
          "bodies are bonded, in the assembly, where the gap between them is at most this share of the sum of their "
          "radii; 0: where they touch"),
      key("density", &T::density, unit("kg/m³"), positive,
          fmt::format("density of the bodies; left out: that of [assembly], [springs] or [material], else {}, which "
                      "grains.csv does not get unless the bodies fell",
                      SettlingOptions{}.density)),
      key("region", &T::region, unit("m"),
          "where void ratio and porosity are measured; left out: away from walls and surface")};
}

std::vector<Key<PackingShape>> packing_shape_keys() {
  using S = PackingShape;
  return {key("kind", &S::kind,
              "the radius drawn is that of the disc of equal area, of pairs that of their two discs; directions are "
              "random; bonded_pair: tied by dashpots (falling), rigid_pair and clump: rigidly"),
          key("aspect", &S::aspect, from(1, 1000), when("kind", {"ellipse"}),
              "long over short half-axis: a = r aspect^(1/2), b = r/aspect^(1/2)"),
          key("discs", &S::discs, required, when("kind", {"clump"}), "in any place and unit; they may overlap")};
}

std::vector<Key<PackingTables>> packing_radii_keys() {
  using D = SizeDistribution;
  const auto uniform = when("distribution", {"uniform"}), log_normal = when("distribution", {"log_normal"});
  return {key("distribution", &T::sizes, &D::kind, "by number of grains"),
          key("smallest", &T::sizes, &D::smallest, required, unit("m"), positive, uniform, "radii between the two"),
          key("largest", &T::sizes, &D::largest, required, unit("m"), positive, uniform, "radii between the two"),
          key("median", &T::sizes, &D::median, required, unit("m"), positive, log_normal),
          key("deviation", &T::sizes, &D::deviation, required, from(0, 2), log_normal,
              "standard deviation of ln r; truncated at three standard deviations"),
          key("path", &T::sieve_curve, required, when("distribution", {"sieve_curve"}),
              "a CSV file: diameter in m, share of the mass that passes")};
}

std::vector<Key<PackingTables>> settling_keys() {
  using P = PackingOptions;
  using O = SettlingOptions;
  const auto settling = [](std::string name, auto member, const auto&... attributes) {
    return key(std::move(name), &T::options, &P::settling, member, attributes...);
  };
  return {
      settling("gravity", &O::gravity, unit("m/s²"), positive, "downwards"),
      settling("friction", &O::friction, not_negative, "between bodies"),
      settling("wall_friction", &O::wall_friction, not_negative),
      settling("damping", &O::damping, range({.low = 0, .high = 10, .low_open = true}),
               "h of the dashpots 2 h sqrt(m k), m the mass of a body"),
      settling("time_step", &O::time_step, or_auto, unit("s"), positive,
               "auto: a quarter of the limit of stability of the two lightest bodies"),
      settling(
          "unbalanced", &O::rest, range({.low = 1e-12, .high = 1, .high_open = true}),
          "mean unbalanced force, with the moment over the radius, over mean contact force, at which the bodies rest"),
      settling("longest", &O::longest, unit("s"), positive,
               "longest motion; bodies that are not at rest then are written as they lie, and the exit code is 1"),
      settling("bond_share", &O::bond_share, positive,
               "dashpots of bonded pairs, relative to the largest of an explicit step: C_n = share m/dt, C_s = a "
               "third of that; the pairs creep, and below 1e3 they hardly come to rest")};
}

static SizeDistribution sizes_of(const TomlValue& table, const PackingTables& given) {
  SizeDistribution sizes = given.sizes;
  if (sizes.kind == SizeDistribution::Kind::uniform && sizes.largest < sizes.smallest) {
    fail_at(*table.find("largest"),
            fmt::format("the largest radius {} m is below the smallest, {} m", sizes.largest, sizes.smallest), "",
            "Exchange them");
  }
  if (given.sieve_curve) sizes.sieves = with_key(table, "path", [&] { return read_sieve_curve(*given.sieve_curve); });
  return sizes;
}

ScalablePacking packing_options(const TomlValue& root, const PackingTables& tables) {
  const TomlValue& packing = *root.find("packing");
  ScalablePacking options{tables.options, tables.amount, sizes_of(*packing.find("radii"), tables)};
  const TomlValue* fraction = packing.find("solid_fraction");
  options.as_dense_as_possible = fraction != nullptr && !fraction->is_number();
  const bool open = tables.sides == PackingBox::Sides::walls && entry_of(options.method).open_top;
  options.box.sides = open ? PackingBox::Sides::open_top : tables.sides;
  if (const TomlValue* shape = packing.find("shape"); shape != nullptr && !options.shape.discs.empty())
    with_key(*shape, "discs", [&] { static_cast<void>(centred_clump(options.shape.discs)); });
  at_key(packing, [&] { set_amount(options.amount, options.sizes, options); });
  return options;
}

}  // namespace equidem::casefile

namespace equidem {
namespace {

namespace fs = std::filesystem;

using namespace casefile;

struct PackTables : PackCase {
  PackingTables tables;
  SpringsTable springs;
  OutputCase output;
};

const File<PackTables>& pack_file() {
  static const File<PackTables> file = [] {
    File<PackTables> made(case_schema, "case file of a packing", CaseKind::packing);
    made.ask(kinds_with);
    bind_packing(made, &PackTables::tables);
    bind_springs(made, &PackTables::springs, required);
    bind_output(made, &PackTables::output);
    return made;
  }();
  return file;
}

SpringConstants springs_of(const TomlValue& root, const SpringsTable& given, double density) {
  if (given.shear_wave_speed)
    return springs_of_wave_speeds(density, wave_speeds_from_shear(*given.shear_wave_speed, *given.poisson_ratio));
  check_stable_in_motion(root, given.constants);
  return given.constants;
}

/// Takes the part of [output] that a packing writes.
void take_output(const OutputCase& output, PackCase& result) {
  result.csv = output.csv;
  result.picture = output.picture;
  result.assembly = output.assembly.value_or(result.assembly);
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
  take_output(whole.output, result);
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
  settling.springs = springs_of(root, tables.springs, settling.density);
  tables.network = {.springs = unweighted(settling.springs, tables.springs.weighting),
                    .gap_tolerance = tables.tables.gap_tolerance};
  take_output(tables.output, tables);
  tables.document = std::move(root);
  return tables;
}

PackCase read_pack_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_pack_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
