// SPDX-License-Identifier: GPL-3.0-or-later
#include "quasistatic/quasistatic_files.hpp"

#include "equidem/breakage/avalanches.hpp"
#include "equidem/core/text.hpp"
#include "equidem/output/pictures/picture.hpp"
#include "equidem/output/plots/plot.hpp"

#include "quasistatic/event_table.hpp"

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

}  // namespace

void expect_quasistatic(const OutputPlan& plan, const OutputCase& wanted) {
  plan.expect(event_table_name);
  plan.expect_plot("curve");
  if (wanted.picture)
    for (const char* end : {".svg", ".png"}) plan.expect(std::string("cracks") + end);
}

void write_figures(const CommonOptions& options, const OutputCase& wanted, const BreakageScene& scene,
                   const EventPath& run, std::span<const std::size_t> cut, const std::string& title) {
  const DrivenBy driven_by = scene.path.driven_by;
  Plot plot;
  plot.title = title;
  plot.x.label = with_unit(driven_by == DrivenBy::strain ? "mean strain" : "motion", unit_of_motion(driven_by));
  plot.y.label = with_unit(driven_by == DrivenBy::strain ? "stress" : "load", unit_of_load(driven_by));
  plot.series = {
      series("events", curve_of(run), SeriesStyle::line, PlotColour::sky_blue),
      series("envelope under motion control", motion_envelope(run), SeriesStyle::line, PlotColour::vermilion),
      series("envelope under load control", load_envelope(run), SeriesStyle::line_with_points, PlotColour::black)};
  write_plot(*options.out, "curve", plot, options.overwrite);
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

EventFrames::EventFrames(const CommonOptions& options, const BreakageScene& scene, const Effects& effects,
                         std::span<const std::size_t> cut, std::int64_t every)
    : scene_(scene),
      broken_(scene.assembly.contacts.size(), 0),
      every_(every),
      per_disc_(static_cast<std::size_t>(effects.unknowns_per_disc())),
      writer_(*options.out, "frames", scene.assembly, {.overwrite = options.overwrite}) {
  for (const std::size_t contact : cut) broken_[contact] = 1;
}

void EventFrames::add(const BreakageRun& run, const BreakableSystem& system) {
  const std::int64_t event = std::ssize(run.events());
  broken_[static_cast<std::size_t>(run.events().back().contact)] = 1;
  if (event % every_ != 0) return;
  const Assembly& assembly = scene_.assembly;
  const bool dead = scene_.path.dead.has_value();
  std::vector<double> motion(assembly.size() * per_disc_);
  for (std::size_t k = 0; k < motion.size(); ++k)
    motion[k] = run.lambda() * system.motion(0)[k] + (dead ? system.motion(1)[k] : 0.0);
  std::vector<BodyContact> contacts;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    if (broken_[c] != 0) continue;
    const ContactForce a = dead ? system.forces(1)[c] : ContactForce{}, b = system.forces(0)[c];
    contacts.push_back(
        bonded_contact(assembly, c, {a.normal + run.lambda() * b.normal, a.tangential + run.lambda() * b.tangential}));
  }
  append(event, motion, contacts);
}

void EventFrames::add(const UnbondedRun& run) {
  const std::int64_t event = std::ssize(run.events());
  if (event / every_ == written_) return;
  written_ = event / every_;
  std::vector<BodyContact> contacts;
  for (std::size_t c = 0; c < scene_.assembly.contacts.size(); ++c) {
    if (run.state().status()[c] == ContactStatus::open) continue;
    contacts.push_back(bonded_contact(scene_.assembly, c, run.state().forces()[c]));
  }
  append(event, run.state().motion().high, contacts);
}

void EventFrames::append(std::int64_t event, std::span<const double> motion, const std::vector<BodyContact>& contacts) {
  const Assembly& assembly = scene_.assembly;
  std::vector<DiscMotion> motions(assembly.size()), still(assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    const std::size_t first = d * per_disc_;
    motions[d] = {{motion[first], motion[first + 1]}, per_disc_ == 3 ? motion[first + 2] / assembly.mean_radius() : 0};
  }
  writer_.append(event, static_cast<double>(event), motions, still, contacts);
}

}  // namespace equidem
