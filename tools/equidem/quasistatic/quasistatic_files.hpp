// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The events of `equidem quasistatic` as events.csv, from which --resume goes on.
/// The part of a case that decides a path, by which a resumed one is recognized as the same.
/// Files of `equidem quasistatic`: the curve, the crack picture, the state at the end, frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "equidem/breakage/event_path.hpp"
#include "equidem/casefile/assembly/case.hpp"
#include "equidem/output/files/csv.hpp"
#include "equidem/output/files/frames.hpp"

#include "command.hpp"

namespace equidem {

/// "N/m" or "Pa" of a load, "m" or "" of a motion.
std::string unit_of_load(DrivenBy driven_by);
std::string unit_of_motion(DrivenBy driven_by);

/// One row for each event, numbers that read back to the same bits.
Table event_table(const EventPath& run, const BreakageScene& scene);
struct StoredEvents {
  std::vector<BreakEvent> events;
  bool cut = false;  ///< whether a last row, cut short, is not among them
};
/// \throws Error (bad_input) where the table is another one, a row was altered, or rows are not numbered on from 0
StoredEvents read_events(const std::filesystem::path& path, const EventPath& run, const BreakageScene& scene);

/// Keys that a resumed path may have otherwise than before.
struct FreeKeysOfPath {
  std::int64_t max_events = 0;
  std::int64_t frame_every = 0;
};

/// \param there case.toml of the path so far
/// \param note of the files that the case reads (note_of_files)
/// \return the keys that it had
/// \throws Error (bad_input) where a key that decides the path differs, which the message names, or such a file
FreeKeysOfPath check_same_path(const std::filesystem::path& there, const Case& resolved, const std::string& note);

/// \param events of the path so far
/// \throws Error (bad_input) where max_events was lowered below them
void check_most_events(const FreeKeysOfPath& before, const Case& resolved, std::int64_t events);

inline constexpr const char* event_table_name = "events.csv";
/// The state from which a path goes on that the table of events does not hold: frictional contacts, and frames.
inline constexpr const char* path_checkpoint_name = "quasistatic.checkpoint.h5";

/// Names of the files of write_end_state, and of those of write_figures.
std::vector<std::string> names_of_end_state(const OutputCase& wanted);
std::vector<std::string> names_of_figures(const OutputCase& wanted);

/// The sample between two opposite sides that supports move: stress is load over width, strain motion over height.
struct TestedSection {
  double width = 0;   ///< the sum of the tributary lengths of a side, m
  double height = 0;  ///< between the centres of the discs of the sides, m
};
/// None: the supports do not move two sides along one axis.
std::optional<TestedSection> section_of(const Assembly& assembly, std::span<const Support> supports);

/// The curve of load against motion, of a section in MPa against strain, with its envelopes, and the picture of the
/// cracks.
void write_figures(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene,
                   const EventPath& run, std::span<const std::size_t> cut, const std::string& title,
                   const std::optional<TestedSection>& section);

/// discs.csv, contacts.csv and state.vtm of the end of a path; none: those of an earlier path in the folder are
/// removed.
void write_end_state(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene, double lambda,
                     const std::optional<PathState>& end);

/// A frame for every n-th event, and one for the end of the path: the network behind the event, at its lambda. The
/// event stands for the time; an end at another lambda than that of the last event is one further.
class EventFrames {
 public:
  /// \param from frames of the path so far; none: they begin with the next events of the run
  EventFrames(const CommonOptions& options, const BreakageScene& scene, std::int64_t every,
              const std::optional<FileMark>& from, const EventPath& run);
  /// Whether a frame is due behind the last event.
  [[nodiscard]] bool due(const EventPath& run) const;
  void add(const EventPath& run, const PathState& state) { append(std::ssize(run.events()), state, true); }
  void add_end(const EventPath& run, const PathState& state);
  /// The frames so far, on disk.
  FileMark kept() {
    writer_.sync();
    return writer_.mark();
  }
  void finish() const { writer_.finish(); }

 private:
  void append(std::int64_t step, const PathState& state, bool regular);

  const BreakageScene scene_;
  std::int64_t every_, begun_;
  FrameWriter writer_;
};

}  // namespace equidem
