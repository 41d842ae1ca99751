// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Tables, JSON and command line.
#include "equidem/core/text.hpp"

#include "fujioka2005/fujioka2005.hpp"
#include "tables.hpp"

namespace equidem::fujioka2005 {

std::vector<Variant> variants(double stiffness) {
  const auto variant = [](NormalLaw law) { return Variant{law, stiffness_of(law), letter_of(law)}; };
  return {variant(NormalLaw::linear_dashpot), variant(NormalLaw::hertz_dashpot),
          variant(NormalLaw::five_case_map),  variant(NormalLaw::energy_map),
          variant(NormalLaw::exact_flow),     {NormalLaw::exact_flow, stiffness, "X stiff"}};
}

namespace {

Reproduction compute(bool quick) {
  Reproduction result;
  result.quick = quick;
  Progress progress("reproducing Fujioka & Ushijima 2005");
  Stopwatch watch;
  result.table2 = count_table2();
  result.slow = impacts(false);
  result.fast = impacts(true);
  result.printed = compare_printed();
  result.times.add("table 2, figures 4 to 7", watch.lap());
  result.ball = cost_of_ball(quick, progress);
  result.times.add("cost of a bouncing ball", watch.lap());
  result.stacked = slide_stacked(quick, progress);
  result.times.add("figures 10 and 11", watch.lap());
  result.rest = come_to_rest(1, 6);
  result.column = come_to_rest(quick ? 4 : 10, quick ? 10 : 40);
  result.lossless = come_to_rest(5, quick ? 10 : 40, 1);
  result.times.add("coming to rest", watch.lap());
  result.table1 = measure_table1(quick, progress);
  result.times.add("table 1", watch.lap());
  return result;
}

template <class Row>
Table table_of(const std::vector<Row>& rows) {
  Table table;
  table.add("law", rows, [](const Row& r) { return std::string(to_string(r.variant.law)); });
  table.add("letter", rows, [](const Row& r) { return std::string(letter_of(r.variant.law)); });
  table.add("a", rows, [](const Row& r) { return r.variant.a; });
  return table;
}

Table csv_of(const std::vector<Table1Row>& rows) {
  Table table = table_of(rows);
  table.add("step_s", rows, &Table1Row::step);
  table.add("evaluations", rows, &Table1Row::evaluations);
  table.add("evaluations_gravity_first", rows, &Table1Row::gravity_first);
  table.add("run_s", rows, &Table1Row::run_seconds);
  table.add("law_alone_ns", rows, &Table1Row::evaluation_nanoseconds);
  return table;
}

Table csv_of(const std::vector<Table2Row>& rows) {
  Table table = table_of(rows);
  for (std::size_t k = 0; k < table2_steps.size(); ++k)
    table.add(fmt::format("steps_at_{:.0e}_s", table2_steps[k]), rows, [k](const Table2Row& r) { return r.steps[k]; });
  return table;
}

/// One object per row: law, letter, a, and the keys that `add` sets.
template <class Row, class Add>
std::vector<Results> json_of(const std::vector<Row>& rows, Add add) {
  std::vector<Results> all;
  for (const Row& row : rows) {
    Results object;
    object.set("law", to_string(row.variant.law)).set("letter", letter_of(row.variant.law)).set("a", row.variant.a);
    add(object, row);
    all.push_back(std::move(object));
  }
  return all;
}

void add_curve(Results& object, const Curve& curve,
               std::initializer_list<std::pair<const char*, double CurvePoint::*>> keys) {
  object.set("label", curve.label);
  for (const auto& [key, member] : keys) {
    std::vector<double> values;
    for (const CurvePoint& point : curve.points) values.push_back(point.*member);
    object.set(key, values);
  }
}

void add_numbers(Results& object, const Reproduction& result) {
  using P = CurvePoint;
  const auto add_impacts = [](Results& o, const Impacts& law) {
    o.set("energy_ratios", law.ratio)
        .set("energy_ratios_of_flights", law.flight_ratio)
        .set("deepest", law.deepest)
        .set("ran_away", law.ran_away);
  };
  const auto add_rest = [](Results& o, const Rest& law) {
    o.set("balls", law.balls).set("speed_of_g_dt", law.speed).set("overlap_of_static", law.overlap);
    o.set("share_of_steps_in_contact", law.contact).set("energy_above_rest", law.energies.back());
  };
  object.set("quick", result.quick);
  object.set("table1", json_of(result.table1.rows, [](Results& o, const Table1Row& row) {
               o.set("time_step", row.step).set("evaluations", row.evaluations).set("run_seconds", row.run_seconds);
               o.set("law_alone_nanoseconds", row.evaluation_nanoseconds);
               if (row.gravity_first > 0) o.set("evaluations_gravity_first", row.gravity_first);
             }));
  object.set("table2", json_of(result.table2, [](Results& o, const Table2Row& row) {
               o.set("steps", std::vector<std::int64_t>(row.steps.begin(), row.steps.end()));
             }));
  object.set("slow_impacts", json_of(result.slow, add_impacts)).set("fast_impacts", json_of(result.fast, add_impacts));
  object.set("exact_speed", exact_speed).set("exact_parting_time", exact_parting);
  object.set("stacked", json_of(result.stacked, [](Results& o, const Curve& curve) {
               add_curve(o, curve,
                         {{"time_step", &P::step},
                          {"speed_error", &P::speed_error},
                          {"parting_error", &P::parting_error},
                          {"seconds", &P::seconds},
                          {"sweeps_in_a_step", &P::sweeps}});
               o.set("speed_order", curve.speed_order).set("parting_order", curve.parting_order);
             }));
  object.set(
      "bouncing_ball", json_of(result.ball, [](Results& o, const Curve& curve) {
        add_curve(o, curve, {{"time_step", &P::step}, {"a", &P::a}, {"error", &P::error}, {"seconds", &P::seconds}});
      }));
  object.set("rest", json_of(result.rest, add_rest)).set("column", json_of(result.column, add_rest));
  object.set("lossless", json_of(result.lossless, [](Results& o, const Rest& law) {
               o.set("energy_change", law.change(law.energies.size() - 1));
             }));
}

int reproduce(const CommonOptions& options, bool quick) {
  const auto lock = start_paper(options,
                                {"figure4", "figure4_flights", "figure5", "figure6", "figure7", "figure10", "figure11",
                                 "stacked_cost", "ball_cost", "rest", "column", "lossless"},
                                {"table1.csv", "table2.csv"});
  const Reproduction result = compute(quick);
  const Variant first = variants(1).front();
  return finish_paper(options, {.paper = "fujioka2005",
                                .report = report(result),
                                .times = result.times,
                                .effects = start(stacked(first.pair()), first.law, 1e-3).effects(),
                                .add_numbers = [&](Results& object) { add_numbers(object, result); },
                                .tables = {{"table1", csv_of(result.table1.rows)}, {"table2", csv_of(result.table2)}},
                                .plots = plots(result)});
}

}  // namespace

Run declare(CLI::App& command) {
  return declare_with_quick(
      command,
      "Tables 1, 2 and Figs. 4 to 7, 10, 11 of normal contact in collisions, the law exact_flow beside the paper's;\n"
      "and two tests that are not in the paper: coming to rest, and time of computing for an accuracy.",
      reproduce);
}

}  // namespace equidem::fujioka2005
