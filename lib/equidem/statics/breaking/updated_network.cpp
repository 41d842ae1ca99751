// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/updated_network.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/ordering/nested_dissection.hpp"
#include "equidem/statics/internal_force.hpp"
#include "equidem/statics/mechanisms.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {
namespace {

constexpr std::size_t contacts_at_once = 1 << 11, discs_at_once = 1 << 9, entries_at_once = 1 << 13;
/// Of motions, |x| over |u| in the norm of energy: mean stresses are wrong by no more, forces of contacts that carry
/// more than others by about as much; load factors and stresses are to have nine digits.
constexpr double most_wrong = 5e-11;

double product(std::span<const double> a, std::span<const double> b) {
  return sums_over<1>(a.size(), entries_at_once, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += a[k] * b[k];
    return std::array{sum};
  })[0];
}

/// The springs of a contact as changes of K that take them out.
std::vector<RankOneChange> taken_out(const SpringNetwork& network, std::size_t number) {
  const Contact& contact = network.assembly.contacts[number];
  ContactStiffness k =
      contact_stiffness(network.springs, number, frame_of(network.assembly, number), network.unknowns.rotation_scale);
  hold_end(network.unknowns, contact.i, k.ends.i);
  hold_end(network.unknowns, contact.j, k.ends.j);
  std::vector<RankOneChange> changes;
  if (k.kN != 0) changes.push_back({-k.kN, contact.i, contact.j, k.ends.i.normal, k.ends.j.normal});
  if (k.kT != 0) changes.push_back({-k.kT, contact.i, contact.j, k.ends.i.tangential, k.ends.j.tangential});
  return changes;
}

void check_network(const ContactSprings& springs, std::size_t cases) {
  if (springs.any_negative()) {
    bad_input("a contact has a negative tangential spring",
              "the factor that is updated is that of a positive definite matrix",
              "Factorize anew after each removal, or take kT >= 0");
  }
  if (cases < 1 || cases > most_right_sides) {
    bad_input(fmt::format("there are {} right-hand sides", cases), "one grows with the load factor, one may be dead",
              "Give one or two");
  }
}

/// \throws Error of networks that cannot be updated
std::shared_ptr<const SymbolicFactor> order_of(const SpringNetwork& network, std::size_t cases, double memory_limit) {
  check_network(network.springs, cases);
  const auto& [assembly, graph, springs, unknowns] = network;
  auto symbolic = std::make_shared<const SymbolicFactor>(analyze(dissect(assembly, graph), graph, unknowns.per_disc));
  check_memory(estimate(*symbolic, unknowns, false), memory_limit);
  return symbolic;
}

}  // namespace

UpdatedNetwork::UpdatedNetwork(const Assembly& assembly, const ContactSprings& springs, DegreesOfFreedom unknowns,
                               std::vector<RightHandSide> cases, const UpdatedNetworkOptions& options)
    : assembly_(assembly),
      graph_(assembly),
      springs_(springs),
      unknowns_(std::move(unknowns)),
      cases_(std::move(cases)),
      options_(options),
      symbolic_(order_of({assembly, graph_, springs_, unknowns_}, cases_.size(), options.memory_limit)),
      factor_(symbolic_),
      spared_(assembly.contacts.size(), 0),
      affine_(cases_.size()),
      exact_(cases_.size(), std::vector<ForceOf<DoubleDouble>>(assembly.contacts.size())),
      forces_(cases_.size(), std::vector<ContactForce>(assembly.contacts.size())),
      twice_energy_(cases_.size(), 0.0),
      unbalanced_(components() * cases_.size()),
      change_(components() * cases_.size()) {
  const double turns = unknowns_.per_disc == 3 ? 1 : 0;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Contact& contact = assembly.contacts[c];
    ContactFrame frame = frame_of(assembly, c);
    for (std::size_t p = 0; p < cases_.size(); ++p) {
      if (cases_[p].gradient)
        affine_[p].push_back(affine_deformation(frame, assembly.branch(contact), *cases_[p].gradient));
    }
    frame = {frame.normal, turns * frame.lever_i, turns * frame.lever_j, turns * frame.offset_i,
             turns * frame.offset_j};
    links_.push_back({symbolic_->position[contact.i], symbolic_->position[contact.j], frame, springs_[c]});
  }
  for (std::size_t p = 0; p < cases_.size(); ++p) {
    motions_.push_back(driving_motion(p));
    double affine = 0;
    for (std::size_t c = 0; c < affine_[p].size(); ++c) {
      const ContactForce f = linear_spring_force(springs_[c], affine_[p][c]);
      affine += f.normal * f.normal + f.tangential * f.tangential;
    }
    evaluate_forces(p);
    scales_.push_back(std::max(balance(p), std::sqrt(affine)));
  }
  evaluate();
  if (!factorize()) {
    computation_failed("the stiffness matrix is not positive definite", "the network has a mechanism",
                       "Hold what moves without energy, or take it out");
  }
  static_cast<void>(refine(2));
}

