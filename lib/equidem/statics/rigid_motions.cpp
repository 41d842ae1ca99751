// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/rigid_motions.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "equidem/contact/frame.hpp"

namespace equidem {
namespace {

/// Below this share of their terms, sums count as zero.
constexpr double tolerance = 1e-9;

/// The triangular factor of a matrix of N columns whose rows come one at a time (Givens rotations): the null space of
/// all rows, without squaring them as a Gram matrix would.
template <int N>
struct TriangularFactor {
  std::array<std::array<double, N>, N> r{};

  void add(std::array<double, N> row) {
    for (int c = 0; c < N; ++c) {
      if (row[c] == 0) continue;
      const double length = std::hypot(r[c][c], row[c]);
      const double cosine = r[c][c] / length;
      const double sine = row[c] / length;
      for (int k = c; k < N; ++k) {
        const double above = r[c][k];
        r[c][k] = cosine * above + sine * row[k];
        row[k] = cosine * row[k] - sine * above;
      }
    }
  }
};

/// Orthonormal basis of the null space.
std::vector<RigidMotion> null_space(const TriangularFactor<3>& factor) {
  Eigen::Matrix3d r;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) r(i, k) = factor.r[i][k];
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullV);
  std::vector<RigidMotion> basis;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector3d v = svd.matrixV().col(c);
    if (svd.singularValues()[c] <= tolerance) basis.push_back({{v[0], v[1]}, v[2]});
  }
  return basis;
}

/// A piece, the box around it, and the equations for its motion (t, omega size).
struct Piece {
  PieceMotions motions;
  Vec2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2 high = -low;
  TriangularFactor<3> equations;
};

/// Discs that contacts with kT != 0 make roll on one another, or bending springs turn together, and the equations for
/// (gamma, omega).
struct RollingComponent {
  std::int32_t first_disc = 0;
  std::int64_t discs = 0;
  TriangularFactor<2> equations;

  /// A disc whose rotation no contact resists.
  [[nodiscard]] bool without_stiffness() const { return discs == 1 && equations.r[0][0] == 0; }
  [[nodiscard]] bool gear_mode() const { return discs > 1 && equations.r[0][0] <= tolerance; }
};

