// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The rate problem in the space of a few contacts on limits, where each combination of their statuses is decided.
///
/// With all these contacts sticking the network is K_s, and e are what they open and slip. Their forces are
///
///   F = F_s - S e,   S = B - B C_s B,   B = diag(kN, kT),   C_s = G K_s^-1 G^T.
///
/// In the units F/sqrt(B), e sqrt(B) the matrix is I - sqrt(B) C_s sqrt(B), and its eigenvalues lie in [0, 1] where no
/// other contact slips: a pivot counts as zero beside 1. A status sets components of e or of F to zero:
///
///   sticks  e = 0                        |T| <= -mu N
///   opens   N = T = 0                    e_N >= 0
///   slips   e_N = 0, s T = -mu N         s e_T >= 0, N <= 0      s: the side, +1 or -1
///
/// The equations of a combination may leave motions free that change no force, as of a disc that rolls on all its
/// contacts. It is then an answer if some such motion satisfies the inequalities.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "equidem/breakage/unbonded/contact_rates.hpp"

namespace equidem {

enum class Verdict : std::uint8_t {
  none,       ///< the equations or an inequality are violated by more than round-off
  answer,     ///< inequalities hold by more than round-off, or of contacts that rest
  tie,        ///< an inequality holds within round-off only
  undecided,  ///< whether the equations have a solution hangs on round-off
};

struct Combination {
  Verdict verdict = Verdict::none;
  std::vector<double> e;                 ///< sqrt(B) e, per component
  std::vector<ContactForce> force;       ///< rates, per contact on a limit
  std::vector<ContactDeformation> rate;  ///< per contact on a limit
};

class CondensedRates {
 public:
  /// \param tried places in RateProblem::limits, ascending; the other contacts on limits keep the statuses given
  /// \param solver is left with other tangents
  CondensedRates(const RateProblem& problem, TangentSolver& solver, std::span<const std::size_t> tried,
                 std::vector<ContactStatus> status);

  /// Whether loads are carried while the contacts that are tried stick, and S is known to more than round-off.
  [[nodiscard]] bool known() const { return known_; }
  /// \param of_tried statuses, one for each contact that is tried
  /// \param same forces, per contact on a limit: a combination that can have no others is Verdict::none; empty: none
  [[nodiscard]] Combination decide(std::span<const ContactStatus> of_tried, std::span<const ContactForce> same) const;
  /// Whether two sets of forces are those of one answer but for round-off.
  [[nodiscard]] bool equal(std::span<const ContactForce> a, std::span<const ContactForce> b,
                           std::span<const ContactDeformation> rate) const;
  /// Motions and lambda of a combination, to begin with.
  [[nodiscard]] Rates rates(const Combination& combination) const;

 private:
  /// A quantity that is constant + by . sqrt(B) e.
  struct Line {
    double constant = 0;
    std::vector<double> by;
  };
  struct Component {
    std::size_t place;  // in RateProblem::limits
    bool tangential;
    double root;  // sqrt of its spring
  };
  /// N/sqrt(kN) and T/sqrt(kT) by the elastic law of the contact, and its openings and slips.
  struct Felt {
    Line normal, tangential;
    std::size_t opens, slips;  // places in components_; none: components_.size()
  };
  struct Equations;

  [[nodiscard]] double ratio(std::size_t place) const;  // mu sqrt(kN/kT)
  [[nodiscard]] const UnbondedLaw& law(std::size_t place) const {
    return problem_.laws[problem_.limits[place].contact];
  }
  void respond(TangentSolver& solver);
  [[nodiscard]] Line limit_line(std::size_t place, double side) const;
  void add_conditions(std::size_t place, ContactStatus status, Equations& equations) const;
  [[nodiscard]] Combination at(std::vector<double> e, std::span<const ContactStatus> status) const;
  [[nodiscard]] double round_off(std::span<const double> e) const;

  const RateProblem& problem_;
  std::vector<std::size_t> tried_;
  std::vector<ContactStatus> status_;  // per contact
  std::vector<Component> components_;
  std::vector<Felt> felt_;  // per contact on a limit
  Rates sticking_;
  std::vector<std::vector<double>> motion_;  // per component of sqrt(B) e
  std::vector<double> lambda_;
  double size_ = 0;   // of rates of force, in the units above
  double noise_ = 0;  // of S
  bool known_ = false;
};

}  // namespace equidem
