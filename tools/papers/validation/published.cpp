// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// The published numbers and their sources: the only place that has them.
#include <algorithm>
#include <array>
#include <cassert>

#include "validation/validation.hpp"

namespace equidem::validation {
namespace {

constexpr std::array the_sources{
    Source{"Jacobs & Thorpe 1995",
           "D. J. Jacobs & M. F. Thorpe (1995), Generic rigidity percolation: the pebble game, Phys. Rev. Lett. 75, "
           "4051"},
    Source{"Jacobs & Thorpe 1996",
           "D. J. Jacobs & M. F. Thorpe (1996), Generic rigidity percolation in two dimensions, Phys. Rev. E 53, 3682"},
    Source{
        "Feng et al. 1985",
        "S. Feng, M. F. Thorpe & E. Garboczi (1985), Effective-medium theory of percolation on central-force elastic "
        "networks, Phys. Rev. B 31, 276"},
    Source{"Feder 1980", "J. Feder (1980), Random sequential adsorption, J. Theor. Biol. 87, 237"},
    Source{"Zhang & Torquato 2013",
           "G. Zhang & S. Torquato (2013), Precise algorithm to generate random sequential addition of hard "
           "hyperspheres at saturation, Phys. Rev. E 88, 053312"},
    Source{"O'Hern et al. 2003",
           "C. S. O'Hern, L. E. Silbert, A. J. Liu & S. R. Nagel (2003), Jamming at zero temperature and zero "
           "applied stress: the epitome of disorder, Phys. Rev. E 68, 011306"},
    Source{
        "Schreck et al. 2011",
        "C. F. Schreck, C. S. O'Hern & L. E. Silbert (2011), Tuning jammed frictionless disk packings from isostatic "
        "to hyperstatic, Phys. Rev. E 84, 011305; arXiv:1007.2162"},
    Source{"Goodrich et al. 2012",
           "C. P. Goodrich, A. J. Liu & S. R. Nagel (2012), Finite-size scaling at the jamming transition, Phys. "
           "Rev. Lett. 109, 095704"},
    Source{"Shundyak et al. 2007",
           "K. Shundyak, M. van Hecke & W. van Saarloos (2007), Force mobilization and generalized isostaticity in "
           "jammed packings of frictional grains, Phys. Rev. E 75, 010301"},
    Source{"Chung & Ooi 2011",
           "Y. C. Chung & J. Y. Ooi (2011), Benchmark tests for verifying discrete element modelling codes at "
           "particle impact level, Granular Matter 13, 643"},
    Source{
        "Hertz 1882",
        "H. Hertz (1882), Über die Berührung fester elastischer Körper, J. reine angew. Math. 92, 156; as printed by "
        "Chung & Ooi (2011)"},
    Source{
        "LAMMPS 2026",
        "The LAMMPS developers (2026), unittest/granular of the LAMMPS distribution (versions of 30 March and 4 July "
        "2026), recorded trajectories and closed forms; https://www.lammps.org"},
    Source{"Flamant 1892",
           "A. Flamant (1892), Sur la répartition des pressions dans un solide rectangulaire chargé "
           "transversalement, C. R. Acad. Sci. Paris 114, 1465; displacements: S. P. Timoshenko & J. N. Goodier "
           "(1970), Theory of Elasticity, article 36"},
    Source{"Agnolin & Kruyt 2008",
           "I. Agnolin & N. P. Kruyt (2008), On the elastic moduli of two-dimensional assemblies of disks: relevance "
           "and modeling of fluctuations in particle displacements and rotations, Comput. Math. Appl. 55, 245; "
           "arXiv:0711.2894"},
};

constexpr std::array the_numbers{
    Published{"bond threshold", 0.6602, 0.0003, "Jacobs & Thorpe 1995"},
    Published{"rigidity exponent", 1.21, 0.06, "Jacobs & Thorpe 1995"},
    Published{"site threshold", 0.6975, 0.0003, "Jacobs & Thorpe 1996"},
    Published{"effective-medium threshold", 2.0 / 3, 0, "Feng et al. 1985"},
    Published{"effective-medium slope", 3, 0, "Feng et al. 1985"},
    Published{"adsorption coverage", 0.5471, 0.00005, "Zhang & Torquato 2013"},
    Published{"adsorption exponent", -0.5, 0, "Feder 1980"},
    Published{"jamming fraction", 0.842, 0.0005, "O'Hern et al. 2003"},
    Published{"jamming exponent", 0.71, 0.08, "O'Hern et al. 2003"},
    Published{"jamming coordination", 4, 0, "O'Hern et al. 2003"},
    Published{"excess coordination", 3.6, 0.5, "O'Hern et al. 2003"},
    Published{"least jamming fraction", 0.84, 0.005, "Schreck et al. 2011"},
    Published{"largest jamming fraction", 0.853, 0.0005, "Schreck et al. 2011"},
    Published{"contacts beyond 2 N' - 1", 0, 0, "Goodrich et al. 2012"},
    Published{"frictional coordination", 3, 0, "Shundyak et al. 2007"},
    Published{"dem01, Hooke, 2-D: speed after 947 steps", 5.0042582133180780e-01, 0, "LAMMPS 2026"},
    Published{"dem01, Hooke, 2-D: place after 947 steps", 5.1414816868621493e-01, 0, "LAMMPS 2026"},
    Published{"dem01, Hooke, e = 0.8: speed after 2068 steps, m/s", 1.5997548989987018, 0, "LAMMPS 2026"},
    Published{"dem01, Hertz with Tsuji's dashpot, e = 0.5: speed after 4100 steps, m/s", 9.9971769309661351e-01, 0,
              "LAMMPS 2026"},
    Published{"dem02, Hertz, two spheres: place after 1508 steps, m", 9.8629436218504573e-03, 0, "LAMMPS 2026"},
    Published{"dem02, Hertz, two spheres: speed after 2508 steps, m/s", 9.9999015425187849, 0, "LAMMPS 2026"},
    Published{"dem03, Hertz, wall: place after 2138 steps, m", 2.4773193520144258e-03, 0, "LAMMPS 2026"},
    Published{"dem03, Hertz, wall: speed after 3038 steps, m/s", 3.9000000198694948, 0, "LAMMPS 2026"},
    Published{"dem04, oblique impact on a wall: tangential velocity, m/s", 1.9626463236052916, 0, "LAMMPS 2026"},
    Published{"dem04, oblique impact on a wall: normal velocity, m/s", 2.9278279037320356, 0, "LAMMPS 2026"},
    Published{"dem04, oblique impact on a wall: spin, rad/s", 5.4425367639471085e+02, 0, "LAMMPS 2026"},
    Published{"dem04, grazing impact, classic model: tangential velocity, m/s", 2.8497777743815123, 0, "LAMMPS 2026"},
    Published{"dem04, grazing impact, classic model: normal velocity, m/s", 9.2469027185000185e-01, 0, "LAMMPS 2026"},
    Published{"dem04, grazing impact, classic model: spin, rad/s", 9.3412222561848876e+02, 0, "LAMMPS 2026"},
    Published{"dem05, sliding to rolling: velocity at 0.4 s, m/s", 1.2400019628833119, 0, "LAMMPS 2026"},
    Published{"dem05, sliding to rolling: spin at 0.4 s, rad/s", 1.5999803711667499e+02, 0, "LAMMPS 2026"},
    Published{"dem05, sliding to rolling: velocity at 1 s, m/s", 1.0000022220127893, 0, "LAMMPS 2026"},
    Published{"dem05, sliding to rolling: spin at 1 s, rad/s", 3.9999777798717338e+02, 0, "LAMMPS 2026"},
    Published{"dem06, spinning sphere: tangential velocity, m/s", 1.2706938882175314e-01, 0, "LAMMPS 2026"},
    Published{"dem06, spinning sphere: normal velocity, m/s", 9.9865657293162532e-02, 0, "LAMMPS 2026"},
    Published{"dem06, spinning sphere: spin, rad/s", 1.9683950332657247e+01, 0, "LAMMPS 2026"},
    Published{"dem10, compressed stack: lower place after 1000 steps, m", 4.2108853140521607e-04, 0, "LAMMPS 2026"},
    Published{"dem10, compressed stack: upper place after 1000 steps, m", 1.3787259677965739e-03, 0, "LAMMPS 2026"},
    Published{"dem10, compressed stack: lower velocity after 1000 steps, m/s", 2.7253050689536862e-01, 0,
              "LAMMPS 2026"},
};

}  // namespace

std::span<const Source> sources() {
  return the_sources;
}

const Published& published(const std::string& key) {
  const auto* found =
      std::find_if(the_numbers.begin(), the_numbers.end(), [&](const Published& number) { return number.key == key; });
  assert(found != the_numbers.end());
  return *found;
}

}  // namespace equidem::validation
