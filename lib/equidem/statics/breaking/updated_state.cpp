// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/updated_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/ordering/nested_dissection.hpp"
#include "equidem/statics/solver_choice.hpp"

namespace equidem {

UpdatedState::UpdatedState(const Assembly& assembly_in, const ContactSprings& springs_in, DegreesOfFreedom unknowns_in,
                           std::vector<RightHandSide> cases_in, std::vector<ContactStrength> strengths,
                           const UpdatedEquilibriumOptions& options_in)
    : assembly(assembly_in),
      graph(assembly_in),
      springs(springs_in),
      first_springs(springs_in),
      unknowns(std::move(unknowns_in)),
      cases(std::move(cases_in)),
      options(options_in),
      symbolic_(std::make_shared<const SymbolicFactor>(analyze(dissect(assembly, graph), graph, unknowns.per_disc))) {
  check_memory(estimate(*symbolic_, unknowns, false), options.memory_limit);
  factor = std::make_unique<UpdatedCholesky>(symbolic_);
  blocks_ = std::make_unique<MotionBlocks>(network(), *symbolic_);
  path_offset_.assign(symbolic_->fronts(), -1);
  moved_.resize(components() * cases.size());
  std::fill(moved_.begin(), moved_.end(), 0.0);
  boundary_.assign(blocks_->boundaries() * symbolic_->block * cases.size(), 0.0);
  slot_.resize(assembly.contacts.size());
  contacts_.resize(assembly.contacts.size());
  classes_.assign(assembly.contacts.size(), never_breaks);
  remainders_.resize(assembly.contacts.size());
  forces_.assign(cases.size(), std::vector<ContactForce>(assembly.contacts.size()));
  if (!assembly.contact_arms.empty()) offsets_.resize(assembly.contacts.size());
  const double turns = unknowns.per_disc == 3 ? 1 : 0;
  for (std::size_t slot = 0; slot < contacts_.size(); ++slot) {
    const auto number = static_cast<std::size_t>(blocks_->contacts()[slot]);
    slot_[number] = static_cast<std::int32_t>(slot);
    const Contact& contact = assembly.contacts[number];
    const ContactFrame frame = frame_of(assembly, number);
    contacts_[slot] = {symbolic_->position[contact.i],
                       symbolic_->position[contact.j],
                       frame.normal,
                       turns * frame.lever_i,
                       turns * frame.lever_j,
                       springs[number],
                       strengths[number]};
    if (!offsets_.empty()) offsets_[slot] = {turns * frame.offset_i, turns * frame.offset_j};
  }
  states_.resize(blocks_->all().size());
  class_contacts();
  followed_.resize((moments() + 3 * cases.size()) * components());
  std::fill(followed_.begin(), followed_.end(), 0.0);
  for (std::size_t p = 0; p < cases.size(); ++p) {
    const RightHandSide& given = cases[p];
    base_.emplace_back(components());
    permute_to_elimination(*symbolic_, driving_motion(p).high, base_.back().high);
    double affine = 0;
    for (std::size_t c = 0; given.gradient && c < assembly.contacts.size(); ++c) {
      const ContactForce f = linear_spring_force(springs[c], affine_deformation_of(c, p));
      affine += f.normal * f.normal + f.tangential * f.tangential;
    }
    grows_[p] = !given.gradient && std::ranges::all_of(base_.back().high, [](double u) { return u == 0; });
    evaluate_forces(p);
    scales.push_back(std::max(balance(p), std::sqrt(affine)));
  }
}

std::vector<std::int32_t> UpdatedState::blocks_above(std::size_t contact) const {
  std::vector<std::int32_t> blocks;
  const Contact& c = assembly.contacts[contact];
  for (std::int32_t k = blocks_->of_front(factor->path_of(c.i, c.j).front()); k >= 0; k = (*blocks_)[k].parent) {
    blocks.push_back(k);
  }
  return blocks;
}

bool UpdatedState::boundary_motion(std::size_t number, std::vector<double>& motion) const {
  const MotionBlock& block = (*blocks_)[number];
  const auto& rows = symbolic_->rows[block.root];
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const std::size_t size = rows.size() * b;
  motion.resize(size * cases.size());
  bool any = false;
  for (std::size_t p = 0; p < cases.size(); ++p) {
    const double* now = moved_.data() + p * components();
    const double* last = boundary_.data() + (p * blocks_->boundaries() + block.boundary) * b;
    double* to = motion.data() + p * size;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (std::size_t r = 0; r < b; ++r) {
        to[k * b + r] = now[rows[k] * b + r] - last[k * b + r];
        any |= to[k * b + r] != 0;
      }
    }
  }
  return any;
}

