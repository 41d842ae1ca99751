// SPDX-License-Identifier: GPL-3.0-or-later
#include "quasistatic/quasistatic_files.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "equidem/breakage/avalanches.hpp"
#include "equidem/casefile/engine/keys.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/table_file.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/output/plots/plot.hpp"

#include "case_text.hpp"
#include "state_files.hpp"

namespace equidem {
namespace {

std::string numbers_of(const std::vector<std::int32_t>& discs) {
  return joined(
      discs, [](std::int32_t disc) { return fmt::format("{}", disc); }, " ");
}

std::vector<std::int32_t> discs_of(const StoredTable& table, std::size_t row, std::size_t column) {
  const std::string& text = table.text(row, column);
  std::vector<std::int32_t> discs;
  if (text.empty()) return discs;
  for (const std::string_view word : parts_of(text, ' ')) {
    const auto disc = number_from<std::int32_t>(word);
    if (!disc) table.refuse(fmt::format("line {} has '{}' in place of numbers of discs", row + 2, text));
    discs.push_back(*disc);
  }
  return discs;
}

/// Members of an event, and their columns.
using Number = std::pair<std::string, double BreakEvent::*>;
std::vector<Number> numbers(DrivenBy driven_by) {
  const bool strain = driven_by == DrivenBy::strain;
  const std::string load = strain ? "load_Pa" : "load_N_per_m", motion = strain ? "motion" : "motion_m";
  return {{"lambda", &BreakEvent::lambda},
          {"gap", &BreakEvent::gap},
          {load, &BreakEvent::load},
          {motion, &BreakEvent::motion},
          {"rate_of_" + load, &BreakEvent::load_rate},
          {"rate_of_" + motion, &BreakEvent::motion_rate},
          {"energy_before_N", &BreakEvent::energy_before},
          {"energy_after_N", &BreakEvent::energy_after},
          {"energy_released_N", &BreakEvent::energy_released},
          {"work_N", &BreakEvent::work},
          {"relative_residual", &BreakEvent::relative_residual}};
}

constexpr std::pair<const char*, std::int64_t BreakEvent::*> count_columns[] = {
    {"leg", &BreakEvent::leg}, {"contact", &BreakEvent::contact}, {"ties", &BreakEvent::ties}};

constexpr std::pair<const char*, double Tensor2::*> stress_columns[] = {{"stress_xx_Pa", &Tensor2::xx},
                                                                        {"stress_yx_Pa", &Tensor2::yx},
                                                                        {"stress_xy_Pa", &Tensor2::xy},
                                                                        {"stress_yy_Pa", &Tensor2::yy}};

}  // namespace

std::string unit_of_load(DrivenBy driven_by) {
  return driven_by == DrivenBy::strain ? "Pa" : "N/m";
}

std::string unit_of_motion(DrivenBy driven_by) {
  return driven_by == DrivenBy::strain ? "" : "m";
}

Table event_table(const EventPath& run, const BreakageScene& scene) {
  const std::vector<BreakEvent>& events = run.events();
  Table table;
  std::vector<std::int64_t> number;
  for (std::int64_t k = 0; k < std::ssize(events); ++k) number.push_back(k);
  table.add("event", std::move(number));
  for (const auto& [name, member] : count_columns) table.add(name, events, member);
  table.add("unstable_modes", events, [](const BreakEvent& event) { return event.unstable_modes.value_or(-1); });
  const auto& contacts = scene.assembly.contacts;
  const auto contact = [&](const BreakEvent& event) { return contacts[static_cast<std::size_t>(event.contact)]; };
  table.add("i", events, [&](const BreakEvent& event) { return contact(event).i; });
  table.add("j", events, [&](const BreakEvent& event) { return contact(event).j; });
  table.add("mode", events, [](const BreakEvent& event) { return to_string(event.mode); });
  for (const auto& [name, member] : numbers(scene.path.driven_by)) table.add(name, events, member);
  for (const auto& column : stress_columns)
    table.add(column.first, events, [&](const BreakEvent& event) { return event.stress.*column.second; });
  table.add("avalanche_of_load", avalanches_by(run, &BreakEvent::load).number);
  table.add("avalanche_of_motion", avalanches_by(run, &BreakEvent::motion).number);
  table.add("loosened", events, [](const BreakEvent& event) { return numbers_of(event.loosened); });
  if (run.has_history()) table.add("friction_N", events, &BreakEvent::friction);
  return table;
}

StoredEvents read_events(const std::filesystem::path& path, const EventPath& run, const BreakageScene& scene) {
  const StoredTable table(path, event_table(run, scene), "quasistatic",
                          "Begin anew, without --resume and with --overwrite", "events", CutRow::left_out);
  std::map<std::string, std::size_t> column;
  for (std::size_t k = 0; k < table.columns().size(); ++k) column[table.columns()[k]] = k;
  std::vector<BreakEvent> events(table.rows());
  for (std::size_t row = 0; row < events.size(); ++row) {
    if (const std::int64_t number = table.integer(row, column.at("event")); number != static_cast<std::int64_t>(row)) {
      table.refuse(fmt::format("line {} has the event {} where {} should be: rows are missing, or are in another order",
                               row + 2, number, row));
    }
    BreakEvent& event = events[row];
    for (const auto& [name, member] : count_columns) event.*member = table.integer(row, column.at(name));
    const std::int64_t unstable = table.integer(row, column.at("unstable_modes"));
    event.unstable_modes = unstable < 0 ? std::nullopt : std::optional(unstable);
    for (const auto& [name, member] : numbers(scene.path.driven_by)) event.*member = table.number(row, column.at(name));
    for (const auto& [name, member] : stress_columns) event.stress.*member = table.number(row, column.at(name));
    event.mode = enum_from<BreakMode>(table.text(row, column.at("mode")));
    event.loosened = discs_of(table, row, column.at("loosened"));
  }
  return {std::move(events), table.cut()};
}

namespace {

struct Difference {
  std::string text;  ///< "strength.seed is 1 there and 2 here"
  bool of_earlier_version = false;
};

/// The first entry in which two documents differ; none: they are the same.
std::optional<Difference> difference(const std::string& key, const TomlValue* there, const TomlValue* here) {
  const std::size_t dot = std::min(key.rfind('.'), key.size());
  const auto is_removed = [&](std::string_view word) {
    return dot < key.size() && casefile::removed_key(key.substr(0, dot), key.substr(dot + 1), word) != nullptr;
  };
  if (there == nullptr || here == nullptr)
    return Difference{fmt::format("{} is given {} alone", key, there == nullptr ? "here" : "there"),
                      there != nullptr && is_removed("")};
  const auto below = [&](const std::string& name) {
    return difference(key.empty() ? name : key + "." + name, there->find(name), here->find(name));
  };
  if (there->is_table() && here->is_table()) {
    for (const auto* table : {there, here}) {
      for (const TomlEntry& entry : table->entries)
        if (auto found = below(entry.name)) return found;
    }
    return {};
  }
  if (there->is_array() && here->is_array()) {
    for (std::size_t k = 0; k < std::max(there->items.size(), here->items.size()); ++k)
      if (auto found = below(std::to_string(k))) return found;
    return {};
  }
  const bool same = there->type == here->type ? there->integer == here->integer && there->real == here->real &&
                                                    there->boolean == here->boolean && there->text == here->text
                                              : there->is_number() && here->is_number() && there->real == here->real;
  if (same) return {};
  return Difference{fmt::format("{} is {} there and {} here", key, there->shown(), here->shown()),
                    there->type == TomlValue::Type::text && is_removed(there->text)};
}

}  // namespace

FreeKeysOfPath check_same_path(const std::filesystem::path& there, const Case& resolved, const std::string& note) {
  const TomlValue kept = casefile::read_document(there, {});
  const TomlValue old_keys = deciding_tables(kept, Decided::path);
  const TomlValue new_keys =
      deciding_tables(casefile::parse_document(to_toml(resolved, there.parent_path()), "the case", {}), Decided::path);
  if (const auto found = difference("", &old_keys, &new_keys)) {
    bad_input_at(there.string(),
                 found->of_earlier_version
                     ? fmt::format("the events there are of a version before {}", library_version())
                     : "the events there are of another case",
                 found->text,
                 fmt::format("{} another --out, or leave out --resume and pass --overwrite",
                             found->of_earlier_version ? "Choose" : "Take the value there, or choose"));
  }
  if (!read_file(there).ends_with(note))
    bad_input_at(there.string(), "the events there are of another case",
                 "a file that the case reads has changed since, or an earlier version wrote them",
                 "Put the file back as it was, or choose another --out, or leave out --resume and pass --overwrite");
  const auto number = [&](const char* key) {
    const TomlValue& value = value_at(kept, key);
    return value.is_number() ? value.integer : 0;
  };
  return {number("quasistatic.max_events"), number("quasistatic.frame_every")};
}

void check_most_events(const FreeKeysOfPath& before, const Case& resolved, std::int64_t events) {
  const std::int64_t most = resolved.quasistatic.max_events;
  // Where contacts are frictional several events may come at once, so that there are more than were asked for.
  if (most == 0 || most >= events || most == before.max_events) return;
  bad_input_at(resolved.where("quasistatic.max_events"),
               fmt::format("max_events is {}, and {} are done", most, counted(events, "event")),
               "a path that is resumed goes on, and not back",
               "Raise max_events, or leave out --resume and pass --overwrite");
}

namespace {

Series series(const std::string& label, LoadCurve curve, const std::optional<TestedSection>& section, SeriesStyle style,
              PlotColour colour) {
  for (double& motion : curve.motion) motion /= section ? section->height : 1;
  for (double& load : curve.load) load /= section ? 1e6 * section->width : 1;
  return {.label = label, .x = curve.motion, .y = curve.load, .style = style, .colour = colour};
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

/// The cracks are the picture.
OutputCase of_end(OutputCase wanted) {
  wanted.picture = false;
  return wanted;
}

/// None where dead loads were not carried, so that lambda never grew.
void write_curve(const CommonOptions& options, const BreakageScene& scene, const EventPath& run,
                 const std::string& title, const std::optional<TestedSection>& section) {
  const LoadCurve curve = curve_of(run);
  if (curve.load.empty()) return remove_files(options, plot_files("curve"));
  const DrivenBy driven_by = scene.path.driven_by;
  const bool strain = driven_by == DrivenBy::strain;
  const Plot plot{
      .title = title,
      .x = {.label = section ? "strain" : with_unit(strain ? "mean strain" : "motion", unit_of_motion(driven_by))},
      .y = {.label = section ? "stress (MPa)" : with_unit(strain ? "stress" : "load", unit_of_load(driven_by))},
      .series = {series("events", curve, section, SeriesStyle::line, PlotColour::sky_blue),
                 series("envelope under motion control", motion_envelope(run), section, SeriesStyle::line,
                        PlotColour::vermilion),
                 series("envelope under load control", load_envelope(run), section, SeriesStyle::line_with_points,
                        PlotColour::black)}};
  write_plot(*options.out, "curve", plot, options.overwrite);
}

}  // namespace

std::optional<TestedSection> section_of(const Assembly& assembly, std::span<const Support> supports) {
  const auto moves = [](const std::optional<double>& u) { return u.value_or(0) != 0; };
  for (const bool along_y : {true, false}) {
    const auto along = along_y ? &Support::uy : &Support::ux, across = along_y ? &Support::ux : &Support::uy;
    std::vector<const Support*> sides;
    bool other_motion = false;
    for (const Support& support : supports) {
      other_motion = other_motion || moves(support.*across);
      if (support.*along) sides.push_back(&support);
    }
    if (other_motion || sides.size() != 2 || sides[0]->*along == sides[1]->*along) continue;
    double width = 0, places[2] = {}, deepest = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto found = assembly.groups.find(sides[k]->group);
      if (found == assembly.groups.end() || found->second.tributary_lengths.empty()) return {};
      const DiscGroup& group = found->second;
      double low = INFINITY, high = -INFINITY;
      for (std::size_t d = 0; d < group.discs.size(); ++d) {
        const Vec2 centre = assembly.centres[static_cast<std::size_t>(group.discs[d])];
        const double at = along_y ? centre.y : centre.x;
        low = std::min(low, at), high = std::max(high, at);
        width += group.tributary_lengths[d] / 2;  // the mean of the two sides
        places[k] += at / static_cast<double>(group.discs.size());
      }
      deepest = std::max(deepest, high - low);
    }
    const double height = std::abs(places[1] - places[0]);
    if (deepest < height) return TestedSection{width, height};  // else the motion is along the sides: it shears
  }
  return {};
}

std::vector<std::string> names_of_end_state(const OutputCase& wanted) {
  return state_names(of_end(wanted), "");
}

std::vector<std::string> names_of_figures(const OutputCase& wanted) {
  std::vector<std::string> names = plot_files("curve");
  if (wanted.picture) names.insert(names.end(), {"cracks.svg", "cracks.png"});
  return names;
}

void write_figures(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene,
                   const EventPath& run, std::span<const std::size_t> cut, const std::string& title,
                   const std::optional<TestedSection>& section) {
  write_curve(options, scene, run, title, section);
  if (!wanted.picture) return;
  PictureOptions picture{.title = title, .colour = DiscColour::none};
  for (const std::size_t contact : cut) picture.cracks.push_back({static_cast<std::int64_t>(contact), CrackKind::cut});
  const auto events = std::ssize(run.events());
  for (std::int64_t k = 0; k < events; ++k) {
    const BreakEvent& event = run.events()[static_cast<std::size_t>(k)];
    if (event.mode != BreakMode::tension && event.mode != BreakMode::shear) continue;
    picture.cracks.push_back({event.contact, event.mode == BreakMode::shear ? CrackKind::shear : CrackKind::tension,
                              events > 1 ? static_cast<double>(k) / static_cast<double>(events - 1) : 1});
  }
  write_picture(*options.out, "cracks", AssemblyState{.assembly = scene.assembly}, picture, options.overwrite);
}

void write_end_state(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene, double lambda,
                     const std::optional<PathState>& end) {
  if (!end) return remove_files(options, names_of_end_state(wanted));
  const Assembly& assembly = scene.assembly;
  std::vector<DiscMotion> motions = end->motions;
  if (const std::optional<Tensor2>& gradient = scene.path.pattern.gradient) {
    for (std::size_t d = 0; d < motions.size(); ++d) motions[d].u += lambda * (*gradient * assembly.centres[d]);
  }
  std::vector<Tensor2> stresses;
  if (cells_hold_area(assembly)) stresses = disc_stresses(assembly, end->forces);
  write_state(options, wanted, "",
              {.assembly = assembly, .motions = motions, .contact_forces = end->forces, .stresses = stresses});
}

EventFrames::EventFrames(const CommonOptions& options, const BreakageScene& scene, std::int64_t every,
                         const std::optional<FileMark>& from, const EventPath& run)
    : scene_(scene),
      every_(every),
      begun_(from ? 0 : std::ssize(run.events())),
      writer_(*options.out, "frames", scene.assembly, {.overwrite = options.overwrite, .continue_from = from}) {}

bool EventFrames::due(const EventPath& run) const {
  // Where contacts are frictional several events may happen at once.
  return std::ssize(run.events()) / every_ > std::max(writer_.last_step(), begun_) / every_;
}

void EventFrames::add_end(const EventPath& run, const PathState& state) {
  const std::int64_t events = std::ssize(run.events());
  const double of_last = events == 0 ? 0 : run.events().back().lambda;
  if (run.lambda() != of_last) return append(events + 1, state, false);
  if (writer_.last_step() < events) append(events, state, false);
}

void EventFrames::append(std::int64_t step, const PathState& state, bool regular) {
  std::vector<BodyContact> contacts;
  for (std::size_t c = 0; c < state.forces.size(); ++c)
    if (state.joined[c] != 0) contacts.push_back(bonded_contact(scene_.assembly, c, state.forces[c]));
  const std::vector<DiscMotion> still(state.motions.size());
  writer_.append(step, static_cast<double>(step), state.motions, still, contacts, regular);
}

}  // namespace equidem
