// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/statics/motion_description.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "equidem/assembly/touching.hpp"
#include "equidem/contact/linear_spring.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/contact_graph.hpp"

namespace equidem {
namespace {

// Shares of the squared motion.
constexpr double negligible = 1e-6;    ///< what is left of a motion that is called rigid, or pure rotation
constexpr double roughly = 0.05;       ///< what uniform strain leaves of what a rigid motion leaves
constexpr double moving_least = 1e-6;  ///< of the largest motion: less counts as rest
constexpr double mechanical = 1e-18;   ///< round-off of the deformation by a mechanism

/// u = t + H (x - c) fitted to some discs by least squares.
struct Field {
  Vec2 c, t;
  Tensor2 H;

  [[nodiscard]] Vec2 at(Vec2 x) const { return t + H * (x - c); }
  [[nodiscard]] double rotation() const { return 0.5 * (H.yx - H.xy); }
};

class Description {
 public:
  Description(const Assembly& assembly, std::span<const DiscMotion> motions)
      : assembly_(assembly), motions_(motions), laid_out_(unwrap_pieces(assembly, ContactGraph(assembly))) {
    assert(motions.size() == assembly.size());
    measure();
  }

  [[nodiscard]] std::string text() const {
    if (moving_.empty()) return "no motion";
    if (rotation_ > (1 - negligible) * total_) return describe_rotations();
    if (moving_.size() == 1) return describe_single();
    if (std::string rigid = describe_rigid(); !rigid.empty()) return rigid;
    const std::string strain = describe_uniform_strain();
    if (strain.empty()) {
      if (std::string sliding = describe_sliding(); !sliding.empty()) return sliding;
    }
    const auto count = static_cast<double>(assembly_.size());
    if (participants_ <= std::max(2.0, 0.1 * count) && participants_ < 0.5 * count) return describe_local();
    return (strain.empty() ? "a motion " : strain) +
           fmt::format("spread over {} of {}, largest at {}{}", moving_.size(), counted(assembly_.size(), "disc"),
                       describe_disc(assembly_, largest_first_.front()), describe_contacts());
  }

 private:
  /// Motions are divided by the largest, so that their squares neither vanish nor overflow.
  void measure() {
    double largest = 0;
    for (std::size_t d = 0; d < assembly_.size(); ++d) {
      largest = std::max({largest, std::abs(motions_[d].u.x), std::abs(motions_[d].u.y),
                          std::abs(assembly_.radii[d] * motions_[d].theta)});
    }
    if (!(largest > 0)) return;
    u_.resize(assembly_.size());
    spin_.resize(assembly_.size());
    weight_.resize(assembly_.size());
    double squares = 0;
    for (std::size_t d = 0; d < assembly_.size(); ++d) {
      u_[d] = motions_[d].u / largest;
      spin_[d] = assembly_.radii[d] * motions_[d].theta / largest;
      weight_[d] = dot(u_[d], u_[d]) + squared(spin_[d]);
      total_ += weight_[d];
      rotation_ += squared(spin_[d]);
      squares += squared(weight_[d]);
    }
    participants_ = squared(total_) / squares;
    largest_first_.resize(assembly_.size());
    std::iota(largest_first_.begin(), largest_first_.end(), 0);
    std::stable_sort(largest_first_.begin(), largest_first_.end(),
                     [&](std::size_t p, std::size_t q) { return weight_[p] > weight_[q]; });
    for (std::size_t d = 0; d < assembly_.size(); ++d) {
      if (moves(d)) moving_.push_back(d);
    }
  }

  /// "all 25 discs", "12 of 25 discs, such as disc 3 at (0.1, 0.2)" or "disc 3 at (0.1, 0.2) alone".
  [[nodiscard]] std::string describe_moving(std::size_t moving) const {
    if (moving == assembly_.size()) return "all " + counted(moving, "disc");
    const std::string disc = describe_disc(assembly_, largest_first_.front());
    if (moving == 1) return disc + " alone";
    return fmt::format("{} of {}, such as {}", moving, counted(assembly_.size(), "disc"), disc);
  }

  [[nodiscard]] std::string describe_single() const {
    const Vec2 u = u_[moving_.front()];
    const bool translates = rotation_ <= negligible * total_;
    return fmt::format("a motion of {}{}", describe_moving(1), translates ? ", along " + describe_direction(u) : "");
  }

