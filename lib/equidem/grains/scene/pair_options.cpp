// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/grains/scene/pair_options.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "equidem/contact/collision_stiffness.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/material/wave_speed_springs.hpp"

namespace equidem {
namespace {

SpringConstants springs_of(const WaveSpeedStiffness& given) {
  if (!(given.poisson_ratio < 0.5))
    bad_input_at("poisson_ratio", fmt::format("poisson_ratio = {} with wave speeds", given.poisson_ratio),
                 "a body that keeps its volume has an infinite speed of pressure waves", "Give less than 0.5");
  return springs_of_wave_speeds(given.density, wave_speeds_from_shear(given.shear_wave_speed, given.poisson_ratio));
}

/// "exact_flow or linear_dashpot": laws with linear spring and dashpot.
std::string linear_laws_with_dashpot() {
  std::vector<std::string> names;
  for (const LawDescription& law : normal_laws())
    if (law.has_dashpot && law.spring_power == 1) names.emplace_back(law.name);
  return listed(std::move(names), " or ");
}

/// Requirements of each way to give the stiffness of a contact.
class StiffnessCheck {
 public:
  StiffnessCheck(const PairOptions& options, const LawDescription& law, Body body)
      : options_(options), law_(law), body_(body), linear_(law.spring_power == 1) {}

  void operator()(std::monostate) const {
    bad_input_at("stiffness", "stiffness is missing", "no default says how stiff contacts are",
                 linear_ ? "Add contact_duration = ... in s, or stiffness, or largest_overlap with closing_speed, "
                           "or shear_wave_speed with poisson_ratio"
                 : law_.hertz_spring
                     ? "Add stiffness, or young_modulus with poisson_ratio, or largest_overlap with closing_speed"
                     : "Add stiffness, or largest_overlap with closing_speed");
  }
  void operator()(SpringStiffness) const {}
  void operator()(DimensionlessStiffness) const {}
  void operator()(ContactDuration) const {
    if (!linear_)
      bad_input_at(
          "contact_duration", fmt::format("contact_duration with {}", law_.name),
          "its contacts last the shorter the faster they are, so that a duration does not give their stiffness",
          fmt::format("Give stiffness, {}or largest_overlap with closing_speed",
                      law_.hertz_spring ? "young_modulus, " : ""));
  }
  void operator()(LargestOverlap) const {
    if (options_.closing_speed == 0)
      bad_input_at("largest_overlap", "largest_overlap is given without closing_speed",
                   "the overlap depends on the speed", "Add closing_speed = ... in m/s");
  }
  void operator()(const HertzModuli&) const {
    if (!law_.hertz_spring)
      bad_input_at("young_modulus", fmt::format("young_modulus with {}", law_.name), "its spring is not that of Hertz",
                   "Give stiffness, or the law hertz_dashpot");
    if (body_ == Body::disc)
      bad_input_at("young_modulus", "the bodies are discs", "the stiffness by Hertz is that of spheres",
                   "Write body = \"sphere\" in [grains], or give stiffness");
  }
  void operator()(const WaveSpeedStiffness&) const {
    if (!linear_)
      bad_input_at("shear_wave_speed", fmt::format("shear_wave_speed with {}", law_.name),
                   "the springs of wave speeds are linear", "Give stiffness, or a law with linear springs");
    if (body_ == Body::sphere)
      bad_input_at("shear_wave_speed", "the bodies are spheres",
                   "springs of wave speeds are those of cylinders, per metre of depth",
                   "Write body = \"disc\" in [grains], or give stiffness");
  }

