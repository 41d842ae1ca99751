// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/case_tables.hpp"
#include "equidem/casefile/grain_tables.hpp"
#include "equidem/casefile/pack_case.hpp"
#include "equidem/casefile/study_case.hpp"

namespace equidem {
namespace {

constexpr const char* example =
    R"(The case file is TOML and says what is computed. It is strict: an unknown key is an error that names
its line. SI units, per metre of depth; tension positive; angles in radians, counter-clockwise.
Paths are relative to the folder of the case file.

An example:

  schema = "equidem/1"
  title  = "Abe 1996, Fig. 6"
  [assembly]
  kind    = "hexagonal"
  columns = 21
  rows    = 21
  radius  = 0.005
  [springs]
  kN = 1.0e9
  kT = 0.5e9
  [test]
  kind = "uniaxial_tension"

Any key can be set on the command line: --set springs.kT=0.3e9 --set assembly.rows=11

)";

constexpr const char* grain_example =
    R"(
Bodies that meet, rebound and part, for 'equidem run': a case with [grains] or [[grain]] in place of
[assembly]. The top of the file, [[schedule]] and [output] are as above, without output.vtk; the
rest is below. An example:

  schema = "equidem/1"
  [grains]
  body    = "sphere"
  density = 2500.0
  [[grain]]
  position = [0.0, 1.0]
  radius   = 0.02
  [collisions]
  restitution      = 0.8
  contact_duration = 1.0e-3
  [[wall]]
  name   = "floor"
  point  = [0.0, 0.0]
  normal = [0.0, 1.0]
  [run]
  duration = 2.0
  gravity  = [0.0, -9.81]
)";

constexpr const char* pack_example =
    R"(
Discs that fill a box, for 'equidem pack': a case with [packing] in place of [assembly]. An example:

  schema = "equidem/1"
  [packing]
  method = "growth"
  box    = [0.3, 0.2]
  solid_fraction = 0.8
  [packing.radii]
  smallest = 0.002
  largest  = 0.004
  [springs]
  kN = 1.0e8
  kT = 0.5e8
)";

constexpr const char* study_example =
    R"(
A study, for 'equidem study': error against time over the keys of a case. An example:

  schema = "equidem/1"
  [study]
  verb    = "solve"
  case    = "abe1996_fig6.toml"
  measure = "poisson_ratio"
  truth   = "known"
  value   = 0.125
  order   = 1.0
  [[vary]]
  key    = "assembly.rows, assembly.columns"
  values = [9, 17, 33, 65]
)";

std::string describe_tables(const casefile::FileSpec& spec) {
  std::string out;
  for (const casefile::TableSpec& table : spec.tables) out += describe_table(spec, table);
  return out;
}

}  // namespace

std::string describe_case_file() {
  const casefile::FileSpec& spec = casefile::case_file().spec();
  std::string out = example;
  out += "At the top of the file\n" + describe_keys(spec, "") + describe_tables(spec) + grain_example;
  const casefile::FileSpec& grains = casefile::grain_file().spec();
  for (const casefile::TableSpec& table : grains.tables)
    if (table.name != "schedule" && table.name != "output") out += describe_table(grains, table);
  return out + pack_example + describe_tables(pack_file_spec()) + study_example + describe_tables(study_file_spec());
}

}  // namespace equidem