  /// Deformation of the contacts by a mechanism.
  [[nodiscard]] std::string describe_contacts() const {
    double stretch = 0;
    double slip = 0;
    double scale = 0;
    for (std::size_t k = 0; k < assembly_.contacts.size(); ++k) {
      const Contact& c = assembly_.contacts[k];
      const DiscMotion i{u_[c.i], spin_[c.i] / assembly_.radii[c.i]};
      const DiscMotion j{u_[c.j], spin_[c.j] / assembly_.radii[c.j]};
      const ContactDeformation d = deformation(frame_of(assembly_, k), i, j);
      stretch += squared(d.normal);
      slip += squared(d.tangential);
      scale += weight_[c.i] + weight_[c.j];
    }
    if (stretch > mechanical * scale) return {};
    return slip > mechanical * scale ? ", contacts slipping but not stretching" : ", discs rolling on one another";
  }

  [[nodiscard]] std::string describe_rotations() const {
    double slip = 0;
    double scale = 0;
    for (std::size_t k = 0; k < assembly_.contacts.size(); ++k) {
      const Contact& c = assembly_.contacts[k];
      const ContactFrame frame = frame_of(assembly_, k);
      const double theta_i = spin_[c.i] / assembly_.radii[c.i], theta_j = spin_[c.j] / assembly_.radii[c.j];
      const ContactDeformation d = deformation(frame, {{}, theta_i}, {{}, theta_j});
      slip += squared(d.tangential) + squared(d.normal);
      scale += (squared(frame.lever_i) + squared(frame.offset_i)) * squared(theta_i) +
               (squared(frame.lever_j) + squared(frame.offset_j)) * squared(theta_j);
    }
    const bool gears = slip <= negligible * scale;
    return fmt::format("a {} in place of {}{}", gears ? "counter-rotation" : "rotation",
                       describe_moving(moving_.size()),
                       gears ? ", neighbours turning against one another like gears" : "");
  }

  /// Least squares over some discs.
  [[nodiscard]] Field fit(const std::vector<std::size_t>& discs, const std::vector<Vec2>& centres) const {
    const double share = 1 / static_cast<double>(discs.size());
    Field f;
    for (const std::size_t d : discs) f.c += share * centres[d], f.t += share * u_[d];
    Tensor2 xx, ux;
    for (const std::size_t d : discs) {
      const Vec2 x = centres[d] - f.c;
      xx += outer(x, x);
      ux += outer(u_[d] - f.t, x);
    }
    const double trace = xx.xx + xx.yy;
    const double determinant = xx.xx * xx.yy - xx.xy * xx.yx;
    if (determinant > 1e-12 * squared(trace)) {
      f.H = (1 / determinant) * Tensor2{ux.xx * xx.yy - ux.xy * xx.yx, ux.xy * xx.xx - ux.xx * xx.xy,
                                        ux.yx * xx.yy - ux.yy * xx.yx, ux.yy * xx.xx - ux.yx * xx.xy};
    } else if (trace > 0) {
      f.H = (1 / trace) * ux;  // centres on a line: no gradient across it
    }
    return f;
  }

  /// Share of the motion of some discs that a field leaves over.
  [[nodiscard]] double left_over(const Field& f, const std::vector<std::size_t>& discs,
                                 const std::vector<Vec2>& centres) const {
    double sum = 0;
    double scale = 0;
    for (const std::size_t d : discs) {
      const Vec2 e = u_[d] - f.at(centres[d]);
      sum += dot(e, e);
      scale += dot(u_[d], u_[d]);
    }
    return sum / scale;
  }

  [[nodiscard]] std::vector<std::size_t> every_disc() const {
    std::vector<std::size_t> discs(assembly_.size());
    std::iota(discs.begin(), discs.end(), 0);
    return discs;
  }

  /// Centres of discs that move, laid out by the contacts among them: a cluster of them may reach across the period.
  [[nodiscard]] std::vector<Vec2> lay_out_moving() const {
    Assembly cluster;
    cluster.centres = assembly_.centres;
    cluster.period = assembly_.period;
    for (const Contact& c : assembly_.contacts) {
      if (moves(c.i) && moves(c.j)) cluster.contacts.push_back(c);
    }
    return unwrap_pieces(cluster, ContactGraph(cluster)).centres;
  }

  [[nodiscard]] bool moves(std::size_t disc) const {
    return weight_[disc] > moving_least * weight_[largest_first_.front()];
  }

  /// The rigid motion of all discs, or else of those that move; empty where neither is rigid.
  [[nodiscard]] std::string describe_rigid() const {
    std::string words = describe_rigid(every_disc(), laid_out_.centres);
    return words.empty() ? describe_rigid(moving_, lay_out_moving()) : words;
  }

