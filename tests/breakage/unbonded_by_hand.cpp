// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts without bonds against closed forms.
#include <cmath>
#include <string>
#include <vector>

#include "equidem/core/error.hpp"

#include "breakage/tied_disc.hpp"
#include "breakage/unbonded_scenes.hpp"
#include "support/assemblies.hpp"
#include "support/catch.hpp"

using namespace equidem;
using namespace equidem::test;

namespace {

constexpr double normal_spring = 1000, tangential_spring = 300;
const ContactSprings stiff_and_soft(SpringConstants{normal_spring, tangential_spring});

/// A disc on a held one, pressed on it by 1 N/m and pushed sideways by lambda.
Unbonded on_the_ground(double friction, std::vector<double> legs) {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", {}, {}, 0}};
  options.dead_loads = {{"last", LoadKind::per_disc, {-1, 0}, 0}};
  options.loads = {{"last", LoadKind::per_disc, {0, 1}, 0}};
  options.control = LoadControl::load;
  options.legs = std::move(legs);
  return {chain_of_discs(2, 1), stiff_and_soft, options, friction};
}

/// The disc of on_the_ground, moved sideways to and fro by 1 mm.
Unbonded to_and_fro(double friction, double tension, double shear, std::vector<double> legs) {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", {}, 1e-3, 0}};
  options.dead_loads = {{"last", LoadKind::per_disc, {-1, 0}, 0}};
  options.control = LoadControl::motion;
  options.legs = std::move(legs);
  const Assembly pair = chain_of_discs(2, 1);
  return {pair, stiff_and_soft, equal_strengths(pair, tension, shear), options, {friction, {}}};
}

std::vector<std::string> modes_of(const Unbonded& scene) {
  std::vector<std::string> modes;
  for (const BreakEvent& event : scene.events()) modes.push_back(to_string(event.mode));
  return modes;
}

std::string refusal(const ContactSprings& springs, LoadPathOptions options, double friction) {
  options.supports = {{"first", 0, 0, 0}, {"last", {}, {}, 0}};
  options.loads = {{"last", LoadKind::per_disc, {-1, 0}, 0}};
  try {
    Unbonded(chain_of_discs(2, 1), springs, options, friction).all();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a_disc_slips_where_the_tangent_of_the_slope_is_the_friction") {
  for (const double friction : {0.1, 0.5, 3.0, 10.0}) {
    CAPTURE(friction);
    Unbonded disc = on_the_ground(friction, {20});
    disc.all();
    REQUIRE(disc.events().size() == 1);
    CHECK(disc.event(0).mode == BreakMode::slip);
    CHECK(disc.event(0).lambda == Approx(friction).epsilon(1e-12));
    CHECK(disc.event(0).motion == Approx(friction / tangential_spring).epsilon(1e-12));
    CHECK(disc.run().end() == PathEnd::load_moves_part);
    CHECK_THAT(disc.run().why(), Catch::Contains("nothing resists"));
  }
  Unbonded smooth = on_the_ground(0, {20});
  CHECK(smooth.all().events().empty());
  CHECK(smooth.run().end() == PathEnd::load_moves_part);
}

TEST_CASE("a_load_below_the_limit_of_friction_goes_to_and_fro_without_slip") {
  Unbonded disc = on_the_ground(0.5, {0.4, -0.4, 0.4});
  disc.all();
  CHECK(disc.events().empty());
  CHECK(disc.run().end() == PathEnd::legs_done);
  CHECK(disc.run().ledger().friction == 0);
  CHECK(disc.run().energy_error() < 1e-12);
}

TEST_CASE("to_and_fro_a_contact_loses_the_area_of_its_loop") {
  // Slip begins where kT u = mu N; the loop of a cycle of the amplitude A has the area 4 mu N (A - mu N/kT).
  const double friction = 0.1, amplitude = 1e-3, slip = amplitude - friction / tangential_spring;
  Unbonded disc = to_and_fro(friction, 0, 0, {1, -1, 1, -1, 1});
  disc.all();
  CHECK(modes_of(disc) ==
        std::vector<std::string>{"slip", "stick", "slip", "stick", "slip", "stick", "slip", "stick", "slip"});
  CHECK(disc.event(0).lambda == Approx(friction / (tangential_spring * amplitude)).epsilon(1e-12));
  CHECK(disc.event(2).lambda == Approx(1 - 2 * friction / (tangential_spring * amplitude)).epsilon(1e-12));
  CHECK(disc.run().ledger().friction == Approx(friction * slip * (1 + 4 * 2)).epsilon(1e-12));
  CHECK(disc.event(8).friction - disc.event(4).friction == Approx(4 * friction * slip).epsilon(1e-12));
  CHECK(disc.run().energy_error() < 1e-12);
}

TEST_CASE("a_bond_that_breaks_in_shear_goes_on_with_friction") {
  const double friction = 0.1, shear = 0.2;
  Unbonded disc = to_and_fro(friction, 5, shear, {1, 0});
  disc.all();
  CHECK(modes_of(disc) == std::vector<std::string>{"shear", "stick", "slip"});
  CHECK(disc.event(0).lambda == Approx(shear / (tangential_spring * 1e-3)).epsilon(1e-12));
  CHECK(disc.event(0).load == Approx(shear).epsilon(1e-12));
  CHECK(disc.event(0).energy_released ==
        Approx((shear * shear - friction * friction) / (2 * tangential_spring)).epsilon(1e-12));
  CHECK(disc.event(1).load == Approx(friction).epsilon(1e-12));
  CHECK(disc.run().energy_error() < 1e-12);
}

TEST_CASE("a_bond_without_tension_strength_breaks_at_the_start_and_the_path_goes_on") {
  // between two held discs the middle one goes by lambda against the right one alone
  Assembly chain = chain_of_discs(3, 1);
  chain.groups["middle"] = {{1}, {}};
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"middle", {}, 0, 0}, {"last", 0, 0, 0}};
  options.loads = {{"middle", LoadKind::per_disc, {1, 0}, 0}};
  options.control = LoadControl::load;
  options.legs = {10};
  ContactStrengths strengths = equal_strengths(chain, 1e3, 1e3);
  strengths.tension[0] = 0;
  Unbonded disc(chain, stiff_and_soft, strengths, options, {0.3, {}});
  disc.all();
  CAPTURE(disc.run().why(), modes_of(disc));
  CHECK(modes_of(disc) == std::vector<std::string>{"tension"});
  CHECK(disc.event(0).lambda == 0);
  CHECK(disc.event(0).contact == 0);
  CHECK(disc.run().end() == PathEnd::legs_done);
  CHECK(disc.run().leg_points().back().load == Approx(10).epsilon(1e-12));
  CHECK(disc.run().leg_points().back().motion == Approx(10 / normal_spring).epsilon(1e-12));
}

