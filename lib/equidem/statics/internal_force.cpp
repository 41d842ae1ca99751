// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/internal_force.hpp"

#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::size_t grain = 1 << 13;

using Extended = long double;  // 64 bits of mantissa on x86, more elsewhere
#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 Quadruple;  // NOLINT(modernize-use-using): an alias cannot be marked as an extension
#else
using Quadruple = long double;
#endif

/// Stretch and slip of a contact, and the rotations of its discs, rad.
struct Evaluated {
  DeformationOf<Extended> deformation;
  Extended theta_i = 0, theta_j = 0;
};

template <typename Number>
Evaluated evaluate_in(const Contact& contact, const ContactFrame& frame, const DegreesOfFreedom& unknowns,
                      const PreciseMotion& motion, const ContactDeformation& affine) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  const std::size_t i = contact.i * b, j = contact.j * b;
  const auto difference = [&](std::size_t c) {
    const Number high = static_cast<Number>(motion.high[j + c]) - motion.high[i + c];
    return motion.low.empty() ? high : high + (static_cast<Number>(motion.low[j + c]) - motion.low[i + c]);
  };
  const auto rotation_of = [&](std::size_t disc) {
    const Number high = motion.high[disc + 2];
    return motion.low.empty() ? high : high + motion.low[disc + 2];
  };
  Evaluated result;
  Number turn = 0, opening = 0;
  if (b == 3) {
    const Number turn_i = rotation_of(i), turn_j = rotation_of(j);
    turn = (frame.lever_i * turn_i + frame.lever_j * turn_j) / unknowns.rotation_scale;
    if (frame.offset_i != 0 || frame.offset_j != 0)
      opening = (frame.offset_i * turn_i + frame.offset_j * turn_j) / unknowns.rotation_scale;
    result.theta_i = static_cast<Extended>(turn_i / unknowns.rotation_scale);
    result.theta_j = static_cast<Extended>(turn_j / unknowns.rotation_scale);
  }
  const auto d = deformation(frame, difference(0), difference(1), turn, opening);
  result.deformation = {static_cast<Extended>(d.normal + affine.normal),
                        static_cast<Extended>(d.tangential + affine.tangential)};
  return result;
}

/// Evaluates a contact under the motion and the mean displacement gradient.
Evaluated evaluate(const Contact& contact, const ContactFrame& frame, const DegreesOfFreedom& unknowns,
                   const PreciseMotion& motion, const ContactDeformation& affine = {}) {
  return motion.quadruple ? evaluate_in<Quadruple>(contact, frame, unknowns, motion, affine)
                          : evaluate_in<Extended>(contact, frame, unknowns, motion, affine);
}

ContactResponse<Extended> response_of(const ContactSprings& springs, std::size_t contact, const Evaluated& by) {
  return contact_response(springs, contact, by.deformation, by.theta_i, by.theta_j);
}

ContactDeformation affine_part(const Assembly& assembly, const Contact& contact, const ContactFrame& frame,
                               const std::optional<Tensor2>& gradient) {
  return gradient ? affine_deformation(frame, assembly.branch(contact), *gradient) : ContactDeformation{};
}

}  // namespace

void PreciseMotion::add(std::span<const double> correction) {
  const bool simple =
      low.empty() && sums_over<1>(high.size(), grain, [&](std::size_t begin, std::size_t end) {
                       const auto both = [&](std::size_t k) { return high[k] != 0 && correction[k] != 0; };
                       std::size_t k = begin;
                       while (k < end && !both(k)) ++k;
                       return std::array{k < end ? 1.0 : 0.0};
                     })[0] == 0;
  if (!simple) low.resize(high.size(), 0.0);
  parallel_ranges(high.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double add = simple ? correction[k] : low[k] + correction[k];
      const double sum = high[k] + add;
      const double rounded = sum - high[k];  // two-sum (Knuth): exact remainder of high + add
      if (!simple) low[k] = (high[k] - (sum - rounded)) + (add - rounded);
      high[k] = sum;
    }
  });
}

void contact_forces_of(const Assembly& assembly, const ContactSprings& springs, const DegreesOfFreedom& unknowns,
                       const PreciseMotion& motion, std::span<ContactForce> forces) {
  parallel_ranges(assembly.contacts.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Contact& contact = assembly.contacts[c];
      const auto f = response_of(springs, c, evaluate(contact, frame_of(assembly, c), unknowns, motion)).force;
      forces[c] = {static_cast<double>(f.normal), static_cast<double>(f.tangential)};
    }
  });
}

std::vector<double> bending_moments_of(const SpringNetwork& network, const PreciseMotion& motion) {
  std::vector<double> moments(network.assembly.contacts.size());
  parallel_ranges(moments.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const auto by = evaluate(network.assembly.contacts[c], frame_of(network.assembly, c), network.unknowns, motion);
      moments[c] = static_cast<double>(bending_moment(network.springs.bending(c), by.theta_i, by.theta_j));
    }
  });
  return moments;
}