  [[nodiscard]] std::string describe_rigid(const std::vector<std::size_t>& discs,
                                           const std::vector<Vec2>& centres) const {
    const Field f = rotation_about_mean(discs, centres);
    if (!(left_over(f, discs, centres) <= negligible)) return {};
    double extent = 0;
    for (const std::size_t d : discs) extent = std::max(extent, norm(centres[d] - f.c));
    const double turn = f.rotation();
    const std::string of = describe_moving(discs.size()) + describe_rolling(turn, discs);
    if (std::abs(turn) * extent <= 1e-4 * norm(f.t)) {
      return fmt::format("a rigid translation along {} of {}", describe_direction(f.t), of);
    }
    if (discs.size() == 2) return {};  // any two discs turn about some point
    Vec2 x = f.c + perpendicular(f.t) / turn;
    for (double* value : {&x.x, &x.y}) {
      if (std::abs(*value) < 1e-6 * extent) *value = 0;
    }
    return fmt::format("a rigid rotation about ({:.6g}, {:.6g}) of {}", x.x, x.y, of);
  }

  /// Groups of discs, such as rows, of which each translates as one; empty where some disc moves by itself.
  [[nodiscard]] std::string describe_sliding() const {
    if (rotation_ > negligible * total_) return {};
    Assembly rigid;
    rigid.centres = assembly_.centres;
    for (const Contact& c : assembly_.contacts) {
      const Vec2 apart = u_[c.j] - u_[c.i];
      if (dot(apart, apart) <= negligible) rigid.contacts.push_back({.i = c.i, .j = c.j});
    }
    const std::vector<std::int32_t> group = unwrap_pieces(rigid, ContactGraph(rigid)).piece;
    std::vector<std::size_t> sizes(assembly_.size(), 0);
    for (const std::size_t d : moving_) ++sizes[group[d]];
    if (std::count(sizes.begin(), sizes.end(), 1) > 0) return {};
    const Vec2 u = u_[largest_first_.front()];
    double across = 0;
    for (const std::size_t d : moving_) across += squared(cross(u, u_[d]));
    const bool along = across <= negligible * total_ * dot(u, u);
    return fmt::format("a sliding of {} of discs{}, each of which moves as one: {} of {}, such as {}",
                       counted(std::ssize(sizes) - std::count(sizes.begin(), sizes.end(), 0), "group"),
                       along ? " along " + describe_direction(u) : "", moving_.size(),
                       counted(assembly_.size(), "disc"), describe_disc(assembly_, largest_first_.front()));
  }

  /// Discs that turn, but not as the rigid motion does.
  [[nodiscard]] std::string describe_rolling(double turn, const std::vector<std::size_t>& discs) const {
    double own = 0;
    for (const std::size_t d : discs) own += squared(spin_[d] - assembly_.radii[d] * turn);
    return rotation_ > negligible * total_ && own > negligible * total_ ? ", discs rolling on one another" : "";
  }

  [[nodiscard]] Field rotation_about_mean(const std::vector<std::size_t>& discs,
                                          const std::vector<Vec2>& centres) const {
    const double share = 1 / static_cast<double>(discs.size());
    Field f;
    for (const std::size_t d : discs) f.c += share * centres[d], f.t += share * u_[d];
    double turning = 0;
    double square = 0;
    for (const std::size_t d : discs) {
      const Vec2 x = centres[d] - f.c;
      turning += cross(x, u_[d] - f.t);
      square += dot(x, x);
    }
    const double omega = square > 0 ? turning / square : 0;
    f.H = {0, -omega, omega, 0};
    return f;
  }

  [[nodiscard]] std::string describe_local() const {
    const auto about = std::max(1LL, std::llround(participants_));
    std::vector<std::string> names;
    for (std::size_t k = 0; k < std::min<std::size_t>({5, static_cast<std::size_t>(about), moving_.size()}); ++k)
      names.push_back(describe_disc(assembly_, largest_first_[k]));
    return fmt::format("a local motion of about {} of {}: {}{}{}", about, counted(assembly_.size(), "disc"),
                       joined(names), about > 5 ? ", ..." : "", describe_contacts());
  }

