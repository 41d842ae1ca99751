// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// A synthetic run whose state is a function of the step, and processes whose disk is full.
#pragma once

#include <cmath>
#include <csignal>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/assembly/assembly.hpp"
#include "equidem/core/error.hpp"
#include "equidem/motion/ledger.hpp"
#include "equidem/motion/saved_state.hpp"
#include "equidem/output/files/body_tables.hpp"
#include "equidem/output/files/checkpoint.hpp"
#include "equidem/output/files/frames.hpp"
#include "equidem/output/files/histories.hpp"

namespace equidem {

inline std::vector<DiscMotion> motions_at(std::int64_t step, std::size_t discs) {
  std::vector<DiscMotion> motions;
  for (std::size_t d = 0; d < discs; ++d) {
    const double k = static_cast<double>(step) + 0.01 * static_cast<double>(d);
    motions.push_back({{1e-3 * std::sin(k), -1e-3 * std::cos(k)}, 1e-2 * std::sin(2 * k)});
  }
  return motions;
}
inline std::vector<DiscMotion> velocities_at(std::int64_t step, std::size_t discs) {
  return motions_at(1000 + step, discs);
}
inline double time_at(std::int64_t step) {
  return 1e-5 * static_cast<double>(step);
}

inline EnergyLedger ledger_at(std::int64_t step) {
  const double s = static_cast<double>(step);
  return {.kinetic = std::sin(s),
          .elastic_bonded = std::cos(s),
          .potential = -s,
          .sway = 1e-3 * s,
          .damped_mass = 0.1 * s,
          .damped_contact = 1 / (s + 3),
          .damped_local = 1e-300 * s,
          .work_of_loads = std::sqrt(s),
          .work_of_supports = s / 7,
          .work_of_walls = -0.0,
          .initial = 42};
}

inline SavedState state_at(std::int64_t step, std::size_t discs) {
  const double s = static_cast<double>(step);
  return {.step = step,
          .arrays = {{"motions", 3, numbers_of(motions_at(step, discs))},
                     {"previous", 3, numbers_of(motions_at(step - 1, discs))},
                     {"velocities", 3, numbers_of(velocities_at(step, discs))},
                     {"sums", 1, {s, s / 3, -s}}}};
}

/// Three discs in a row, two of which touch, and a run of three steps with a checkpoint, frames and a history.
struct KeptRun {
  std::filesystem::path folder;
  Assembly discs = [] {
    Assembly row;
    row.centres = {{0, 0}, {2, 0}, {9, 0}};
    row.radii = {1, 1, 1};
    row.contacts = {{.i = 0, .j = 1, .lever_i = 1, .lever_j = 1}};
    return row;
  }();
  std::vector<Probe> probes = {{"a", {0, 2}, {ProbeQuantity::displacement, ProbeQuantity::spin}}};
  std::string case_text = "title = \"tension\"\n";
  FileMark frames = {}, history = {};  ///< where the run may go on

  void append(FrameWriter& writer, std::int64_t step) const {
    const BodyContact contact = bonded_contact(discs, 0, {1.0 + static_cast<double>(step), 0.5});
    writer.append(step, time_at(step), motions_at(step, 3), velocities_at(step, 3), std::vector{contact});
  }
  void record(ProbeWriter& writer, std::int64_t step, bool regular = true) const {
    writer.record(step, time_at(step), motions_at(step, 3), velocities_at(step, 3), {}, ledger_at(step), regular);
  }
  void write() {
    CheckpointWriter(folder / "run.checkpoint.h5", case_text, true).write({state_at(5, 12)});
    FrameWriter frame_writer(folder, "run", discs, {.overwrite = true});
    ProbeWriter history_writer(folder / "history.csv", probes, 3, {.overwrite = true});
    for (std::int64_t step = 0; step < 3; ++step) append(frame_writer, step), record(history_writer, step);
    frames = frame_writer.mark(), history = history_writer.mark();
    record(history_writer, 5, false);
  }
};

/// Message of the Error of `work` in another process whose files may not grow beyond `bytes`; empty: no error.
inline std::string error_on_full_disk(const std::function<void()>& work, std::uint64_t bytes) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
    std::string message;
    try {
      work();
    } catch (const Error& error) {
      message = error.what();
    } catch (...) {
      message = "another exception";
    }
    const bool told = write(ends[1], message.data(), message.size()) == static_cast<ssize_t>(message.size());
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  std::string message;
  char part[256];
  for (ssize_t got; (got = read(ends[0], part, sizeof part)) > 0;) message.append(part, static_cast<std::size_t>(got));
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return message;
}

}  // namespace equidem