bool UpdatedState::whole_boundary_motion(std::size_t number, std::vector<double>& motion) const {
  bool any = boundary_motion(number, motion);
  const auto& rows = symbolic_->rows[(*blocks_)[number].root];
  const auto b = static_cast<std::size_t>(symbolic_->block);
  for (std::size_t p = 0; p < cases.size(); ++p) {
    const double grown = grown_since_visit(number, p);
    if (grown == 0) continue;
    any = true;
    double* to = motion.data() + p * rows.size() * b;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (std::size_t r = 0; r < b; ++r) to[k * b + r] += grown * base_[p].high[rows[k] * b + r];
    }
  }
  return any;
}

UpdatedState::Visit UpdatedState::visit(std::size_t number, const FactorPath* path, int worker, Forces forces) {
  thread_local std::vector<double> motion;
  Visit done;
  const std::array<double, 2> reached = std::exchange(states_[number].reached, {});
  const bool to_correct = std::exchange(states_[number].to_correct, false);
  std::array<double, 2> grown{};
  for (std::size_t p = 0; p < cases.size(); ++p) grown[p] = grown_since_visit(number, p);
  const bool grew = grown[0] != 0 || grown[1] != 0;
  if (!boundary_motion(number, motion) && path == nullptr && !to_correct && !grew) return done;  // nothing has moved
  // Forces are those of (1 + more) times the base and of what was moved beside it: the former grow by this share.
  std::array<double, 2> share{};
  for (std::size_t p = 0; p < cases.size(); ++p) share[p] = grown[p] / (1 + states_[number].more[p]);
  states_[number].more = more_;
  for (const std::int32_t child : (*blocks_)[number].children) {
    for (std::size_t p = 0; p < cases.size(); ++p) states_[child].reached[p] += reached[p];
  }
  const MotionBlock& block = (*blocks_)[number];
  const auto& rows = symbolic_->rows[block.root];
  const auto& nodes = symbolic_->tree.nodes;
  const auto b = static_cast<std::size_t>(symbolic_->block);
  const std::size_t n = components();
  LargeVector<double>& x = scratch_[worker];
  // Rigid motions that nothing resists need no solution, and leave no rounding of one: x is what is beside them.
  std::array<RigidBlockMotion, most_right_sides> rigid{};
  for (std::size_t p = 0; p < cases.size(); ++p)
    rigid[p] = blocks_->rigid_motion(number, std::span(motion).subspan(p * rows.size() * b, rows.size() * b));
  for (std::size_t p = 0; p < cases.size(); ++p) {
    double* last = boundary_.data() + (p * blocks_->boundaries() + block.boundary) * b;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::array<double, 3> rigidly = blocks_->motion_at(rigid[p], number, rows[k]);
      for (std::size_t r = 0; r < b; ++r) {
        const std::size_t component = rows[k] * b + r;
        x[p * n + component] = motion[(p * rows.size() + k) * b + r] - rigidly[r];
        last[k * b + r] = moved_[p * n + component];
      }
    }
  }
  for (std::int32_t t = block.root; t >= block.first; --t) {
    const std::size_t own = nodes[t].begin * b, pivots = symbolic_->pivots(t);
    for (std::size_t p = 0; p < cases.size(); ++p) {
      double* to = x.data() + p * n + own;
      if (path != nullptr && path_offset_[t] >= 0) {
        std::copy_n(path->values.data() + path_offset_[t] + p * pivots, pivots, to);
      } else if (to_correct) {
        std::copy_n(left(p).data() + own, pivots, to);
      } else {
        std::fill_n(to, pivots, 0.0);
      }
      if (grown[p] == 0) continue;
      const double* base = of_base(p).data() + own;
      for (std::size_t k = 0; k < pivots; ++k) to[k] -= grown[p] * base[k];
    }
    factor->backward(t, {x.data(), n, cases.size()});
  }
  const std::span<const double> stiffness = factor->stiffness_in_order();
  for (std::size_t p = 0; p < cases.size(); ++p) {
    const double turned = rigid[p].spin * blocks_->extent();
    const double* base = grown[p] != 0 ? of_base(p).data() : nullptr;
    for (std::int32_t place = nodes[block.first].begin; place < nodes[block.root].end; ++place) {
      const std::array<double, 3> rigidly = blocks_->motion_at(rigid[p], number, place);
      for (std::size_t r = 0; r < b; ++r) {
        const std::size_t k = place * b + r;
        double& moved = moved_[p * n + k];
        const double before = moved;
        moved += x[p * n + k] + rigidly[r];
        done.moved[p] += squared(stiffness[k] * x[p * n + k]);
        x[p * n + k] -= share[p] * before;
        if (base != nullptr) done.moved[p] += stiffness[k] * squared(grown[p] * base[k]);
        done.accumulated[p] += squared(stiffness[k]) * (squared(moved) + squared(turned));
      }
    }
  }
  if (forces == Forces::follow) {
    const auto begin = static_cast<std::size_t>(block.contacts_begin);
    const std::size_t count = static_cast<std::size_t>(block.contacts_end) - begin;
    for (std::size_t p = 0; p < cases.size(); ++p) {
      const std::span<ContactForce> to = std::span(forces_[p]).subspan(begin, count);
      if (share[p] != 0) {
        for (ContactForce& force : to)
          force = {force.normal + share[p] * force.normal, force.tangential + share[p] * force.tangential};
        for (std::size_t k = 0; k < rows.size(); ++k) {
          for (std::size_t r = 0; r < b; ++r) {
            const std::size_t component = rows[k] * b + r;
            const double before = moved_[p * n + component] - motion[(p * rows.size() + k) * b + r];
            x[p * n + component] -= share[p] * before;
          }
        }
      }
      add_forces(std::span(contacts_).subspan(begin, count), offsets(begin, count), layout(), x.data() + p * n, to);
    }
    evaluate_block(number);
    states_[number].subtree = ClassedUtilization::unknown();  // until its children are looked at
  }
  done.fronts = block.root - block.first + 1;
  return done;
}