 private:
  const PairOptions& options_;
  const LawDescription& law_;
  Body body_;
  bool linear_;
};

/// The law and the body have what the options ask for.
void check_use(const PairOptions& options, const LawDescription& law, Body body) {
  if (std::holds_alternative<std::monostate>(options.rebound))
    bad_input_at("restitution", "restitution is missing", "no default says how contacts rebound",
                 "Add restitution = ... from 0 to 1, or damping = ... of the dashpots");
  std::visit(StiffnessCheck(options, law, body), options.stiffness);
  if (!std::holds_alternative<DashpotDamping>(options.rebound)) return;
  if (!law.has_dashpot || law.spring_power != 1)
    bad_input_at("damping", fmt::format("{} has no use for damping", law.name),
                 "it is h of the dashpots 2 h sqrt(m k) of linear springs",
                 "Give restitution, or the law " + linear_laws_with_dashpot());
}

/// The restitution, and zeta of the tangential dashpot where no other is given.
double set_rebound(const ReboundOptions& rebound, const MeetingBodies& bodies, PairProperties& properties) {
  if (const auto* given = std::get_if<Restitution>(&rebound)) {
    properties.restitution = given->value;
    return 0;
  }
  const ContactDamping zeta =
      contact_damping_of(std::get<DashpotDamping>(rebound).value, bodies.on_wall, inertia_factor(bodies.body));
  properties.restitution = restitution_of(zeta.normal, properties.end);
  return zeta.tangential;
}

/// The dashpot that gives the restitution is finite, and floating-point numbers resolve its work.
void check_restitution(NormalLaw law, const PairProperties& pair) {
  constexpr double least = 1e-12;  // a dashpot a million times the critical one
  if (!describe(law).has_dashpot || pair.end == ContactEnd::at_zero_overlap || pair.restitution >= least) return;
  bad_input_at("restitution", fmt::format("restitution = {} for contacts that end at zero force", pair.restitution),
               "it would need an infinite dashpot, or one too strong for numbers to resolve",
               fmt::format("Give {} or more, or the law energy_map", least));
}

void set_friction(const PairOptions& options, NormalLaw law, double tangential_zeta, PairProperties& properties) {
  properties.friction = options.friction;
  if (!(options.friction > 0)) return;
  const auto* waves = std::get_if<WaveSpeedStiffness>(&options.stiffness);
  const double usual = is_map(law) ? 0 : waves != nullptr ? springs_of(*waves).ratio() : 2.0 / 7;
  properties.tangential_ratio = options.tangential_ratio.value_or(usual);
  if (options.tangential_damping) {
    properties.tangential_damping = *options.tangential_damping;
  } else if (properties.tangential_ratio > 0) {
    properties.tangential_damping = tangential_zeta;
  }
  if (gives_force(law) && properties.tangential_ratio == 0)
    bad_input_at("tangential_ratio", "friction is given without a tangential spring",
                 fmt::format("contacts by {} stick by one", to_string(law)),
                 "Give tangential_ratio > 0, such as 2/7, or friction = 0");
  if (properties.tangential_damping > 0 && properties.tangential_ratio == 0)
    bad_input_at("tangential_damping", "tangential damping is given without a tangential spring",
                 "it is measured by that spring", "Give tangential_ratio > 0");
}

/// Sets stiffness, dimensionless or duration of a contact whose other properties are known.
class StiffnessOf {
 public:
  StiffnessOf(NormalLaw law, const MeetingBodies& bodies, PairContact& contact)
      : law_(law), bodies_(bodies), contact_(contact), k_(contact.properties.stiffness) {}

  void operator()(std::monostate) const {}
  void operator()(SpringStiffness given) const { k_ = given.value; }
  void operator()(DimensionlessStiffness given) const { contact_.properties.dimensionless = given.value; }
  void operator()(ContactDuration given) const {
    contact_.duration = given.value;
    const double zeta = damping_ratio(law_, contact_.properties);
    if (zeta >= 1)
      bad_input_at("contact_duration",
                   fmt::format("with restitution {} the contact never comes back to zero overlap",
                               contact_.properties.restitution),
                   fmt::format("its damping ratio is {:.4g}, 1 or more", zeta), "Give stiffness instead");
  }
  void operator()(LargestOverlap given) const {
    k_ = describe(law_).stiffness_from_overlap(given.value, contact_.closing_speed, bodies_.largest_reduced_mass,
                                               damping_ratio(law_, contact_.properties));
  }
  void operator()(const HertzModuli& given) const {
    const double young = given.young_modulus, poisson = given.poisson_ratio;
    k_ = bodies_.on_wall ? hertz_stiffness_on_rigid_wall(young, poisson, bodies_.radius_i)
                         : hertz_stiffness(young, poisson, bodies_.radius_i, young, poisson, bodies_.radius_j);
  }
  void operator()(const WaveSpeedStiffness& given) const { k_ = springs_of(given).kN; }

 private:
  NormalLaw law_;
  const MeetingBodies& bodies_;
  PairContact& contact_;
  double& k_;
};

}  // namespace

PairContact contact_of(const PairOptions& options, NormalLaw law, const MeetingBodies& bodies) {
  check_use(options, describe(law), bodies.body);
  PairContact contact{.properties = {}, .closing_speed = options.closing_speed};
  contact.properties.end = describe(law).usual_end;
  const double tangential_zeta = set_rebound(options.rebound, bodies, contact.properties);
  set_friction(options, law, tangential_zeta, contact.properties);
  check_restitution(law, contact.properties);
  std::visit(StiffnessOf(law, bodies, contact), options.stiffness);
  return contact;
}

PairProperties properties_at(const PairContact& contact, NormalLaw law, double step) {
  PairProperties properties = contact.properties;
  if (contact.duration > 0) {  // the half period of the damped oscillator
    const double zeta = damping_ratio(law, properties);
    const double turn = std::numbers::pi * step / contact.duration;
    properties.dimensionless = turn * turn / (1 - zeta * zeta);
  }
  return properties;
}

double damping_ratio(NormalLaw law, const PairProperties& pair) {
  return describe(law).damping_ratio(pair.restitution, pair.end);
}

}  // namespace equidem
