// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/contact/contact_springs.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

std::string name_of(const Assembly& assembly, std::size_t contact) {
  const Contact& c = assembly.contacts[contact];
  return fmt::format("contact {} (discs {} and {})", contact, c.i, c.j);
}

/// cos 2 theta, sin 2 theta, cos 4 theta, sin 4 theta at the direction of a contact. Odd harmonics of psi vanish: each
/// contact is seen from both of its discs.
std::array<double, 4> harmonics_at(const Assembly& assembly, std::size_t contact) {
  const Vec2 n = frame_of(assembly, contact).normal;
  const double c2 = n.x * n.x - n.y * n.y;
  const double s2 = 2 * n.x * n.y;
  return {c2, s2, c2 * c2 - s2 * s2, 2 * c2 * s2};
}

/// Factors of the springs of the case at each contact.
std::vector<double> weights(const Assembly& assembly, SpringWeighting weighting) {
  using enum SpringWeighting;
  const std::size_t count = assembly.contacts.size();
  if (weighting == voronoi && assembly.facet_lengths.size() != count) {
    bad_input("the weighting \"voronoi\" has no cell edges to weight with",
              "only assemblies made by triangulation have the edges that the cells of two discs share",
              "Use an assembly of kind \"delaunay\", or another weighting");
  }
  std::vector<double> psi;
  if (weighting == local_contact_density) psi = equidem::local_contact_density(assembly);
  if (weighting == contact_density) psi = equidem::contact_density(assembly);
  std::vector<double> weight(count);
  for (std::size_t c = 0; c < count; ++c) {
    if (weighting == voronoi) {
      weight[c] = assembly.facet_lengths[c] / norm(assembly.branch(assembly.contacts[c]));
      if (weight[c] > 0) continue;
      bad_input(fmt::format("the cells share no edge at {}", name_of(assembly, c)),
                "the weighting \"voronoi\" would give it kN = 0", "Move one of the discs, or use another weighting");
    }
    weight[c] = 1 / psi[c];
    if (psi[c] > 0 && weight[c] > 0) continue;
    if (weighting == contact_density) {
      bad_input(fmt::format("the contact density is {:.6g} contacts per radian at {}", psi[c], name_of(assembly, c)),
                "its second and fourth harmonics do not describe so anisotropic an assembly",
                "Use the weighting \"uniform\"");
    }
    bad_input(fmt::format("both discs have three contacts in one direction at {}", name_of(assembly, c)),
              "the weighting \"local_contact_density\" would give it kN = 0",
              "Remove contacts that are given twice, or use another weighting");
  }
  return weight;
}

}  // namespace

std::vector<ContactPrestress> ContactSprings::scaled_prestress(double factor) const {
  std::vector<ContactPrestress> result = prestress_;
  for (ContactPrestress& g : result) {
    for (double* entry : {&g.ns, &g.ni, &g.nj, &g.ss, &g.si, &g.sj, &g.ii, &g.ij, &g.jj}) *entry *= factor;
  }
  return result;
}

void ContactSprings::check_count(std::size_t contacts) const {
  const auto check = [&](std::size_t given, const char* what) {
    if (given == contacts) return;
    bad_input(fmt::format("there are {} of {}, and the assembly has {}", what,
                          counted(static_cast<std::int64_t>(given), "contact"), contacts),
              "each contact has its own", "Give as many, in the order of the contacts");
  };
  if (!uniform()) check(per_contact_.size(), "springs");
  if (bending_.size() > 1) check(bending_.size(), "bending springs");
  if (prestressed()) check(prestress_.size(), "geometric stiffnesses");
}

double ContactSprings::largest() const {
  const auto larger = [](const SpringConstants& k) { return std::max(std::abs(k.kN), std::abs(k.kT)); };
  double result = uniform() ? larger(uniform_) : 0;
  for (const SpringConstants& k : per_contact_) result = std::max(result, larger(k));
  return result;
}

ContactSprings contact_springs(const Assembly& assembly, SpringConstants springs, SpringWeighting weighting) {
  const bool own_kN = !assembly.contact_kN.empty();
  const bool own_kT = !assembly.contact_kT.empty();
  const std::size_t count = assembly.contacts.size();
  assert(!own_kN || assembly.contact_kN.size() == count);
  assert(!own_kT || assembly.contact_kT.size() == count);
  const bool case_is_used = !own_kN || !own_kT;
  if (case_is_used) {
    check(SpringConstants{own_kN ? 1.0 : springs.kN, own_kT ? 0.0 : springs.kT});
    if (weighting == SpringWeighting::uniform && !own_kN && !own_kT) return ContactSprings(springs);
  }

  std::vector<double> weight(count, 1.0);
  if (case_is_used && weighting != SpringWeighting::uniform) weight = weights(assembly, weighting);
  std::vector<SpringConstants> result(count);
  for (std::size_t c = 0; c < count; ++c) {
    result[c] = {own_kN ? assembly.contact_kN[c] : weight[c] * springs.kN,
                 own_kT ? assembly.contact_kT[c] : weight[c] * springs.kT};
    check(result[c], "of " + name_of(assembly, c));
  }
  return ContactSprings(std::move(result));
}

