# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem calibrate names its springs in the parameters of other programs; YADE makes those springs of them."""
import json
import shutil
import subprocess
import unittest

from program import CASES, ProgramTest, equidem, parse_json

RANDOM = CASES / "calibrate_random.toml"
YADE = shutil.which("yade")
SCRIPT = """
import json
given = json.load(open("given.json"))
O.materials.append([FrictMat(young=young, poisson=given["poisson"]) for young in given["young"]])
O.materials.append([CohFrictMat(young=young, poisson=given["poisson"]) for young in given["young"]])
found = []
for kind, functor in ((0, Ip2_FrictMat_FrictMat_FrictPhys()), (2, Ip2_CohFrictMat_CohFrictMat_CohFrictPhys())):
    for a, b in ((0, 0), (0, 1), (1, 1)):
        O.bodies.clear(), O.interactions.clear()
        r, s = given["radii"][a], given["radii"][b]
        O.bodies.append([sphere((0, 0, 0), r, material=kind + a), sphere((0.999 * (r + s), 0, 0), s, material=kind + b)])
        geometry, law = ((Ig2_Sphere_Sphere_ScGeom(), Law2_ScGeom_FrictPhys_CundallStrack()) if kind == 0 else
                         (Ig2_Sphere_Sphere_ScGeom6D(), Law2_ScGeom6D_CohFrictPhys_CohesionMoment()))
        O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb()]),
                     InteractionLoop([geometry], [functor], [law]), NewtonIntegrator()]
        O.dt = 1e-12
        O.step()
        found.append([O.interactions[0, 1].phys.kn, O.interactions[0, 1].phys.ks])
json.dump(found, open("found.json", "w"))
"""


class EngineSprings(ProgramTest):
    def calibrated(self, *arguments):
        return parse_json(self.check_done(equidem("calibrate", RANDOM, *arguments, "--json", "-")).stdout)

    def test_every_program_has_its_parameters_with_units(self):
        result = self.calibrated()
        engines, kN, kT = result["engines"], result["kN"], result["kT"]
        self.assertEqual(engines["depth"], 1)
        for first, second in (("lammps", "k_r k_s"), ("lammps", "kn kt"), ("pfc", "kn ks")):
            self.assertEqual([engines[first][name] for name in second.split()], [kN, kT])
        for young, kn, radius in zip(engines["yade"]["young"], engines["pfc"]["pb_kn"], engines["radii"]):
            self.assertAlmostEqual(young * radius / kN, 1, 12)
            self.assertAlmostEqual(kn * 2 * radius / kN, 1, 12)
        self.assertAlmostEqual(engines["yade"]["poisson"], kT / kN, 14)
        for word in ("bpm/rotational", "gran/hooke/history", "CohFrictMat", "linearpbond", "per metre of depth", "N/m", "Pa/m"):
            self.assertIn(word, result["report"])

    def test_springs_that_differ_or_are_negative_have_no_such_parameters(self):
        self.assertNotIn("engines", self.calibrated("--set", "material.weighting=voronoi"))
        negative = self.calibrated("--set", "material.poisson_ratio=0.26", "--set", "material.static_only=true")
        self.assertNotIn("engines", negative)
        self.assertIn("kT < 0: they have no such springs", negative["report"])

    @unittest.skipIf(YADE is None, "YADE is not installed")
    def test_yade_makes_these_springs_between_bodies_of_any_radii(self):
        result = self.calibrated("--set", "assembly.radius=none", "--set",
                                 "assembly.radii={smallest=0.004,largest=0.006}")
        engines = result["engines"]
        self.assertGreater(engines["radii"][0], 1.2 * engines["radii"][1])
        given = {"young": engines["yade"]["young"], "poisson": engines["yade"]["poisson"], "radii": engines["radii"]}
        (self.folder / "given.json").write_text(json.dumps(given))
        (self.folder / "springs.py").write_text(SCRIPT)
        done = subprocess.run([YADE, "-x", "-n", "-j1", "springs.py"], cwd=self.folder, capture_output=True, text=True,
                              timeout=120)
        self.assertTrue((self.folder / "found.json").exists(), done.stdout + done.stderr)
        for kn, ks in json.loads((self.folder / "found.json").read_text()):
            self.assertAlmostEqual(kn / result["kN"], 1, 10)
            self.assertAlmostEqual(ks / result["kT"], 1, 10)


if __name__ == "__main__":
    unittest.main()