TEST_CASE("a_gap_closes_where_the_disc_has_crossed_it") {
  // The middle of three discs hangs on a bond and meets the other one behind a gap: from there on both resist.
  const double gap = 2e-3;
  Assembly chain = chain_of_discs(3, 1);
  chain.groups["middle"] = {{1}, {}};
  ContactStrengths strengths = equal_strengths(chain, 0, 0);
  strengths.tension[0] = strengths.shear[0] = 1e9;
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", 0, 0, 0}, {"middle", {}, 0, 0}};
  options.loads = {{"middle", LoadKind::per_disc, {1, 0}, 0}};
  options.control = LoadControl::load;
  options.legs = {2 * normal_spring * gap, 0};
  Unbonded walls(chain, stiff_and_soft, strengths, options, {0.3, {{0, 0}, {normal_spring * gap, 0}}});
  walls.all();
  CHECK(modes_of(walls) == std::vector<std::string>{"close", "open"});
  for (const BreakEvent& event : walls.events()) {
    CHECK(event.lambda == Approx(normal_spring * gap).epsilon(1e-12));
    CHECK(event.motion == Approx(gap).epsilon(1e-12));
  }
  CHECK(walls.run().leg_points()[1].motion == Approx(1.5 * gap).epsilon(1e-12));
  CHECK(walls.run().energy_error() < 1e-12);
  options.legs = {2 * normal_spring * gap};
  Unbonded closed(chain, stiff_and_soft, strengths, options, {0.3, {{0, 0}, {normal_spring * gap, 0}}});
  closed.all();
  CHECK(closed.run().load_left(1.2 * gap) == Approx(1.4 * normal_spring * gap).epsilon(1e-12));
}

