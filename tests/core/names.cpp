// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/core/names.hpp"

#include "equidem/core/error.hpp"

#include "support/catch.hpp"

namespace equidem {
namespace {

enum class Fruit { apple, pear, quince };

}  // namespace

template <>
struct EnumNames<Fruit> {
  struct Entry {
    Fruit value;
    const char* name;
    int seeds;
  };
  static constexpr const char* what = "fruit";
  static constexpr Entry list[] = {
      {Fruit::apple, "apple", 5}, {Fruit::pear, "pear", 10}, {Fruit::quince, "quince", 50}};
};

TEST_CASE("names_and_values_of_an_enum_follow_from_one_list") {
  for (const Fruit fruit : {Fruit::apple, Fruit::pear, Fruit::quince}) {
    CAPTURE(to_string(fruit));
    CHECK(enum_from<Fruit>(to_string(fruit)) == fruit);
  }
  CHECK(entry_of(Fruit::quince).seeds == 50);
  CHECK(names_of<Fruit>() == std::vector<std::string>{"apple", "pear", "quince"});
}

TEST_CASE("an_unknown_name_is_refused_with_the_choices_and_the_nearest") {
  CHECK_THROWS_WITH(enum_from<Fruit>("per"),
                    "unknown fruit 'per' (it must be \"apple\", \"pear\" or \"quince\"). Did you mean \"pear\"?");
  CHECK_THROWS_WITH(enum_from<Fruit>("melon"), Catch::Contains("Choose one of them"));
  CHECK_THROWS_AS(enum_from<Fruit>(""), Error);
  CHECK_THROWS_AS(enum_from<Fruit>("Pear"), Error);
}

}  // namespace equidem
