// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "equidem/core/text.hpp"

#include "fujioka2005/fujioka2005.hpp"
#include "tables.hpp"

namespace equidem::fujioka2005 {
namespace {

/// Begins a row: law and stiffness.
std::string cells_of(const Variant& variant) {
  return fmt::format("{} & {:g}", variant.label, variant.a);
}

std::string table_1(const Table1& table1) {
  struct Printed {
    double run, evaluation;  ///< s, microseconds
    double count;
  };
  constexpr std::array printed{Printed{423, 1.88, 1.87e7}, Printed{341, 1.91, 1.26e7}, Printed{269, 1.95, 5.62e6},
                               Printed{306, 1.96, 1.07e7}};
  TextTable table(
      "law & a & step & evaluations & gravity first & run & law alone & printed: evaluations & run & one evaluation");
  const std::vector<Table1Row>& rows = table1.rows;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Table1Row& row = rows[k];
    const std::string first = row.gravity_first > 0 ? fmt::format("{:.3g}", double(row.gravity_first)) : "-";
    const std::string beside = k < printed.size() ? fmt::format(" & {:.3g} & {} s & {:.2f} µs", printed[k].count,
                                                                printed[k].run, printed[k].evaluation)
                                                  : "";
    table.add("{} & {:.0e} s & {:.3g} & {} & {:.3g} s & {:.3g} ns{}", cells_of(row.variant), row.step,
              double(row.evaluations), first, row.run_seconds, row.evaluation_nanoseconds, beside);
  }
  const double c = printed[0].count;
  return fmt::format("Table 1: 16 balls fall and come to rest, {:g} s; times are of the processor\n", table1.duration) +
         table.text() +
         fmt::format(
             "  The paper states a step of 1e-5 s and 5e6 steps, 50 s. A rigid ball is at rest from {:.4f} s on; 16\n"
             "  balls in contact at every later step make {:.3g} evaluations in 5 s with a step of 1e-6 s, which is\n"
             "  the printed number of C, but {:.3g} in 50 s with 1e-5 s: the run was of 5 s and 1e-6 s{}.\n"
             "  C itself comes to rest sooner here, since its ratio is low at most phases of the impact.\n"
             "  With gravity after the contact force (as Table 2 requires) F and P come to rest like C. The printed\n"
             "  counts of F and P, {:.2f} and {:.2f} of that of C, need balls that continue to bounce; with gravity\n"
             "  before the contact force they do, in the same proportion of P to F ({:.2f}, printed 1.90), though not\n"
             "  with the same counts. The printed count of T follows from neither order.\n"
             "  X needs no small step: \"X stiff\" makes the same run with 1e-3 s.\n"
             "  An evaluation of P costs {:+.0f} % against C here (the paper: +4 %), in a loop of evaluations alone,\n"
             "  of which the compiler may compute several of C at once;\n"
             "  with {:.1f} of about {:.0f} ns per ball and step the whole run of P takes {:+.0f} % against C.\n",
             table1.rest_time, 16 * (table1.duration - table1.rest_time) / 1e-6, 16 * (50 - table1.rest_time) / 1e-5,
             table1.step > 1e-6 ? fmt::format(" (here {:g} s)", table1.step) : "", printed[2].count / c,
             printed[3].count / c, double(rows[3].gravity_first) / double(rows[2].gravity_first),
             100 * (rows[3].evaluation_nanoseconds / rows[0].evaluation_nanoseconds - 1),
             rows[3].evaluation_nanoseconds, rows[3].run_seconds * 1e9 / (16 * table1.duration / table1.step),
             100 * (rows[3].run_seconds / rows[0].run_seconds - 1));
}

std::string table_2(const std::vector<Table2Row>& rows) {
  TextTable table("law & a & 1e-3 s & 1e-4 s & 1e-5 s & printed");
  constexpr std::array printed{"9, 10, 10", "14, 23, 37", "2, 1, 1", "3, 3, 3"};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& steps = rows[k].steps;
    table.add("{} & {} & {} & {}{}", cells_of(rows[k].variant), steps[0], steps[1], steps[2],
              k < printed.size() ? fmt::format(" & {}", printed[k]) : "");
  }
  return "Table 2: steps in contact at three time steps, first impact of the slow ball\n" + table.text();
}

