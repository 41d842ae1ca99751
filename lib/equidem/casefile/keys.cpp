// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/keys.hpp"

#include <cmath>

#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Range positive{.low = 0, .low_open = true};
constexpr Range not_negative{.low = 0};

Range whole_from(double low, double high) {
  return {.low = low, .high = high};
}

std::vector<KeySpec> case_keys() {
  using enum KeyType;
  const std::vector<std::string> lattices = {"square", "hexagonal"};
  const std::vector<std::string> delaunay = {"delaunay"};
  return {
      {.table = "", .name = "schema", .type = text, .help = "says which rules the file follows: \"equidem/1\""},
      {.table = "", .name = "title", .type = text, .fallback = "\"\"", .help = "shown in reports and pictures"},
      {.table = "",
       .name = "springs",
       .type = path,
       .fallback = KeySpec::none,
       .help = "a springs file, instead of [springs] or [material]"},

      {.table = "assembly",
       .name = "kind",
       .type = choice,
       .choices = {"square", "hexagonal", "delaunay", "file"},
       .later = {"packing"},
       .help = "square and hexagonal: lattices of equal touching discs; delaunay: random points, the edges of "
               "their triangulation are the contacts; file: read from a file"},
      {.table = "assembly",
       .name = "columns",
       .type = whole,
       .range = whole_from(1, 1e6),
       .when_key = "kind",
       .when = lattices,
       .help = "discs in the longest row; hexagonal, free: rows alternate columns and columns - 1"},
      {.table = "assembly",
       .name = "rows",
       .type = whole,
       .range = whole_from(1, 1e6),
       .when_key = "kind",
       .when = lattices,
       .help = "in a periodic hexagonal assembly: even"},
      {.table = "assembly",
       .name = "radius",
       .type = number,
       .unit = "m",
       .range = positive,
       .when_key = "kind",
       .when = lattices,
       .help = "of every disc"},
      {.table = "assembly",
       .name = "radius",
       .type = number,
       .unit = "m",
       .fallback = KeySpec::none,
       .range = positive,
       .when_key = "kind",
       .when = delaunay,
       .help = "of every disc, half the mean spacing of neighbours; or give [assembly.radii]"},
      {.table = "assembly",
       .name = "discs",
       .type = whole,
       .fallback = "10000",
       .range = whole_from(3, 1e9),
       .when_key = "kind",
       .when = delaunay,
       .help = "how many are wanted; the report says how many there are"},
      {.table = "assembly",
       .name = "points",
       .type = choice,
       .fallback = "\"poisson_disc\"",
       .choices = {"poisson_disc", "perturbed_hexagonal", "random"},
       .when_key = "kind",
       .when = delaunay,
       .help = "poisson_disc: random but never close; perturbed_hexagonal: a lattice, disturbed; random: "
               "independent"},
      {.table = "assembly",
       .name = "disorder",
       .type = number,
       .fallback = "0.1",
       .range = {.low = 0, .high = 0.5, .high_open = true},
       .when_key = "points",
       .when = {"perturbed_hexagonal"},
       .help = "largest shift of a point, in spacings"},
      {.table = "assembly",
       .name = "seed",
       .type = whole,
       .fallback = "1",
       .range = not_negative,
       .when_key = "kind",
       .when = delaunay,
       .help = "same seed, same assembly"},
      {.table = "assembly",
       .name = "aspect",
       .type = number,
       .fallback = "1.0",
       .range = {.low = 1e-3, .high = 1e3},
       .when_key = "kind",
       .when = delaunay,
       .help = "width over height of the rectangle"},
      {.table = "assembly",
       .name = "periodic",
       .type = flag,
       .fallback = "false",
       .when_key = "kind",
       .when = {"square", "hexagonal", "delaunay"},
       .help = "joined to itself left-right and top-bottom"},
      {.table = "assembly",
       .name = "path",
       .type = path,
       .when_key = "kind",
       .when = {"file"},
       .help = "an assembly file (JSON)"},

      {.table = "assembly.radii", .name = "smallest", .type = number, .unit = "m", .range = positive},
      {.table = "assembly.radii",
       .name = "largest",
       .type = number,
       .unit = "m",
       .range = positive,
       .help = "radii are uniform between the two"},

      {.table = "springs", .name = "kN", .type = number, .unit = "Pa", .range = positive, .help = "normal spring"},
      {.table = "springs",
       .name = "kT",
       .type = number,
       .unit = "Pa",
       .help = "tangential spring; 0: none; negative: a static answer exists for small ones only"},
      {.table = "springs",
       .name = "weighting",
       .type = choice,
       .fallback = "\"uniform\"",
       .choices = {"uniform", "contact_density", "voronoi"},
       .help = "uniform: the same at every contact; contact_density: k/psi(theta), Abe (11), (21); voronoi: "
               "k h/l, "
               "shared cell edge over centre distance"},

      {.table = "material",
       .name = "shear_modulus",
       .type = number,
       .unit = "Pa",
       .fallback = KeySpec::none,
       .range = positive,
       .help = "G; or give young_modulus"},
      {.table = "material",
       .name = "young_modulus",
       .type = number,
       .unit = "Pa",
       .fallback = KeySpec::none,
       .range = positive,
       .help = "E; or give shear_modulus"},
      {.table = "material",
       .name = "poisson_ratio",
       .type = number,
       .range = {.low = -1, .high = 1, .low_open = true, .high_open = true},
       .help = "discs can show at most 1/4 in plane strain, 1/3 in plane stress"},
      {.table = "material",
       .name = "plane",
       .type = choice,
       .choices = {"strain", "stress"},
       .help = "how Poisson's ratio and Young's modulus are meant: plane strain or plane stress"},
      {.table = "material",
       .name = "static_only",
       .type = flag,
       .fallback = "false",
       .help = "allow kT < 0 for larger Poisson's ratios: no dynamics with such springs"},
      {.table = "material",
       .name = "weighting",
       .type = choice,
       .fallback = "\"uniform\"",
       .choices = {"uniform", "contact_density", "voronoi"},
       .help = "as in [springs]"},

      {.table = "effects",
       .name = "rotation",
       .type = choice,
       .fallback = KeySpec::none,
       .choices = {"free", "restrained"},
       .help = "of the discs; left out: free where a tangential spring turns them"},

      {.table = "test",
       .name = "kind",
       .type = choice,
       .choices = {"uniaxial_tension"},
       .help = "pulled along x by its left and right sides (Abe 1996, section 3)"},
      {.table = "test",
       .name = "stress",
       .type = number,
       .unit = "Pa",
       .fallback = "1.0e6",
       .range = {.zero_excluded = true},
       .help = "tension positive"},
      {.table = "test",
       .name = "gauge",
       .type = choice,
       .fallback = "\"centre\"",
       .choices = {"centre", "quarter", "ends"},
       .help = "where strain is read: two spacings or a quarter of the block either side of the middle, or "
               "side to side"},

      {.table = "group", .name = "name", .type = text, .help = "for use in [[support]] and [[load]]"},
      {.table = "group",
       .name = "discs",
       .type = discs,
       .fallback = KeySpec::none,
       .help = "counted from 0; or give box"},
      {.table = "group",
       .name = "box",
       .type = box,
       .unit = "m",
       .fallback = KeySpec::none,
       .help = "the discs with their centre inside"},

      {.table = "support",
       .name = "group",
       .type = text,
       .help = "left, right, bottom, top, bottom_left, bottom_right, top_left, top_right, or your own"},
      {.table = "support",
       .name = "ux",
       .type = held,
       .unit = "m",
       .fallback = KeySpec::none,
       .help = "prescribed motion; true: held at 0; left out: free"},
      {.table = "support", .name = "uy", .type = held, .unit = "m", .fallback = KeySpec::none},
      {.table = "support",
       .name = "rotation",
       .type = held,
       .unit = "rad",
       .fallback = KeySpec::none,
       .help = "counter-clockwise"},

      {.table = "load", .name = "group", .type = text, .help = "as in [[support]]"},
      {.table = "load",
       .name = "kind",
       .type = choice,
       .fallback = "\"per_disc\"",
       .choices = {"per_disc", "total", "traction"},
       .help = "per_disc: on each disc; total: shared equally; traction: per area of the side that the group "
               "forms"},
      {.table = "load",
       .name = "force",
       .type = vector,
       .unit = "N/m (traction: Pa)",
       .fallback = KeySpec::none,
       .help = "[f_x, f_y]"},
      {.table = "load",
       .name = "moment",
       .type = number,
       .unit = "N",
       .fallback = KeySpec::none,
       .help = "N m per metre of depth, counter-clockwise"},
      {.table = "load",
       .name = "case",
       .type = text,
       .fallback = "\"\"",
       .help = "loads of one name act together; a load without acts in every load case"},

      {.table = "solver",
       .name = "method",
       .type = choice,
       .fallback = "\"auto\"",
       .choices = {"auto", "multifrontal", "cholmod", "umfpack"},
       .help = "auto: multifrontal"},
      {.table = "solver",
       .name = "max_refinements",
       .type = whole,
       .fallback = "4",
       .range = whole_from(0, 100),
       .help = "steps of iterative refinement"},
      {.table = "solver",
       .name = "memory_limit",
       .type = bytes,
       .unit = "bytes",
       .fallback = "0",
       .range = not_negative,
       .help = "that the factor may take, also as \"4 GB\"; 0: what the machine has free"},

      {.table = "output", .name = "csv", .type = flag, .fallback = "true", .help = "discs.csv, contacts.csv"},
      {.table = "output", .name = "vtk", .type = flag, .fallback = "true", .help = "state for ParaView"},
      {.table = "output", .name = "picture", .type = flag, .fallback = "true", .help = "picture.svg, picture.png"},
  };
}

}  // namespace