void UpdatedState::account(const Visit& visit) {
  visits_.fronts += visit.fronts;
  for (std::size_t p = 0; p < cases.size(); ++p) {
    visits_.moved[p] += visit.moved[p];
    visits_.accumulated[p] += visit.accumulated[p];
  }
}

void UpdatedState::bring_up_to_date(std::span<const std::int32_t> blocks, const FactorPath* path) {
  std::vector<Visit> visits(blocks.size());
  parallel_tasks(blocks.size(), [&](std::size_t k, int worker) { visits[k] = visit(blocks[k], path, worker); });
  for (const Visit& visit : visits) account(visit);
}

void UpdatedState::follow(const FactorPath& path, std::span<const std::int32_t> blocks) {
  reach_beside(path);
  grow_by(path);
  std::int32_t offset = 0;
  for (const std::int32_t t : path.fronts) {
    path_offset_[t] = offset;
    offset += static_cast<std::int32_t>(symbolic_->pivots(t) * cases.size());
  }
  // The column of a pivot of which little is left has lost digits, which this motion meets, and others after it.
  constexpr double share_that_doubles = 1.0 / 64, shares_that_double = 64;
  const double left = std::min(path.share, 1.0), lost = 1 + squared(share_that_doubles / left);
  growth_ += 1 / (shares_that_double * left);
  for (auto block = blocks.rbegin(); block != blocks.rend(); ++block) {
    Visit done = visit(*block, &path, 0);
    for (double& moved : done.moved) moved *= lost;
    account(done);
    counters.fronts += done.fronts;
  }
  for (const std::int32_t t : path.fronts) path_offset_[t] = -1;
}

ContactDeformation UpdatedState::deformation(std::size_t number, std::size_t of_case) const {
  // The base is the larger part; the rest is a difference of single doubles.
  const std::int32_t slot = slot_[number];
  const BreakingContact& c = contacts_[slot];
  const ContactOffsets beside = offsets_of(slot);
  const ContactDeformation first = opening_of(c, beside, layout(), base(of_case));
  const ContactDeformation since = opening_of(c, beside, layout(), moved_.data() + of_case * components());
  const ContactDeformation affine = affine_deformation_of(number, of_case);
  const double grown = 1 + more_[of_case];
  return {affine.normal + grown * first.normal + since.normal,
          affine.tangential + grown * first.tangential + since.tangential};
}

