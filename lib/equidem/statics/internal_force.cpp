// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/internal_force.hpp"

#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/threads.hpp"

namespace equidem {
namespace {

constexpr std::size_t grain = 1 << 13;

/// The motion of a contact, with the mean displacement gradient where there is one.
template <typename Number>
ContactMotionOf<Number> evaluate(const Assembly& assembly, const DegreesOfFreedom& unknowns, const ContactFrame& frame,
                                 const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                                 std::size_t number, bool rotations) {
  const Contact& contact = assembly.contacts[number];
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  auto result = precise_motion_of<Number>(frame, motion, contact.i * b, contact.j * b, unknowns, rotations);
  if (gradient) {
    const ContactDeformation affine = affine_deformation(frame, assembly.branch(contact), *gradient);
    result.deformation.normal += affine.normal;
    result.deformation.tangential += affine.tangential;
  }
  return result;
}

ContactMotionOf<DoubleDouble> evaluate(const Assembly& assembly, const DegreesOfFreedom& unknowns,
                                       const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                                       std::size_t number) {
  return evaluate<DoubleDouble>(assembly, unknowns, frame_of(assembly, number), motion, gradient, number, true);
}

template <typename Number>
ContactResponse<Number> response_of(const ContactSprings& springs, std::size_t contact,
                                    const ContactMotionOf<Number>& by) {
  return contact_response(springs, contact, by.deformation, by.theta_i, by.theta_j);
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
      const auto sum = DoubleDouble::sum(high[k], add);
      high[k] = sum.high();
      if (!simple) low[k] = sum.low();
    }
  });
}

void contact_forces_of(const Assembly& assembly, const ContactSprings& springs, const DegreesOfFreedom& unknowns,
                       const PreciseMotion& motion, std::span<ContactForce> forces) {
  parallel_ranges(assembly.contacts.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const auto f = response_of(springs, c, evaluate(assembly, unknowns, motion, {}, c)).force;
      forces[c] = {static_cast<double>(f.normal), static_cast<double>(f.tangential)};
    }
  });
}

std::vector<double> bending_moments_of(const SpringNetwork& network, const PreciseMotion& motion) {
  std::vector<double> moments(network.assembly.contacts.size());
  parallel_ranges(moments.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const auto by = evaluate(network.assembly, network.unknowns, motion, {}, c);
      moments[c] = static_cast<double>(bending_moment(network.springs.bending(c), by.theta_i, by.theta_j));
    }
  });
  return moments;
}

ContactMotion motion_of(const SpringNetwork& network, const PreciseMotion& motion,
                        const std::optional<Tensor2>& gradient, std::size_t number) {
  const auto [d, theta_i, theta_j] = evaluate(network.assembly, network.unknowns, motion, gradient, number);
  return {{static_cast<double>(d.normal), static_cast<double>(d.tangential)},
          static_cast<double>(theta_i),
          static_cast<double>(theta_j)};
}

PreciseDeformation precise_deformation_of(const SpringNetwork& network, const PreciseMotion& motion,
                                          const std::optional<Tensor2>& gradient, std::size_t number) {
  return evaluate(network.assembly, network.unknowns, motion, gradient, number).deformation;
}

ContactForce force_of(const ContactSprings& springs, std::size_t contact, const ContactMotion& motion) {
  return contact_response(springs, contact, motion.deformation, motion.theta_i, motion.theta_j).force;
}

namespace {

template <typename Number>
PullOf<Number> pull_on(const SpringNetwork& network, const PreciseMotion& motion,
                       const std::optional<Tensor2>& gradient, std::size_t d) {
  const bool rotations = network.springs.bends() || network.springs.prestressed();
  PullOf<Number> sum;
  for (const auto& edge : network.graph.of(d)) {
    const auto c = static_cast<std::size_t>(edge.contact);
    const Contact& contact = network.assembly.contacts[c];
    const ContactFrame frame = frame_of(network.assembly, c);
    const bool on_i = static_cast<std::size_t>(contact.i) == d, on_j = static_cast<std::size_t>(contact.j) == d;
    const ContactResponse<Number> response =
        response_of(network.springs, c,
                    evaluate<Number>(network.assembly, network.unknowns, frame, motion, gradient, c, rotations));
    sum.add(frame, response.force, on_i, on_j);
    if (rotations && on_i) sum.moment += response.moment_i;
    if (rotations && on_j) sum.moment += response.moment_j;
  }
  return sum;
}

/// The internal force of the discs of a range, or f less it on free components.
struct ForceRange {
  const SpringNetwork& network;
  const PreciseMotion& motion;
  const std::optional<Tensor2>& gradient;
  bool residual;
  std::span<const double> f;
  std::span<double> result;

  template <typename Number>
  void evaluate(std::size_t begin, std::size_t end) const {
    const DegreesOfFreedom& unknowns = network.unknowns;
    const auto b = static_cast<std::size_t>(unknowns.per_disc);
    for (std::size_t d = begin; d < end; ++d) {
      const std::array<Number, 3> pull =
          pull_on<Number>(network, motion, gradient, d).components(unknowns.rotation_scale);
      for (std::size_t k = 0; k < b; ++k) {
        const Number value = f.empty() ? pull[k] : pull[k] + f[d * b + k];
        const bool held = residual && unknowns.held[d * b + k] != 0;
        result[d * b + k] = held ? 0.0 : static_cast<double>(residual ? value : -value);
      }
    }
  }
};

void evaluate_in_ranges(const ForceRange& range) {
  parallel_ranges(range.network.assembly.size(), grain, [&](std::size_t begin, std::size_t end) {
    with_double_doubles([&](auto number) { range.evaluate<typename decltype(number)::type>(begin, end); });
  });
}

}  // namespace

void residual_force(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                    std::span<const double> f, std::span<double> residual) {
  evaluate_in_ranges({network, motion, gradient, true, f, residual});
}

void internal_force(const SpringNetwork& network, const PreciseMotion& motion, const std::optional<Tensor2>& gradient,
                    std::span<double> result) {
  evaluate_in_ranges({network, motion, gradient, false, {}, result});
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
