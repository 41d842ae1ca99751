// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/packing/pack_case.hpp"

#include "equidem/casefile/engine/bind.hpp"
#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/core/file.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/packing/amount.hpp"
#include "equidem/packing/methods.hpp"

namespace equidem {
namespace {

namespace fs = std::filesystem;

using namespace casefile;

/// [packing.radii].
struct SizeTable {
  SizeDistribution sizes;
  std::optional<fs::path> path;
};

/// [springs]: kN and kT, or the other two.
struct SpringsOrSpeeds {
  std::optional<double> kN, kT;            ///< Pa
  std::optional<double> shear_wave_speed;  ///< m/s
  std::optional<double> poisson_ratio;
};

struct PackTables : PackCase {
  PackingAmount amount;
  PackingBox::Sides sides = PackingBox::Sides::walls;
  SizeTable radii;
  SpringsOrSpeeds springs;
  enum class Start { fall, relax } start = Start::fall;
};

}  // namespace

template <>
struct EnumNames<PackTables::Start> {
  using enum PackTables::Start;
  static constexpr const char* what = "start of settling";
  static constexpr NamedValue<PackTables::Start> list[] = {{fall, "fall"}, {relax, "relax"}};
};

namespace {

void bind_bodies(File<PackTables>& file) {
  using T = PackTables;
  using O = PackingOptions;
  file.table("packing", required, "how many bodies fill which box")
      .keys({key_in<T>("method", &PackCase::packing, &O::method, help_of(EnumNames<PackingMethod>::list)),
             key("grains", &T::amount, &PackingAmount::grains, from(1, 10000000),
                 "number of bodies; two of grains, box and solid_fraction give the third (falling: grains and box)"),
             key("box", &T::amount, &PackingAmount::box, unit("m"),
                 "width and height from the origin; falling: the height is not used"),
             key("solid_fraction", &T::amount, &PackingAmount::solid_fraction, or_auto, optional, between(0, 1),
                 "wanted; auto: as dense as the method gets, with grains and box (growth scales the radii, rejection "
                 "and insertion leave out what finds no place)"),
             key("sides", &T::sides, choices({"walls", "periodic"}), "of the box; falling: walls and an open top"),
             key_in<T>("seed", &PackCase::packing, &O::seed, not_negative),
             key_in<T>("overlap", &PackCase::packing, &O::overlap, range({.low = 0, .high = 0.1, .low_open = true}),
                       "allowed, of the smaller radius; growth with auto: the mean overlap at which discs jam, 1e-3 is "
                       "quick"),
             key_in<T>("attempts", &PackCase::packing, &O::attempts, from(1, 1e12),
                       "to place a disc; sweeps of local_moves"),
             key_in<T>("density", &PackCase::packing, &O::settling, &SettlingOptions::density, unit("kg/m³"), positive,
                       "density of the bodies"),
             key_in<T>("region", &PackCase::region, unit("m"),
                       "where void ratio and porosity are measured; left out: away from walls and surface")});
  using S = PackingShape;
  file.table("packing.shape", &T::packing, &O::shape, completed, "shape of the bodies")
      .keys({key("kind", &S::kind,
                 "the radius drawn is that of the disc of equal area, of pairs that of their two discs; directions are "
                 "random; bonded_pair: tied by dashpots (falling), rigid_pair and clump: rigidly"),
             key("aspect", &S::aspect, from(1, 1000), when("kind", {"ellipse"}),
                 "long over short half-axis: a = r aspect^(1/2), b = r/aspect^(1/2)"),
             key("discs", &S::discs, required, when("kind", {"clump"}), "in any place and unit; they may overlap")});
  const auto uniform = when("distribution", {"uniform"}), log_normal = when("distribution", {"log_normal"});
  using R = SizeTable;
  using D = SizeDistribution;
  file.table("packing.radii", &T::radii, required, "radii of the bodies")
      .keys({key("distribution", &R::sizes, &D::kind, "by number of grains"),
             key("smallest", &R::sizes, &D::smallest, required, unit("m"), positive, uniform),
             key("largest", &R::sizes, &D::largest, required, unit("m"), positive, uniform),
             key("median", &R::sizes, &D::median, required, unit("m"), positive, log_normal),
             key("deviation", &R::sizes, &D::deviation, required, from(0, 2), log_normal,
                 "standard deviation of ln r; cut at three of them"),
             key("path", &R::path, required, when("distribution", {"sieve_curve"}),
                 "a CSV file: diameter in m, share of the mass that passes")});
}

void bind_contacts(File<PackTables>& file) {
  using T = PackTables;
  using O = SettlingOptions;
  using S = SpringsOrSpeeds;
  const std::string how_stiff =
      "two numbers say how stiff contacts are: kN and kT, or shear_wave_speed and poisson_ratio";
  file.table("springs", &T::springs, required, "springs of contacts: kN and kT, or wave speeds")
      .keys({key("kN", &S::kN, unit("Pa"), positive, or_instead({"shear_wave_speed"}, how_stiff),
                 only_with({"kT"}, how_stiff), "of every contact, walls too; instead of the wave speeds"),
             key("kT", &S::kT, unit("Pa"), not_negative, only_with({"kN"}, how_stiff)),
             key("shear_wave_speed", &S::shear_wave_speed, unit("m/s"), positive,
                 only_with({"poisson_ratio"}, how_stiff), "Vs: kT = pi/4 rho Vs², kN = pi/4 rho Vp²"),
             key("poisson_ratio", &S::poisson_ratio, between(-1, 0.5), only_with({"shear_wave_speed"}, how_stiff),
                 "plane strain; with shear_wave_speed")});
  file.table("settling", completed, "how bodies fall and come to rest (method = falling)")
      .keys({key("start", &T::start,
                 "fall: all of it in time; relax: first brought down without inertia and friction, much faster and "
                 "denser")});
  file.table("settling", &T::packing, &PackingOptions::settling)
      .keys(
          {key("gravity", &O::gravity, unit("m/s²"), positive, "downwards"),
           key("friction", &O::friction, not_negative, "between bodies"),
           key("wall_friction", &O::wall_friction, not_negative),
           key("damping", &O::damping, range({.low = 0, .high = 10, .low_open = true}),
               "h of the dashpots 2 h sqrt(m k), m the mass of a body"),
           key("time_step", &O::time_step, or_auto, unit("s"), positive,
               "auto: a quarter of the limit of stability of the two lightest bodies"),
           key("unbalanced", &O::rest, range({.low = 1e-12, .high = 1, .high_open = true}),
               "mean unbalanced force over mean contact force, at which the bodies rest"),
           key("longest", &O::longest, unit("s"), positive, "longest motion, before it is given up"),
           key("bond_share", &O::bond_share, positive,
               "dashpots of bonded pairs, relative to the largest of an explicit step: C_n = share m/dt, C_s = a third "
               "of that; the pairs creep, and below 1e3 they hardly come to rest")});
  file.table("output", completed, "what is written with --out")
      .keys({key_in<T>("csv", &PackCase::csv, "grains.csv, for [grains] path"),
             key_in<T>("picture", &PackCase::picture)});
}

const File<PackTables>& pack_file() {
  static const File<PackTables> file = [] {
    File<PackTables> made(case_schema, "case file of a packing");
    bind_bodies(made);
    bind_contacts(made);
    return made;
  }();
  return file;
}

SizeDistribution sizes_of(const TomlValue& table, const SizeTable& given) {
  SizeDistribution sizes = given.sizes;
  if (sizes.kind == SizeDistribution::Kind::uniform && sizes.largest < sizes.smallest) {
    fail_at(*table.find("largest"), "packing.radii.largest",
            fmt::format("the largest radius {} m is below the smallest, {} m", sizes.largest, sizes.smallest), "",
            "Exchange them");
  }
  if (given.path)
    sizes.sieves = with_key(table, "packing.radii", "path", [&] { return read_sieve_curve(*given.path); });
  return sizes;
}

SpringConstants springs_of(const SpringsOrSpeeds& given, double density) {
  if (given.kN) return {*given.kN, *given.kT};
  return springs_of_wave_speeds(density, wave_speeds_from_shear(*given.shear_wave_speed, *given.poisson_ratio));
}

}  // namespace

const casefile::FileSpec& pack_file_spec() {
  return pack_file().spec();
}

PackCase parse_pack_case(std::string_view content, const std::string& name, const fs::path& folder,
                         std::span<const std::string> overrides) {
  TomlValue root = parse_document(content, name, overrides);
  PackTables tables = pack_file().read(root, folder);
  const TomlValue& packing = *root.find("packing");
  PackingOptions& options = tables.packing;
  const TomlValue* fraction = packing.find("solid_fraction");
  options.as_dense_as_possible = fraction != nullptr && !fraction->is_number();
  const bool open = tables.sides == PackingBox::Sides::walls && entry_of(options.method).open_top;
  options.box.sides = open ? PackingBox::Sides::open_top : tables.sides;
  const SizeDistribution sizes = sizes_of(*packing.find("radii"), tables.radii);
  at_key(packing, "packing", [&] { set_amount(tables.amount, sizes, options); });
  SettlingOptions& settling = options.settling;
  settling.relax_first = tables.start == PackTables::Start::relax;
  settling.springs = springs_of(tables.springs, settling.density);
  tables.document = std::move(root);
  return tables;
}

PackCase read_pack_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_pack_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