std::string mended(const std::vector<PrintedRow>& rows) {
  TextTable table("law P & a & mean & least & largest");
  for (const PrintedRow& row : rows)
    table.add("{} & {:g} & {:.6f} & {:.6f} & {:.6f}", row.name, row.a, row.mean, row.least, row.largest);
  return "Corrections to the paper\n"
         "  (16): f_(j-1)/s_j is a name of the force f^ alone. (18): the left side is the corrected energy E^, not K.\n"
         "  (20): d_j is the corrected depth d^. Mode 2: where (21) gives d' <= 0, that is for s >= sqrt(1 - a), the\n"
         "  contact is left by (23); the energy a d²/2 would be lost otherwise. (26): h h' + d d' = 0. (31): the step "
         "of\n"
         "  the sum is (sqrt3/2 - k)/N. Figs. 4, 5: the ratio is e², not e^(1/2). Energy after over before one impact\n"
         "  without gravity, over 4000 phases of the contact step (theory 0.49):\n" +
         table.text();
}

std::string table_of(const std::vector<Impacts>& laws, std::vector<double> Impacts::*ratio) {
  TextTable table(
      "law & a & impacts & N = 1 & 2 & 3 & 4 & 5 & 6 & 7 & 8 & 9 & 10 & 15 & 20 & worst to 10 & worst & deepest & ");
  for (const Impacts& law : laws) {
    const std::vector<double>& ratios = law.*ratio;
    std::string cells = fmt::format("{} & {}{}", cells_of(law.variant), ratios.size(), ratios.size() == 20 ? "+" : " ");
    for (const std::size_t n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 15, 20})
      cells += n <= ratios.size() ? fmt::format(" & {:.4f}", ratios[n - 1]) : " & -";
    double early = 0, worst = 0;
    for (std::size_t n = 0; n < ratios.size(); ++n) {
      worst = std::max(worst, std::abs(ratios[n] - theory));
      if (n < 10) early = worst;
    }
    table.add("{} & {:.1e} & {:.1e} & {:.2g} d & {}", cells, early, worst, law.deepest, law.ran_away ? "unstable" : "");
  }
  return table.text();
}

/// The point at a step; null: none.
const CurvePoint* point_at(const Curve& curve, double step) {
  const auto at = std::find_if(curve.points.begin(), curve.points.end(),
                               [&](const CurvePoint& p) { return std::abs(p.step / step - 1) < 0.01; });
  return at == curve.points.end() ? nullptr : &*at;
}

std::string stacked_spheres(const std::vector<Curve>& curves) {
  TextTable table(
      "law & a & d': 1e-3 s & 1e-4 s & 1e-5 s & 1e-6 s & order & T0: 1e-3 s & 1e-4 s & 1e-5 s & 1e-6 s & order");
  for (const Curve& curve : curves) {
    std::string cells = fmt::format("{} & {:g}", curve.label, curve.variant.a);
    for (const auto& [error, order] :
         {std::pair{&CurvePoint::speed_error, curve.speed_order}, {&CurvePoint::parting_error, curve.parting_order}}) {
      for (const double step : {1e-3, 1e-4, 1e-5, 1e-6}) {
        const CurvePoint* at = point_at(curve, step);
        cells += at == nullptr ? " & -" : fmt::format(" & {:.1e}", at->*error);
      }
      cells += fmt::format(" & {:.2f}", order);
    }
    table.add_row(cells);
  }
  return fmt::format(
             "Figs. 10, 11: stacked spheres; exact d' = {:.12f}, T0 = {:.12f} s (the paper's sum (31) is low by {:g})\n"
             "  Relative errors of d' and T0 by the time step\n",
             exact_speed, exact_parting, printed_parting_error) +
         table.text() +
         fmt::format(
             "  Sweeps of X in a step of 1e-4 s: {:.1f} (a = 0.1), {:.1f} (a = 4).\n"
             "  C stops converging (orders near 0, as printed): its closing speed is the velocity of the previous "
             "step\n"
             "  along the normal of this step, low by (v_t²/L) dt/2. The damping per step is kept with a, so that the\n"
             "  dashpot turns this error into an adhesion that no time step removes. With the closing speed from\n"
             "  d_j - d_(j-1) (last line) it vanishes. T has no such error: its damping vanishes with d^(1/4). F and "
             "P\n"
             "  coincide, since the contacts last and only their first steps differ; in the paper they differ, and F\n"
             "  is often the better one. T0 is the time of the step in which B and C part: order 1 at best.\n",
             point_at(curves[4], 1e-4)->sweeps, point_at(curves[5], 1e-4)->sweeps);
}