void UpdatedState::bring_all_up_to_date(Forces forces) {
  scratch_.resize(thread_count());
  for (auto& x : scratch_) x.resize(moved_.size());
  std::vector<std::int32_t> level, next;
  std::vector<Visit> visits;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    if ((*blocks_)[k].parent < 0) level.push_back(static_cast<std::int32_t>(k));
  }
  while (!level.empty()) {
    visits.assign(level.size(), {});
    parallel_tasks(level.size(),
                   [&](std::size_t k, int worker) { visits[k] = visit(level[k], nullptr, worker, forces); });
    for (const Visit& visit : visits) account(visit);
    next.clear();
    for (const std::int32_t k : level) {
      next.insert(next.end(), (*blocks_)[k].children.begin(), (*blocks_)[k].children.end());
    }
    std::swap(level, next);
  }
}

// A solution with L leaves a residual of some units of round-off of sqrt(K_ii K_jj) |x_j|, summed over j (Higham,
// Accuracy and Stability of Numerical Algorithms, theorem 10.4), and each addition to a motion one of half a unit of
// K_ii |u_i|. A rotation leaves as much where
// levers and branches differ by round-off of the places of discs. Roundings are independent of each other, so that
// squares add up; K is the first one, of which errors of the factor keep the size. The factors are about twice the
// largest that sequences of lattices and random networks needed to their last contact.
double UpdatedState::rounding() const {
  constexpr double of_solution = 20, of_sum = 0.6;
  double largest = 0;
  for (std::size_t p = 0; p < cases.size(); ++p) {
    if (!(scales[p] > 0)) continue;
    const double square =
        of_solution * of_solution * growth_ * visits_.moved[p] + of_sum * of_sum * visits_.accumulated[p];
    largest = std::max(largest, std::sqrt(square) / scales[p]);
  }
  return std::numeric_limits<double>::epsilon() * largest;
}

void UpdatedState::set_contact(std::size_t contact, SpringConstants k, std::span<const ContactForce> forces) {
  springs.set(contact, k, assembly.contacts.size());
  const std::int32_t slot = slot_[contact];
  contacts_[slot].springs = k;
  if (k.kN == 0 && k.kT == 0) spare(contact);
  for (std::size_t p = 0; p < forces.size(); ++p) forces_[p][slot] = forces[p];
}

ContactForce UpdatedState::force_of(std::size_t contact, std::size_t of_case) const {
  return forces_[of_case][slot_[contact]];
}

double UpdatedState::hold(std::int64_t component) {
  const double stiffness = factor->stiffness_of(component);
  holds_.push_back({component, stiffness});
  blocks_->hold(component, stiffness);
  ++counters.held;
  return stiffness;
}

double UpdatedState::moved_by(std::int64_t component, std::size_t of_case) const {
  const std::int64_t b = symbolic_->block;
  const std::int64_t place = symbolic_->position[component / b] * b + component % b;
  return moved_[of_case * components() + place] + more_[of_case] * base_[of_case].high[place];
}

bool UpdatedState::factorize() {
  constexpr int most_holds = 16;
  for (int attempt = 0; attempt < most_holds; ++attempt) {
    StiffnessMatrix matrix = assemble_stiffness(assembly, graph, springs, unknowns);
    const auto b = static_cast<std::int64_t>(symbolic_->block);
    for (const Held& held : holds_) {
      matrix.diagonal[held.component / b * b * b + held.component % b * (b + 1)] += held.stiffness;
    }
    ++counters.factorizations;
    growth_ = 1;
    const bool first = counters.factorizations == 1;
    if (factor->factorize({matrix, assembly, graph})) {
      solve_followed();
      return true;
    }
    if (first || factor->report().smallest_component < 0) return false;
    hold(factor->report().smallest_component);
  }
  return false;
}

double UpdatedState::bytes() const {
  const auto of = [](const auto& v) { return static_cast<double>(v.size() * sizeof(v[0])); };
  double bytes = factor->report().bytes + blocks_->bytes() + of(states_) + of(contacts_) + of(offsets_) + of(classes_) +
                 of(slot_) + of(moved_) + of(boundary_) + of(remainders_) + of(path_offset_) + of(followed_);
  for (const auto& x : scratch_) bytes += of(x);
  for (const auto& forces : forces_) bytes += of(forces);
  for (const PreciseMotion& motion : base_) bytes += of(motion.high) + of(motion.low);
  return bytes;
}

}  // namespace equidem
