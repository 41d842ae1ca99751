// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Breaking contacts one after another, with a factor that is updated, beside factorizing anew: bench_breakage --help.
#include <algorithm>
#include <cmath>

#include <CLI/CLI.hpp>

#include "equidem/assembly/least_rectangle.hpp"
#include "equidem/breakage/breakage_run.hpp"
#include "equidem/core/random.hpp"
#include "equidem/core/stopwatch.hpp"
#include "equidem/core/text.hpp"
#include "equidem/core/threads.hpp"
#include "equidem/linear/multifrontal/multifrontal_cholesky.hpp"
#include "equidem/statics/stiffness_solver.hpp"

#include "bench.hpp"

namespace equidem::bench {
namespace {

constexpr const char* introduction = R"(
A notched sample (a line of contacts cut from the left side in half of the height) is held at its bottom and pulled at
its top; kT/kN = 0.4, 3 unknowns per disc, Weibull strengths, friction 0.3. A break, as quasistatic reports it: take the
contact out of the factor, solve for the motions, evaluate all forces and the residual of the loads, find the next
contact; load, motion, stress, energies and the discs that leave the network. Anew: assemble, factorize in the order at
hand, solve once, evaluate the forces; both take turns in every round. Refined, factorized: times that motions were, and
that the factor was made anew; rattlers: discs that left the network; softness: motion over load behind the last break,
over that of the unbroken sample; residual: the largest, relative. Processor time with one thread, wall time with more;
medians (smallest .. largest).

)";

struct Request {
  Sizes sizes = {.discs = {1e4, 1e5}, .rounds = 3};
  int breaks = 5000;
  int part = 0;  // breaks of a line of the table; 0: the whole path
  double weibull_modulus = 2;
  double notch = 0.2;
};

/// Without contacts across a horizontal line of this share of the width, from the left side in half of the height.
Assembly notched(Assembly assembly, double share) {
  const auto [low, high] = upright_rectangle(assembly.centres);
  const double height = 0.5 * (low.y + high.y) + 1e-3 * assembly.mean_radius();
  const double tip = low.x + share * (high.x - low.x);
  std::vector<Contact> kept;
  std::vector<double> facets;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    const Vec2 a = assembly.centres[assembly.contacts[c].i], b = assembly.centres[assembly.contacts[c].j];
    if ((a.y - height) * (b.y - height) < 0 && 0.5 * (a.x + b.x) < tip) continue;
    kept.push_back(assembly.contacts[c]);
    if (!assembly.facet_lengths.empty()) facets.push_back(assembly.facet_lengths[c]);
  }
  assembly.contacts = std::move(kept);
  assembly.facet_lengths = std::move(facets);
  return assembly;
}

constexpr double friction = 0.3;

struct Scene {
  Assembly assembly;
  ContactSprings springs{SpringConstants{1e9, 4e8}};
  Effects effects{};
  std::vector<Support> supports = {{"bottom", 0.0, 0.0, std::nullopt}};
  DegreesOfFreedom unknowns{};
  LoadPath path{};
  ContactStrengths strengths{.tension = {}, .shear = {}, .friction = friction};
};

/// Pulled apart along y: the bottom is held, forces act on the top.
Scene build(const Request& request, const std::string& kind, double discs) {
  Scene scene{.assembly = notched(build_assembly(kind, std::llround(discs), 0.005), request.notch)};
  scene.effects = derive_effects(scene.springs, Rotation::from_scene);
  scene.unknowns = number_unknowns(scene.assembly, scene.springs, scene.effects, scene.supports);
  LoadPathOptions path;
  path.supports = scene.supports;
  path.loads = {{"top", LoadKind::per_disc, {0, 1}, 0}};
  scene.path = make_load_path(scene.assembly, scene.springs, scene.effects, path);
  Random random(1);
  for (std::size_t c = 0; c < scene.assembly.contacts.size(); ++c) {
    const auto draw = [&] { return std::pow(-std::log(1 - random.uniform()), 1 / request.weibull_modulus); };
    scene.strengths.tension.push_back(draw());
    scene.strengths.shear.push_back(2 * draw());
  }
  return scene;
}

/// Processor time with one thread, wall time with more.
class Clock {
 public:
  double lap() {
    const double at = now(), taken = at - last_;
    last_ = at;
    return taken;
  }

 private:
  [[nodiscard]] double now() const { return thread_count() == 1 ? processor_time() : watch_.seconds(); }

  Stopwatch watch_;
  double last_ = now();
};

/// A part of a path, with all that quasistatic reports of a break: load, motion, stress, energies, rattlers.
struct PathPart {
  std::int64_t first = 0, end = 0;  // breaks
  double seconds = 0;
  SolverReport counters;      // of this part
  std::int64_t rattlers = 0;  // discs that left the network
  double softness = 1;        // motion over load behind it, over that at first
};