/// Times of the cheapest point with at most the wanted error.
std::string costs(const std::string& title, const std::vector<Curve>& curves, double CurvePoint::*error,
                  std::initializer_list<double> wanted) {
  std::string head = "law & a";
  for (const double accuracy : wanted) head += fmt::format(" & {:.0e}", accuracy);
  TextTable table(head);
  for (const Curve& curve : curves) {
    if (curve.points.front().seconds <= 0) continue;
    std::string cells = curve.label == curve.variant.label ? cells_of(curve.variant) : curve.label + " & any";
    for (const double accuracy : wanted) {
      double least = INFINITY;
      for (const CurvePoint& point : curve.points)
        if (point.seconds > 0 && point.*error <= accuracy) least = std::min(least, point.seconds);
      cells += std::isfinite(least) ? fmt::format(" & {:.2g} s", least) : " & -";
    }
    table.add_row(cells);
  }
  return title + "\n" + table.text();
}

std::string at_rest(const std::string& title, const std::vector<Rest>& laws) {
  TextTable table(
      "law & a & speed, of g dt & energy above rest, of weight x d & overlap at the floor, of the static one & steps "
      "in "
      "contact");
  for (const Rest& law : laws)
    table.add("{} & {:.2g} & {:.1e} & {:.6f} & {:.1f} %", cells_of(law.variant), law.speed,
              std::max(0.0, law.energies.back()), law.overlap, 100 * law.contact);
  return title + " at rest (not in the paper)\n" + table.text();
}

std::string lossless(const std::vector<Rest>& laws) {
  TextTable table("law & a & at the end & largest");
  for (const Rest& law : laws) {
    double largest = 0;
    for (std::size_t k = 0; k < law.energies.size(); ++k) largest = std::max(largest, std::abs(law.change(k)));
    table.add("{} & {:+.1e} & {:.1e}", cells_of(law.variant), law.change(law.energies.size() - 1), largest);
  }
  return fmt::format(
             "A column of {} balls without loss, e = 1, bounces for {:.0f} s: relative change of the energy (not in "
             "the paper)\n",
             laws.front().balls, laws.front().times.back()) +
         table.text();
}

constexpr const char* introduction =
    "Fujioka & Ushijima (2005): normal contact with energy conservation\n"
    "\n"
    "C: Cundall's spring and dashpot (linear_dashpot), T: Tanaka's Hertz spring (hertz_dashpot), F: the\n"
    "authors' earlier model (five_case_map), P: the paper's (energy_map), X: exact_flow, not in the paper.\n"
    "e = 0.7, g = 9.8 m/s², spheres of 225 m, step 1e-3 s unless stated.\n"
    "Not stated in the paper, but deduced from Table 2: the dimensionless stiffness a = k dt²/m is kept while\n"
    "the step changes, 0.10 for C, F and P, 4.62 for T (k d_c^(1/2) dt²/m); velocities are updated first, then\n"
    "positions (semi-implicit Euler); gravity is added after the contact force; contacts of C and T last while\n"
    "the bodies overlap, e = exp(-pi zeta/sqrt(1 - zeta²)), although the force is then attractive at the end.\n"
    "Contacts of X end where the force is zero.\n";

