// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

#include "fujioka2005/fujioka2005.hpp"

namespace equidem::fujioka2005 {
namespace {

struct Printed1 {
  const char* law;
  double run, evaluation;  ///< s, microseconds
  double count;
};
constexpr std::array printed1{Printed1{"C", 423, 1.88, 1.87e7}, Printed1{"T", 341, 1.91, 1.26e7},
                              Printed1{"F", 269, 1.95, 5.62e6}, Printed1{"P", 306, 1.96, 1.07e7}};

std::string label_of(const Variant& variant) {
  return fmt::format("{:<8}a = {:<6g}", variant.label, variant.a);
}

/// A row of a table without the blanks of its last columns.
std::string trimmed(std::string row) {
  row.erase(row.find_last_not_of(" \n") + 1);
  return row + "\n";
}

std::string table_1(const Table1& table) {
  constexpr const char* row_format = "  {:<20}{:>8}{:>13}{:>15}{:>10}{:>13}{:>22}{:>8}{:>16}\n";
  std::string text = fmt::format("Table 1: 16 balls fall and come to rest, {:g} s\n", table.duration);
  text += fmt::format(row_format, "", "step", "evaluations", "gravity first", "run", "law alone",
                      "printed: evaluations", "run", "one evaluation");
  for (const Table1Row& row : table.rows) {
    std::array<std::string, 3> beside;
    for (const Printed1& printed : printed1) {
      if (row.variant.label != printed.law) continue;
      beside = {fmt::format("{:.3g}", printed.count), fmt::format("{} s", printed.run),
                fmt::format("{:.2f} µs", printed.evaluation)};
    }
    text += trimmed(fmt::format(row_format, label_of(row.variant), fmt::format("{:.0e} s", row.step),
                                fmt::format("{:.3g}", double(row.evaluations)),
                                row.gravity_first > 0 ? fmt::format("{:.3g}", double(row.gravity_first)) : "-",
                                fmt::format("{:.3g} s", row.run_seconds),
                                fmt::format("{:.3g} ns", row.evaluation_nanoseconds), beside[0], beside[1], beside[2]));
  }
  const double resting = 16 * (table.duration - table.rest_time) / 1e-6;
  text += fmt::format(
      "  The paper states a step of 1e-5 s and 5e6 steps, 50 s. A rigid ball lies still from {:.4f} s on; 16\n"
      "  balls of which every step counts from then on make {:.3g} evaluations in 5 s with a step of 1e-6 s,\n"
      "  C's printed number, but {:.3g} in 50 s with 1e-5 s: the run was of 5 s and 1e-6 s{}.\n"
      "  C itself lies still sooner here, its ratio being low at most phases.\n"
      "  With gravity after the contact force (as Table 2 asks) F and P lie still like C. The printed counts of\n"
      "  F and P, {:.2f} and {:.2f} of C's, need balls that go on bouncing; gravity added before the contact\n"
      "  force does that, in the same proportion of P to F ({:.2f}, printed 1.90) though not the same number.\n"
      "  T's printed count follows from neither order.\n"
      "  X needs no small step: \"X stiff\" makes the same run with 1e-3 s.\n"
      "  One evaluation costs P {:+.0f} % against C here (the paper: +4 %), {:.1f} ns of about {:.0f} ns that a\n"
      "  step of a ball takes in all.\n",
      table.rest_time, resting, 16 * (50 - table.rest_time) / 1e-5,
      table.step > 1e-6 ? fmt::format(" (here {:g} s)", table.step) : "", printed1[2].count / printed1[0].count,
      printed1[3].count / printed1[0].count, double(table.rows[3].gravity_first) / double(table.rows[2].gravity_first),
      100 * (table.rows[3].evaluation_nanoseconds / table.rows[0].evaluation_nanoseconds - 1),
      table.rows[3].evaluation_nanoseconds, table.rows[3].run_seconds * 1e9 / (16 * table.duration / table.step));
  return text;
}

std::string table_2(const std::vector<Table2Row>& rows) {
  std::string text = "Table 2: steps in contact, first impact of the slow ball\n";
  text += "                       step 1e-3   1e-4   1e-5 s   printed\n";
  constexpr std::array printed{"9, 10, 10", "14, 23, 37", "2, 1, 1", "3, 3, 3"};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Table2Row& row = rows[k];
    text += trimmed(fmt::format("  {}  {:>12}  {:>5}  {:>5}      {}", label_of(row.variant), row.steps[0], row.steps[1],
                                row.steps[2], k < printed.size() ? printed[k] : ""));
  }
  return text;
}

std::string impacts(const std::string& title, const std::vector<Impacts>& laws) {
  std::string text = title + "\n                      impacts";
  for (const int n : {1, 2, 5, 10, 15, 20}) text += fmt::format("{:>9}", fmt::format("N = {}", n));
  text += "   worst |ratio - 0.49|   deepest\n";
  for (const Impacts& law : laws) {
    text += fmt::format("  {}  {:>8}{}", label_of(law.variant), law.ratio.size(), law.ratio.size() == 20 ? "+" : " ");
    for (const std::size_t n : {1U, 2U, 5U, 10U, 15U, 20U}) {
      text += n <= law.ratio.size() ? fmt::format("  {:.5f}", law.ratio[n - 1]) : "        -";
    }
    double worst = 0;
    for (const double ratio : law.ratio) worst = std::max(worst, std::abs(ratio - restitution * restitution));
    text += fmt::format("   {:>12.1e}         {:>9.2g} d{}\n", worst, law.deepest, law.ran_away ? ", runs away" : "");
  }
  return text;
}

double sweeps_of(const Stacked& law) {
  const auto at = std::find_if(law.points.begin(), law.points.end(),
                               [](const StackedPoint& point) { return std::abs(point.step / 1e-4 - 1) < 0.01; });
  return at->sweeps;
}

std::string stacked_spheres(const std::vector<Stacked>& laws) {
  std::string text = fmt::format(
      "Figs. 10, 11: stacked spheres; exact d' = {:.12f}, T0 = {:.12f} s (the paper's sum (31) is low by {:g})\n"
      "                      error of d' at a step of (s)              error of T0                            order\n"
      "                           1e-3     1e-4     1e-5     1e-6        1e-3     1e-4     1e-5     1e-6     of d'  of "
      "T0\n",
      exact_speed, exact_parting, printed_parting_error);
  for (const Stacked& law : laws) {
    text += law.label == law.variant.label ? fmt::format("  {}  ", label_of(law.variant)) : "  C, no lag           ";
    for (const auto error : {&StackedPoint::speed_error, &StackedPoint::parting_error}) {
      text += "   ";
      for (const double step : {1e-3, 1e-4, 1e-5, 1e-6}) {
        const auto at = std::find_if(law.points.begin(), law.points.end(),
                                     [&](const StackedPoint& p) { return std::abs(p.step / step - 1) < 0.01; });
        text += at == law.points.end() ? "        -" : fmt::format("  {:.1e}", (*at).*error);
      }
    }
    text += fmt::format("    {:>6.2f}  {:>5.2f}\n", law.speed_order, law.parting_order);
  }
  text += fmt::format("  Sweeps of X in a step of 1e-4 s: {:.1f} (a = 0.1), {:.1f} (a = 4).\n", sweeps_of(laws[4]),
                      sweeps_of(laws[5]));
  text +=
      "  C stops improving (orders near 0, as printed): its closing speed is the velocity of the step before\n"
      "  along the normal of this step, low by (v_t²/L) dt/2, which the dashpot, whose damping for a step is\n"
      "  held with a, turns into an adhesion that no step removes. Closing taken as d_j - d_{j-1} (last line)\n"
      "  removes it. T has none: its damping vanishes with d^(1/4). F and P coincide, the contacts last and\n"
      "  only their first step differs; the paper shows them apart, F often the better.\n"
      "  T0 is the step in which B and C part, known to a step: order 1 at best.\n";
  return text;
}

/// The time of the cheapest point with an error of at most `wanted`; negative: none.
template <class Points, class Error>
double cheapest(const Points& points, Error error, double wanted) {
  double least = -1;
  for (const auto& point : points) {
    if (point.seconds > 0 && point.*error <= wanted && (least < 0 || point.seconds < least)) least = point.seconds;
  }
  return least;
}

template <class Laws, class Error>
std::string costs(const std::string& title, const Laws& laws, Error error, std::initializer_list<double> wanted) {
  std::string text = title + "\n                               ";
  for (const double accuracy : wanted) text += fmt::format("{:>10.0e}", accuracy);
  text += "\n";
  for (const auto& law : laws) {
    if (law.points.front().seconds <= 0) continue;
    text += fmt::format("  {:<28} ", law.label == law.variant.label ? label_of(law.variant) : law.label);
    for (const double accuracy : wanted) {
      const double seconds = cheapest(law.points, error, accuracy);
      text += seconds < 0 ? "         -" : fmt::format("{:>8.2g} s", seconds);
    }
    text += "\n";
  }
  return text;
}

std::string at_rest(const std::string& title, const std::vector<Rest>& laws) {
  std::string text = title +
                     "\n                     speed at the end   energy above rest     overlap at the floor   steps in "
                     "contact\n                     (of g dt)          (of weight x d)       (of the static one)\n";
  for (const Rest& law : laws) {
    text += fmt::format("  {}   {:>10.2g}         {:>10.1e}            {:>10.6f}             {:>5.1f} %\n",
                        label_of(law.variant), law.speed, std::max(0.0, law.energies.back()), law.overlap,
                        100 * law.contact);
  }
  return text;
}

std::string lossless(const std::vector<Rest>& laws) {
  std::string text = fmt::format(
      "A column of {} balls without loss, e = 1, bounces for {:.0f} s: energy, relative change (not in the paper)\n"
      "                      at the end   largest\n",
      laws.front().balls, laws.front().times.back());
  for (const Rest& law : laws) {
    double largest = 0;
    for (const double energy : law.energies) largest = std::max(largest, std::abs(energy / law.energies.front() - 1));
    text += fmt::format("  {}   {:>+9.1e}   {:>7.1e}\n", label_of(law.variant),
                        law.energies.back() / law.energies.front() - 1, largest);
  }
  return text;
}

constexpr const char* introduction =
    "Fujioka & Ushijima (2005): normal contact with energy conservation\n"
    "\n"
    "C: Cundall's spring and dashpot (linear_dashpot), T: Tanaka's Hertz spring (hertz_dashpot), F: the\n"
    "authors' earlier model (five_case_map), P: the paper's (energy_map), X: ours (exact_flow).\n"
    "e = 0.7, g = 9.8 m/s², spheres of 225 m, step 1e-3 s unless said.\n"
    "What the paper leaves unsaid, read off Table 2: the dimensionless stiffness a = k dt²/m is held while\n"
    "the step changes, 0.10 for C, F and P, 4.62 for T (k d_c^(1/2) dt²/m); velocities first, then positions\n"
    "(semi-implicit Euler); gravity is added after the contact force; contacts of C and T last while the\n"
    "bodies overlap, e = exp(-pi zeta/sqrt(1 - zeta²)), though the force then attracts at the end. X ends\n"
    "where the force does.\n";

constexpr const char* about_x =
    "X, the law that is better at rest and in clusters\n"
    "  In a step a contact feels all else (gravity, the other contacts of its bodies) as a force that is\n"
    "  linear in time, m (h0 + h1 t), of the same impulse and first moment. Spring and dashpot then obey\n"
    "  u'' + 2 zeta w u' + w² u = h0 + h1 t, and u'' = h0 + h1 t while apart, whose solutions are known; contacts\n"
    "  begin and end inside the step, where these say so. The impulse of the contact changes the velocities\n"
    "  of its bodies, its first moment their positions; the contacts are solved in turn until all agree. It\n"
    "  keeps: one contact, exact at any step and stiffness (any e, any energy, to round-off); straight\n"
    "  clusters with e = 1, a symplectic map of fourth order, whose energy does not drift, stable for w dt <\n"
    "  2.25 in a chain; rest, exact, at m g/k, a steady force being one of the linear ones. A contact that\n"
    "  begins or ends within the step is a kink in the force that others feel of it: that is what is left of\n"
    "  error in clusters that collide, and stiff ones (a = 4) feel it.\n"
    "  P steps round an ellipse of one contact's energy, without gravity and the other contacts: one ball\n"
    "  rests at (1 + a)/2 of m g/k, a column never.\n"
    "  The price of X is a dearer evaluation (Table 1), and several sweeps over a cluster in a step. For one\n"
    "  contact it is repaid a hundredfold, as the step need not resolve the contact; for the stacked spheres\n"
    "  it is not: P is cheaper there at equal error of d'.\n";

}  // namespace