std::vector<HeldMechanism> UpdatedNetwork::remove(std::size_t number) {
  const std::vector<RankOneChange> changes = taken_out({assembly_, graph_, springs_, unknowns_}, number);
  if (changes.empty()) return {};
  std::vector<UpdatedCholesky::Load> loads(cases_.size());
  for (std::size_t p = 0; p < cases_.size(); ++p) {
    const ForceOf<DoubleDouble>& f = exact_[p][number];
    const bool normal = links_[number].springs.kN != 0;
    for (std::size_t k = 0; k < changes.size(); ++k) {
      const auto force = static_cast<double>(normal && k == 0 ? f.normal : f.tangential);
      for (std::size_t r = 0; r < 3; ++r) {
        loads[p].at_i[r] += force * changes[k].at_i[r];
        loads[p].at_j[r] += force * changes[k].at_j[r];
      }
    }
  }
  ++counters_.updates;
  ++altered_;
  const FactorPath path = factor_.change(changes, loads);
  springs_.set(number, {0, 0}, assembly_.contacts.size());
  links_[number].springs = {0, 0};
  spared_[number] = 1;

  std::ranges::fill(change_, 0.0);
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const double* from = path.values.data();
  for (const std::int32_t t : path.fronts) {
    const std::size_t pivots = symbolic_->pivots(static_cast<std::size_t>(t));
    for (std::size_t p = 0; p < cases_.size(); ++p, from += pivots)
      std::copy_n(from, pivots, column(change_, p).data() + symbolic_->tree.nodes[t].begin * b);
  }
  add_change();
  std::vector<HeldMechanism> mechanisms;
  for (const std::int64_t component : path.held) {
    hold(component);
    mechanisms.push_back(mechanism_at(component));
  }
  constexpr double delicate = 1e-3;  // share of the determinant: digits that are lost
  const bool lost_digits = path.share < delicate || !path.held.empty();
  constexpr int most_unmeasured = 16;
  const bool too_much = lost_digits || !(residual() <= options_.claimed_residual);
  // Where motions drive, the energy is in proportion to the stiffness that is left, and |x| over |u| to its inverse.
  const double fallen = std::max(1.0, measured_energy_ / twice_energy_[0]);
  const bool measure = residual_ * softness_ * fallen > most_wrong || ++unmeasured_ >= most_unmeasured;
  if (carried_ && (too_much || measure)) {
    for (const HeldMechanism& found : refine(too_much ? 1 : 0)) mechanisms.push_back(found);
  }
  return mechanisms;
}

/// A soft network answers a residual of 1e-13 by forces that are wrong by far more: an error x of the motions has the
/// energy x.K x = |y|² with L y = r. Motions that are wrong by more than most_wrong are corrected to round-off.
/// \return false where corrections end before that: round-off has spoiled the factor for what is soft
bool UpdatedNetwork::improve(int least_steps) {
  constexpr double wrong = 1e-12, contracts = 0.5;
  constexpr int most_steps = 5;
  for (int step = 0;; ++step) {
    std::ranges::copy(unbalanced_, change_.begin());
    factor_.forward(change());
    double error = 0;
    for (std::size_t p = 0; p < cases_.size(); ++p) {
      const double energy = product(column(change_, p), column(change_, p));
      if (energy > 0) error = std::max(error, std::sqrt(energy / twice_energy_[p]));
    }
    if (step == 0 && residual_ > 0) {
      softness_ = error / residual_;
      measured_energy_ = twice_energy_[0];
    }
    unmeasured_ = 0;
    if (step >= least_steps && error < (step == 0 ? most_wrong : wrong)) return true;
    if (step == most_steps) return false;
    if (step == 0) ++counters_.refinements;
    const double before = residual_;
    add_change();
    if (step > 0 && !(residual_ < contracts * before)) return true;  // round-off of the residual itself
  }
}