ContactHarmonics contact_harmonics(const Assembly& assembly) {
  ContactHarmonics sum;
  const auto count = static_cast<double>(assembly.contacts.size());
  for (std::size_t contact = 0; contact < assembly.contacts.size(); ++contact) {
    const auto h = harmonics_at(assembly, contact);
    sum.a2 += 2 * h[0] / count;
    sum.b2 += 2 * h[1] / count;
    sum.a4 += 2 * h[2] / count;
    sum.b4 += 2 * h[3] / count;
  }
  return sum;
}

std::vector<double> contact_density(const Assembly& assembly) {
  const ContactHarmonics mean = contact_harmonics(assembly);
  const double psi_mean = assembly.coordination_number() / (2 * std::numbers::pi);
  std::vector<double> psi;
  psi.reserve(assembly.contacts.size());
  for (std::size_t contact = 0; contact < assembly.contacts.size(); ++contact) {
    const auto h = harmonics_at(assembly, contact);
    psi.push_back(psi_mean * (1 + mean.a2 * h[0] + mean.b2 * h[1] + mean.a4 * h[2] + mean.b4 * h[3]));
  }
  return psi;
}

std::vector<double> local_contact_density(const Assembly& assembly) {
  struct Seen {
    double angle;
    std::size_t contact;
  };
  std::vector<std::vector<Seen>> around(assembly.size());
  for (std::size_t contact = 0; contact < assembly.contacts.size(); ++contact) {
    const Vec2 n = frame_of(assembly, contact).normal;
    around[assembly.contacts[contact].i].push_back({std::atan2(n.y, n.x), contact});
    around[assembly.contacts[contact].j].push_back({std::atan2(-n.y, -n.x), contact});
  }
  constexpr double turn = 2 * std::numbers::pi, side = turn / 2 * (1 - 1e-9);
  std::vector<double> angle(assembly.contacts.size(), 0.0);
  for (std::vector<Seen>& contacts : around) {
    std::sort(contacts.begin(), contacts.end(), [](const Seen& a, const Seen& b) { return a.angle < b.angle; });
    const std::size_t count = contacts.size();
    for (std::size_t k = 0; k < count; ++k) {
      const bool first = k == 0, last = k + 1 == count;
      double before = contacts[k].angle - contacts[first ? count - 1 : k - 1].angle + (first ? turn : 0);
      double after = contacts[last ? 0 : k + 1].angle - contacts[k].angle + (last ? turn : 0);
      if (before >= side && after < side) before = after;
      if (after >= side && before < side) after = before;
      angle[contacts[k].contact] += 0.25 * (before + after);  // half of either gap, half of each disc
    }
  }
  for (double& a : angle) a = 1 / a;
  return angle;
}

ContactSprings equal_springs(const ContactSprings& springs, double radius) {
  std::vector<double> bending = springs.bending_springs();
  for (double& kM : bending) kM = kM > 0 ? radius * radius : 0;
  return springs
      .changed([](SpringConstants k) {
        return SpringConstants{k.kN != 0 ? 1.0 : 0.0, k.kT != 0 ? 1.0 : 0.0};
      })
      .with_prestress({})
      .with_bending(std::move(bending));
}

ContactSprings scaled_springs(const ContactSprings& springs, double factor) {
  std::vector<double> bending = springs.bending_springs();
  for (double& kM : bending) kM *= factor;
  return springs.changed([factor](SpringConstants k) {
                  return SpringConstants{factor * k.kN, factor * k.kT};
                })
      .with_prestress(springs.scaled_prestress(factor))
      .with_bending(std::move(bending));
}

double spring_unit(const ContactSprings& springs) {
  const double largest = springs.largest();
  constexpr int least = -1000;  // its inverse does not overflow
  return largest > 0 ? std::ldexp(1.0, std::max(least, std::ilogb(largest))) : 1.0;
}

double spring_spread(const Assembly& assembly, const ContactSprings& springs) {
  double smallest = springs.largest(), stiffest = smallest;
  const double radius = assembly.mean_radius();
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const SpringConstants k = springs[c];
    smallest = std::min(smallest, k.kN);
    if (k.kT != 0) smallest = std::min(smallest, std::abs(k.kT));
    const double kM = springs.bending(c) / (radius * radius);
    if (kM > 0) smallest = std::min(smallest, kM), stiffest = std::max(stiffest, kM);
  }
  return stiffest / smallest;
}

void refuse_spread(double spread) {
  bad_input(fmt::format("the springs differ by a factor of {:.1e}", spread),
            "the softest of them is lost in the round-off of the stiffest",
            "Choose springs within a factor of 1e10 of each other");
}