TEST_CASE("loads_under_control_of_their_motion_fall_as_a_bond_lets_go") {
  // A load between two springs in a row with a bond of its own beside: the motion goes on as the bond breaks, and the
  // load falls to what the unbonded contact that is pulled no longer carries.
  const double tension = 2;
  Assembly chain = chain_of_discs(3, 1);
  chain.groups["middle"] = {{1}, {}};
  ContactStrengths strengths = equal_strengths(chain, 1e9, 1e9);
  strengths.tension[0] = tension;
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", 0, 0, 0}, {"middle", {}, 0, 0}};
  options.loads = {{"middle", LoadKind::per_disc, {1, 0}, 0}};
  options.control = LoadControl::motion;
  options.legs = {8, 0};
  Unbonded pulled(chain, stiff_and_soft, strengths, options, {0.3, {}});
  pulled.all();
  CHECK(modes_of(pulled).front() == "tension");
  CHECK(pulled.event(0).load == Approx(2 * tension).epsilon(1e-12));
  CHECK(pulled.event(0).motion == Approx(tension / normal_spring).epsilon(1e-12));
  // With the bond both springs resist the motion, behind it one: the load at the end of the leg follows from it.
  const LegPoint end = pulled.run().leg_points()[1];
  CHECK(end.lambda == Approx(8).epsilon(1e-12));
  CHECK(end.motion == Approx(8 / normal_spring).epsilon(1e-12));
  CHECK(pulled.run().ledger().released == Approx(tension * tension / (2 * normal_spring)).epsilon(1e-12));
  CHECK(pulled.run().energy_error() < 1e-12);
  options.control = LoadControl::load;
  Unbonded held(chain, stiff_and_soft, strengths, options, {0.3, {}});
  held.all();
  // Where the load is held the energy of its further motion is released too.
  CHECK(held.run().ledger().released == Approx(2 * tension * tension / (2 * normal_spring)).epsilon(1e-12));
}

TEST_CASE("the_gap_to_the_next_bond_is_one_of_lambda_whatever_leg_it_is_on") {
  Assembly chain = chain_of_discs(3, 1);
  chain.groups["middle"] = {{1}, {}};
  ContactStrengths strengths = equal_strengths(chain, 2, 1e9);
  strengths.tension[1] = 3;
  LoadPathOptions options;
  options.supports = {{"middle", 0, 0, 0}, {"first", {}, 0, 0}, {"last", {}, 0, 0}};
  options.loads = {{"first", LoadKind::per_disc, {-1, 0}, 0}, {"last", LoadKind::per_disc, {1, 0}, 0}};
  options.control = LoadControl::load;
  options.legs = {1, 10};
  Unbonded pulled(chain, stiff_and_soft, strengths, options, {0.3, {}});
  pulled.all();
  REQUIRE(!pulled.events().empty());
  CHECK(pulled.event(0).lambda == Approx(2).epsilon(1e-12));
  CHECK(pulled.event(0).gap == Approx(0.5).epsilon(1e-12));
}

TEST_CASE("forces_at_rest_beyond_friction_are_refused") {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", {}, {}, 0}};
  options.loads = {{"last", LoadKind::per_disc, {-1, 0}, 0}};
  options.control = LoadControl::load;
  const Assembly pair = chain_of_discs(2, 1);
  const auto with = [&](ContactForce rest) {
    Unbonded(pair, stiff_and_soft, equal_strengths(pair, 0, 0), options, {0.5, {rest}});
  };
  CHECK_NOTHROW(with({-2, 0.99}));
  CHECK_THROWS_WITH(with({-2, 1.01}), Catch::Contains("carries |T| up to 1 N/m"));
  CHECK_THROWS_WITH(with({2, 0.1}), Catch::Contains("no bond"));
}

