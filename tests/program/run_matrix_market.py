# SPDX-License-Identifier: GPL-3.0-or-later
"""equidem export --to matrix-market: SciPy reads the equations, solves them and finds the motions of the program."""
import unittest

from program import CASES, CELL, TENSION, ProgramTest, equidem, result_in, rows_of

try:
    import numpy
    import scipy.io
    import scipy.sparse.linalg
except ImportError:
    scipy = None

NAMES = {"ux": "ux_m", "uy": "uy_m", "rotation": "rotation_rad"}
GRADIENTS = {"xx": ((1, 0), (0, 0)), "yy": ((0, 0), (0, 1)), "xy": ((0, 0.5), (0.5, 0))}


def solved(folder):
    """Of each right-hand side the motions by discs: unknown by unknown, and those that are prescribed."""
    K = scipy.io.mmread(folder / "stiffness.mtx").tocsc()
    f = scipy.io.mmread(folder / "right_hand_sides.mtx")
    factor = scipy.sparse.linalg.splu(K, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    u = factor.solve(f)
    u += factor.solve(f - K @ u)
    motions = {(int(row["disc"]), row["component"]): u[int(row["unknown"])] * float(row["scale"])
               for row in rows_of(folder / "unknowns.csv")}
    for row in rows_of(folder / "held.csv"):
        motions[int(row["disc"]), row["component"]] = numpy.full(f.shape[1], float(row["value"]))
    return [[{column: motions[disc, name][k] if (disc, name) in motions else 0.0 for name, column in NAMES.items()}
             for disc in sorted({disc for disc, _ in motions})] for k in range(f.shape[1])]


@unittest.skipIf(scipy is None, "SciPy is not installed")
class MatrixMarket(ProgramTest):
    def exported(self, *arguments):
        folder = self.folder / "equations"
        self.done("export", *arguments, "--to", "matrix-market", "--out", folder, "--overwrite")
        return folder

    def check_motions(self, theirs, ours, columns):
        """`ours` are rows of numbers by column."""
        largest = max(abs(row[name]) for row in ours for name in columns)
        self.assertGreater(largest, 0)
        for a, b in zip(theirs, ours, strict=True):
            for name in columns:
                self.assertAlmostEqual(a[name], b[name], delta=1e-10 * largest)

    def test_motions_of_supports_loads_and_tests_are_those_of_solve(self):
        cantilever = (CASES / "cantilever.toml",)
        for case, loads in (((TENSION,), ("",)), ((TENSION, "springs.kT=0.2e9"), ("",)), (cantilever, ("_weight", "_tip")),
                            ((*cantilever, "support.0.uy=1e-4"), ("_weight", "_tip"))):
            with self.subTest(case=case):
                found, out = solved(self.exported(*case)), self.folder / "ours"
                self.done("solve", *case, "--out", out, "--overwrite")
                for theirs, load in zip(found, loads, strict=True):
                    ours = [{name: float(row[name]) for name in NAMES.values() if name in row}
                            for row in rows_of(out / f"discs{load}.csv")]
                    self.check_motions(theirs, ours, ("ux_m", "uy_m"))
                    if "rotation_rad" in ours[0]:
                        self.check_motions(theirs, ours, ("rotation_rad",))

    def check_cell(self, *case):
        found, out = solved(self.exported(*case)), self.folder / "ours"
        self.done("homogenize", *case, "--out", out, "--overwrite")
        written = result_in(out)["strain_of_states"]
        for theirs, (name, gradient) in zip(found, GRADIENTS.items(), strict=True):
            ours = []
            for row in rows_of(out / f"discs_strain_{name}.csv"):
                x, y = float(row["x_m"]), float(row["y_m"])
                ours.append({column: float(row[column]) / written - along[0] * x - along[1] * y
                             for column, along in zip(("ux_m", "uy_m"), gradient)})
            self.check_motions(theirs, ours, ("ux_m", "uy_m"))

    def test_a_periodic_cell_has_three_right_hand_sides(self):
        self.check_cell(CELL, "assembly.discs=200")

    def test_forces_at_rest_are_in_the_matrix(self):
        packed = self.folder / "packed"
        self.done("pack", CASES / "pack_ellipses.toml", "packing.sides=periodic", "packing.grains=60", "--out", packed)
        case, matrices = self.of_file(packed / "assembly.json"), []
        for counts in ("on", "off"):
            self.check_cell(case, f"effects.prestress={counts}")
            matrices.append(scipy.io.mmread(self.folder / "equations" / "stiffness.mtx").toarray())
        self.assertGreater(abs(matrices[0] - matrices[1]).max(), 1e-4 * abs(matrices[1]).max())

    def test_matrices_say_what_they_are_and_are_symmetric_and_definite(self):
        folder = self.exported(TENSION)
        matrix = scipy.io.mmread(folder / "stiffness.mtx").toarray()
        self.assertTrue((matrix == matrix.T).all())
        self.assertGreater(numpy.linalg.eigvalsh(matrix)[0], 0)
        motions = scipy.io.mmread(folder / "rigid_motions.mtx")
        self.assertEqual((motions.shape, numpy.linalg.matrix_rank(motions)), ((len(matrix), 3), 3))
        self.assertEqual(len(rows_of(folder / "unknowns.csv")), len(matrix))
        for name in ("stiffness.mtx", "right_hand_sides.mtx", "rigid_motions.mtx", "README.txt"):
            self.assertIn("metre of depth", (folder / name).read_text())

    def test_what_nothing_holds_is_refused(self):
        case = self.write('[assembly]\nkind = "hexagonal"\ncolumns = 4\nrows = 4\nradius = 0.01\n[springs]\nkN = 1e9\nkT = 1e8\n')
        self.check_error(equidem("export", case, "--to", "matrix-market", "--out", self.folder / "no"), 2,
                         "nothing holds the assembly", "singular")


if __name__ == "__main__":
    unittest.main()
