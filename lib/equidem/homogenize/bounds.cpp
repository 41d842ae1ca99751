// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/homogenize/bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "equidem/contact/contact_springs.hpp"
#include "equidem/contact/frame.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/statistics.hpp"
#include "equidem/core/text.hpp"
#include "equidem/homogenize/elasticity_tensor.hpp"
#include "equidem/homogenize/stress.hpp"

namespace equidem {
namespace {

/// sum += k v v^T, as an upper triangle.
void add_square(double k, const std::array<double, 3>& v, double* sum) {
  add_triangle(sum, [&](std::size_t r, std::size_t c) { return k * v[r] * v[c]; });
}

void refuse_negative_springs(const Assembly& assembly, const ContactSprings& springs) {
  if (!springs.any_negative()) return;
  std::size_t c = 0;
  while (springs[c].kT >= 0) ++c;
  bad_input(fmt::format("the tangential spring is kT = {:.6g} Pa at contact {} (discs {} and {})", springs[c].kT, c,
                        assembly.contacts[c].i, assembly.contacts[c].j),
            "the uniform-stress estimate adds up the energies that contacts store under given forces, which must not "
            "be negative",
            "Give kT >= 0, or do without this estimate");
}

/// Off the lines of centres the stress B/A loads tangential springs too.
void refuse_absent_springs(const Assembly& assembly, const ContactSprings& springs) {
  if (on_lines_of_centres(assembly)) return;
  for (std::size_t c = 0; c < assembly.contacts.size(); ++c) {
    if (springs[c].kT != 0) continue;
    bad_input(fmt::format("contact {} has kT = 0", c),
              "where contacts lie off the lines of centres, a uniform stress loads all tangential springs",
              "Give kT > 0, or do without this estimate");
  }
}

/// The branch fabric B/A.
Tensor2 spanning_fabric(const Assembly& assembly) {
  const Tensor2 h = fabric(assembly).branch;
  const double trace = h.xx + h.yy;
  if (!(determinant(h) > 1e-13 * trace * trace)) {  // the ratio of the principal values, about
    bad_input("all branches are parallel", "a uniform stress across them is carried by no contact",
              "Give an assembly whose contacts span the plane");
  }
  return h;
}

/// A symmetric 2x2 matrix.
struct Symmetric2 {
  double xx = 0, xy = 0, yy = 0;
  [[nodiscard]] double determinant() const { return xx * yy - xy * xy; }
};

/// Limit of (finite + t infinite)^-1 as t -> infinity, both positive semi-definite, their sum definite.
Symmetric2 inverse_in_the_limit(const Symmetric2& finite, const Symmetric2& infinite) {
  const double trace = infinite.xx + infinite.yy;
  if (trace == 0) {
    const double d = finite.determinant();
    return {finite.yy / d, -finite.xy / d, finite.xx / d};
  }
  if (infinite.determinant() > 1e-13 * trace * trace) return {};
  // The rank is one: only the null vector v is left, v v^T / (v^T finite v).
  const Vec2 v = infinite.xx > infinite.yy ? Vec2{-infinite.xy, infinite.xx} : Vec2{infinite.yy, -infinite.xy};
  const double energy = finite.xx * v.x * v.x + 2 * finite.xy * v.x * v.y + finite.yy * v.y * v.y;
  return {v.x * v.x / energy, v.x * v.y / energy, v.y * v.y / energy};
}

}  // namespace

Matrix3 voigt_stiffness(const Assembly& assembly, const ContactSprings& springs) {
  const bool off_line = !assembly.contact_arms.empty();
  const auto sum = contact_sums<6>(assembly.contacts.size(), [&](std::size_t c, std::array<double, 6>& sums) {
    const Vec2 l = assembly.branch(assembly.contacts[c]);
    const ContactFrame frame = frame_of(assembly, c);
    const Vec2 n = frame.normal, s = frame.tangent();
    const auto [kN, kT] = springs[c];
    // n . e l and s . e l for unit strains e_xx, e_yy, gamma_xy.
    add_square(kN, {n.x * l.x, n.y * l.y, off_line ? 0.5 * (n.x * l.y + n.y * l.x) : n.x * l.y}, sums.data());
    add_square(kT, {s.x * l.x, s.y * l.y, 0.5 * (s.x * l.y + s.y * l.x)}, sums.data());
  });
  Matrix3 stiffness = symmetric(sum.data());
  const double area = assembly.area();
  for (auto& row : stiffness) {
    for (double& entry : row) entry /= area;
  }
  return stiffness;
}

Matrix3 uniform_stress_estimate(const Assembly& assembly, const ContactSprings& given) {
  const Tensor2 h = spanning_fabric(assembly);
  refuse_negative_springs(assembly, given);
  const bool off_line = !assembly.contact_arms.empty();
  if (off_line) refuse_absent_springs(assembly, given);
  const double unit = spring_unit(given);
  const ContactSprings springs = scaled_springs(given, 1 / unit);
  const double area = assembly.area();
  const Tensor2 h_inverse = inverse(h);

  // Stresses in the basis B/A, (1, -1, 0), (0, 0, 1). The first loads no tangential spring, F = l, so that however soft
  // they are its stiffness stays exact. Energies per area, doubled: of springs that there are, and of unit ones where
  // springs are absent.
  const auto sum = contact_sums<12>(assembly.contacts.size(), [&](std::size_t c, std::array<double, 12>& sums) {
    const Vec2 l = assembly.branch(assembly.contacts[c]);
    const ContactFrame frame = frame_of(assembly, c);
    const Vec2 n = frame.normal, s = frame.tangent();
    const Vec2 m = h_inverse * l;
    const Vec2 deviator{m.x, -m.y}, shear{m.y, m.x};
    const auto [kN, kT] = springs[c];
    add_square(1 / (kN * area), {off_line ? dot(n, l) : norm(l), dot(n, deviator), dot(n, shear)}, sums.data());
    const std::array<double, 3> tangential{off_line ? dot(s, l) : 0, dot(s, deviator), dot(s, shear)};
    if (kT != 0) add_square(1 / (kT * area), tangential, sums.data());
    if (kT == 0) add_square(1 / area, tangential, sums.data() + 6);
  });
  const auto [s11, s12, s13, s22, s23, s33, t11, t12, t13, t22, t23, t33] = sum;

  // The compliance [a b^T; b D] inverted by its block D of deviators, whose inverse g is zero where springs are absent.
  const Symmetric2 g = inverse_in_the_limit({s22, s23, s33}, {t22, t23, t33});
  const Vec2 gb{g.xx * s12 + g.xy * s13, g.xy * s12 + g.yy * s13};
  const double first = 1 / (s11 - (s12 * gb.x + s13 * gb.y));
  // C = sum of the squares of stresses: that of the first, p = B/A - g b, and those of the deviators.
  const std::array<double, 3> p{h.xx - gb.x, h.yy + gb.x, h.xy - gb.y};
  double stiffness[]{g.xx, -g.xx, g.xy, g.xx, -g.xy, g.yy};
  add_square(first, p, stiffness);
  return unit * symmetric(stiffness);
}

std::vector<StiffnessBeside> BoundedStiffness::ordered(const ContactSprings& springs) const {
  std::vector<StiffnessBeside> order;
  if (springs.may_be_indefinite()) return order;
  for (const std::string key : {"traction", "periodic", "displacement", "voigt"}) {
    if (key == to_string(result.boundary)) order.push_back({key, result.stiffness, {}});
    std::ranges::copy_if(beside, std::back_inserter(order),
                         [&](const StiffnessBeside& other) { return other.key == key && other.stiffness; });
  }
  return order;
}

std::vector<Boundary> boundaries_of(const Assembly& assembly, const ContactSprings& springs,
                                    const BoundsOptions& options) {
  const bool periodic = assembly.periodic();
  std::vector<Boundary> chosen = {options.boundary.value_or(periodic ? Boundary::periodic : Boundary::displacement)};
  const bool few = assembly.size() <= most_discs_of_bounds && !springs.may_be_indefinite();
  const bool side_by_side = !periodic && !options.boundary;
  if (side_by_side || options.bounds == BoundsWanted::all || (options.bounds == BoundsWanted::automatic && few)) {
    for (const Boundary other : {Boundary::displacement, Boundary::traction})
      if (other != chosen.front()) chosen.push_back(other);
  }
  return chosen;
}

BoundedStiffness bounded_stiffness(const Assembly& assembly, const ContactSprings& springs,
                                   const BoundsOptions& options) {
  const auto solve = [&](Boundary boundary) {
    return effective_stiffness(assembly, springs,
                               {.boundary = boundary, .rotation = options.rotation, .solver = options.solver});
  };
  const std::vector<Boundary> boundaries = boundaries_of(assembly, springs, options);
  BoundedStiffness all{.result = solve(boundaries.front()), .beside = {}};
  const auto add = [&](const std::string& key, const auto& stiffness_of) {
    StiffnessBeside& one = all.beside.emplace_back(StiffnessBeside{key, {}, {}});
    try {
      one.stiffness = stiffness_of();
    } catch (const Error& error) {
      one.missing = error.what();
      if (error.kind() == ErrorKind::interrupted) throw ErrorWith(error, "bounds are missing", std::move(all));
    }
  };
  Stopwatch watch;
  for (std::size_t k = 1; k < boundaries.size(); ++k)
    add(to_string(boundaries[k]), [&] { return solve(boundaries[k]).stiffness; });
  if (springs.prestressed()) return all;  // those below are of springs alone
  add("voigt", [&] { return voigt_stiffness(assembly, springs); });
  add("uniform_stress_estimate", [&] { return uniform_stress_estimate(assembly, springs); });
  all.result.times.add("bounds", watch.lap());
  return all;
}

Fabric fabric(const Assembly& assembly) {
  const std::size_t count = assembly.contacts.size();
  if (count == 0) {
    bad_input("the assembly has no contacts", "fabric is the distribution of their directions",
              "Give discs that touch, or contacts");
  }
  const auto [ll_xx, ll_xy, ll_yy, length] = contact_sums<4>(count, [&](std::size_t c, std::array<double, 4>& sums) {
    const Vec2 l = assembly.branch(assembly.contacts[c]);
    sums[0] += l.x * l.x;
    sums[1] += l.x * l.y;
    sums[2] += l.y * l.y;
    sums[3] += norm(l);
  });
  const ContactHarmonics h = contact_harmonics(assembly);
  // n_x² = (1 + cos 2 theta)/2, n_x n_y = sin 2 theta/2, and <cos 2 theta> = a_2/2.
  return {.normal = {0.5 + h.a2 / 4, h.b2 / 4, h.b2 / 4, 0.5 - h.a2 / 4},
          .branch = (1 / assembly.area()) * Tensor2{ll_xx, ll_xy, ll_xy, ll_yy},
          .anisotropy_2 = std::hypot(h.a2, h.b2),
          .direction_2 = harmonic_direction(h.a2, h.b2, 2),
          .anisotropy_4 = std::hypot(h.a4, h.b4),
          .direction_4 = harmonic_direction(h.a4, h.b4, 4),
          .mean_branch = length / static_cast<double>(count)};
}

}  // namespace equidem
