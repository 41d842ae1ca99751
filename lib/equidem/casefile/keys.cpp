// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/keys.hpp"

#include <cmath>

#include "equidem/casefile/run_keys.hpp"
#include "equidem/casefile/scene_keys.hpp"
#include "equidem/casefile/task_keys.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<KeySpec> all_keys() {
  std::vector<KeySpec> keys = scene_keys();
  for (const auto& more : {task_keys(), run_keys()}) keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

}  // namespace

bool Range::contains(double value) const {
  if (!std::isfinite(value) || (zero_excluded && value == 0)) return false;
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
  const auto shown = [](double value) {
    const bool short_whole = std::abs(value) < 1e7 && value == std::floor(value);
    return short_whole ? fmt::format("{:.0f}", value) : fmt::format("{:g}", value);
  };
  if (zero_excluded) return "not 0";
  if (low == -infinity && high == infinity) return {};
  if (high == infinity) return fmt::format("{} {}", low_open ? ">" : ">=", shown(low));
  if (low == -infinity) return fmt::format("{} {}", high_open ? "<" : "<=", shown(high));
  if (low_open && high_open) return fmt::format("between {} and {}", shown(low), shown(high));
  if (!low_open && !high_open) return fmt::format("from {} to {}", shown(low), shown(high));
  return fmt::format("{} {} and {} {}", low_open ? ">" : ">=", shown(low), high_open ? "<" : "<=", shown(high));
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
                 {.name = "run", .help = "motion in time, for the verb run"},
                 {.name = "run.damping",
                  .help = "what takes energy out of a run; at most one of stiffness and contact"},
                 {.name = "schedule",
                  .repeated = true,
                  .help = "how a motion or load changes in a run; without one it is there from the start"},
                 {.name = "wall", .repeated = true, .help = "a straight wall without friction, in a run"},
                 {.name = "velocity", .repeated = true, .help = "of a group at the start of a run"},
                 {.name = "probe", .repeated = true, .help = "a history of a group in a run"},
                 {.name = "homogenize", .completed = true, .help = "how the effective stiffness is found"},
                 {.name = "ensemble", .help = "many random samples (kind = delaunay): mean, scatter, the size needed"},
                 {.name = "solver", .completed = true, .help = "how the equations are solved"},
                 {.name = "output", .completed = true, .help = "what is written with --out"}},
      .keys = all_keys(),
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
