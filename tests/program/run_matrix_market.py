# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem export --to matrix-market: SciPy reads the equations, solves them and finds the motions of the program."""
import csv
import unittest

from program import CASES, TENSION, ProgramTest, equidem, parse_json

try:
    import numpy
    import scipy.io
    import scipy.sparse.linalg
except ImportError:
    scipy = None

GRADIENTS = {"xx": ((1, 0), (0, 0)), "yy": ((0, 0), (0, 1)), "xy": ((0, 0.5), (0.5, 0))}


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def solved(folder):
    """The motions as rows of right-hand side, disc and components: unknown by unknown, and those that are held."""
    K = scipy.io.mmread(folder / "stiffness.mtx").tocsc()
    f = scipy.io.mmread(folder / "right_hand_sides.mtx")
    factor = scipy.sparse.linalg.splu(K, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    u = factor.solve(f)
    u += factor.solve(f - K @ u)
    motions = {(int(row["disc"]), row["component"]): u[int(row["unknown"])] * float(row["scale"])
               for row in rows_of(folder / "unknowns.csv")}
    for row in rows_of(folder / "held.csv"):
        motions[int(row["disc"]), row["component"]] = numpy.full(f.shape[1], float(row["value"]))
    names = {"ux": "ux_m", "uy": "uy_m", "rotation": "rotation_rad"}
    return [{"right_hand_side": str(k), **{column: motions[disc, name][k] if (disc, name) in motions else 0.0
                                           for name, column in names.items()}}
            for k in range(f.shape[1]) for disc in sorted({disc for disc, _ in motions})]


@unittest.skipIf(scipy is None, "SciPy is not installed")
class MatrixMarket(ProgramTest):
    def exported(self, *arguments):
        folder = self.folder / "equations"
        self.check_done(equidem("export", *arguments, "--to", "matrix-market", "--out", folder, "--overwrite"))
        return folder, solved(folder)

    def check_motions(self, theirs, ours, motion_of=lambda row: (float(row["ux_m"]), float(row["uy_m"]))):
        largest = max(abs(value) for row in ours for value in motion_of(row))
        off = max(abs(float(a[name]) - value) for a, b in zip(theirs, ours, strict=True)
                  for name, value in zip(("ux_m", "uy_m"), motion_of(b)))
        self.assertLess(off, 1e-10 * largest)
        self.assertGreater(largest, 0)

    def check_case(self, *case, loads=("",)):
        _, found = self.exported(*case)
        self.check_done(equidem("solve", *case, "--out", self.folder / "ours", "--overwrite"))
        for k, name in enumerate(loads):
            ours = rows_of(self.folder / "ours" / f"discs{name}.csv")
            theirs = [row for row in found if row["right_hand_side"] == str(k)]
            self.check_motions(theirs, ours)
            if "rotation_rad" in ours[0]:
                size = max(abs(float(row["rotation_rad"])) for row in ours)
                for a, b in zip(theirs, ours):
                    self.assertAlmostEqual(float(a["rotation_rad"]), float(b["rotation_rad"]), delta=1e-10 * size)

    def test_a_tension_test_has_the_same_displacements(self):
        self.check_case(TENSION)
        self.check_case(TENSION, "--set", "springs.kT=0.2e9")

    def test_supports_loads_and_imposed_motions_are_in_the_right_hand_sides(self):
        self.check_case(CASES / "cantilever.toml", loads=("_weight", "_tip"))
        self.check_case(CASES / "cantilever.toml", "--set", "support.0.uy=1e-4", loads=("_weight", "_tip"))

    def check_cell(self, *case):
        folder, found = self.exported(*case)
        self.check_done(equidem("homogenize", *case, "--out", self.folder / "ours", "--overwrite"))
        written = parse_json((self.folder / "ours" / "result.json").read_text())["strain_of_states"]
        for k, (name, gradient) in enumerate(GRADIENTS.items()):
            ours = rows_of(self.folder / "ours" / f"discs_strain_{name}.csv")
            theirs = [row for row in found if row["right_hand_side"] == str(k)]

            def beside(row, gradient=gradient):
                x, y = float(row["x_m"]), float(row["y_m"])
                return (float(row["ux_m"]) / written - gradient[0][0] * x - gradient[0][1] * y,
                        float(row["uy_m"]) / written - gradient[1][0] * x - gradient[1][1] * y)
            self.check_motions(theirs, ours, beside)
        self.assertEqual(scipy.io.mmread(folder / "right_hand_sides.mtx").shape[1], 3)

    def test_a_periodic_cell_has_three_right_hand_sides(self):
        self.check_cell(CASES / "random_cell.toml", "--set", "assembly.discs=200")

    def test_forces_at_rest_are_in_the_matrix(self):
        packed = self.folder / "packed"
        self.check_done(equidem("pack", CASES / "pack_ellipses.toml", "--set", "packing.sides=periodic", "--set",
                                "packing.grains=60", "--out", packed))
        case = self.folder / "cell.toml"
        case.write_text(f'schema = "equidem/1"\n[assembly]\nkind = "file"\npath = "{packed / "assembly.json"}"\n')
        matrices = []
        for counts in ("on", "off"):
            self.check_cell(case, "--set", f"effects.prestress={counts}")
            matrices.append(scipy.io.mmread(self.folder / "equations" / "stiffness.mtx").toarray())
        self.assertGreater(abs(matrices[0] - matrices[1]).max(), 1e-4 * abs(matrices[1]).max())

    def test_matrices_say_what_they_are_and_are_symmetric_and_definite(self):
        folder, _ = self.exported(TENSION)
        matrix = scipy.io.mmread(folder / "stiffness.mtx").toarray()
        self.assertTrue((matrix == matrix.T).all())
        self.assertGreater(numpy.linalg.eigvalsh(matrix)[0], 0)
        motions = scipy.io.mmread(folder / "rigid_motions.mtx")
        self.assertEqual(motions.shape, (len(matrix), 3))
        self.assertEqual(numpy.linalg.matrix_rank(motions), 3)
        self.assertEqual(len(rows_of(folder / "unknowns.csv")), len(matrix))
        for name in ("stiffness.mtx", "right_hand_sides.mtx", "rigid_motions.mtx", "README.txt"):
            self.assertIn("metre of depth", (folder / name).read_text())

    def test_what_nothing_holds_is_refused(self):
        case = self.folder / "free.toml"
        case.write_text('schema = "equidem/1"\n[assembly]\nkind = "hexagonal"\ncolumns = 4\nrows = 4\nradius = 0.01\n'
                        "[springs]\nkN = 1e9\nkT = 1e8\n")
        self.check_error(equidem("export", case, "--to", "matrix-market", "--out", self.folder / "no"), 2,
                         "nothing holds the assembly", "singular")


if __name__ == "__main__":
    unittest.main()