std::string report(const Reproduction& r) {
  std::string text = introduction;
  text += "\n" + table_1(r.table1) + "\n" + table_2(r.table2);
  text += "\n" + impacts("Fig. 4: energy ratio of slow impacts (theory 0.49), ball dropped by 0.01 diameters", r.slow);
  text +=
      "  Where flights last but a few steps, gravity in the step of contact spoils the ratio of C, F, P; X at\n"
      "  a = 0.1 is the soft spring's true answer under gravity, and, stiff, stays with the rigid ball.\n";
  text += "\n" + impacts("Figs. 5 to 7: fast impacts, 1e5 m/s, 0.444 diameters in a step", r.fast);
  text +=
      "  C sinks deeper than a diameter in the first impact and comes back, the floor being a half space; the\n"
      "  paper loses it at the second. T with the stiffness of Table 2 is unstable here: it gives more energy\n"
      "  back than came in. Flights are made at once, by the formula that their steps follow.\n";
  text += "\n" + stacked_spheres(r.stacked);
  text += "\n" + costs("Stacked spheres: least time of computing for a relative error of d' of", r.stacked,
                       &StackedPoint::speed_error, {1e-2, 1e-3, 1e-4, 1e-5, 1e-6});
  text += "\n" + costs("Bouncing ball, 3 s: least time for an rms error of the height, of the drop, of", r.ball,
                       &BallPoint::error, {1e-1, 1e-2, 1e-3, 1e-4, 1e-6});
  text += "\n" + at_rest("One ball at rest (not in the paper)", r.rest);
  text +=
      "\n" + at_rest(fmt::format("A column of {} balls at rest (not in the paper)", r.column.front().balls), r.column);
  text += "\n" + lossless(r.lossless);
  return text + "\n" + about_x;
}

}  // namespace equidem::fujioka2005
