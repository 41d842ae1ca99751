// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The numbers of a result that its page shows first.
/// Checks of a run in time: whether it may be trusted.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "equidem/output/results.hpp"

namespace equidem {

struct Answer {
  std::string label;
  double value = 0;
  std::string text;        ///< HTML
  std::string unit = {};   ///< with its prefix
  std::string error = {};  ///< HTML: a bound or a standard error, with its unit
};

struct Answers {
  std::vector<Answer> main;     ///< at most four
  std::vector<Answer> quality;  ///< errors, residuals and what else tells how far the answer may be trusted
};

/// Whether a verb has a page: its numbers are listed in answers.cpp.
bool has_page(std::string_view verb);

Answers answers_of(std::string_view verb, const Results& results);

/// A number in HTML: "0.120432", "1.8 × 10⁻¹⁹" with an element for the exponent.
std::string number_html(double value, int digits = 6);

struct TrustCheck {
  enum class Verdict { good, doubtful, bad };
  Verdict verdict = Verdict::good;
  std::string name;         ///< "time step"
  std::string found;        ///< "0.8 of the critical one"
  std::string advice = {};  ///< what to change; empty where nothing is
};

/// Limits of the checks. A step up to half the critical one is safe for several contacts at a body; an overlap of a
/// hundredth of the radius changes normals and contact areas by about as much, which a linear contact law neglects; the
/// balance of energies is that of run_results.
struct TrustLimits {
  double safe_step_of_contact = 0.5;  ///< over that of one contact: its bodies may have several
  double small_overlap = 0.01, large_overlap = 0.05;
  double small_imbalance = 1e-3, large_imbalance = 0.1;  ///< of the largest energy
  double small_unbalanced_force = 1e-6, large_unbalanced_force = 1e-3;
};

/// Step over critical step, largest overlap over radius, balance of the energies or of the forces, and whether springs
/// without negative stiffness can have the Poisson's ratio; those that the results tell.
/// \param results of the verb run
std::vector<TrustCheck> trust_checks(const Results& results, const TrustLimits& limits = {});

}  // namespace equidem
