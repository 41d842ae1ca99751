// SPDX-License-Identifier: GPL-3.0-or-later
#include <charconv>
#include <sstream>
#include <string>

#include "equidem/core/file.hpp"
#include "equidem/core/random.hpp"
#include "equidem/output/files/histories.hpp"

#include "output/runs.hpp"
#include "output/states.hpp"
#include "support/catch.hpp"
#include "support/fields.hpp"

using namespace equidem;
using equidem::test::refusal_of;

namespace {

constexpr std::size_t discs = 30;
const std::vector<Probe> probes = {
    {"top", {3, 4, 29}, {ProbeQuantity::displacement, ProbeQuantity::velocity}},
    {"one, quoted", {7}, {ProbeQuantity::rotation, ProbeQuantity::spin}},
};

void record(ProbeWriter& writer, std::int64_t step) {
  writer.record(step, time_at(step), motions_at(step, discs), velocities_at(step, discs), {}, ledger_at(step));
}

/// Steps of the rows of a file, all of which must be whole.
std::vector<std::int64_t> steps_in(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  REQUIRE(text.ends_with('\n'));
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  std::vector<std::int64_t> steps;
  while (std::getline(lines, line)) steps.push_back(std::stoll(line));
  return steps;
}

}  // namespace

TEST_CASE("a_probe_with_a_box_counts_its_bodies_inside_sides_included") {
  const TemporaryFolder folder;
  const Probe probe{.name = "out", .bodies = {0, 1, 2, 4}, .quantities = {}, .box = Rectangle{{-1, -2}, {1, 0}}};
  std::vector<DiscMotion> places(5), velocities(5);
  places[0].u = {1, -2}, places[1].u = {0, 1e-9}, places[2].u = {1.1, -1}, places[3].u = {0, -1}, places[4].u = {0, -1};
  {
    ProbeWriter writer(folder / "count.csv", {probe}, places.size(), {.family = BodyFamily::colliding});
    writer.record(0, 0, places, velocities, {}, {});
  }
  const std::string text = read_file(folder / "count.csv");
  CHECK(text.starts_with("step,time_s,out_inside,"));
  CHECK(text.find("\n0,0,2,") != std::string::npos);
}

TEST_CASE("a_probe_of_stress_records_that_of_its_box_by_its_own_bodies") {
  const TemporaryFolder folder;
  const Probe probe{
      .name = "middle", .bodies = {1}, .quantities = {ProbeQuantity::stress}, .box = Rectangle{{0.5, -2}, {2.5, 2}}};
  std::vector<DiscMotion> places(3), velocities(3);
  places[1].u = {1, 0}, places[2].u = {2, 0};
  // Body 1 is pushed by 3 N/m along and by 5 N/m across at x = 0.5 and 1.5; of bodies 0 and 2 the ways do not count.
  const std::vector<BodyContact> contacts{{.i = 0, .j = 1, .arm = {0.5, 0}, .force = {-3, 5}},
                                          {.i = 1, .j = 2, .arm = {0.5, 0}, .force = {-3, 5}}};
  {
    ProbeWriter writer(folder / "stress.csv", {probe}, places.size(), {.family = BodyFamily::colliding});
    writer.record(0, 0, places, velocities, {}, {}, true, {}, contacts);
  }
  const std::string text = read_file(folder / "stress.csv");
  CHECK(
      text.starts_with("step,time_s,middle_stress_xx_Pa,middle_stress_xy_Pa,middle_stress_yx_Pa,middle_stress_yy_Pa,"
                       "middle_inside,"));
  // (F_x, F_y) times the branch of 1 m over the area of 8 m²: the row of y crosses nothing.
  CHECK(text.find("\n0,0,-0.375,0,0.625,0,1,") != std::string::npos);
}

TEST_CASE("probes_record_means_and_energies") {
  const TemporaryFolder folder;
  {
    ProbeWriter writer(folder / "run_probes.csv", probes, discs, {});
    for (std::int64_t step = 0; step <= 20; step += 10) record(writer, step);
  }
  std::istringstream lines(read_file(folder / "run_probes.csv"));
  std::string line;
  std::getline(lines, line);
  CHECK(line ==
        "step,time_s,top_ux_m,top_uy_m,top_vx_m_per_s,top_vy_m_per_s,\"one, quoted_rotation_rad\","
        "\"one, "
        "quoted_spin_rad_per_s\",kinetic_J_per_m,elastic_J_per_m,potential_J_per_m,sway_J_per_m,damped_mass_J_per_m,"
        "damped_contact_J_per_m,damped_local_J_per_m,work_of_loads_J_per_m,work_of_supports_J_per_m,"
        "work_of_walls_J_per_m,initial_J_per_m,error_J_per_m");
  for (std::int64_t step = 0; step <= 20; step += 10) {
    REQUIRE(std::getline(lines, line));
    CAPTURE(line);
    std::vector<double> found;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      double value = 0;
      std::from_chars(cell.data(), cell.data() + cell.size(), value);
      found.push_back(value);
    }
    const auto u = motions_at(step, discs), v = velocities_at(step, discs);
    const EnergyLedger ledger = ledger_at(step);
    std::vector<double> wanted{static_cast<double>(step), time_at(step)};
    for (const auto& values : {u, v}) {
      wanted.push_back((values[3].u.x + values[4].u.x + values[29].u.x) / 3);
      wanted.push_back((values[3].u.y + values[4].u.y + values[29].u.y) / 3);
    }
    wanted.insert(wanted.end(),
                  {u[7].theta, v[7].theta, ledger.kinetic, ledger.elastic(), ledger.potential, ledger.sway,
                   ledger.damped_mass, ledger.damped_contact, ledger.damped_local, ledger.work_of_loads,
                   ledger.work_of_supports, ledger.work_of_walls, ledger.initial, ledger.error()});
    CHECK(found == wanted);
  }
}

