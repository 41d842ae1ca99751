// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/breaking/motion_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "equidem/contact/linear_spring.hpp"

namespace equidem {
namespace {

constexpr std::int32_t small_subtree = 48;  // discs that are brought up to date together

/// Derivatives of stretch and slip by (e_xx, e_yy, e_xy, spin) of a homogeneous motion.
struct AffineGradient {
  std::array<double, 4> normal{}, tangential{};
};

AffineGradient affine_gradient(const ContactFrame& frame, Vec2 branch, bool turns) {
  const Vec2 n = frame.normal, s = frame.tangent();
  const std::array<Vec2, 4> motions = {Vec2{branch.x, 0}, {0, branch.y}, {branch.y, branch.x}, {-branch.y, branch.x}};
  AffineGradient g;
  for (std::size_t k = 0; k < 4; ++k) g.normal[k] = dot(motions[k], n), g.tangential[k] = dot(motions[k], s);
  if (turns) {
    g.normal[3] += frame.offset_i + frame.offset_j;
    g.tangential[3] -= frame.lever_i + frame.lever_j;
  }
  return g;
}

/// x.A x of a lower triangle by rows.
double quadratic(const std::array<double, 10>& a, const std::array<double, 4>& x) {
  double sum = 0;
  for (std::size_t r = 0, k = 0; r < 4; ++r) {
    for (std::size_t c = 0; c <= r; ++c, ++k) sum += (r == c ? 1 : 2) * a[k] * x[r] * x[c];
  }
  return std::max(sum, 0.0);
}

}  // namespace

MotionBlocks::MotionBlocks(const SpringNetwork& network, const SymbolicFactor& symbolic)
    : symbolic_(symbolic), rotation_scale_(network.unknowns.rotation_scale) {
  Vec2 low = network.assembly.centres.front(), high = low;
  for (const std::int32_t disc : symbolic.tree.order) {
    const Vec2 at = network.assembly.centres[disc];
    centres_.push_back(at);
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  extent_ = norm(high - low);
  divide();
  sort_contacts(network);
  add_energies(network);
  find_rigid_motions(network);
  for (MotionBlock& block : blocks_) describe_boundary(network, block);
}

void MotionBlocks::divide() {
  const auto& nodes = symbolic_.tree.nodes;
  const auto begin_of = [&](std::size_t t) { return nodes[nodes[t].first_descendant].begin; };
  const auto is_small = [&](std::int32_t t) { return nodes[t].end - begin_of(t) <= small_subtree; };
  block_of_front_.resize(nodes.size());
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(nodes.size()); ++t) {
    const bool small = is_small(t);
    if (small && nodes[t].parent >= 0 && is_small(nodes[t].parent)) continue;
    MotionBlock block;
    block.root = t;
    block.first = small ? nodes[t].first_descendant : t;
    block.interior_begin = begin_of(t);
    block.interior_end = nodes[t].end;
    const auto number = static_cast<std::int32_t>(blocks_.size());
    for (std::int32_t s = block.first; s <= t; ++s) block_of_front_[s] = number;
    blocks_.push_back(std::move(block));
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const std::int32_t parent = nodes[blocks_[k].root].parent;
    if (parent < 0) continue;
    blocks_[k].parent = block_of_front_[parent];
    blocks_[blocks_[k].parent].children.push_back(static_cast<std::int32_t>(k));
  }
}

void MotionBlocks::sort_contacts(const SpringNetwork& network) {
  contacts_.reserve(network.assembly.contacts.size());
  const auto& nodes = symbolic_.tree.nodes;
  for (MotionBlock& block : blocks_) {
    block.contacts_begin = static_cast<std::int64_t>(contacts_.size());
    for (std::int32_t p = nodes[block.first].begin; p < nodes[block.root].end; ++p) {
      const std::int32_t disc = symbolic_.tree.order[p];
      for (const auto& edge : network.graph.of(disc)) {
        if (symbolic_.position[edge.other] >= p) contacts_.push_back(edge.contact);
      }
    }
    block.contacts_end = static_cast<std::int64_t>(contacts_.size());
  }
}

void MotionBlocks::add_energies(const SpringNetwork& network) {
  const auto& [assembly, graph, springs, unknowns] = network;
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  const auto& nodes = symbolic_.tree.nodes;
  for (MotionBlock& block : blocks_) {  // children before their parents
    const auto lower = [&](MotionBlock::Fit fit) { block.fit = std::min(block.fit, fit); };
    for (std::int32_t p = nodes[block.first].begin; p < nodes[block.root].end; ++p) {
      for (std::size_t r = 0; r < b; ++r) {
        const std::size_t component = symbolic_.tree.order[p] * b + r;
        if (unknowns.held[component] == DegreesOfFreedom::supported) lower(MotionBlock::Fit::none);
      }
    }
    for (std::int64_t k = block.contacts_begin; k < block.contacts_end; ++k) {
      const auto number = static_cast<std::size_t>(contacts_[k]);
      const Contact& contact = assembly.contacts[number];
      if (contact.shift_x != 0 || contact.shift_y != 0) lower(MotionBlock::Fit::translation);
      const AffineGradient g = affine_gradient(frame_of(assembly, number), assembly.branch(contact), b == 3);
      const SpringConstants spring = springs[number];
      for (std::size_t r = 0, e = 0; r < 4; ++r) {
        for (std::size_t c = 0; c <= r; ++c, ++e) {
          block.affine[e] += spring.kN * g.normal[r] * g.normal[c] + spring.kT * g.tangential[r] * g.tangential[c];
        }
      }
    }
    for (const std::int32_t child : block.children) {
      lower(blocks_[child].fit);
      for (std::size_t e = 0; e < block.affine.size(); ++e) block.affine[e] += blocks_[child].affine[e];
    }
  }
}

void MotionBlocks::find_rigid_motions(const SpringNetwork& network) {
  const auto& [assembly, graph, springs, unknowns] = network;
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  const double round_off = 2 * std::numeric_limits<double>::epsilon() * extent_;
  const auto is_held = [&](std::int32_t disc) {
    bool held = false;
    for (std::size_t r = 0; r < b; ++r) held = held || network.unknowns.held[disc * b + r] != DegreesOfFreedom::free;
    return held;
  };
  for (MotionBlock& block : blocks_) {  // children before their parents
    const auto lower = [&](MotionBlock::Rigid rigid) { block.rigid = std::min(block.rigid, rigid); };
    for (const std::int32_t child : block.children) lower(blocks_[child].rigid);
    for (std::int32_t p = symbolic_.tree.nodes[block.first].begin; p < block.interior_end; ++p) {
      if (is_held(symbolic_.tree.order[p])) lower(MotionBlock::Rigid::none);
    }
    for (std::int64_t k = block.contacts_begin; k < block.contacts_end; ++k) {
      const auto number = static_cast<std::size_t>(contacts_[k]);
      const Contact& contact = assembly.contacts[number];
      if (is_held(contact.i) || is_held(contact.j)) lower(MotionBlock::Rigid::none);
      const AffineGradient g = affine_gradient(frame_of(assembly, number), assembly.branch(contact), b == 3);
      const bool slips = springs[number].kT != 0 && std::abs(g.tangential[3]) > round_off;
      if (contact.shift_x != 0 || contact.shift_y != 0 || std::abs(g.normal[3]) > round_off || slips)
        lower(MotionBlock::Rigid::translation);
    }
  }
}

void MotionBlocks::describe_boundary(const SpringNetwork& network, MotionBlock& block) {
  const auto& [assembly, graph, springs, unknowns] = network;
  const auto& rows = symbolic_.rows[block.root];
  block.boundary = static_cast<std::int64_t>(resistance_.size());
  for (const std::int32_t p : rows) {
    block.centre += centres_[p];
    double resistance = 0;
    for (const auto& edge : graph.of(symbolic_.tree.order[p])) {
      const std::int32_t other = symbolic_.position[edge.other];
      if (other < block.interior_begin || other >= block.interior_end) continue;
      const Contact& contact = assembly.contacts[edge.contact];
      const bool first = contact.i == symbolic_.tree.order[p];
      const DeformationGradient g =
          deformation_gradient(frame_of(assembly, static_cast<std::size_t>(edge.contact)), unknowns.rotation_scale);
      const SpringConstants spring = springs[edge.contact];
      const auto squared_size = [](const std::array<double, 3>& x) { return x[0] * x[0] + x[1] * x[1] + x[2] * x[2]; };
      resistance += spring.kN * squared_size(first ? g.normal_i : g.normal_j) +
                    spring.kT * squared_size(first ? g.tangential_i : g.tangential_j);
    }
    resistance_.push_back(resistance);
  }
  if (rows.empty()) return;
  block.centre = block.centre / static_cast<double>(rows.size());
  double xx = 0, xy = 0, yy = 0;
  for (const std::int32_t p : rows) {
    const Vec2 x = centres_[p] - block.centre;
    xx += x.x * x.x, xy += x.x * x.y, yy += x.y * x.y;
  }
  const double determinant = xx * yy - xy * xy;
  constexpr double flat = 1e-6;
  if (determinant > flat * (xx + yy) * (xx + yy)) {
    block.moments = {yy / determinant, -xy / determinant, xx / determinant};
  } else {
    block.fit = std::min(block.fit, MotionBlock::Fit::translation);
  }
}

void MotionBlocks::hold(std::int64_t component, double stiffness) {
  const std::int64_t b = symbolic_.block;
  const std::int32_t position = symbolic_.position[component / b];
  holds_.push_back({position, static_cast<int>(component % b), stiffness});
  for (MotionBlock& block : blocks_) {
    if (position >= block.interior_begin && position < block.interior_end) block.rigid = MotionBlock::Rigid::none;
  }
}

MotionBlocks::Homogeneous MotionBlocks::translation_of(const MotionBlock& block, std::span<const double> motion) const {
  const std::size_t count = symbolic_.rows[block.root].size(), b = static_cast<std::size_t>(symbolic_.block);
  Homogeneous fit;
  for (std::size_t k = 0; k < count; ++k) fit.translation += {motion[k * b], motion[k * b + 1]};
  fit.translation = fit.translation / static_cast<double>(std::max<std::size_t>(count, 1));
  return fit;
}

void MotionBlocks::add_gradient(const MotionBlock& block, std::span<const double> motion, Homogeneous& to) const {
  const auto& rows = symbolic_.rows[block.root];
  const auto b = static_cast<std::size_t>(symbolic_.block);
  double sxx = 0, sxy = 0, syx = 0, syy = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vec2 x = centres_[rows[k]] - block.centre;
    sxx += motion[k * b] * x.x, sxy += motion[k * b] * x.y;
    syx += motion[k * b + 1] * x.x, syy += motion[k * b + 1] * x.y;
  }
  const auto& m = block.moments;
  to.xx = sxx * m[0] + sxy * m[1], to.xy = sxx * m[1] + sxy * m[2];
  to.yx = syx * m[0] + syy * m[1], to.yy = syx * m[1] + syy * m[2];
}

