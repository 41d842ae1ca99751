// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/rigidity.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/statics/motion_description.hpp"
#include "equidem/statics/rigid_motions.hpp"

namespace equidem {
namespace {

/// "rotation about (x, y)".
std::string describe_rotation(const PieceMotions& piece, const RigidMotion& motion) {
  // u = 0 at the point x with e_z x (x - centre) = -t size / rotation.
  const double size = piece.size;
  Vec2 x = piece.centre + (size / motion.rotation) * perpendicular(motion.t);
  for (double* value : {&x.x, &x.y}) {
    if (std::abs(*value) < 1e-9 * size) *value = 0;
  }
  return fmt::format("rotation about ({:.6g}, {:.6g}){}", x.x, x.y,
                     piece.rolls ? ", discs rolling on one another" : "");
}

/// A rotation about a point 1e7 sizes away counts as a translation.
bool turns(const RigidMotion& motion) {
  return std::abs(motion.rotation) > 1e-7;
}

/// The pure translation among the combinations of two motions.
Vec2 common_translation(const std::vector<RigidMotion>& two) {
  return two[1].rotation * two[0].t - two[0].rotation * two[1].t;
}

/// The free motions of a piece by name: "translation along y and rotation about (x, y)".
std::string describe_free(const PieceMotions& piece) {
  const std::vector<RigidMotion>& free = piece.free;
  if (free.size() == 3) return "translation along x and along y, and rotation";
  if (free.size() == 1) {
    return turns(free[0]) ? describe_rotation(piece, free[0]) : "translation along " + describe_direction(free[0].t);
  }
  if (!turns(free[0]) && !turns(free[1])) return "translation along x and along y";
  // The rotation is the combination orthogonal to the translation.
  const auto& [p, q] = std::pair{free[0], free[1]};
  const RigidMotion rotation{p.rotation * p.t + q.rotation * q.t, p.rotation * p.rotation + q.rotation * q.rotation};
  return fmt::format("translation along {} and {}", describe_direction(common_translation(free)),
                     describe_rotation(piece, rotation));
}

void check_discs_without_contacts(const Assembly& assembly, const std::vector<PieceMotions>& pieces) {
  std::int64_t count = 0;
  std::vector<std::string> first_names;
  for (const PieceMotions& piece : pieces) {
    if (piece.has_contacts || piece.free.empty()) continue;
    if (++count <= 3) first_names.push_back(describe_disc(assembly, piece.first_disc));
  }
  const std::string names = joined(first_names);
  if (count == 0) return;
  if (assembly.size() == 1) {
    bad_input(fmt::format("the assembly is a single disc that is free to move, {}", names),
              "no contact resists its motion", "Give it neighbours");
  }
  if (count == 1) {
    bad_input(fmt::format("{} has no contacts and is not held in both directions", names), "nothing resists its motion",
              "Hold it, remove it, or give it contacts");
  }
  bad_input(fmt::format("{} have no contacts and are not held in both directions: {}{}", counted(count, "disc"), names,
                        count > 3 ? ", ..." : ""),
            "nothing resists their motion", "Hold them, remove them, or give them contacts");
}

/// "of 400, 12 and 5 discs", largest first.
std::string sizes_of(const std::vector<PieceMotions>& pieces) {
  std::vector<std::int64_t> sizes;
  for (const PieceMotions& piece : pieces) {
    if (piece.has_contacts) sizes.push_back(piece.discs);
  }
  std::sort(sizes.rbegin(), sizes.rend());
  const bool many = sizes.size() > 5;
  if (many) sizes.resize(5);
  std::vector<std::string> words;
  for (const std::int64_t size : sizes) words.push_back(fmt::format("{}", size));
  return fmt::format("of {} discs", many ? joined(words) + ", ..." : listed(words));
}

/// Components to hold so that the motions stop. They are held along x or y, so that a translation that is free while
/// another is not runs along x or y.
std::string remedy(const PieceMotions& piece) {
  const std::vector<RigidMotion>& free = piece.free;
  if (free.size() == 3) return "Hold one disc in x and y, and another one across the line that joins them";
  const bool rotates = std::any_of(free.begin(), free.end(), turns);
  if (free.size() == 2 && !rotates) return "Hold one disc in x and y";
  if (free.size() == 1 && rotates) {
    return "Hold one more disc, along a line that does not pass through that point";
  }
  const std::string direction = describe_direction(free.size() == 1 ? free[0].t : common_translation(free));
  return fmt::format("Hold a disc in {}{}", direction,
                     rotates ? ", and another one so that the assembly cannot turn" : "");
}

void check_pieces(const Assembly& assembly, const std::vector<PieceMotions>& pieces) {
  std::int64_t joined = 0;
  std::int64_t loose = 0;
  const PieceMotions* first = nullptr;
  for (const PieceMotions& piece : pieces) {
    if (!piece.has_contacts) continue;
    ++joined;
    if (piece.free.empty()) continue;
    ++loose;
    if (first == nullptr) first = &piece;
  }
  if (first == nullptr) return;
  const std::string names = describe_free(*first);
  const bool several = first->free.size() > 1;
  if (joined == 1) {
    bad_input(first->held ? fmt::format("the supports leave {} of the assembly free: {}",
                                        several ? "rigid motions" : "a rigid motion", names)
                          : fmt::format("no support holds the assembly: {} {} free", names, several ? "are" : "is"),
              "no contact resists a rigid motion, so that equilibrium has no single answer", remedy(*first));
  }
  const std::string which = loose == 1        ? "one of them is not fully held,"
                            : loose == joined ? "none of them is fully held, such as"
                                              : fmt::format("{} of them are not fully held, such as", loose);
  bad_input(fmt::format("the assembly is in {} pieces ({}) and {} the {} with {}: {}", joined, sizes_of(pieces), which,
                        counted(first->discs, "disc"), describe_disc(assembly, first->first_disc), names),
            "no contact joins them to the rest", "Hold every piece, remove it, or join it by contacts");
}

void check_gears(const Assembly& assembly, const std::vector<GearMode>& gears) {
  if (gears.empty()) return;
  const GearMode& first = gears.front();
  const auto more = static_cast<std::int64_t>(gears.size()) - 1;
  bad_input(fmt::format("{} around {} can counter-rotate like gears without energy{}", counted(first.discs, "disc"),
                        describe_disc(assembly, first.first_disc),
                        more > 0 ? fmt::format(", and so can {} more such {}", more, more > 1 ? "groups" : "group")
                                 : std::string()),
            "their graph of contacts is bipartite: no odd ring of contacts makes neighbours slip",
            "Hold the rotation of one of them, restrain rotation, or add a contact that closes an odd ring");
}

}  // namespace

void check_rigidity(const Assembly& assembly, const ContactGraph& graph, const ContactSprings& springs,
                    const DegreesOfFreedom& unknowns, Mechanisms mechanisms) {
  if (assembly.size() == 0) {
    bad_input("the assembly has no discs", "there is nothing to solve for", "Give it discs");
  }
  const FreeMotions motions = find_free_motions(assembly, graph, springs, unknowns);
  check_discs_without_contacts(assembly, motions.pieces);
  check_pieces(assembly, motions.pieces);
  if (mechanisms == Mechanisms::refuse) check_gears(assembly, motions.gears);
}

}  // namespace equidem