std::vector<PathPart> follow_path(const Scene& scene, int breaks, int part) {
  const BreakageScene all{scene.assembly, scene.springs, scene.strengths, scene.path};
  BreakableSystem system(breakable_network(all, scene.effects, scene.supports));
  BreakageRun run(all, system);
  const double stiff = run.response().motion[1];
  std::vector<PathPart> parts;
  SolverReport before = system.report();
  Clock watch;
  bool more = true;
  while (more && std::ssize(run.events()) < breaks) {
    const std::int64_t first = std::ssize(run.events()), end = std::min<std::int64_t>(first + part, breaks);
    watch.lap();
    while (std::ssize(run.events()) < end && more) more = run.advance();
    PathPart now;
    now.first = first, now.end = std::ssize(run.events()), now.seconds = watch.lap();
    const SolverReport counters = system.report();
    now.counters.refinements = counters.refinements - before.refinements;
    now.counters.factorizations = counters.factorizations - before.factorizations;
    now.counters.largest_residual = counters.largest_residual;
    before = counters;
    for (std::int64_t k = first; k < now.end; ++k)
      now.rattlers += std::ssize(run.events()[static_cast<std::size_t>(k)].loosened);
    now.softness = run.response().motion[1] / stiff;
    if (now.end > first) parts.push_back(now);
  }
  return parts;
}

/// Assemble, factorize in the order at hand, solve once, evaluate all contact forces: what a break costs without
/// updates.
double factorize_anew(const Scene& scene, const ContactGraph& graph, std::shared_ptr<const SymbolicFactor> symbolic) {
  Clock watch;
  const StiffnessMatrix matrix = assemble_stiffness(scene.assembly, graph, scene.springs, scene.unknowns);
  const auto factor = multifrontal_cholesky(std::move(symbolic), {matrix, scene.assembly, graph});
  std::vector<double> x = scene.path.pattern.force;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (scene.unknowns.held[k] != 0) x[k] = 0;
  }
  factor->solve(x, 1);
  PreciseMotion motion(x.size());
  motion.add(x);
  std::vector<ContactForce> forces(scene.assembly.contacts.size());
  contact_forces_of(scene.assembly, scene.springs, scene.unknowns, motion, forces);
  return watch.lap();
}

PathPart whole_path(const std::vector<PathPart>& parts) {
  PathPart whole = parts.back();
  whole.first = 0, whole.seconds = 0, whole.rattlers = 0;
  whole.counters.refinements = whole.counters.factorizations = 0;
  for (const PathPart& part : parts) {
    whole.seconds += part.seconds;
    whole.rattlers += part.rattlers;
    whole.counters.refinements += part.counters.refinements;
    whole.counters.factorizations += part.counters.factorizations;
  }
  return whole;
}

/// A path part by part, its whole in the last line; in every round it takes turns with factorizing anew.
void compare(const Request& request, const std::string& kind, double discs, int threads, TextTable& table) {
  set_thread_count(threads);
  const Scene scene = build(request, kind, discs);
  const ContactGraph graph(scene.assembly);
  const auto symbolic =
      std::make_shared<const SymbolicFactor>(analyze(dissect(scene.assembly, graph), graph, scene.unknowns.per_disc));
  static_cast<void>(factorize_anew(scene, graph, symbolic));  // the first use of memory is slow
  Seconds anew;
  std::vector<PathPart> parts;
  std::vector<Seconds> each;  // of a break, by part
  for (int round = 0; round < request.sizes.rounds; ++round) {
    anew.push_back(factorize_anew(scene, graph, symbolic));
    parts = follow_path(scene, request.breaks, request.part > 0 ? request.part : request.breaks);
    if (parts.empty()) return;  // nothing broke
    if (parts.size() > 1) parts.push_back(whole_path(parts));
    each.resize(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k)
      each[k].push_back(parts[k].seconds / static_cast<double>(parts[k].end - parts[k].first));
  }
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const PathPart& part = parts[k];
    table.add("{} & {} & {} & {} .. {} & {} & {:.3g} & {} & {} & {} & {} & {:.4g} & {:.1e}", kind,
              scene.assembly.size(), threads, part.first + 1, part.end, (range_of(each[k]) * 1e3).text("{:.3g}"),
              1e3 * range_of(anew).median, ratio_of(anew, each[k]).text("{:.0f}"), part.counters.refinements,
              part.counters.factorizations, part.rattlers, part.softness, part.counters.largest_residual);
  }
}

}  // namespace
}  // namespace equidem::bench

int main(int argc, char** argv) {
  using namespace equidem::bench;
  Request request;
  return run_benchmark(
      "bench_breakage", "Contacts that break one after another, beside factorizing anew", argc, argv,
      [&](CLI::App& app) {
        request.sizes.declare(app);
        app.add_option("--breaks", request.breaks, "of each assembly")->check(CLI::PositiveNumber);
        app.add_option("--part", request.part, "breaks of a line; else a line is a whole path")
            ->check(CLI::PositiveNumber);
        app.add_option("--weibull-modulus", request.weibull_modulus, "of the strengths")->check(CLI::PositiveNumber);
        app.add_option("--notch", request.notch, "length over the width")->check(CLI::Range(0.0, 0.9));
      },
      [&](Report& report) {
        report.begin("Breaking contacts");
        TextTable table(
            "assembly & discs & threads & breaks & a break, ms & anew, ms & anew over a break & refined & factorized & "
            "rattlers & softness & residual");
        request.sizes.for_each(
            [&](const std::string& kind, double discs, int threads) { compare(request, kind, discs, threads, table); });
        report.add(introduction + table.markdown());
      });
}