  /// "a nearly uniform shear ", "a nearly uniform strain " or "": images of one disc move alike, which strain forbids.
  [[nodiscard]] std::string describe_uniform_strain() const {
    if (std::count(laid_out_.winds.begin(), laid_out_.winds.end(), 1) > 0) return {};
    const std::vector<std::size_t> all = every_disc();
    const std::vector<Vec2>& centres = laid_out_.centres;
    const Field f = fit(all, centres);
    const double rigid = left_over(rotation_about_mean(all, centres), all, centres);
    if (left_over(f, all, centres) > roughly * rigid) return {};
    const double volume = 0.5 * squared(f.H.xx + f.H.yy);
    const double shear = 0.5 * (squared(f.H.xx - f.H.yy) + squared(f.H.xy + f.H.yx));
    return volume < 0.1 * shear ? "a nearly uniform shear " : "a nearly uniform strain ";
  }

  const Assembly& assembly_;
  std::span<const DiscMotion> motions_;
  UnwrappedPieces laid_out_;
  std::vector<Vec2> u_;         ///< over the largest component of any motion
  std::vector<double> spin_;    ///< radius times rotation, likewise
  std::vector<double> weight_;  ///< |u|² + spin²
  double total_ = 0;
  double rotation_ = 0;
  double participants_ = 0;  ///< participation ratio (sum w)² / sum w²
  std::vector<std::size_t> largest_first_, moving_;
};

}  // namespace

std::string describe_motion(const Assembly& assembly, std::span<const DiscMotion> motions) {
  return Description(assembly, motions).text();
}

std::string describe_direction(Vec2 direction) {
  constexpr double aligned = 1e-6;
  Vec2 n = direction / norm(direction);
  if (std::abs(n.y) < aligned) return "x";
  if (std::abs(n.x) < aligned) return "y";
  if (n.x < 0) n = -n;
  return fmt::format("({:.4g}, {:.4g})", n.x, n.y);
}

std::string describe_disc(const Assembly& assembly, std::size_t disc) {
  return fmt::format("disc {} at ({:.6g}, {:.6g})", disc, assembly.centres[disc].x, assembly.centres[disc].y);
}

std::string remedy_of_mechanisms(const Assembly& assembly, const ContactSprings& springs, bool rotation,
                                 std::vector<std::string> before) {
  std::vector<std::string> ways = std::move(before);
  ways.push_back("add contacts" + by_larger_tolerance(assembly));
  bool slides = false;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) slides |= springs[c].kT == 0;
  if (slides) ways.emplace_back("give the contacts tangential springs (kT > 0)");
  if (rotation && !springs.bends()) ways.emplace_back("give the contacts bending springs (kM > 0)");
  if (rotation) ways.emplace_back("restrain rotation");
  std::string text = ways.front();
  for (std::size_t k = 1; k < ways.size(); ++k) text += (k + 1 < ways.size() ? ", " : ", or ") + ways[k];
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text;
}

double elastic_energy(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions) {
  double energy = 0;
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    const ContactDeformation d = deformation(frame_of(assembly, k), motions[c.i], motions[c.j]);
    energy += linear_spring_energy(springs[k], d);
    if (springs.bends()) energy += bending_energy(springs.bending(k), motions[c.i].theta, motions[c.j].theta);
    if (const ContactPrestress* const prestress = springs.prestress(k)) {
      const double theta_i = motions[c.i].theta, theta_j = motions[c.j].theta;
      energy += 0.5 * prestress_form(*prestress, d, theta_i, theta_j, d, theta_i, theta_j);
    }
  }
  return energy;
}

double reference_energy(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions) {
  double energy = 0;
  for (std::size_t k = 0; k < assembly.contacts.size(); ++k) {
    const Contact& c = assembly.contacts[k];
    const DiscMotion& i = motions[c.i];
    const DiscMotion& j = motions[c.j];
    const ContactFrame frame = frame_of(assembly, k);
    energy +=
        0.5 * springs[k].kN *
            (dot(i.u, i.u) + dot(j.u, j.u) + squared(frame.offset_i * i.theta) + squared(frame.offset_j * j.theta)) +
        0.5 * std::abs(springs[k].kT) * (squared(frame.lever_i * i.theta) + squared(frame.lever_j * j.theta)) +
        0.5 * springs.bending(k) * (squared(i.theta) + squared(j.theta));
  }
  return energy;
}

double softness(const Assembly& assembly, const ContactSprings& springs, std::span<const DiscMotion> motions) {
  const double reference = reference_energy(assembly, springs, motions);
  return reference > 0 ? elastic_energy(assembly, springs, motions) / reference : 0;
}

}  // namespace equidem
