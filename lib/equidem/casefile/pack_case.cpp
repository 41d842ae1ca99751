// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/pack_case.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/casefile/keys.hpp"
#include "equidem/casefile/pack_keys.hpp"
#include "equidem/casefile/read_value.hpp"
#include "equidem/core/file.hpp"
#include "equidem/material/wave_speed_springs.hpp"
#include "equidem/packing/size_distribution.hpp"

namespace equidem {
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

/// Box and radii from two of grains, box and solid_fraction.
void read_amount(const TomlValue& table, const SizeDistribution& sizes, PackingOptions& options) {
  const TomlValue* grains = table.find("grains");
  const TomlValue* box = table.find("box");
  const TomlValue* fraction = table.find("solid_fraction");
  const bool falls = entry_of(options.method).open_top;
  options.box.sides = falls                                ? PackingBox::Sides::open_top
                      : text(table, "sides") == "periodic" ? PackingBox::Sides::periodic
                                                           : PackingBox::Sides::walls;
  if (falls && text(table, "sides") == "periodic")
    fail_at(*table.find("sides"), "packing.sides", "bodies fall into a periodic box", "they would fall for ever",
            "Take walls, or another method");
  const bool dense = fraction != nullptr && !fraction->is_number();
  if (falls && fraction != nullptr)
    fail_at(*fraction, "packing.solid_fraction", "a solid fraction is wanted of falling bodies",
            "it comes about by itself, lower with more friction", "Remove it");
  if (dense && !entry_of(options.method).as_dense_as_possible)
    fail_at(*fraction, "packing.solid_fraction", fmt::format("auto with {}", to_string(options.method)),
            "the method has no end without a wanted solid fraction", "Give a number, or take growth");
  const int given = (grains != nullptr) + (box != nullptr) + (fraction != nullptr && !dense);
  if (given != 2) {
    fail_at(table, "packing",
            given > 2 ? "grains, box and solid_fraction are all given" : "it is not said how much is packed",
            falls || dense ? "grains and box say it" : "two of grains, box and solid_fraction say it",
            given > 2 ? "Remove one of them" : "Give two of them");
  }
  Random random(~options.seed);  // sizes are independent of places
  if (box != nullptr) {
    options.box.size = vector(table, "box");
    if (!(options.box.size.x > 0 && options.box.size.y > 0))
      fail_at(*box, "packing.box", "the box has no area", "width and height are positive", "Correct it");
  }
  const double mean_area = unit_body_of(options.shape).area * moments_of(sizes).mean_square;
  std::int64_t count = 0;
  if (grains != nullptr) {
    count = grains->integer;
  } else {
    const double wanted = std::round(fraction->real * options.box.area() / mean_area);
    if (!(wanted >= 1 && wanted <= 1e7))
      fail_at(*box, "packing.box", fmt::format("{:.3g} bodies would fill the box", wanted), "they are 1 to 1e7",
              "Change the box or the radii");
    count = static_cast<std::int64_t>(wanted);
  }
  options.radii = draw_radii(sizes, count, random);
  // What drawing leaves open: a box for the bodies, or radii for the box, to the last bit of the solid fraction.
  if (box == nullptr) {
    const double side = std::sqrt(area_of(options.shape, options.radii) / fraction->real);
    options.box.size = {side, side};
  } else if (grains == nullptr) {
    const double scale = std::sqrt(fraction->real * options.box.area() / area_of(options.shape, options.radii));
    for (double& radius : options.radii) radius *= scale;
  }
  options.as_dense_as_possible = dense;
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
