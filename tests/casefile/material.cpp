// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "equidem/casefile/assembly/build.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/core/file.hpp"
#include "equidem/core/text.hpp"

#include "example.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// A hexagonal block of a material.
std::string block_of(const std::string& material) {
  return "schema = \"equidem/1\"\n[assembly]\nkind = \"hexagonal\"\ncolumns = 4\nrows = 4\nradius = 0.005\n"
         "[material]\n" +
         material;
}

std::string building_error_of(const Case& c) {
  const Assembly assembly = build_assembly(c);
  return test::refusal_of([&] { static_cast<void>(disc_density(c, assembly)); }).message;
}

}  // namespace

TEST_CASE("the_four_ways_to_give_a_material_mean_the_same") {
  const std::string plane = GENERATE(as<std::string>{}, "strain", "stress");
  const double nu = GENERATE(-0.3, 0.0, 0.2);
  const double density = 1800;
  const ElasticModuli m{.shear_modulus = 1.3e9, .poisson_ratio = nu, .plane = enum_from<Plane>(plane)};
  CAPTURE(plane, nu);
  const double K = m.bulk_modulus_2d(), G = m.shear_modulus;
  const std::vector<std::string> ways = {
      fmt::format("shear_modulus = {}\npoisson_ratio = {}\n", G, nu),
      fmt::format("young_modulus = {}\npoisson_ratio = {}\n", m.young_modulus(), nu),
      fmt::format("bulk_modulus_2d = {}\nshear_modulus = {}\n", K, G),
      // lambda + 2G = K + G = gamma Vp², G = gamma Vs²
      fmt::format("p_wave_speed = {}\ns_wave_speed = {}\n", std::sqrt((K + G) / density), std::sqrt(G / density)),
  };
  for (const std::string& way : ways) {
    CAPTURE(way);
    const Case c = parsed(block_of(way + fmt::format("density = {}\nplane = \"{}\"\n", density, plane)));
    REQUIRE(c.material);
    CHECK(c.material->moduli.plane == m.plane);
    CHECK(c.material->moduli.shear_modulus == Approx(G).epsilon(1e-14));
    CHECK(c.material->moduli.poisson_ratio == Approx(nu).epsilon(1e-14).margin(1e-14));
    CHECK(c.material->given.density == density);
  }
}

TEST_CASE("disc_and_bulk_density_differ_by_the_solid_fraction") {
  const std::string material = "shear_modulus = 1.0\npoisson_ratio = 0.1\nplane = \"strain\"\n";
  const Case none = parsed(block_of(material));
  const Assembly assembly = build_assembly(none);
  const double phi = assembly.solid_fraction();
  CAPTURE(phi);
  CHECK_FALSE(disc_density(none, assembly));

  const Case bulk = parsed(block_of(material + "density = 1800.0\n"));
  REQUIRE(disc_density(bulk, assembly));
  CHECK(*disc_density(bulk, assembly) * phi == Approx(1800).epsilon(1e-14));

  CHECK(disc_density(parsed(block_of(material), {"assembly.density=2000"}), assembly) == 2000.0);
  const auto both = [&](double rho) {
    return building_error_of(
        parsed(block_of(material + "density = 1800.0\n"), {fmt::format("assembly.density={}", rho)}));
  };
  CHECK(both(1800 / phi).empty());
  CHECK(both(1800 / phi * (1 + 5e-7)).empty());
  const std::string sentence = both(1800 / phi * (1 + 2e-6));
  CAPTURE(sentence);
  CHECK(sentence.starts_with("a.toml:11: material.density: "));
  CHECK(sentence.find("contradicts") != std::string::npos);
}

TEST_CASE("spheres_have_a_density_of_their_own") {
  const std::string text = block_of("shear_modulus = 1.0\npoisson_ratio = 0.1\nplane = \"strain\"\ndensity = 1800.0\n");
  const Case alone = parsed(text, {"assembly.body=sphere"});
  CHECK(building_error_of(alone).find("Give assembly.density") != std::string::npos);
  const Case given = parsed(text, {"assembly.body=sphere", "assembly.density=2500"});
  CHECK(disc_density(given, build_assembly(given)) == 2500.0);
}
