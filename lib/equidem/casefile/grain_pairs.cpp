// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/grain_pairs.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "equidem/casefile/engine/read_value.hpp"

namespace equidem {
using namespace casefile;
namespace {

constexpr std::array ways_to_stiffness = {"stiffness",       "dimensionless_stiffness", "contact_duration",
                                          "largest_overlap", "young_modulus",           "shear_wave_speed"};

StiffnessOptions stiffness_by(std::string_view key, double value, const TomlValue& table, double density) {
  if (key == "stiffness") return SpringStiffness{value};
  if (key == "dimensionless_stiffness") return DimensionlessStiffness{value};
  if (key == "contact_duration") return ContactDuration{value};
  if (key == "largest_overlap") return LargestOverlap{value};
  const double poisson = number(table, "poisson_ratio");
  if (key == "young_modulus") return HertzModuli{value, poisson};
  return WaveSpeedStiffness{density, value, poisson};
}

/// `options` with those that a table gives instead.
PairOptions with(PairOptions options, const TomlValue& table, const std::string& name, double density = 0) {
  if (const TomlValue* h = table.find("damping")) {
    if (table.find("restitution") != nullptr)
      fail_at(*h, name + ".damping", "restitution and damping are both given", "each says how strong the dashpot is",
              "Remove one of them");
    options.rebound = DashpotDamping{h->real};
  }
  if (const TomlValue* e = table.find("restitution")) options.rebound = Restitution{e->real};
  const char* by = nullptr;
  for (const char* way : ways_to_stiffness) {
    const TomlValue* found = table.find(way);
    if (found == nullptr) continue;
    if (by != nullptr)
      fail_at(*found, fmt::format("{}.{}", name, way), fmt::format("{} and {} are both given", by, way),
              "each says how stiff a contact is", "Remove one of them");
    by = way;
    options.stiffness = stiffness_by(way, found->real, table, density);
  }
  if (const TomlValue* end = table.find("contact_end")) options.contact_end = enum_from<ContactEnd>(end->text);
  options.closing_speed = optional_number(table, "closing_speed").value_or(options.closing_speed);
  options.friction = optional_number(table, "friction").value_or(options.friction);
  if (const auto ratio = optional_number(table, "tangential_ratio")) options.tangential_ratio = ratio;
  if (const auto zeta = optional_number(table, "tangential_damping")) options.tangential_damping = zeta;
  if (const TomlValue* cap = table.find("friction_cap"))
    options.friction_cap = cap->text == "whole_force" ? FrictionCap::whole_force : FrictionCap::spring_alone;
  return options;
}

/// Keys of [collisions] that belong together are given together, and those that exclude one another are not.
void check_moduli(const TomlValue& table, const GrainCase& result) {
  const TomlValue* young = table.find("young_modulus");
  const TomlValue* shear = table.find("shear_wave_speed");
  const TomlValue* poisson = table.find("poisson_ratio");
  if (young == nullptr && shear == nullptr) {
    if (poisson == nullptr) return;
    const bool hertz = describe(result.options.law).hertz_spring;
    fail_at(*poisson, "collisions.poisson_ratio",
            fmt::format("poisson_ratio is given without {}", hertz ? "young_modulus" : "shear_wave_speed"),
            "both make the stiffness of a contact",
            hertz ? "Add young_modulus = ... in Pa" : "Add shear_wave_speed = ... in m/s");
  }
  const TomlValue& given = young != nullptr ? *young : *shear;
  const char* name = young != nullptr ? "young_modulus" : "shear_wave_speed";
  if (poisson == nullptr)
    fail_at(given, fmt::format("collisions.{}", name), fmt::format("{} is given without poisson_ratio", name),
            "both make the stiffness of a contact", "Add poisson_ratio = ...");
  if (shear == nullptr) return;
  if (const TomlValue* ratio = table.find("tangential_ratio"))
    fail_at(*ratio, "collisions.tangential_ratio", "tangential_ratio and shear_wave_speed are both given",
            "each says how stiff the tangential spring is", "Remove one of them");
  const auto [least, most] = std::ranges::minmax(result.densities);
  if (least < most && result.body == Body::disc)
    fail_at(given, "collisions.shear_wave_speed",
            fmt::format("the grains have densities from {} to {} kg/m³", least, most),
            "springs of wave speeds belong to one density",
            "Give one density, or stiffness and tangential_ratio for each pair");
}

/// The error of set_kinds with the line and the key of its option: "walls.stiffness", "pairs.2.with".
[[noreturn]] void fail_at_option(const Error& error, const TomlValue& collisions) {
  std::string_view option = error.where();
  std::string name = "collisions";
  std::vector<const TomlValue*> tables{&collisions};  // the first that has the key is at fault
  if (option.starts_with("pairs.")) {
    std::size_t k = 0;
    option.remove_prefix(6);
    const char* after = std::from_chars(option.data(), option.data() + option.size(), k).ptr;
    option.remove_prefix(static_cast<std::size_t>(after - option.data()));
    if (option.starts_with('.')) option.remove_prefix(1);
    tables.insert(tables.begin(), &repeated(collisions, "pair")[k]);
    if (const TomlValue* walls = collisions.find("walls")) tables.insert(tables.begin() + 1, walls);
    name += ".pair";
  } else if (option.starts_with("walls")) {
    option.remove_prefix(std::min<std::size_t>(6, option.size()));
    tables.insert(tables.begin(), collisions.find("walls"));
    name += ".walls";
  }
  if (option == "group" && tables.size() == 1) name = "grain";
  const TomlValue* at = tables.front();
  for (auto table = tables.rbegin(); table != tables.rend(); ++table)
    if (const TomlValue* value = (*table)->find(option)) at = value;
  if (!option.empty()) name += '.' + std::string(option);
  fail_at(*at, name, error.problem(), error.why(), error.remedy());
}

}  // namespace

void read_collisions(const TomlValue& root, const std::vector<std::string>& groups, GrainCase& result) {
  const TomlValue& table = *root.find("collisions");
  check_moduli(table, result);
  CollisionOptions options{.body = result.body};
  options.bodies = with({}, table, "collisions", result.densities.front());
  PairOptions walls = options.bodies;
  if (const TomlValue* differs = table.find("walls")) options.walls = walls = with(walls, *differs, "collisions.walls");
  for (const TomlValue& pair : repeated(table, "pair")) {
    const std::string& group = text(pair, "group");
    const std::string& other = text(pair, "with");
    const bool on_wall = std::ranges::find(groups, other) == groups.end();
    options.pairs.push_back({group, other, with(on_wall ? walls : options.bodies, pair, "collisions.pair")});
  }
  try {
    result.contacts = set_kinds(result.scene, groups, options, result.options.law);
  } catch (const Error& error) {
    fail_at_option(error, table);
  }
}

}  // namespace equidem