ContactSprings chosen_springs(const ContactSprings& springs, const std::vector<std::int32_t>& contacts) {
  if (contacts.empty()) return springs.with_prestress({});
  const auto of_chosen = [&](const auto& value) {
    std::vector<std::decay_t<decltype(value(0))>> values;
    values.reserve(contacts.size());
    for (const std::int32_t c : contacts) values.push_back(value(static_cast<std::size_t>(c)));
    return values;
  };
  std::vector<double> bending = springs.bending_springs();
  if (bending.size() > 1) bending = of_chosen([&](std::size_t c) { return springs.bending(c); });
  std::vector<ContactPrestress> prestress;
  if (springs.prestressed()) prestress = of_chosen([&](std::size_t c) { return *springs.prestress(c); });
  ContactSprings result = springs;
  if (!springs.uniform()) result = ContactSprings(of_chosen([&](std::size_t c) { return springs[c]; }));
  return result.with_bending(std::move(bending)).with_prestress(std::move(prestress));
}

namespace {

double smaller_radius(const Assembly& assembly, std::size_t contact) {
  const Contact& c = assembly.contacts[contact];
  return std::min(assembly.radii[c.i], assembly.radii[c.j]);
}

void check(const BendingOptions& options) {
  if (options.kM && options.bond_width) {
    bad_input("kM and bond_width are both given", "each says how stiff contacts are in bending", "Remove one of them");
  }
  check_range(Range::not_negative(), options.kM.value_or(0), "bending spring kM of the contacts", "N");
  check_range(Range::not_negative(), options.bond_width.value_or(0), "bond_width of the contacts");
}

}  // namespace

double bond_width(const Assembly& assembly, std::size_t contact, const BendingOptions& options) {
  return options.bond_width.value_or(0) * 2 * smaller_radius(assembly, contact);
}

ContactSprings bending_springs(const Assembly& assembly, const ContactSprings& springs, const BendingOptions& options) {
  if (!options.given()) return springs;
  check(options);
  std::vector<double> bending(assembly.contacts.size());
  constexpr double most = 1e10;  // leaves six digits of the normal stiffness
  bool differ = false;
  for (std::size_t c = 0; c < bending.size(); ++c) {
    const double width = bond_width(assembly, c, options), radius = smaller_radius(assembly, c), kN = springs[c].kN;
    bending[c] = options.kM ? *options.kM : kN * width * width / 12;
    differ |= bending[c] != bending.front();
    if (bending[c] <= most * kN * radius * radius) continue;
    bad_input(fmt::format("contact {} has kM = {:.3g} N beside kN r² = {:.3g} N", c, bending[c], kN * radius * radius),
              fmt::format("springs so ill-scaled lose the normal stiffness in the round-off of bending, from about "
                          "{:.0e} on",
                          most),
              "Choose kM nearer to kN r², which a bond as wide as the disc has a third of");
  }
  if (std::all_of(bending.begin(), bending.end(), [](double kM) { return kM == 0; })) return springs;
  if (!differ) bending.resize(1);
  return springs.with_bending(std::move(bending));
}

ChosenRelation spring_relation(const Assembly& assembly, SpringWeighting weighting, const Lattice* lattice) {
  switch (weighting) {
    case SpringWeighting::contact_density:
    case SpringWeighting::local_contact_density:
      return {isotropic_relation, {assembly.solid_fraction(), 1.0}};
    case SpringWeighting::voronoi:
      return {isotropic_relation, {0.5, 1.0}};
    case SpringWeighting::uniform:
      break;
  }
  if (lattice != nullptr) return {lattice->relation, {}};
  const double psi = assembly.coordination_number() / (2 * std::numbers::pi);
  return {isotropic_relation, {assembly.solid_fraction(), psi}};
}

SpringConstants springs_of_moduli(const ElasticModuli& moduli, const Assembly& assembly, SpringWeighting weighting,
                                  const Lattice* lattice, NegativeTangential negative) {
  if (weighting != SpringWeighting::uniform && lattice != nullptr && lattice->relation.equal_springs != nullptr) {
    bad_input(fmt::format("the weighting is \"{}\" on the {}", to_string(weighting), lattice->relation.place),
              fmt::format("its relation to moduli ({}) is for equal springs", lattice->relation.source),
              "Use weighting = \"uniform\"");
  }
  const ChosenRelation chosen = spring_relation(assembly, weighting, lattice);
  return springs_for(moduli, chosen.relation, chosen.measures, negative);
}

std::optional<double> disc_density(std::optional<double> of_discs, std::optional<double> of_continuum, Body body,
                                   const Assembly& assembly) {
  if (!of_continuum) return of_discs;
  if (body == Body::sphere) {
    if (of_discs) return of_discs;
    bad_input("the density of a continuum does not give that of spheres",
              "a sheet of spheres has no mass per metre of depth", "Give assembly.density");
  }
  const double gamma = *of_continuum;
  const double phi = assembly.solid_fraction();
  if (!of_discs) return gamma / phi;
  const double rho = *of_discs;
  constexpr double tolerance = 1e-6;
  if (std::abs(gamma - rho * phi) <= tolerance * gamma) return rho;
  bad_input(fmt::format("density = {:.9g} kg/m³ contradicts the density of the discs", gamma),
            fmt::format("discs of {:.9g} kg/m³ that fill {:.6g} of the area make {:.9g} kg/m³", rho, phi, rho * phi),
            "Remove one of the two");
}

}  // namespace equidem