TEST_CASE("a_disc_in_a_wedge_sticks_or_slips_at_once") {
  for (const double angle : {0.5, 0.9, 1.2}) {
    for (const double friction : {0.0, 0.1, 0.3, 10.0}) {
      CAPTURE(angle, friction);
      Assembly wedge;
      const double c = std::cos(angle), s = std::sin(angle);
      wedge.centres = {{-2 * c, -2 * s}, {2 * c, -2 * s}, {0, 0}};
      wedge.radii.assign(3, 1.0);
      wedge.contacts = {{0, 2, 0, 0, 1, 1}, {1, 2, 0, 0, 1, 1}};
      wedge.groups["walls"] = {{0, 1}, {}};
      wedge.groups["disc"] = {{2}, {}};
      LoadPathOptions options;
      options.supports = {{"walls", 0, 0, 0}};
      options.loads = {{"disc", LoadKind::per_disc, {0, -1}, 0}};
      options.control = LoadControl::load;
      options.legs = {1};
      Unbonded scene(wedge, stiff_and_soft, options, friction);
      scene.all();
      REQUIRE(scene.run().end() == PathEnd::legs_done);
      const bool slips = friction > 0 && tangential_spring * c > friction * normal_spring * s;
      const double sticks = 2 * (normal_spring * s * s + tangential_spring * c * c),
                   slides = 2 * normal_spring * s * (s + friction * c);
      CHECK(scene.run().leg_points().back().motion ==
            Approx(1 / (slips || friction == 0 ? slides : sticks)).epsilon(1e-10));
      CHECK(scene.events().size() == (slips ? 2 : 0));
      CHECK(scene.run().energy_error() < 1e-12);
    }
  }
}

TEST_CASE("a_cut_section_in_bending_opens_contact_by_contact") {
  // Two bodies that touch at the heights y_k, pressed by P and bent by lambda: plane sections stay plane, and the
  // contacts that are left carry N_k = -P/m + (P c - lambda) (y_k - c)/I, c their mean height, I = sum (y_k - c)².
  const std::vector<double> heights{-2.5, -1.5, -0.5, 0.5, 1.5, 2.5};
  const double pressed = 6;
  Assembly section;
  section.centres = {{0, 0}, {2, 0}};
  section.radii.assign(2, 1.0);
  for (const double y : heights) {
    section.contacts.push_back({0, 1, 0, 0, 1, 1});
    section.contact_arms.push_back({{1, 0}, y, -y});
  }
  section.groups["first"] = {{0}, {}};
  section.groups["last"] = {{1}, {}};
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}};
  options.dead_loads = {{"last", LoadKind::per_disc, {-pressed, 0}, 0}};
  options.loads = {{"last", LoadKind::per_disc, {0, 0}, 1}};
  options.control = LoadControl::load;
  options.legs = {100};
  Unbonded beam(section, stiff_and_soft, options, 0.4);
  beam.all();
  REQUIRE(beam.events().size() == 5);
  for (std::size_t k = 0; k < 4; ++k) {
    CAPTURE(k);
    double mean = 0, inertia = 0;
    const double m = static_cast<double>(heights.size() - k);
    for (std::size_t p = k; p < heights.size(); ++p) mean += heights[p] / m;
    for (std::size_t p = k; p < heights.size(); ++p) inertia += std::pow(heights[p] - mean, 2);
    CHECK(beam.event(k).mode == BreakMode::open);
    CHECK(beam.event(k).contact == static_cast<std::int64_t>(k));
    CHECK(beam.event(k).lambda ==
          Approx(pressed * mean - inertia * pressed / (m * (heights[k] - mean))).epsilon(1e-10));
  }
  CHECK(beam.run().end() == PathEnd::load_moves_part);  // it turns about the last contact
}

TEST_CASE("a_contact_that_is_pulled_opens") {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", 1e-3, 0, 0}};
  options.control = LoadControl::motion;
  options.legs = {-1, 1, -1};
  Unbonded pair(chain_of_discs(2, 1), stiff_and_soft, options, 0.5);
  pair.all();
  CHECK(modes_of(pair) == std::vector<std::string>{"open", "close"});
  CHECK(pair.event(0).lambda == Approx(0).margin(1e-12));
  CHECK(pair.event(1).lambda == Approx(0).margin(1e-12));
  CHECK(pair.run().leg_points().back().load == Approx(-normal_spring * 1e-3).epsilon(1e-12));
  CHECK(pair.run().end() == PathEnd::legs_done);
}

