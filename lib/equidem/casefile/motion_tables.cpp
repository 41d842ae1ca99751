// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/casefile/motion_tables.hpp"

#include "equidem/core/names.hpp"

namespace equidem::casefile {

std::vector<Key<ScheduleTable>> schedule_keys() {
  const std::vector<std::string> ramp = {"ramp"}, sine = {"sine"}, waves = {"ramp", "sine"}, table = {"table"};
  using T = ScheduleTable;
  return {
      key("name", &T::name, required, "for schedule = of [[support]], [[load]], [[wall]]"),
      key("kind", &T::schedule, &Schedule::kind, required,
          "ramp: smooth, from 0 at start to value at end; sine: value sin(2 pi frequency (t - start)), 0 before start; "
          "table: straight between points, constant outside"),
      key("value", &T::schedule, &Schedule::value, when("kind", waves)),
      key("start", &T::schedule, &Schedule::start, unit("s"), when("kind", waves)),
      key("end", &T::schedule, &Schedule::end, required, unit("s"), when("kind", ramp), "after start"),
      key("frequency", &T::schedule, &Schedule::frequency, required, unit("Hz"), positive, when("kind", sine)),
      key("times", &T::schedule, &Schedule::times, optional, unit("s"), when("kind", table),
          "ascending; with values, or give path"),
      key("values", &T::schedule, &Schedule::values, optional, when("kind", table), "one for each time"),
      key("path", &T::path, when("kind", table),
          "a CSV file with two columns, time and value, instead of times and values")};
}

std::vector<Key<WallTable>> wall_keys(BodyFamily family) {
  using T = WallTable;
  using W = Wall;
  const bool colliding = family == BodyFamily::colliding;
  const auto of = [&](std::vector<std::string> shapes) {
    return colliding ? when("shape", std::move(shapes)) : when({}, {});
  };
  std::vector<Key<T>> keys = {
      key("name", &T::wall, &W::name, required, colliding ? "for reports, and for [[collisions.pair]]" : "for reports"),
      key("point", &T::wall, &W::point, required, unit("m"), of({"line", "segment"}),
          colliding ? "on the line; the first end of the segment" : "on the wall, a straight line"),
      key("normal", &T::wall, &W::normal, required, of({"line"}),
          "towards the bodies, of any length; all bodies are on that side")};
  if (colliding) {
    const auto segment = of({"segment"}), arc = of({"arc"});
    keys.insert(keys.begin() + 1,
                key("shape", &T::wall, &W::shape,
                    "line: endless, bodies on one side; segment, arc: thin, with two sides and two ends"));
    keys.insert(keys.end(), {key("end", &T::wall, &W::end, required, unit("m"), segment),
                             key("centre", &T::wall, &W::point, required, unit("m"), arc),
                             key("radius", &T::wall, &W::radius, required, unit("m"), positive, arc),
                             key("from", &T::wall, &W::from, unit("rad"), arc, "counter-clockwise from here ..."),
                             key("to", &T::wall, &W::to, unit("rad"), arc, "... to here"),
                             key("shaken", &T::shaken, optional, "false: [shaking] does not move it")});
  } else {
    keys.push_back(key("kN", &T::wall, &W::kN, required, unit("Pa"), positive,
                       "spring that pushes discs out; there is no friction"));
  }
  keys.insert(keys.end(), {key("displacement", &T::displacement, unit("m"), "along direction, times the schedule"),
                           key("direction", &T::direction, "of any length; left out: the normal of a line"),
                           key("schedule", &T::schedule, "schedule of the displacement")});
  return keys;
}

std::vector<Key<Probe>> probe_keys(BodyFamily family) {
  using enum ProbeQuantity;
  const std::vector<ProbeQuantity> own = family == BodyFamily::bonded
                                             ? std::vector{displacement, velocity, rotation, spin}
                                             : std::vector{position, velocity, angle, spin};
  std::vector<std::string> words;
  for (const ProbeQuantity quantity : own) words.push_back(to_string(quantity));
  const auto first = [&](KeySpec& key) { key.fallback = default_text(std::vector{own.front()}); };
  return {key("name", &Probe::name, required, "begins the names of its columns"),
          key("group", &Probe::group, optional, "a group; or give bodies"),
          key("bodies", &Probe::bodies, optional, formerly("grains"), "counted from 0; those of a file first"),
          key("quantities", &Probe::quantities, choices(std::move(words)), first,
              "the means over these bodies; the energies of the whole scene are in every history")};
}

}  // namespace equidem::casefile
