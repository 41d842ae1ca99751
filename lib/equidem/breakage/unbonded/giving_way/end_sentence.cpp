// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/breakage/unbonded/giving_way/end_sentence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "equidem/breakage/unbonded/giving_way/unborne_loads.hpp"
#include "equidem/breakage/unbonded/giving_way/unresisted_motion.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"

namespace equidem {
namespace {

std::string percent_of_dead_loads(double share) {
  return fmt::format("{:.4g} % of the dead loads", 100 * share);
}

/// "at 37 % of the dead loads ", before a clause; nothing on the legs of lambda, whose place the report tells.
std::string at_dead_loads(const PathStage& stage) {
  if (!stage.dead) return "";
  return stage.share > 0 ? "at " + percent_of_dead_loads(stage.share) + " " : "before any of the dead loads acts ";
}

std::string words_of(const Assembly& assembly, const DegreesOfFreedom& unknowns, std::span<const double> motion) {
  const auto b = static_cast<std::size_t>(unknowns.per_disc);
  std::vector<DiscMotion> motions(assembly.size());
  for (std::size_t d = 0; d < motions.size(); ++d) {
    motions[d].u = {motion[d * b], motion[d * b + 1]};
    if (b > 2) motions[d].theta = motion[d * b + 2] / unknowns.rotation_scale;
  }
  return describe_motion(assembly, motions);
}

std::string part_that_moves(const Assembly& assembly, const DegreesOfFreedom& unknowns,
                            std::span<const double> motion) {
  std::size_t fastest = 0;
  for (std::size_t k = 0; k < motion.size(); ++k)
    if (std::abs(motion[k]) > std::abs(motion[fastest])) fastest = k;
  return describe_disc(assembly, fastest / static_cast<std::size_t>(unknowns.per_disc));
}

std::string unborne_sentence(const PathStage& stage, bool rough, const std::string& motion) {
  const std::string forces =
      rough ? "no contact forces without tension and within friction" : "no contact forces without tension";
  std::string what;
  if (stage.releasing) {
    what = fmt::format("the contacts cannot take over the force of the bond that breaks: {} balance it", forces);
  } else if (!stage.dead) {
    what = fmt::format("the contacts can carry no more of the load: beyond lambda = {:g} {} balance it", stage.lambda,
                       forces);
  } else if (stage.share == 0) {
    what = fmt::format("the contacts can carry no part of the dead loads: {} balance them", forces);
  } else {
    what = fmt::format("the contacts can carry {} and no more: {} balance a larger part of them",
                       percent_of_dead_loads(stage.share), forces);
  }
  return what + ", and nothing resists " + motion;
}

std::string tried_statuses(const RateProblem& problem, const RateSearch& search) {
  return fmt::format("the {} of {} on limits",
                     counted(search.tried, "combination of the states", "combinations of the states"),
                     counted(static_cast<std::int64_t>(problem.limits.size()), "contact"));
}

std::string undecided_sentence(const RateProblem& problem, const RateSearch& search, const PathStage& stage) {
  const std::string at = at_dead_loads(stage);
  if (search.ties > 0) {
    return fmt::format(
        "{}of {} none balances what acts on them beyond doubt, and {} within round-off: whether the increment has an "
        "answer is not decided",
        at, tried_statuses(problem, search), search.ties);
  }
  if (search.tried > 0) {
    return fmt::format("{}none of {} balances what acts on them: with friction the increment has no answer", at,
                       tried_statuses(problem, search));
  }
  return at + "no statuses of the contacts on their limits were found that balance what acts on them: " +
         (std::ranges::any_of(problem.laws, &UnbondedLaw::rough)
              ? "with friction the increment may have no answer"
              : "without friction some do, unless loads move a part");
}

std::string unstable_sentence(const RateProblem& problem, const RateSearch& search, const PathStage& stage,
                              const std::string& motion) {
  std::string sentence = fmt::format(
      "{}the equilibrium is unstable: contacts that slip give up more force than others take over, and a disturbance "
      "grows into {}, which only motion in time can follow",
      at_dead_loads(stage), motion);
  if (search.tried == 0) return sentence;
  return sentence + fmt::format("; none of {} balances what acts on them: with friction the increment has no answer",
                                tried_statuses(problem, search));
}

}  // namespace

PathEnding ending_of(const Assembly& assembly, const RateProblem& problem, const RateSearch& search,
                     std::span<const ContactStatus> status, const PathStage& stage) {
  const DegreesOfFreedom& unknowns = problem.contacts.unknowns();
  if (!search.answer.agrees || stage.dead) {
    if (const std::optional<UnborneLoads> unborne = unborne_loads(problem, status)) {
      return {PathEnd::load_moves_part, unborne_sentence(stage, std::ranges::any_of(problem.laws, &UnbondedLaw::rough),
                                                         words_of(assembly, unknowns, unborne->motion))};
    }
  }
  if (search.answer.agrees) {
    return {PathEnd::load_moves_part,
            fmt::format("{}nothing resists the motion of the part around {} any more: its contacts are open or slip",
                        at_dead_loads(stage), part_that_moves(assembly, unknowns, search.answer.rates.motion))};
  }
  const auto motion = search.ties == 0 ? unresisted_motion(problem, {status.begin(), status.end()}) : std::nullopt;
  if (motion && motion->growth > 0) {
    return {PathEnd::no_answer,
            unstable_sentence(problem, search, stage, words_of(assembly, unknowns, motion->motion))};
  }
  if (motion) {
    return {PathEnd::load_moves_part, fmt::format("{}nothing resists {} any more: its contacts are open or slip",
                                                  at_dead_loads(stage), words_of(assembly, unknowns, motion->motion))};
  }
  return {PathEnd::no_answer, undecided_sentence(problem, search, stage)};
}

}  // namespace equidem
