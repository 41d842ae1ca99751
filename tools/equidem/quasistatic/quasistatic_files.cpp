// SPDX-License-Identifier: GPL-3.0-or-later
#include "quasistatic/quasistatic_files.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "equidem/breakage/avalanches.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/stress.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/output/plots/plot.hpp"

#include "quasistatic/event_table.hpp"
#include "state_files.hpp"

namespace equidem {
namespace {

Series series(const std::string& label, const LoadCurve& curve, SeriesStyle style, PlotColour colour) {
  Series s;
  s.label = label;
  s.x = curve.motion;
  s.y = curve.load;
  s.style = style;
  s.colour = colour;
  return s;
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
                 const std::string& title) {
  const LoadCurve curve = curve_of(run);
  if (curve.load.empty()) {
    std::error_code ignored;  // that of an earlier path in the same folder
    for (const char* extension : {".csv", ".gp", ".svg", ".png"})
      std::filesystem::remove(*options.out / (std::string("curve") + extension), ignored);
    return;
  }
  const DrivenBy driven_by = scene.path.driven_by;
  Plot plot;
  plot.title = title;
  plot.x.label = with_unit(driven_by == DrivenBy::strain ? "mean strain" : "motion", unit_of_motion(driven_by));
  plot.y.label = with_unit(driven_by == DrivenBy::strain ? "stress" : "load", unit_of_load(driven_by));
  plot.series = {
      series("events", curve, SeriesStyle::line, PlotColour::sky_blue),
      series("envelope under motion control", motion_envelope(run), SeriesStyle::line, PlotColour::vermilion),
      series("envelope under load control", load_envelope(run), SeriesStyle::line_with_points, PlotColour::black)};
  write_plot(*options.out, "curve", plot, options.overwrite);
}

}  // namespace

void expect_quasistatic(const OutputPlan& plan, const OutputCase& wanted, bool checkpoint) {
  plan.expect(event_table_name);
  if (checkpoint) plan.expect(path_checkpoint_name);
  plan.expect_plot("curve");
  if (wanted.picture)
    for (const char* end : {".svg", ".png"}) plan.expect(std::string("cracks") + end);
  expect_state(plan, of_end(wanted), "");
}

void write_figures(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene,
                   const EventPath& run, std::span<const std::size_t> cut, const std::string& title) {
  write_curve(options, scene, run, title);
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

namespace {

PathState empty_state(const Assembly& assembly) {
  return {std::vector<DiscMotion>(assembly.size()), std::vector<ContactForce>(assembly.contacts.size()),
          std::vector<std::uint8_t>(assembly.contacts.size(), 1)};
}

/// \param component the motion of a component, m
template <class Component>
void set_motions(const Assembly& assembly, const Effects& effects, const Component& component, PathState& state) {
  const auto per_disc = static_cast<std::size_t>(effects.unknowns_per_disc());
  for (std::size_t d = 0; d < state.motions.size(); ++d) {
    const std::size_t k = d * per_disc;
    state.motions[d] = {{component(k), component(k + 1)},
                        per_disc == 3 ? component(k + 2) / assembly.mean_radius() : 0};
  }
}

}  // namespace

std::optional<PathState> state_of(const BreakageScene& scene, const Effects& effects, std::span<const std::size_t> cut,
                                  const BreakageRun& run, const BreakableSystem& system) {
  const bool dead = scene.path.dead.has_value();
  if (!system.carries(0) || (dead && !system.carries(1))) return {};
  PathState state = empty_state(scene.assembly);
  for (const std::size_t contact : cut) state.joined[contact] = 0;
  for (const BreakEvent& event : run.events()) state.joined[static_cast<std::size_t>(event.contact)] = 0;
  const double lambda = run.lambda();
  for (std::size_t c = 0; c < state.forces.size(); ++c) {
    const ContactForce a = dead ? system.forces(1)[c] : ContactForce{}, b = system.forces(0)[c];
    if (state.joined[c] != 0) state.forces[c] = {a.normal + lambda * b.normal, a.tangential + lambda * b.tangential};
  }
  const auto component = [&](std::size_t k) {
    return lambda * system.motion(0)[k] + (dead ? system.motion(1)[k] : 0.0);
  };
  set_motions(scene.assembly, effects, component, state);
  return state;
}

PathState state_of(const BreakageScene& scene, const Effects& effects, const UnbondedRun& run) {
  PathState state = empty_state(scene.assembly);
  for (std::size_t c = 0; c < state.forces.size(); ++c) {
    state.joined[c] = run.state().status()[c] == ContactStatus::open ? 0 : 1;
    state.forces[c] = run.state().forces()[c];
  }
  const std::vector<double>& motion = run.state().motion().high;
  set_motions(
      scene.assembly, effects, [&](std::size_t k) { return motion[k]; }, state);
  return state;
}

void write_end_state(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene, double lambda,
                     const std::optional<PathState>& end) {
  if (!end) return remove_state(options, of_end(wanted), "");
  const PathState& state = *end;
  const Assembly& assembly = scene.assembly;
  std::vector<DiscMotion> motions = state.motions;
  if (const std::optional<Tensor2>& gradient = scene.path.pattern.gradient) {
    for (std::size_t d = 0; d < motions.size(); ++d) motions[d].u += lambda * (*gradient * assembly.centres[d]);
  }
  std::vector<Tensor2> stresses;
  if (cells_hold_area(assembly)) stresses = disc_stresses(assembly, state.forces);
  write_state(options, wanted, "",
              {.assembly = assembly, .motions = motions, .contact_forces = state.forces, .stresses = stresses});
}

EventFrames::EventFrames(const CommonOptions& options, const BreakageScene& scene, std::int64_t every,
                         const std::optional<FileMark>& from, const EventPath& run)
    : scene_(scene),
      every_(every),
      begun_(from ? 0 : std::ssize(run.events())),
      writer_(*options.out, "frames", scene.assembly, {.overwrite = options.overwrite, .continue_from = from}) {}

bool EventFrames::due(const EventPath& run) const {
  // Where contacts rub several events may happen at once.
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