RigidBlockMotion MotionBlocks::rigid_motion(std::size_t number, std::span<const double> motion) const {
  const MotionBlock& block = blocks_[number];
  if (block.rigid == MotionBlock::Rigid::none) return {};
  Homogeneous fit = translation_of(block, motion);
  if (block.rigid == MotionBlock::Rigid::any) add_gradient(block, motion, fit);
  return {fit.translation, 0.5 * (fit.yx - fit.xy)};
}

std::array<double, 3> MotionBlocks::motion_at(const RigidBlockMotion& rigid, std::size_t block,
                                              std::int32_t place) const {
  const Vec2 x = centres_[place] - blocks_[block].centre;
  return {rigid.translation.x - rigid.spin * x.y, rigid.translation.y + rigid.spin * x.x, rigid.spin * rotation_scale_};
}

double MotionBlocks::force_bound(std::size_t number, std::span<const double> motion) const {
  const MotionBlock& block = blocks_[number];
  const auto& rows = symbolic_.rows[block.root];
  const auto b = static_cast<std::size_t>(symbolic_.block);
  Homogeneous fit;
  if (block.fit != MotionBlock::Fit::none) fit = translation_of(block, motion);
  if (block.fit == MotionBlock::Fit::affine) add_gradient(block, motion, fit);
  const double shear = 0.5 * (fit.xy + fit.yx), spin = 0.5 * (fit.yx - fit.xy), turn = spin * rotation_scale_;
  const auto trial = [&](std::int32_t p) {
    const Vec2 x = centres_[p] - block.centre;
    return std::array<double, 3>{fit.translation.x + fit.xx * x.x + fit.xy * x.y,
                                 fit.translation.y + fit.yx * x.x + fit.yy * x.y, turn};
  };
  double homogeneous = quadratic(block.affine, {fit.xx, fit.yy, shear, spin});
  for (const Hold& hold : holds_) {
    if (hold.position < block.interior_begin || hold.position >= block.interior_end) continue;
    homogeneous += hold.stiffness * squared(trial(hold.position)[hold.component]);
  }
  double rest = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto there = trial(rows[k]);
    double square = 0;
    for (std::size_t r = 0; r < b; ++r) square += squared(motion[k * b + r] - there[r]);
    rest += resistance_[block.boundary + k] * square;
  }
  constexpr double margin = 1 + 1e-6;  // for round-off
  return margin * (std::sqrt(homogeneous) + std::sqrt(rest));
}

double MotionBlocks::bytes() const {
  double bytes = static_cast<double>(blocks_.size() * sizeof(MotionBlock) + block_of_front_.size() * 4 +
                                     contacts_.size() * 4 + resistance_.size() * 8 + centres_.size() * sizeof(Vec2));
  for (const MotionBlock& block : blocks_) bytes += static_cast<double>(block.children.size() * 4);
  return bytes;
}

}  // namespace equidem