std::vector<HeldMechanism> UpdatedNetwork::refine(int least_steps) {
  constexpr int many_changes = 16;
  const bool right = improve(least_steps);
  std::vector<HeldMechanism> found;
  if (!carried_) return found;
  if (residual() <= options_.claimed_residual && (right || altered_ <= many_changes)) return found;
  ++counters_.mended;
  altered_ = 0;
  const std::size_t held = holds_.size();
  if (!factorize()) {
    computation_failed("the stiffness matrix could not be factorized anew",
                       "round-off of changes had grown, and the network is singular in more than a few places",
                       "Stop before the network falls apart");
  }
  improve(1);
  for (std::size_t k = held; k < holds_.size(); ++k) found.push_back(mechanism_at(holds_[k].component));
  return found;
}

bool UpdatedNetwork::factorize() {
  constexpr int most_holds = 16;
  for (int attempt = 0; attempt < most_holds; ++attempt) {
    StiffnessMatrix matrix = assemble_stiffness(assembly_, graph_, springs_, unknowns_);
    const auto b = static_cast<std::int64_t>(symbolic_->block);
    for (const Held& held : holds_)
      matrix.diagonal[held.component / b * b * b + held.component % b * (b + 1)] += held.stiffness;
    const bool first = ++counters_.factorizations == 1;
    if (factor_.factorize({matrix, assembly_, graph_})) return true;
    if (first || !factor_.report().smallest_component) return false;
    hold(static_cast<std::int64_t>(*factor_.report().smallest_component));
  }
  return false;
}

void UpdatedNetwork::hold(std::int64_t component) {
  holds_.push_back({component, factor_.stiffness_of(component)});
}

/// With K + s e e^T in the factor, what the force of the support takes of the loads is left by the contacts.
HeldMechanism UpdatedNetwork::mechanism_at(std::int64_t component) {
  HeldMechanism mechanism{component};
  for (std::size_t p = 0; p < cases_.size(); ++p) {
    const double reaction = column(unbalanced_, p)[place_of(component)];
    if (std::abs(reaction) > negligible_reaction * scales_[p]) mechanism.driven = true;
  }
  carried_ = carried_ && !mechanism.driven;
  return mechanism;
}

/// Solves L^T x = y with y in change_, adds x to the motions and evaluates the forces.
void UpdatedNetwork::add_change() {
  factor_.backward(change());
  for (std::size_t p = 0; p < cases_.size(); ++p) motions_[p].add(column(change_, p));
  evaluate();
}

void UpdatedNetwork::evaluate() {
  residual_ = 0;
  for (std::size_t p = 0; p < cases_.size(); ++p) {
    evaluate_forces(p);
    const double length = balance(p);
    if (scales_[p] > 0) residual_ = std::max(residual_, length / scales_[p]);
    if (std::isnan(length)) residual_ = length;
  }
}

void UpdatedNetwork::evaluate_forces(std::size_t of_case) {
  twice_energy_[of_case] = sums_over<1>(links_.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
    return std::array{with_double_doubles(
        [&](auto number) { return evaluate_forces<typename decltype(number)::type>(of_case, begin, end); })};
  })[0];
}

template <typename Number>
double UpdatedNetwork::evaluate_forces(std::size_t of_case, std::size_t begin, std::size_t end) {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const PreciseMotion& u = motions_[of_case];
  const std::vector<ContactDeformation>& affine = affine_[of_case];
  double twice_energy = 0;
  for (std::size_t c = begin; c < end; ++c) {
    const Link& link = links_[c];
    ForceOf<DoubleDouble>& exact = exact_[of_case][c];
    exact = {};
    if (link.springs.kN == 0 && link.springs.kT == 0) {
      forces_[of_case][c] = {};
      continue;
    }
    const std::size_t i = static_cast<std::size_t>(link.i) * b, j = static_cast<std::size_t>(link.j) * b;
    DeformationOf<Number> d = precise_motion_of<Number>(link.frame, u, i, j, unknowns_, false).deformation;
    if (!affine.empty()) d.normal += affine[c].normal, d.tangential += affine[c].tangential;
    const Number normal = link.springs.kN * d.normal, tangential = link.springs.kT * d.tangential;
    exact = {DoubleDouble(normal), DoubleDouble(tangential)};
    const ContactForce f{static_cast<double>(normal), static_cast<double>(tangential)};
    forces_[of_case][c] = spared_[c] != 0 ? ContactForce{} : f;
    if (link.springs.kN != 0) twice_energy += 2 * linear_spring_energy_of(link.springs, f);
  }
  return twice_energy;
}