TEST_CASE("a_disc_has_come_loose_on_contacts_without_a_force_unless_they_carried_one_on_the_last_way") {
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", 1e-3, 0, 0}};
  options.control = LoadControl::motion;
  const Assembly chain = chain_of_discs(3, 1);
  struct Way {
    std::vector<double> legs;
    bool bonded;  // the first contact
    std::vector<std::int32_t> loose;
  };
  for (const Way& way : {Way{{-1}, false, {}}, Way{{-1, 0}, false, {}}, Way{{-1, 1}, false, {1}},
                         Way{{-1, 1, -1}, false, {}}, Way{{-1, 0}, true, {}}, Way{{-1, 1}, true, {1}}}) {
    options.legs = way.legs;
    ContactStrengths strengths = equal_strengths(chain, 0, 0);
    if (way.bonded) strengths.tension[0] = strengths.shear[0] = 1e9;
    Unbonded path(chain, stiff_and_soft, strengths, options, {0.3, {}});
    path.all();
    CAPTURE(way.legs, way.bonded, path.run().why());
    CHECK(path.run().end() == PathEnd::legs_done);
    CHECK(path.run().loose() == way.loose);
    if (way.bonded) CHECK(path.run().untouched().empty());
  }
}

TEST_CASE("a_disc_between_two_bonds_almost_in_line_is_held_by_what_they_lack_to_the_line") {
  // Across the bonds, which have no tangential spring, the disc at the height h has the stiffness 2 kN h², of about
  // what numerical methods hold loose discs with.
  LoadPathOptions options;
  options.supports = {{"first", 0, 0, 0}, {"last", 0, 0, 0}};
  options.loads = {{"middle", LoadKind::per_disc, {0, -1e-9}, 0}};
  options.control = LoadControl::load;
  options.legs = {1};
  for (const double share : {1e-6, 1e-8, 1e-9, 5.5e-10, 3e-10}) {
    Assembly scene = chain_of_discs(3, 0.5);
    const double h = std::sqrt(share / 2);
    scene.centres[1].y = h;
    scene.groups["middle"] = {{1}, {}};
    Unbonded path(scene, ContactSprings(SpringConstants{normal_spring, 0}), equal_strengths(scene, 1e9, 1e9), options,
                  {0.3, {}});
    path.all();
    CAPTURE(share, path.run().why(), path.run().contact_state().relative_residual());
    CHECK(path.run().end() == PathEnd::legs_done);
    CHECK(path.run().contact_state().relative_residual() < 1e-12);
    const double along = 1e-9 / (2 * h / std::sqrt(1 + h * h));  // N of each bond balances half of the load
    for (const ContactForce& f : path.run().contact_state().forces()) CHECK(f.normal == Approx(-along).epsilon(1e-9));
  }
}

TEST_CASE("a_path_ends_where_friction_leaves_no_answer") {
  // The tied disc slips on the other as on the ground: its slip away from the spring takes it off the ground, so that
  // beyond mu = 1 (Klarbring's condition mu kN |c| > b (kN + a) - c², a = b = c = k/2 of the oblique spring) the
  // stiffness against slip is negative, and at the limit there is no answer onward.
  for (const double friction : {0.5, 2.0}) {
    for (const double side : {1.0, -1.0}) {
      LoadPathOptions options;
      options.supports = TiedDisc::supports();
      options.dead_loads = {{"disc", LoadKind::per_disc, {-1, 0}, 0}};
      options.loads = {{"disc", LoadKind::per_disc, {0, side}, 0}};
      options.control = LoadControl::load;
      options.legs = {100};
      Unbonded onward(TiedDisc::assembly(), TiedDisc::springs(), TiedDisc::strengths(), options, {friction, {}});
      onward.all();
      CAPTURE(friction, side, onward.run().why(), onward.run().lambda());
      const bool answered = friction < 1 || side > 0;
      CHECK((onward.run().end() == PathEnd::no_answer) == !answered);
      if (!answered) CHECK_THAT(onward.run().why(), Catch::Contains("no consistent contact state found"));
    }
  }
}

TEST_CASE("what_has_no_meaning_without_bonds_is_refused") {
  LoadPathOptions options;
  options.control = LoadControl::load;
  CHECK_THAT(refusal(ContactSprings(SpringConstants{normal_spring, -20}), options, 0.5), Catch::Contains("kT < 0"));
  CHECK_THAT(refusal(stiff_and_soft, options, -1), Catch::Contains("friction"));
  options.control = LoadControl::path;
  CHECK_THAT(refusal(stiff_and_soft, options, 0.5), Catch::Contains("depends on the path"));
  // Without tangential springs contacts carry no friction.
  options.control = LoadControl::load;
  options.legs = {1};
  CHECK(refusal(ContactSprings(SpringConstants{normal_spring, 0}), options, 0.5).empty());
}
