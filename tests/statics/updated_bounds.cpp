// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds by which the search for the contact that breaks next skips parts of a network, against the forces of all
// contacts.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "equidem/core/text.hpp"

#include "statics/breaking_scenes.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

/// Keys of all contacts by the definition.
std::vector<double> keys_by_definition(const BreakingScene& scene, const std::vector<std::vector<ContactForce>>& forces,
                                       const std::vector<std::uint8_t>& gone, const LoadFactorSearch& search) {
  std::vector<double> keys;
  for (std::size_t c = 0; c < forces[0].size(); ++c) {
    const ContactForce dead = forces.size() > 1 ? forces[1][c] : ContactForce{};
    const BreakingMoment moment = breaking_moment({dead, forces[0][c]}, scene.strengths[c], scene.friction, search);
    keys.push_back(gone[c] != 0 ? std::numeric_limits<double>::infinity() : moment.key());
  }
  return keys;
}

}  // namespace

TEST_CASE("no_contact_breaks_before_the_bound_of_the_part_that_it_is_in") {
  std::int64_t bounded = 0, near = 0;
  double nearest = 0;  // bound over key
  for (const BreakingScene& given : breaking_scenes()) {
    for (const int read_every : {1000, 7}) {     // reads of forces bring all parts up to date
      for (const double modulus : {4.0, 1.0}) {  // strengths within a class or two, and in all of them
        BreakingScene scene = given;
        Random random(17);
        for (ContactStrength& s : scene.strengths) {
          const double factor = modulus == 4 ? 1 : std::pow(-std::log(1 - random.uniform()), 0.75);
          s = {s.tension * factor, s.shear * factor};
        }
        UpdatedEquilibrium state = scene.updated();
        std::vector<std::uint8_t> gone(scene.assembly.contacts.size(), 0);
        for (int events = 0; events < 60; ++events) {
          // Parts are told apart by a search from where a control holds the network, too.
          const double from = events % 5 == 4 ? 0.25 * state.critical().moment.t : 0;
          const LoadFactorSearch search{.from = from, .direction = 1, .by_least_load = true};
          const CriticalContact next = state.critical(search);
          if (next.contact < 0) break;
          if (events % 4 == 0) {
            const std::vector<double> bounds = state.least_keys(search);
            const auto forces = anew(scene, state.springs());
            const std::vector<double> keys = keys_by_definition(scene, forces, gone, search);
            double largest = 0;
            for (const ContactForce& f : forces[0])
              largest = std::max({largest, std::abs(f.normal), std::abs(f.tangential)});
            std::size_t above = 0;
            std::string told;
            for (std::size_t c = 0; c < keys.size(); ++c) {
              // Small forces have fewer digits, and some none.
              const double size = std::max(std::abs(forces[0][c].normal), std::abs(forces[0][c].tangential));
              if (size <= 1e-12 * largest) continue;
              if (bounds[c] > keys[c] + (1e-9 + 1e-10 * largest / size) * std::abs(keys[c] + from)) {
                ++above;
                told += fmt::format("{}: {} above {}, force {} of {}; ", c, bounds[c], keys[c], size, largest);
              }
              if (!(bounds[c] > 0) || !std::isfinite(keys[c])) continue;
              const double share = bounds[c] / keys[c];
              if (std::abs(share - 1) < 1e-9) continue;  // up to date
              ++bounded;
              near += share > 0.5 ? 1 : 0;
              nearest = std::max(nearest, share);
            }
            CAPTURE(scene.name, read_every, modulus, events, next.contact, from, told);
            CHECK(above == 0);
          }
          gone[next.contact] = 1;
          if (!is_carried(state.remove(next.contact))) break;
          if (events % read_every == read_every - 1) static_cast<void>(state.forces(0));
        }
      }
    }
  }
  CAPTURE(bounded, near, nearest);
  CHECK(bounded > 10000);
  CHECK(near > 1000);  // bounds that are far off would hide a wrong one
}