ContactMotion motion_of(const SpringNetwork& network, const PreciseMotion& motion,
                        const std::optional<Tensor2>& gradient, std::size_t number) {
  const Contact& contact = network.assembly.contacts[number];
  const ContactFrame frame = frame_of(network.assembly, number);
  const auto [d, theta_i, theta_j] =
      evaluate(contact, frame, network.unknowns, motion, affine_part(network.assembly, contact, frame, gradient));
  return {{static_cast<double>(d.normal), static_cast<double>(d.tangential)},
          static_cast<double>(theta_i),
          static_cast<double>(theta_j)};
}

ContactDeformation deformation_of(const SpringNetwork& network, const PreciseMotion& motion,
                                  const std::optional<Tensor2>& gradient, std::size_t number) {
  return motion_of(network, motion, gradient, number).deformation;
}

PreciseDeformation precise_deformation_of(const SpringNetwork& network, const PreciseMotion& motion,
                                          const std::optional<Tensor2>& gradient, std::size_t number) {
  const Contact& contact = network.assembly.contacts[number];
  const ContactFrame frame = frame_of(network.assembly, number);
  return evaluate(contact, frame, network.unknowns, motion, affine_part(network.assembly, contact, frame, gradient))
      .deformation;
}

ContactForce force_of(const ContactSprings& springs, std::size_t contact, const ContactMotion& motion) {
  return contact_response(springs, contact, motion.deformation, motion.theta_i, motion.theta_j).force;
}

namespace {

/// The force and the moment that the contacts of a disc exert on it, N/m and N.
struct Pull {
  Extended x = 0, y = 0, moment = 0;
};

Pull pull_on(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
             std::size_t d) {
  const auto& [assembly, graph, springs, unknowns] = network;
  Pull sum;
  for (const auto& edge : graph.of(d)) {
    const Contact& contact = assembly.contacts[edge.contact];
    const ContactFrame frame = frame_of(assembly, static_cast<std::size_t>(edge.contact));
    const auto response =
        response_of(springs, static_cast<std::size_t>(edge.contact),
                    evaluate(contact, frame, unknowns, motion, affine_part(assembly, contact, frame, gradient)));
    const ForceOf<Extended>& force = response.force;
    const Vec2 n = frame.normal;
    const Extended fx = force.normal * n.x - force.tangential * n.y;
    const Extended fy = force.normal * n.y + force.tangential * n.x;
    if (static_cast<std::size_t>(contact.i) == d) {
      sum.x += fx, sum.y += fy;
      sum.moment += moment_on_i(frame, force) + response.moment_i;
    }
    if (static_cast<std::size_t>(contact.j) == d) {
      sum.x -= fx, sum.y -= fy;
      sum.moment += moment_on_j(frame, force) + response.moment_j;
    }
  }
  return sum;
}

}  // namespace

void residual_force(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                    std::span<const double> f, std::span<double> residual) {
  const auto& unknowns = network.unknowns;
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  parallel_ranges(network.assembly.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      const auto [x, y, moment] = pull_on(network, motion, gradient, d);
      const auto keep = [&](std::size_t k, Extended value) {
        if (!f.empty()) value += f[d * b + k];
        residual[d * b + k] = unknowns.held[d * b + k] != 0 ? 0.0 : static_cast<double>(value);
      };
      keep(0, x);
      keep(1, y);
      if (b == 3) keep(2, moment / unknowns.rotation_scale);
    }
  });
}

void internal_force(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                    std::span<double> result) {
  const auto b = static_cast<std::size_t>(network.unknowns.per_disc);
  parallel_ranges(network.assembly.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      const auto [x, y, moment] = pull_on(network, motion, gradient, d);
      result[d * b] = -static_cast<double>(x);
      result[d * b + 1] = -static_cast<double>(y);
      if (b == 3) result[d * b + 2] = -static_cast<double>(moment / network.unknowns.rotation_scale);
    }
  });
}

void internal_force(const Assembly& assembly, const ContactGraph& graph, const DegreesOfFreedom& unknowns,
                    std::span<const ContactForce> forces, std::span<double> result) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  parallel_ranges(assembly.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t d = begin; d < end; ++d) {
      Vec2 force;
      double moment = 0;
      for (const auto& edge : graph.of(d)) {
        const Contact& contact = assembly.contacts[edge.contact];
        const ContactForce& f = forces[edge.contact];
        const ContactFrame frame = frame_of(assembly, static_cast<std::size_t>(edge.contact));
        if (static_cast<std::size_t>(contact.i) == d) {
          force += force_on_i(frame, f);
          moment += moment_on_i(frame, f);
        }
        if (static_cast<std::size_t>(contact.j) == d) {
          force -= force_on_i(frame, f);
          moment += moment_on_j(frame, f);
        }
      }
      result[d * b] = -force.x;
      result[d * b + 1] = -force.y;
      if (b == 3) result[d * b + 2] = -moment / unknowns.rotation_scale;
    }
  });
}

std::vector<double> contact_moments(const Assembly& assembly, std::span<const ContactForce> forces) {
  std::vector<double> moments(assembly.size(), 0.0);
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    const ContactFrame frame = frame_of(assembly, c);
    moments[contact.i] += moment_on_i(frame, forces[c]);
    moments[contact.j] += moment_on_j(frame, forces[c]);
  }
  return moments;
}

}  // namespace equidem