class Equations {
 public:
  Equations(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
            const DegreesOfFreedom& unknowns)
      : assembly_(assembly),
        graph_(graph),
        springs_(springs),
        unknowns_(unknowns),
        off_line_(!assembly.contact_arms.empty()) {
    assert(unknowns.held.size() == assembly.size() * unknowns.per_disc);
    measure_pieces();
    hold_translations();
    if (unknowns.per_disc == 3) {
      follow_rolling();
      close_rings();
      if (springs.bends()) turn_together();
      hold_rotations();
    } else {
      for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
        const ContactFrame frame = frame_of(assembly, c);
        if (turns_against(1, frame.offset_i + frame.offset_j, springs[c].kT))
          piece_of(assembly.contacts[c].i).equations.add({0, 0, 1});
      }
    }
  }

  FreeMotions solve() {
    FreeMotions result;
    result.pieces.reserve(pieces_.size());
    for (Piece& piece : pieces_) {
      piece.motions.free = null_space(piece.equations);
      result.pieces.push_back(std::move(piece.motions));
    }
    for (const RollingComponent& c : components_) {
      if (c.gear_mode()) result.gears.push_back({c.first_disc, c.discs});
    }
    result.unwrapped = std::move(unwrapped_);
    return result;
  }

 private:
  Piece& piece_of(std::int32_t disc) { return pieces_[unwrapped_.piece[disc]]; }

  void measure_pieces() {
    unwrapped_ = unwrap_pieces(assembly_, graph_);
    pieces_.resize(unwrapped_.count());
    for (std::size_t d = assembly_.size(); d-- > 0;) {
      Piece& piece = piece_of(static_cast<std::int32_t>(d));
      const Vec2 x = unwrapped_.centres[d];
      piece.motions.first_disc = static_cast<std::int32_t>(d);
      ++piece.motions.discs;
      piece.motions.has_contacts |= !graph_.of(d).empty();
      piece.low = {std::min(piece.low.x, x.x), std::min(piece.low.y, x.y)};
      piece.high = {std::max(piece.high.x, x.x), std::max(piece.high.y, x.y)};
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      Piece& piece = pieces_[p];
      piece.motions.centre = 0.5 * (piece.low + piece.high);
      piece.motions.size = 0.5 * norm(piece.high - piece.low);
      // A disc alone has only the rotation of discs.
      if (piece.motions.discs == 1 || unwrapped_.winds[p] != 0) piece.equations.add({0, 0, 1});
    }
  }

  void hold_translations() {
    for (std::size_t d = 0; d < assembly_.size(); ++d) {
      const std::uint8_t* held = &unknowns_.held[d * unknowns_.per_disc];
      if (held[0] == 0 && held[1] == 0) continue;
      Piece& piece = piece_of(static_cast<std::int32_t>(d));
      const PieceMotions& m = piece.motions;
      const Vec2 turned = m.discs == 1 ? Vec2{} : perpendicular(unwrapped_.centres[d] - m.centre) / m.size;
      piece.motions.held = true;
      if (held[0] != 0) piece.equations.add({1, 0, turned.x});
      if (held[1] != 0) piece.equations.add({0, 1, turned.y});
    }
  }

  /// Slip of a contact, off the line of centres its stretch, and where it bends the relative rotation, from rotations
  /// of i and j.
  struct Row {
    double i = 0, j = 0;
    bool bends = false;
    [[nodiscard]] bool joins() const { return i != 0 && j != 0; }
  };
  struct Rows {
    std::array<Row, 3> row;
    int count = 0;
  };
  [[nodiscard]] Rows rows_of(std::size_t contact) const {
    Rows rows;
    const Contact& c = assembly_.contacts[contact];
    if (springs_[contact].kT != 0) rows.row[rows.count++] = {c.lever_i, c.lever_j};
    if (off_line_) {
      const ContactArms& arms = assembly_.contact_arms[contact];
      if (arms.offset_i != 0 || arms.offset_j != 0) rows.row[rows.count++] = {arms.offset_i, arms.offset_j};
    }
    if (springs_.bending(contact) > 0) rows.row[rows.count++] = {1, -1, true};
    return rows;
  }

  /// The coefficients of theta_i = alpha_i omega + beta_i gamma, breadth first so that rounding stays small.
  void follow_rolling() {
    alpha_.resize(assembly_.size());
    beta_.resize(assembly_.size());
    component_.assign(assembly_.size(), -1);
    std::vector<std::int32_t> reached;
    for (std::size_t start = 0; start < assembly_.size(); ++start) {
      if (component_[start] >= 0) continue;
      const auto number = static_cast<std::int32_t>(components_.size());
      reached.assign(1, static_cast<std::int32_t>(start));
      component_[start] = number;
      alpha_[start] = beta_[start] = 1;
      for (std::size_t next = 0; next < reached.size(); ++next) {
        const std::int32_t i = reached[next];
        for (const auto& edge : graph_.of(i)) {
          const Contact& c = assembly_.contacts[edge.contact];
          const std::int32_t j = edge.other;
          if (component_[j] >= 0) continue;
          const Rows rows = rows_of(static_cast<std::size_t>(edge.contact));
          const auto row = std::find_if(rows.row.begin(), rows.row.begin() + rows.count, std::mem_fn(&Row::joins));
          if (row == rows.row.begin() + rows.count) continue;
          const double here = c.i == i ? row->i : row->j;
          const double there = c.i == i ? row->j : row->i;
          component_[j] = number;
          alpha_[j] = off_line_ ? 1 : row->bends ? alpha_[i] : (norm(assembly_.branch(c)) - here * alpha_[i]) / there;
          beta_[j] = -here * beta_[i] / there;
          reached.push_back(j);
        }
      }
      components_.push_back({static_cast<std::int32_t>(start), static_cast<std::int64_t>(reached.size()), {}});
    }
  }

  /// The tolerance, or more where rounding of the coordinates (far from the origin, or over a long way) hides more of
  /// the lengths and adds up around a ring.
  [[nodiscard]] double closing_tolerance() const {
    double largest = 0;
    for (const Vec2 x : unwrapped_.centres) largest = std::max({largest, std::abs(x.x), std::abs(x.y)});
    constexpr double rounding = 1e3 * std::numeric_limits<double>::epsilon();
    return std::max(tolerance, rounding * largest / assembly_.mean_radius());
  }

  /// No slip at any contact with a tangential spring.
  void close_rings() {
    if (off_line_) {
      close_rings_off_line();
      return;
    }
    const double closed = closing_tolerance();
    for (std::size_t k = 0; k < assembly_.contacts.size(); ++k) {
      if (springs_[k].kT == 0) continue;
      const Contact& c = assembly_.contacts[k];
      const double length = norm(assembly_.branch(c));
      if (c.lever_i == 0 && c.lever_j == 0) {
        piece_of(c.i).equations.add({0, 0, 1});
        continue;
      }
      double scale = 0;
      const auto sum = [&scale, closed](double p, double q, double less) {
        const double terms = std::abs(p) + std::abs(q) + less;
        scale += terms;
        const double value = p + q - less;
        return std::abs(value) <= closed * terms ? 0.0 : value;
      };
      const double omega = sum(c.lever_i * alpha_[c.i], c.lever_j * alpha_[c.j], length);
      const double gamma = sum(c.lever_i * beta_[c.i], c.lever_j * beta_[c.j], 0);
      // A lever arm of zero leaves its disc out: only the other one has gamma in this equation.
      components_[component_[c.lever_i > 0 ? c.i : c.j]].equations.add({gamma / scale, omega / scale});
    }
  }

  /// No relative rotation where contacts bend.
  void turn_together() {
    const double closed = closing_tolerance();
    for (std::size_t k = 0; k < assembly_.contacts.size(); ++k) {
      const Contact& c = assembly_.contacts[k];
      if (springs_.bending(k) == 0 || c.i == c.j) continue;
      const auto difference = [closed](double of_i, double of_j) {
        const double terms = std::abs(of_i) + std::abs(of_j);
        return std::abs(of_j - of_i) <= closed * terms ? 0.0 : (of_j - of_i) / terms;
      };
      components_[component_[c.i]].equations.add(
          {difference(beta_[c.i], beta_[c.j]), difference(alpha_[c.i], alpha_[c.j])});
    }
  }

  /// Neither slip nor stretch; arms that meet leave no term in omega.
  void close_rings_off_line() {
    for (std::size_t k = 0; k < assembly_.contacts.size(); ++k) {
      const Contact& c = assembly_.contacts[k];
      const Rows rows = rows_of(k);
      for (int r = 0; r < rows.count; ++r) {
        const double of_i = rows.row[r].i * beta_[c.i], of_j = rows.row[r].j * beta_[c.j];
        const double scale = std::abs(of_i) + std::abs(of_j), gamma = of_i + of_j;
        if (scale == 0) continue;
        const bool closed = std::abs(gamma) <= tolerance * scale;
        components_[component_[of_i != 0 ? c.i : c.j]].equations.add({closed ? 0.0 : gamma / scale, 0});
      }
    }
  }

  /// Rows of held rotations; then gamma is eliminated, and the equation of a component for omega is added to those of
  /// its piece.
  void hold_rotations() {
    std::vector<std::uint8_t> no_stiffness(components_.size());
    for (std::size_t k = 0; k < components_.size(); ++k) no_stiffness[k] = components_[k].without_stiffness() ? 1 : 0;
    for (std::size_t d = 0; d < assembly_.size(); ++d) {
      if (unknowns_.held[3 * d + 2] == 0 || no_stiffness[component_[d]] != 0) continue;
      piece_of(static_cast<std::int32_t>(d)).motions.held = true;
      const double scale = std::abs(alpha_[d]) + std::abs(beta_[d]);
      components_[component_[d]].equations.add({beta_[d] / scale, alpha_[d] / scale});
    }
    for (const RollingComponent& component : components_) {
      const auto& r = component.equations.r;
      Piece& piece = piece_of(component.first_disc);
      if (std::abs(r[1][1]) > tolerance) piece.equations.add({0, 0, r[1][1]});
      if (std::abs(r[0][1]) > tolerance) piece.motions.rolls = true;
    }
  }

  const Assembly& assembly_;
  const ContactGraph& graph_;
  const ContactSprings& springs_;
  const DegreesOfFreedom& unknowns_;
  bool off_line_;  ///< contacts have arms, and their arms meet
  UnwrappedPieces unwrapped_;
  std::vector<Piece> pieces_;
  std::vector<RollingComponent> components_;
  std::vector<std::int32_t> component_;
  std::vector<double> alpha_, beta_;
};

}  // namespace

FreeMotions find_free_motions(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                              const DegreesOfFreedom& unknowns) {
  return Equations(assembly, graph, springs, unknowns).solve();
}

}  // namespace equidem
