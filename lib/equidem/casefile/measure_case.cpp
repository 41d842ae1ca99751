// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/measure_case.hpp"

#include "equidem/casefile/engine/read_value.hpp"

namespace equidem {
using namespace casefile;

std::vector<KeySpec> measure_keys() {
  using enum KeyType;
  constexpr const char* none = KeySpec::none;
  return {
      {.table = "measures",
       .name = "region",
       .type = box,
       .unit = "m",
       .fallback = none,
       .help =
           "[x_min, y_min, x_max, y_max] in which the void ratio is measured; it goes with the shaking box. Left out: "
           "the box without "
           "two mean diameters at its walls and without three below the lowest place of the surface, at each moment"},
      {.table = "measures",
       .name = "columns",
       .type = whole,
       .fallback = none,
       .range = Range::from(2, 10000),
       .help = "in which the highest points make the surface; left out: two largest diameters wide"},
      {.table = "measures",
       .name = "thrown_gap",
       .type = number,
       .unit = "mean diameters",
       .fallback = "1.0",
       .range = Range::positive(),
       .help = "a body further than that from all others of the heap is thrown"},
      {.table = "measures",
       .name = "cell",
       .type = number,
       .unit = "m",
       .fallback = none,
       .range = Range::positive(),
       .help = "width of the cells of the fields of stress, velocity, solid fraction and coordination at the end, some "
               "bodies "
               "wide; left out: no fields"},
  };
}

MeasureOptions read_measures(const TomlValue& table, Body body) {
  if (body == Body::sphere)
    fail_at(table, "measures", "the bodies are spheres", "areas of the plane say nothing of their volumes",
            "Remove [measures], or take discs");
  MeasureOptions measures;
  if (const TomlValue* region = table.find("region")) {
    const auto& sides = region->items;
    if (!(sides[0].real < sides[2].real && sides[1].real < sides[3].real))
      fail_at(*region, "measures.region", "the region has no area", "its lower left corner comes first",
              "Write it like [0.1, 0.1, 0.9, 0.5]");
    measures.region = Region{{sides[0].real, sides[1].real}, {sides[2].real, sides[3].real}};
  }
  if (const TomlValue* columns = table.find("columns")) measures.columns = static_cast<std::size_t>(columns->integer);
  measures.thrown_gap = number(table, "thrown_gap");
  measures.cell = optional_number(table, "cell");
  return measures;
}

}  // namespace equidem