/// The force that the contacts of a disc exert on it, N/m and N.
template <typename Number>
PullOf<Number> UpdatedNetwork::pull_on(std::size_t disc, std::size_t of_case) const {
  PullOf<Number> pull;
  const std::int32_t place = symbolic_->position[disc];
  for (const auto& edge : graph_.of(disc)) {
    const Link& link = links_[edge.contact];
    const ForceOf<DoubleDouble>& force = exact_[of_case][edge.contact];
    pull.add(link.frame, {Number(force.normal), Number(force.tangential)}, link.i == place, link.j == place);
  }
  return pull;
}

/// Writes what forces leave of the loads. \return its length, N/m
double UpdatedNetwork::balance(std::size_t of_case) {
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const std::vector<double>& load = cases_[of_case].force;
  const std::span<double> unbalanced = column(unbalanced_, of_case);
  const auto square = sums_over<1>(assembly_.size(), discs_at_once, [&](std::size_t begin, std::size_t end) {
    return std::array{with_double_doubles([&](auto number) {
      using Number = typename decltype(number)::type;
      double sum = 0;
      for (std::size_t disc = begin; disc < end; ++disc) {
        const std::array<Number, 3> components = pull_on<Number>(disc, of_case).components(unknowns_.rotation_scale);
        const std::size_t place = static_cast<std::size_t>(symbolic_->position[disc]) * b;
        for (std::size_t r = 0; r < b; ++r) {
          const std::size_t component = disc * b + r;
          const Number left = load.empty() ? components[r] : components[r] + load[component];
          const double kept = unknowns_.held[component] != 0 ? 0.0 : static_cast<double>(left);
          unbalanced[place + r] = kept;
          sum += kept * kept;
        }
      }
      return sum;
    })};
  });
  return std::sqrt(square[0]);
}

/// Works of the state that balances the loads, to second order in the residual r that the state here has: that of a
/// load on it is f.u + u.r, and with prescribed motions and mean strains the free discs take the work of r away.
EquilibriumSums UpdatedNetwork::sums() const {
  enum : std::size_t { imposed, moment = imposed + 2, count = moment + 8 };
  const bool strained = cases_[0].gradient.has_value();
  EquilibriumSums result;
  if (strained || options_.force_moments) {
    const auto total = sums_over<count>(links_.size(), contacts_at_once, [&](std::size_t begin, std::size_t end) {
      std::array<double, count> sum{};
      for (std::size_t c = begin; c < end; ++c) {
        const Vec2 branch = assembly_.branch(assembly_.contacts[c]);
        for (std::size_t p = 0; p < cases_.size(); ++p) {
          const ContactForce& f = forces_[p][c];
          if (strained) sum[imposed + p] += f.normal * affine_[0][c].normal + f.tangential * affine_[0][c].tangential;
          const Tensor2 t = outer(force_on_i(links_[c].frame, f), branch);
          const double entries[] = {t.xx, t.xy, t.yx, t.yy};
          for (std::size_t e = 0; e < 4; ++e) sum[moment + 4 * p + e] += entries[e];
        }
      }
      return sum;
    });
    for (std::size_t p = 0; p < cases_.size(); ++p) {
      const double* m = &total[moment + 4 * p];
      result.imposed[p] = total[imposed + p];
      result.moment[p] = {m[0], m[1], m[2], m[3]};
    }
  }
  const auto b = static_cast<std::size_t>(symbolic_->block);
  for (std::size_t p = 0; p < cases_.size(); ++p) {
    const std::vector<double>& force = cases_[p].force;
    bool loads = false;
    for (std::size_t k = 0; k < force.size(); ++k) {
      if (force[k] == 0) continue;
      loads = true;
      const std::size_t place = place_of(static_cast<std::int64_t>(k));
      for (std::size_t q = 0; q < cases_.size(); ++q) result.load_work[p][q] += force[k] * motions_[q].high[place];
    }
    for (std::size_t q = 0; q < cases_.size(); ++q) {
      const double of_residual = product(motions_[p].high, column(unbalanced_, q));
      if (loads) result.load_work[p][q] += of_residual;
      if (p == 0 && !loads) result.imposed[q] -= of_residual;
    }
  }
  const std::vector<double>& prescribed = cases_[0].prescribed;
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    if (unknowns_.held[k] == DegreesOfFreedom::free || prescribed[k] == 0) continue;
    for (std::size_t q = 0; q < cases_.size(); ++q) {
      const double load = cases_[q].force.empty() ? 0 : cases_[q].force[k];
      const auto pull = pull_on<DoubleDouble>(k / b, q).components(unknowns_.rotation_scale);
      result.imposed[q] -= prescribed[k] * (load + static_cast<double>(pull[k % b]));
    }
  }
  return result;
}

