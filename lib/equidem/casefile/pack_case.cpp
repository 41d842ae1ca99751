// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/pack_case.hpp"

#include "equidem/casefile/engine/keys.hpp"
#include "equidem/casefile/engine/read_value.hpp"
#include "equidem/casefile/pack_keys.hpp"
#include "equidem/core/file.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/packing/amount.hpp"

namespace equidem {
using namespace casefile;
namespace {

namespace fs = std::filesystem;

SizeDistribution read_sizes(TomlValue& table, const fs::path& folder) {
  SizeDistribution sizes;
  const std::string& kind = text(table, "distribution");
  if (kind == "uniform") {
    sizes.smallest = number(table, "smallest");
    sizes.largest = number(table, "largest");
    if (sizes.largest < sizes.smallest) {
      fail_at(*table.find("largest"), "packing.radii.largest",
              fmt::format("the largest radius {} m is below the smallest, {} m", sizes.largest, sizes.smallest), "",
              "Exchange them");
    }
  } else if (kind == "log_normal") {
    sizes.kind = SizeDistribution::Kind::log_normal;
    sizes.median = number(table, "median");
    sizes.deviation = number(table, "deviation");
  } else {
    sizes.kind = SizeDistribution::Kind::sieve_curve;
    TomlValue& path = *table.find("path");
    const fs::path file = opened(path.text, folder);
    try {
      sizes.sieves = read_sieve_curve(file);
    } catch (const Error& error) {
      throw error.at(fmt::format("{}: packing.radii.path", path.where()));
    }
    path.text = file.string();
    path.is_path = true;
  }
  return sizes;
}

SpringConstants read_springs(const TomlValue& table, double density) {
  const auto kN = optional_number(table, "kN"), kT = optional_number(table, "kT");
  const auto speed = optional_number(table, "shear_wave_speed"), poisson = optional_number(table, "poisson_ratio");
  if (kN && kT && !speed && !poisson) return {*kN, *kT};
  if (speed && poisson && !kN && !kT) return springs_of_wave_speeds(density, wave_speeds_from_shear(*speed, *poisson));
  fail_at(table, "springs", "it is not said how stiff contacts are", "two numbers say it",
          "Give kN and kT, or shear_wave_speed and poisson_ratio, and no others");
}

PackingShape read_shape(const TomlValue& table) {
  PackingShape shape;
  shape.kind = enum_from<PackingShape::Kind>(text(table, "kind"));
  if (shape.kind == PackingShape::Kind::ellipse) shape.aspect = number(table, "aspect");
  if (shape.kind == PackingShape::Kind::clump) {
    for (const TomlValue& disc : table.find("discs")->items)
      shape.discs.push_back({{disc.items[0].real, disc.items[1].real}, disc.items[2].real});
  }
  return shape;
}

/// The method, the shape and the seed are read before.
void read_amount(const TomlValue& table, const SizeDistribution& sizes, PackingOptions& options) {
  PackingAmount amount;
  if (const TomlValue* grains = table.find("grains")) amount.grains = grains->integer;
  if (table.find("box") != nullptr) amount.box = vector(table, "box");
  if (const TomlValue* fraction = table.find("solid_fraction")) {
    options.as_dense_as_possible = !fraction->is_number();
    if (fraction->is_number()) amount.solid_fraction = fraction->real;
  }
  const bool falls = entry_of(options.method).open_top;
  options.box.sides = text(table, "sides") == "periodic" ? PackingBox::Sides::periodic
                      : falls                            ? PackingBox::Sides::open_top
                                                         : PackingBox::Sides::walls;
  try {
    set_amount(amount, sizes, options);
  } catch (const Error& error) {
    const TomlValue* value = table.find(error.where());
    fail_at(value != nullptr ? *value : table, value != nullptr ? "packing." + error.where() : "packing",
            error.problem(), error.why(), error.remedy());
  }
}

SettlingOptions read_settling(const TomlValue& table) {
  SettlingOptions settling;
  settling.relax_first = text(table, "start") == "relax";
  settling.gravity = number(table, "gravity");
  settling.friction = number(table, "friction");
  settling.wall_friction = number(table, "wall_friction");
  settling.damping = number(table, "damping");
  const TomlValue& step = *table.find("time_step");
  settling.time_step = step.is_number() ? step.real : 0;
  settling.rest = number(table, "unbalanced");
  settling.longest = number(table, "longest");
  settling.bond_share = number(table, "bond_share");
  return settling;
}

}  // namespace

PackCase parse_pack_case(std::string_view content, const std::string& name, const fs::path& folder,
                         std::span<const std::string> overrides) {
  TomlValue root = parse_toml(content, name);
  for (const std::string& assignment : overrides) apply_override(root, assignment);
  check_and_complete(root, pack_file_spec());
  PackCase result;
  result.title = text(root, "title");
  TomlValue& packing = *root.find("packing");
  PackingOptions& options = result.packing;
  options.method = enum_from<PackingMethod>(text(packing, "method"));
  options.seed = static_cast<std::uint64_t>(packing.find("seed")->integer);
  options.overlap = number(packing, "overlap");
  options.attempts = packing.find("attempts")->integer;
  options.shape = read_shape(*packing.find("shape"));
  TomlValue* radii = packing.find("radii");
  if (radii == nullptr)
    fail_at(packing, "packing", "the table [packing.radii] is missing", "it says how large the discs are", "Add it");
  read_amount(packing, read_sizes(*radii, folder), options);
  options.settling = read_settling(*root.find("settling"));
  options.settling.density = number(packing, "density");
  options.settling.springs = read_springs(*root.find("springs"), options.settling.density);
  if (const TomlValue* region = packing.find("region")) {
    const auto& items = region->items;
    result.region = Region{{items[0].real, items[1].real}, {items[2].real, items[3].real}};
  }
  const TomlValue& output = *root.find("output");
  result.csv = flag(output, "csv");
  result.picture = flag(output, "picture");
  result.document = std::move(root);
  return result;
}

PackCase read_pack_case(const fs::path& path, std::span<const std::string> overrides) {
  return parse_pack_case(read_file(path), path.string(), path.parent_path(), overrides);
}

}  // namespace equidem
