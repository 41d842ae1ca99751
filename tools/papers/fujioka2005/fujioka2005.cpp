// SPDX-License-Identifier: GPL-3.0-or-later
#include "fujioka2005/fujioka2005.hpp"

#include "equidem/core/text.hpp"

#include "papers.hpp"

namespace equidem::fujioka2005 {
namespace {

constexpr std::array plot_names{"figure4",      "figure5",   "figure6", "figure7", "figure10", "figure11",
                                "stacked_cost", "ball_cost", "rest",    "column",  "lossless"};

Reproduction compute(bool quick) {
  Reproduction result;
  result.quick = quick;
  Progress progress("reproducing Fujioka & Ushijima 2005");
  Stopwatch watch;
  result.table2 = count_table2();
  result.slow = slow_impacts();
  result.fast = fast_impacts();
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

/// One column from all rows.
template <class Value, class Rows, class Take>
std::vector<Value> column_of(const Rows& rows, Take take) {
  std::vector<Value> values;
  for (const auto& row : rows) values.push_back(take(row));
  return values;
}

template <class Rows>
Table table_of(const Rows& rows) {
  Table table;
  table.add("law", column_of<std::string>(rows, [](const auto& r) { return to_string(r.variant.law); }));
  table.add("letter", column_of<std::string>(rows, [](const auto& r) { return letter_of(r.variant.law); }));
  table.add("a", column_of<double>(rows, [](const auto& r) { return r.variant.a; }));
  return table;
}

Table csv_of(const Table1& table1) {
  using Row = Table1Row;
  Table table = table_of(table1.rows);
  table.add("step_s", column_of<double>(table1.rows, [](const Row& r) { return r.step; }));
  table.add("evaluations", column_of<std::int64_t>(table1.rows, [](const Row& r) { return r.evaluations; }));
  table.add("evaluations_gravity_first",
            column_of<std::int64_t>(table1.rows, [](const Row& r) { return r.gravity_first; }));
  table.add("run_s", column_of<double>(table1.rows, [](const Row& r) { return r.run_seconds; }));
  table.add("law_alone_ns", column_of<double>(table1.rows, [](const Row& r) { return r.evaluation_nanoseconds; }));
  return table;
}

Table csv_of(const std::vector<Table2Row>& rows) {
  Table table = table_of(rows);
  for (std::size_t k = 0; k < table2_steps.size(); ++k) {
    table.add(fmt::format("steps_at_{:.0e}_s", table2_steps[k]),
              column_of<std::int64_t>(rows, [k](const Table2Row& r) { return r.steps[k]; }));
  }
  return table;
}

JsonObject json_of(const Variant& variant) {
  JsonObject object;
  object.set("law", to_string(variant.law)).set("letter", letter_of(variant.law)).set("a", variant.a);
  return object;
}

std::vector<JsonObject> json_of(const std::vector<Impacts>& laws) {
  std::vector<JsonObject> all;
  for (const Impacts& law : laws) {
    all.push_back(json_of(law.variant));
    all.back().set("energy_ratios", law.ratio).set("deepest", law.deepest).set("ran_away", law.ran_away);
  }
  return all;
}

std::vector<JsonObject> json_of(const std::vector<Rest>& laws) {
  std::vector<JsonObject> all;
  for (const Rest& law : laws) {
    all.push_back(json_of(law.variant));
    all.back().set("balls", law.balls).set("speed_of_g_dt", law.speed).set("overlap_of_static", law.overlap);
    all.back().set("share_of_steps_in_contact", law.contact).set("energy_above_rest", law.energies.back());
  }
  return all;
}

template <class Laws, class Member>
JsonObject curve_of(const typename Laws::value_type& law, std::initializer_list<std::pair<const char*, Member>> keys) {
  JsonObject object = json_of(law.variant);
  object.set("label", law.label);
  for (const auto& [key, member] : keys) {
    object.set(key, column_of<double>(law.points, [m = member](const auto& p) { return p.*m; }));
  }
  return object;
}

void add_numbers(JsonObject& object, const Reproduction& result) {
  object.set("quick", result.quick);
  std::vector<JsonObject> table1, table2, stacked_laws, ball;
  for (const Table1Row& row : result.table1.rows) {
    table1.push_back(json_of(row.variant));
    table1.back().set("time_step", row.step).set("evaluations", row.evaluations).set("run_seconds", row.run_seconds);
    table1.back().set("law_alone_nanoseconds", row.evaluation_nanoseconds);
    if (row.gravity_first > 0) table1.back().set("evaluations_gravity_first", row.gravity_first);
  }
  for (const Table2Row& row : result.table2) {
    table2.push_back(json_of(row.variant));
    table2.back().set("steps", std::vector<std::int64_t>(row.steps.begin(), row.steps.end()));
  }
  for (const Stacked& law : result.stacked) {
    using P = StackedPoint;
    stacked_laws.push_back(curve_of<std::vector<Stacked>, double P::*>(law, {{"time_step", &P::step},
                                                                             {"speed_error", &P::speed_error},
                                                                             {"parting_error", &P::parting_error},
                                                                             {"seconds", &P::seconds},
                                                                             {"sweeps_in_a_step", &P::sweeps}}));
    stacked_laws.back().set("speed_order", law.speed_order).set("parting_order", law.parting_order);
  }
  for (const BallCost& law : result.ball) {
    using P = BallPoint;
    ball.push_back(curve_of<std::vector<BallCost>, double P::*>(
        law, {{"time_step", &P::step}, {"a", &P::a}, {"error", &P::error}, {"seconds", &P::seconds}}));
  }
  object.set("table1", table1).set("table2", table2);
  object.set("slow_impacts", json_of(result.slow)).set("fast_impacts", json_of(result.fast));
  object.set("exact_speed", exact_speed).set("exact_parting_time", exact_parting);
  object.set("stacked", stacked_laws).set("bouncing_ball", ball);
  object.set("rest", json_of(result.rest)).set("column", json_of(result.column));
  std::vector<JsonObject> lossless;
  for (const Rest& law : result.lossless) {
    lossless.push_back(json_of(law.variant));
    lossless.back().set("energy_change", law.energies.back() / law.energies.front() - 1);
  }
  object.set("lossless", lossless);
}

}  // namespace

Run declare(CLI::App& command) {
  return declare_with_quick(
      command,
      "Tables 1, 2 and Figs. 4 to 7, 10, 11 of normal contact in collisions, the law exact_flow beside the paper's;\n"
      "and what the paper does not try: coming to rest, time of computing for an accuracy.",
      [](const CommonOptions& options, bool quick) {
        start_paper(options, {plot_names.begin(), plot_names.end()}, {"table1.csv", "table2.csv"});
        const Reproduction result = compute(quick);
        const Variant first = variants(1).front();
        return finish_paper(options, {.paper = "fujioka2005",
                                      .report = report(result),
                                      .times = result.times,
                                      .effects = start(stacked(first), first, 1e-3).effects(),
                                      .add_numbers = [&](JsonObject& object) { add_numbers(object, result); },
                                      .tables = {{"table1", csv_of(result.table1)}, {"table2", csv_of(result.table2)}},
                                      .plots = plots(result)});
      });
}

}  // namespace equidem::fujioka2005