// With K + s e e^T, which holds one component of a mechanism, K v + s e e.v = e has the mechanism for a solution. Where
// round-off has left a pivot in place of it, solutions turn to it: their other parts are smaller by that pivot over the
// next stiffness, each time. What the factor is wrong by is then corrected with the forces of the contacts.
std::vector<DiscMotion> UpdatedNetwork::driven_mechanism(std::int64_t component) {
  constexpr int most_solutions = 3, most_corrections = 2;
  const auto scaled_to_one = [](std::vector<double>& x) {
    double largest = 0;
    for (const double value : x) largest = std::max(largest, std::abs(value));
    if (!(largest > 0 && std::isfinite(largest))) return false;
    for (double& value : x) value /= largest;
    return true;
  };
  const SpringNetwork network{assembly_, graph_, springs_, unknowns_};
  PreciseMotion motion(components());
  std::vector<double>& x = motion.high;
  std::vector<double> change(components());
  if (component >= 0) x[static_cast<std::size_t>(component)] = 1;
  for (std::size_t k = 0; component < 0 && k < cases_[0].force.size(); ++k)
    x[k] = unknowns_.held[k] == DegreesOfFreedom::free ? cases_[0].force[k] : 0;
  for (int step = 0; step < (component >= 0 ? 1 : most_solutions); ++step) {
    if (!scaled_to_one(x)) return {};
    factor_.solve(x, 1);
  }
  for (int step = 0;; ++step) {
    if (!scaled_to_one(x)) return {};
    for (const RightHandSide& given : cases_) {
      if (!does_work(given.force, x, unknowns_.per_disc)) return {};
    }
    std::vector<DiscMotion> motions = disc_motions(unknowns_, x);
    if (softness(assembly_, springs_, motions) < softness_of_mechanisms) return motions;
    if (step == most_corrections) return {};
    residual_force(network, motion, {}, {}, change);
    factor_.solve(change, 1);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += change[k];
  }
}

void UpdatedNetwork::spare(std::span<const std::size_t> contacts) {
  for (const std::size_t c : contacts) {
    spared_[c] = 1;
    for (std::vector<ContactForce>& forces : forces_) forces[c] = {};
  }
}

double UpdatedNetwork::residual() const {
  constexpr double of_measuring = 4 * std::numeric_limits<double>::epsilon();
  return residual_ + of_measuring;
}

std::size_t UpdatedNetwork::place_of(std::int64_t component) const {
  const std::int64_t b = symbolic_->block;
  return static_cast<std::size_t>(symbolic_->position[component / b] * b + component % b);
}

/// Prescribed motions, all free components at rest, in the order of elimination.
PreciseMotion UpdatedNetwork::driving_motion(std::size_t of_case) const {
  PreciseMotion motion(components());
  const std::vector<double>& prescribed = cases_[of_case].prescribed;
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    if (unknowns_.held[k] != DegreesOfFreedom::free)
      motion.high[place_of(static_cast<std::int64_t>(k))] = prescribed[k];
  }
  return motion;
}

PreciseMotion UpdatedNetwork::motion(std::size_t of_case) const {
  const PreciseMotion& now = motions_[of_case];
  PreciseMotion motion(components());
  permute_from_elimination(*symbolic_, now.high, motion.high);
  if (!now.low.empty()) {
    motion.low.resize(components());
    permute_from_elimination(*symbolic_, now.low, motion.low);
  }
  return motion;
}

}  // namespace equidem