constexpr const char* about_x =
    "X, the law that is more accurate at rest and in clusters\n"
    "  During a step all other forces on a contact (gravity, the other contacts of its bodies) are replaced by\n"
    "  a force linear in time, m (h0 + h1 t), with the same impulse and first moment. Spring and dashpot obey\n"
    "  u'' + 2 zeta w u' + w² u = h0 + h1 t, and u'' = h0 + h1 t while apart, both solved in closed form; a\n"
    "  contact begins and ends inside the step, at the instants of these solutions. The impulse of the contact\n"
    "  changes the velocities of its bodies, its first moment their positions; the contacts are solved in turn\n"
    "  until all agree. One contact is exact at any step and stiffness (any e, any energy, to round-off);\n"
    "  straight clusters with e = 1 follow a symplectic map of fourth order, whose energy does not drift and\n"
    "  which is stable for w dt < 2.25 in a chain; rest is exact, at m g/k, since a constant force is linear.\n"
    "  A contact that begins or ends within the step makes a kink in its force on its neighbours: this is the\n"
    "  remaining error of colliding clusters, largest for stiff contacts (a = 4).\n"
    "  P moves on an ellipse of the energy of one contact, without gravity and other contacts: one ball comes\n"
    "  to rest at (1 + a)/2 of m g/k, a column never.\n"
    "  An evaluation of X costs more (Table 1), and a step takes several sweeps over a cluster. For one contact\n"
    "  this is repaid a hundredfold, since the step need not resolve the contact; for the stacked spheres it\n"
    "  is not: P is cheaper there at equal error of d'.\n";

}  // namespace

std::string report(const Reproduction& r) {
  const std::vector<std::string> parts{
      introduction,
      table_1(r.table1),
      table_2(r.table2),
      mended(r.printed),
      "Fig. 4: energy ratio of slow impacts (theory 0.49), ball dropped by 0.01 diameters, in two readings\n"
      "  1. E = v²/2 + g h of the first step apart over that of the step of contact, v and h of the same step\n" +
          table_of(r.slow, &Impacts::ratio) +
          "  2. The energy that a flight keeps, v²/2 + g (h - v dt/2), after over before\n" +
          table_of(r.slow, &Impacts::flight_ratio) +
          "  The paper compares the energies before and after the N-th impact, that is reading 1: in it P stays at\n"
          "  0.49 over ten impacts, as printed. Velocities of semi-implicit Euler are half a step behind positions, "
          "so\n"
          "  that E of a step differs from what the flight keeps by g v dt/2, with opposite signs before and after an\n"
          "  impact: reading 2 is lower by (e + e²) g dt/v, v the speed of the impact, and is that of the energy "
          "that the ball keeps.\n"
          "  X at a = 0.1 is the exact answer of the soft spring under gravity; stiff, it follows the rigid ball.\n",
      "Figs. 5 to 7: fast impacts, 1e5 m/s, 0.444 diameters in a step\n" + table_of(r.fast, &Impacts::ratio) +
          "  C penetrates more than a diameter in the first impact and returns, since the floor is a half space; in\n"
          "  the paper it is lost at the second. T with the stiffness of Table 2 is unstable here: it returns more\n"
          "  energy than it received; \"T soft\", with a smaller stiffness, goes on with ratios that are not "
          "constant,\n"
          "  as the paper describes. Flights are computed in one move, by the closed form of their steps.\n",
      stacked_spheres(r.stacked),
      verdicts(r),
      costs("Stacked spheres: least time of computing for a relative error of d'", r.stacked, &CurvePoint::speed_error,
            {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}),
      costs("Bouncing ball, 3 s: least time of computing for an rms error of the height over the drop", r.ball,
            &CurvePoint::error, {1e-1, 1e-2, 1e-3, 1e-4, 1e-6}),
      at_rest("One ball", r.rest),
      at_rest(fmt::format("A column of {} balls", r.column.front().balls), r.column),
      lossless(r.lossless),
      about_x};
  return fmt::format("{}", fmt::join(parts, "\n"));
}

}  // namespace equidem::fujioka2005
