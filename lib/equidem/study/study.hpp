// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Definition of a study: settings to try, quantities to measure, reference values.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "equidem/core/names.hpp"

namespace equidem {

/// One way to compute a result.
struct Setting {
  std::string problem = {};  ///< problem solved; results for one problem compete. Empty where there is only one
  std::string method = {};   ///< by what; empty where there is only one
  std::vector<std::pair<std::string, double>> values = {};  ///< what is varied, by name
  double size = 0;                                          ///< of the problem, in what Study::size names; 0: none
  /// h > 0, smaller is finer: errors of a method of order p fall as h^p. Not a number: nothing is refined.
  double resolution = std::numeric_limits<double>::quiet_NaN();

  /// "rows = 33", "energy_map, time_step = 0.001": without the problem.
  [[nodiscard]] std::string label() const;
};

/// Reference values of errors.
enum class Truth {
  known,   ///< from a closed form or an independent method: Quantity::truth; 0 where a setting measures an error itself
  finest,  ///< the value at the finest level of the same problem and method, whose own error is not known
  richardson,  ///< the limit of the two finest levels of the same problem and method, by the order of theory
};

template <>
struct EnumNames<Truth> {
  using enum Truth;
  static constexpr const char* what = "kind of truth";
  static constexpr NamedValue<Truth> list[] = {{finest, "finest"}, {richardson, "richardson"}, {known, "known"}};
};

/// Something that is measured.
struct Quantity {
  std::string name;        ///< "poisson_ratio"
  std::string label = {};  ///< of its axis: "error of Poisson's ratio"; facts: "bytes per disc"
  /// A fact has no reference value: it is reported beside the errors.
  bool fact = false;
  /// A fact that is the resolution of its setting, known only by measurement.
  bool resolution = false;
  bool relative = false;    ///< errors are divided by the truth
  double truth = 0;         ///< Truth::known
  std::string source = {};  ///< of the truth: "closed form, Abe (1996), eq. (22)"
  double rounding = 1e-15;  ///< errors below are rounding: shown as this, and no part of an order
};

/// The order of a method by theory.
struct ExpectedOrder {
  std::string problem = {}, method = {}, quantity = {};  ///< empty: all
  double order = 1;
  std::string why = {};  ///< of it, or of what deviates from it
};

/// A setting made ready to be carried out once.
struct Trial {
  std::function<void()> work;  ///< timed
  std::function<std::vector<double>()>
      values;  ///< afterwards, not timed: one per quantity; not a number where it has none
};

/// A setting and how to carry it out. The work is the same each time, to the last bit.
struct StudyTask {
  Setting setting;
  std::function<Trial()> prepare;  ///< not timed
};

/// A task on a state of its own, which all its steps share.
/// \param start() makes the state; work(state) is timed; values(state) are read afterwards
template <class Start, class Work, class Values>
StudyTask task_on(Setting setting, Start start, Work work, Values values) {
  return {std::move(setting), [=] {
            const auto state = std::make_shared<std::invoke_result_t<Start>>(start());
            return Trial{.work = [=] { work(*state); }, .values = [=] { return values(*state); }};
          }};
}

struct Study {
  std::string name;
  std::string title;
  std::vector<Quantity> quantities;
  std::vector<StudyTask> tasks;
  Truth truth = Truth::known;
  std::vector<ExpectedOrder> orders = {};
  std::vector<std::string> notes = {};  ///< sentences: what is computed, and what to make of it
  /// Where problems differ in their size: what it counts, "discs", and the errors to which the methods are compared, by
  /// the time of the cheapest setting of each against the size.
  std::string size = {};
  std::vector<double> compared = {};
  /// Equal pieces of the work of each setting, such as a step of one disc: the time of one is reported. 0: none.
  double pieces = 0;
  std::string piece = {};  ///< name of one: "disc-step"

  /// The first entry that fits; empty: no theory.
  [[nodiscard]] const ExpectedOrder* expected(const Setting& setting, const std::string& quantity) const;
  /// Checksum of name, quantities, truth and settings, as 16 hexadecimal digits: measurements of studies with one sum
  /// fit together. \param context what else they depend on, such as machine and build
  [[nodiscard]] std::string checksum(const std::string& context) const;
};

}  // namespace equidem