bool Range::contains(double value) const {
  if (!std::isfinite(value) || (zero_excluded && value == 0)) return false;
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  const auto shown = [](double value) {
    const bool short_whole = std::abs(value) < 1e7 && value == std::floor(value);
    return short_whole ? format("{:.0f}", value) : format("{:g}", value);
  };
  if (zero_excluded) return "not 0";
  if (low == -infinity && high == infinity) return {};
  if (high == infinity) return format("{} {}", low_open ? ">" : ">=", shown(low));
  if (low == -infinity) return format("{} {}", high_open ? "<" : "<=", shown(high));
  if (low_open && high_open) return format("between {} and {}", shown(low), shown(high));
  if (!low_open && !high_open) return format("from {} to {}", shown(low), shown(high));
  return format("{} {} and {} {}", low_open ? ">" : ">=", shown(low), high_open ? "<" : "<=", shown(high));
}

const FileSpec& case_file_spec() {
  static const FileSpec spec{
      .schema = "equidem/1",
      .noun = "case file",
      .tables = {{.name = "assembly", .required = true, .help = "the discs and their contacts"},
                 {.name = "assembly.radii",
                  .when_key = "kind",
                  .when = {"delaunay"},
                  .help = "discs of different sizes, instead of radius"},
                 {.name = "springs", .help = "the two springs of a contact"},
                 {.name = "material", .help = "the continuum that the springs shall stand for, instead of [springs]"},
                 {.name = "effects", .completed = true, .help = "what may be switched off"},
                 {.name = "test", .help = "a standard test, instead of [[support]] and [[load]]"},
                 {.name = "group", .repeated = true, .help = "discs chosen by name"},
                 {.name = "support", .repeated = true, .help = "prescribed motion of a group"},
                 {.name = "load", .repeated = true, .help = "forces and moments on a group"},
                 {.name = "solver", .completed = true, .help = "how the equations are solved"},
                 {.name = "output", .completed = true, .help = "what is written with --out"}},
      .keys = case_keys(),
  };
  return spec;
}

const FileSpec& springs_file_spec() {
  static const FileSpec spec = [] {
    FileSpec file{.schema = "equidem-springs/1",
                  .noun = "springs file",
                  .tables = {{.name = "springs", .required = true, .help = "the two springs of a contact"}},
                  .keys = {}};
    for (const KeySpec& key : case_file_spec().keys) {
      const std::string_view table = key.table, name = key.name;
      if (table == "springs" || (table.empty() && (name == "schema" || name == "title"))) file.keys.push_back(key);
    }
    return file;
  }();
  return spec;
}

}  // namespace equidem
