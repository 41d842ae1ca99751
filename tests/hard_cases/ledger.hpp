// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The table of hard cases: each is right to a stated accuracy, or refused with a sentence that says what to do. What a
/// test promises and measures becomes a row of data/hard_cases/tasks.csv (make_table.py).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "equidem/assembly/assembly.hpp"
#include "equidem/contact/contact_springs.hpp"
#include "equidem/core/matrix.hpp"
#include "equidem/homogenize/effective_stiffness.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/statics/equilibrium.hpp"

#include "support/fields.hpp"

namespace equidem::test {

/// An answer of the library and its distance from the truth. Errors and bounds are relative, of motions (2-norm,
/// rotations times the mean radius) or of the largest entry of the stiffness.
struct Answer {
  double error = 0;
  double bound = 0;  ///< the library's own
  double condition = 0;
  double residual = 0;
  std::optional<std::int64_t> unstable_modes = 0;
  Refusal refusal;  ///< empty where it answered
};

/// Its refusal, if it is refused.
Answer attempt(const std::function<void()>& call);

/// kN = 1e9 Pa and kT = ratio kN, of every contact.
inline ContactSprings springs_of(double ratio) {
  return ContactSprings(SpringConstants{1e9, ratio * 1e9});
}
inline const ContactSprings usual_springs = springs_of(0.4);

/// Assembly under supports and loads (no tractions), against quadruple precision.
struct Problem {
  Assembly assembly;
  ContactSprings springs;
  std::vector<Support> supports;
  LoadCase loads;
  Rotation rotation = Rotation::from_scene;
  SolverMethod method = SolverMethod::automatic;
};
Answer solve(const Problem& problem);
/// Against motions (u_x, u_y[, a theta]) that are known.
Answer solve(const Problem& problem, const std::vector<double>& exact);
/// By multigrid against elimination, within the bounds of both together.
Answer solve_by_multigrid(Problem problem);

/// Periodic cell, against quadruple precision, or a stiffness that is known.
Answer homogenize(const Assembly& cell, const ContactSprings& springs, Rotation rotation = Rotation::from_scene);
Answer homogenize(const Assembly& cell, const ContactSprings& springs, Rotation rotation, const Matrix3& exact,
                  SolverMethod method = SolverMethod::automatic);

/// One case of the table: collects what its tests ask of each task, checks it, and writes a row for each task to the
/// file that EQUIDEM_HARD_CASES names. From the first on, all cases run on as many threads as
/// EQUIDEM_HARD_CASES_THREADS says.
class HardCase {
 public:
  struct Words {
    std::string name;
    std::string why;  ///< it is hard
  };
  explicit HardCase(Words words);
  ~HardCase();
  HardCase(const HardCase&) = delete;
  HardCase& operator=(const HardCase&) = delete;

  /// The answer is within its own bound of the truth, and the bound is no more than what is promised.
  void right(const std::string& task, const Answer& answer, double promised);
  /// The sentence contains these words and says what to do.
  void refused(const std::string& task, const Answer& answer, const std::vector<std::string>& words);
  /// Anything else that was promised and checked.
  void note(const std::string& task, const std::string& promised, const std::string& measured);

 private:
  struct Accuracy {
    int runs = 0;
    double error = 0, bound = 0, condition = 0, promised = 0;  // largest
  };
  Words words_;
  std::map<std::string, Accuracy> accuracies_;  // by task
  struct Row {
    std::string task, promised, measured;
  };
  std::vector<Row> rows_;
};

}  // namespace equidem::test
