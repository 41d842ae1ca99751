// SPDX-License-Identifier: GPL-3.0-or-later

#include "equidem/contact/prestress/forces_at_rest.hpp"

#include <algorithm>
#include <cmath>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {

namespace {

constexpr double largest_round_off = 1e-12;  // of the largest force: such as solve leaves where a contact carries none

bool is_loaded(const ContactForce& force) {
  return force.normal != 0 || force.tangential != 0;
}

}  // namespace

bool carries_forces(const Assembly& assembly) {
  for (std::size_t c = 0; c < assembly.contact_normal_force.size(); ++c)
    if (is_loaded(force_at_rest(assembly, c))) return true;
  return false;
}

RestSums sums_at_rest(const Assembly& assembly) {
  RestSums sums{std::vector<Vec2>(assembly.size()), std::vector<double>(assembly.size())};
  std::vector<double> magnitudes;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const ContactForce force = force_at_rest(assembly, c);
    if (!is_loaded(force)) continue;
    const Contact& contact = assembly.contacts[c];
    const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
    const ContactFrame frame = frame_of(assembly, c);
    const Vec2 on_i = force_on_i(frame, force);
    sums.forces[i] += on_i;
    sums.forces[j] -= on_i;
    sums.moments[i] += moment_on_i(frame, force);
    sums.moments[j] += moment_on_j(frame, force);
    magnitudes.push_back(norm(on_i));
  }
  if (magnitudes.empty()) return sums;
  const double largest = *std::ranges::max_element(magnitudes);
  for (const double force : magnitudes) {
    if (force <= largest_round_off * largest) continue;
    sums.mean_force += force;
    ++sums.loaded;
  }
  if (sums.loaded > 0) sums.mean_force /= static_cast<double>(sums.loaded);
  return sums;
}

RestBalance balance_at_rest(const Assembly& assembly, const std::vector<std::int32_t>& held) {
  const RestSums sums = sums_at_rest(assembly);
  RestBalance balance;
  balance.loaded = sums.loaded;
  balance.mean_force = sums.mean_force;
  if (balance.loaded == 0) return balance;
  for (std::size_t d = 0; d < assembly.size(); ++d) {
    const auto disc = static_cast<std::int32_t>(d);
    if (std::ranges::binary_search(held, disc)) continue;
    if (norm(sums.forces[d]) > balance.largest_force) {
      balance.largest_force = norm(sums.forces[d]);
      balance.disc_of_force = disc;
    }
    if (std::abs(sums.moments[d]) > balance.largest_moment) {
      balance.largest_moment = std::abs(sums.moments[d]);
      balance.disc_of_moment = disc;
    }
  }
  balance.relative =
      std::max(balance.largest_force, balance.largest_moment / assembly.mean_radius()) / balance.mean_force;
  return balance;
}

namespace {

/// True where a surface of that curvature is a disc about the centre of its body.
bool about_its_centre(double curvature, double lever) {
  constexpr double close = 1e-9;
  return std::abs(curvature * lever - 1) <= close;
}

ContactPrestress prestress_at(const Assembly& assembly, std::size_t c) {
  const ContactFrame frame = frame_of(assembly, c);
  const ContactForce force = force_at_rest(assembly, c);
  const double length = norm(assembly.branch(assembly.contacts[c]));
  if (assembly.contact_curvature_i.empty()) {
    if (assembly.contact_arms.empty()) return prestress_of_discs(frame, length, force);
    bad_input(
        "the curvatures of the bodies are not known at their contacts",
        "forces at rest change with the place of the contact point, which rolls along the surfaces as bodies turn",
        "Give \"curvatures\" in the assembly file, as pack does, or set effects.prestress = \"off\"");
  }
  const ContactCurvatures curvatures{assembly.contact_curvature_i[c], assembly.contact_curvature_j[c]};
  const bool disc_i = about_its_centre(curvatures.i, frame.lever_i),
             disc_j = about_its_centre(curvatures.j, frame.lever_j);
  if (disc_i && disc_j) return prestress_of_discs(frame, length, force);
  return prestress_of_bodies(frame, curvatures, force);
}

void refuse_imbalance(const Assembly& assembly, const RestBalance& balance) {
  if (!assembly.periodic() || balance.relative <= largest_imbalance) return;
  const bool force = balance.largest_force >= balance.largest_moment / assembly.mean_radius();
  bad_input(
      fmt::format("the forces at rest do not balance: on disc {} {} of their mean is left",
                  force ? balance.disc_of_force : balance.disc_of_moment, percent(balance.relative)),
      fmt::format("in a periodic cell nothing else acts on a body; at most {} may be left", percent(largest_imbalance)),
      "Let the packing come to rest, or set effects.prestress = \"off\"");
}

}  // namespace

double largest_prestress(const Assembly& assembly, const ContactSprings& springs) {
  double largest = 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    if (springs[c].kN == 0) continue;
    const double length = norm(assembly.branch(assembly.contacts[c]));
    largest = std::max(largest, std::abs(force_at_rest(assembly, c).normal) / (springs[c].kN * length));
  }
  return largest;
}

std::vector<ContactPrestress> prestress_of(const Assembly& assembly) {
  std::vector<ContactPrestress> all;
  all.reserve(assembly.contacts.size());
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) all.push_back(prestress_at(assembly, c));
  return all;
}

std::optional<PrestressedSprings> choose_prestress(const Assembly& assembly, const ContactSprings& springs,
                                                   PrestressChoice choice) {
  if (!carries_forces(assembly)) {
    if (choice != PrestressChoice::on) return {};
    bad_input("prestress is asked for, and no contact carries a force at rest", "there is nothing to count",
              "Take an assembly file with \"forces\", as pack writes it, or leave effects.prestress out");
  }
  PrestressedSprings result{.springs = springs,
                            .largest = largest_prestress(assembly, springs),
                            .balance = balance_at_rest(assembly),
                            .sentence = {}};
  const std::string size = fmt::format("|N0|/(kN l) is up to {:.2g}", result.largest);
  if (choice == PrestressChoice::off) {
    result.sentence = "do not count, as asked; " + size;
    return result;
  }
  const bool noticeable = result.largest >= noticeable_prestress || !springs.any_tangential();
  if (choice == PrestressChoice::automatic && !noticeable) {
    result.sentence = fmt::format("do not count: {}, below {:g}", size, noticeable_prestress);
    return result;
  }
  try {
    refuse_imbalance(assembly, result.balance);
    result.springs = springs.with_prestress(prestress_of(assembly));
    result.sentence = fmt::format("count at {}: {}; on one body they lack up to {:.2g} of their mean{}",
                                  counted(result.balance.loaded, "contact"), size, result.balance.relative,
                                  assembly.periodic() ? "" : ", which weight, walls and loads balance");
  } catch (const Error& error) {
    if (choice == PrestressChoice::on || error.kind() != ErrorKind::bad_input) throw;
    result.sentence = fmt::format("DO NOT COUNT: {}; {}", error.problem(), size);
  }
  return result;
}

}  // namespace equidem