TEST_CASE("rows_are_written_many_at_a_time_and_all_before_a_checkpoint") {
  const TemporaryFolder folder;
  const auto path = folder / "probes.csv";
  ProbeWriter writer(path, probes, discs, {.interval = 1e9});
  record(writer, 0);
  CHECK(steps_in(path).empty());
  writer.sync();
  CHECK(steps_in(path).size() == 1);
  std::size_t writes = 0, size = 0;
  for (std::int64_t step = 1; step <= 3000; ++step) {
    record(writer, step);
    const std::size_t now = std::filesystem::file_size(path);
    writes += now != size ? 1 : 0;
    size = now;
  }
  CAPTURE(writes, size);
  CHECK(writes <= 1 + size / 60000);
  CHECK(steps_in(path).size() > 2500);
  writer.flush();
  CHECK(steps_in(path).size() == 3001);
}

TEST_CASE("rows_are_written_after_an_interval") {
  const TemporaryFolder folder;
  ProbeWriter writer(folder / "probes.csv", probes, discs, {.interval = 0});
  for (std::int64_t step = 0; step < 5; ++step) {
    record(writer, step);
    CHECK(writer.last_step() == step);
    CHECK(steps_in(folder / "probes.csv").size() == static_cast<std::size_t>(step) + 1);
  }
}

TEST_CASE("histories_of_a_resumed_run_are_those_of_an_uninterrupted_one") {
  const TemporaryFolder folder;
  const auto uninterrupted = folder / "whole.csv", path = folder / "probes.csv";
  {
    ProbeWriter writer(uninterrupted, probes, discs, {});
    for (std::int64_t step = 0; step <= 500; ++step) record(writer, step);
  }
  const std::int64_t checkpoint = 123;
  Random random(5);
  for (int round = 0; round < 30; ++round) {
    CAPTURE(round);
    FileMark mark;
    {
      ProbeWriter writer(path, probes, discs, {.overwrite = true});
      for (std::int64_t step = 0; step <= 300; ++step) {
        record(writer, step);
        if (step != checkpoint) continue;
        writer.sync();
        mark = writer.mark();
      }
    }
    if (round > 0) {  // killed while it wrote: cut at any place after the checkpoint
      const std::string text = read_file(path);
      const std::size_t safe = text.find(fmt::format("\n{},", checkpoint + 1)) + 1;
      std::filesystem::resize_file(path, safe + random.below(text.size() - safe));
    }
    ProbeWriter writer(path, probes, discs, {.continue_from = mark});
    CHECK(writer.last_step() == checkpoint);
    for (std::int64_t step = checkpoint + 1; step <= 500; ++step) record(writer, step);
    writer.flush();
    CHECK(read_file(path) == read_file(uninterrupted));
  }
}

TEST_CASE("histories_with_other_columns_are_refused") {
  const TemporaryFolder folder;
  const auto path = folder / "probes.csv";
  const FileMark mark = ProbeWriter(path, probes, discs, {}).mark();
  const auto go_on = [&](const std::vector<Probe>& with) {
    return refusal_of([&] { ProbeWriter(path, with, discs, {.continue_from = mark}); });
  };
  CHECK(go_on({probes[0]}).says("its columns are 'step,time_s,top_ux_m"));
  CHECK(go_on(probes).message.empty());
}

TEST_CASE("probes_that_cannot_measure_are_refused") {
  const TemporaryFolder folder;
  const auto start = [&](const std::vector<Probe>& with) {
    return refusal_of([&] { ProbeWriter(folder / "probes.csv", with, discs, {}); });
  };
  CHECK(start({{"a", {}}}).says("the probe 'a' holds no body"));
  CHECK(start({{"a", {30}}}).says("the probe 'a' names body 30 (the bodies are 0 to 29)"));
  CHECK(start({{"a", {-1}}}).says("the probe 'a' names body -1"));
  CHECK(start({{"a", {1}}, {"a", {2}}}).says("two probes are called 'a'"));
  CHECK(start({{"", {1}}}).says("a probe has no name"));
  CHECK(start({{"a", {1}, {ProbeQuantity::stress}}}).says("the probe 'a' has a stress and no box"));
  CHECK(folder.files() == 0);
  using enum ProbeQuantity;
  CHECK(refusal_of([] { enum_from<ProbeQuantity>("speed"); }).says("unknown quantity of a probe 'speed'"));
  CHECK(enum_from<ProbeQuantity>("displacement") == displacement);
  CHECK(enum_from<ProbeQuantity>("angle") == angle);
  CHECK(enum_from<ProbeQuantity>("spin") == spin);
}
