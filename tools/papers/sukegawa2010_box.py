# SPDX-License-Identifier: GPL-3.0-or-later
"""Sukegawa (2010), chapter 8: a box filled with grains and shaken, its void ratio, surface and the motion of grains."""
import dataclasses
import math
import time

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from common import eq, published

# The tables of sections 8.2 to 8.4.
NUMBERS = {name: row.value for name, row in published("sukegawa2010/published").items()}
CELL, PAIR_ROW = 0.03, 0.041  # m, distance of places and height of rows of pairs, which take two places of a row
SAMPLE = 0.01  # s
REST = 1.5  # s, the longest after the shaking, which ends where the kinetic energy is below
RESTING, CREEPING = 1e-6, 3e-4  # times the weight times the smallest radius; the latter of pairs that creep
PICTURES = ("start", "filled", "during", "after")


@dataclasses.dataclass(frozen=True)
class Fill:
    """A filling of the box. The start: rows of places at the distance CELL, every other row shifted by half of it, in a
    box of their width; 40 columns and 75 rows give the thesis's box, 1.215 m wide and filled from 2.25 m."""
    shape: str = "discs"  # ellipses, bonded_pairs, rigid_pairs
    seed: int = 1
    columns: int = 40
    rows: int = 75
    softness: float = 1.0  # springs of (2.26) over those used
    damping: float = 1.0  # h of (2.27)
    friction: float = NUMBERS["friction"]
    step_share: float = 0.5  # of the limit of the two lightest bodies
    step: float = 0.0  # s, in place of that
    bond_step: float = NUMBERS["time step"]  # s: C_n = m_r/bond_step, C_s = C_n/3
    row_share: float = 1.0  # height of the rows at the start over that of the thesis
    bulk: str = ""  # "springs", "all": rho = (1 + e) gamma (2.25) in the springs, in the masses too
    ellipse_contact: str = "exact"
    fall: float = 2.0  # s until the shaking

    @property
    def width(self):
        return CELL * (self.columns + 0.5)

    @property
    def pairs(self):
        return self.shape.endswith("pairs")

    @property
    def density(self):
        return NUMBERS["density"] * (1 + NUMBERS["discs, void ratio before"] if self.bulk == "all" else 1)

    def springs(self):
        """kN, kT of (2.26), from Vs, nu and rho."""
        shear = NUMBERS["shear wave speed"]**2 * self.density * math.pi / 4
        if self.bulk == "springs":  # the speeds are those of the medium, the density that of the discs
            shear *= 1 + NUMBERS["discs, void ratio before"]
        nu = NUMBERS["poisson ratio"]
        return shear * 2 * (1 - nu) / (1 - 2 * nu) / self.softness, shear / self.softness

    def followed(self):
        """The grains of the thesis's numbers 485, 500, ..., 2515, or those in the same places of another grid."""
        places = [(row, column) for row in (self.rows // 6, self.rows // 2, self.rows * 5 // 6)
                  for column in (self.columns // 8 - 1, self.columns // 2 - 1, self.columns * 7 // 8 - 1)]
        numbers = [row * self.columns + column for row, column in places]
        return [n // 2 if self.shape == "rigid_pairs" else n for n in numbers], [f"No. {n + 1}" for n in numbers]


def directions(angles):
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


class Bodies:
    """The bodies of a filling: `radii` drawn, `half_axes` of ellipses, `mass` and `moment` of each grain."""
    def __init__(self, fill):
        self.fill, random = fill, eq._core.Random(fill.seed)
        columns = fill.columns // 2 if fill.pairs else fill.columns
        n = columns * fill.rows
        least, most = NUMBERS["smallest radius"], NUMBERS["largest radius"]
        drawn = least + (most - least) * (np.arange(n) + random.uniforms(n)) / n
        self.radii = drawn[random.order(n)]
        self.angles = 2 * math.pi * np.array(random.uniforms(n)) * (fill.shape != "discs")
        wide, high = CELL * (2 if fill.pairs else 1), PAIR_ROW if fill.pairs else CELL
        row, column = np.divmod(np.arange(n), columns)
        self.places = np.stack([(column + 0.5) * wide + row % 2 * (CELL / 2), (row + 0.5) * high * fill.row_share], 1)
        self.layers = np.arange(n) * 5 // n
        self.offsets = np.outer((-1, 1) if fill.shape == "rigid_pairs" else (0,), self.radii)  # along the axis
        if fill.shape == "bonded_pairs":
            along = self.radii[:, None] * directions(self.angles)
            self.places = np.stack([self.places - along, self.places + along], axis=1).reshape(-1, 2)
            self.radii, self.angles, self.layers = (np.repeat(one, 2) for one in (self.radii, self.angles, self.layers))
            self.offsets = np.zeros((1, 2 * n))
        aspect = math.sqrt(2) if fill.shape == "ellipses" else 1.0  # ellipses have the areas of the discs
        self.half_axes = self.radii[:, None] * (aspect, 1 / aspect)
        self.area = len(self.offsets) * math.pi * self.half_axes.prod(axis=1)
        self.mass, self.reach = fill.density * self.area, self.half_axes[:, 0] * len(self.offsets)
        self.moment = self.mass * ((self.half_axes**2).sum(axis=1) / 4 + self.offsets[0]**2)
        self.diameter = 2 * np.mean(np.sqrt(self.area / math.pi))

    def step(self):
        """The one given, else step_share of the limit of a contact of the two lightest bodies (semi-implicit)."""
        if self.fill.step:
            return self.fill.step
        kN, kT = self.fill.springs()
        # the longest arm of a normal force
        arm = self.radii if self.fill.shape == "rigid_pairs" else self.half_axes[:, 0] - self.half_axes[:, 1]

        def limit(stiffness, lever):
            moved = (0.5 / (1 / self.mass + lever**2 / self.moment)).min()
            zeta = self.fill.damping * math.sqrt(self.mass.min() / moved)
            return 2 / (math.sqrt(1 + zeta**2) + zeta) / math.sqrt(stiffness / moved)
        return self.fill.step_share * min(limit(kN, arm), limit(kT, self.reach))

    def tables(self):
        """Of the case file."""
        (kN, kT), shape = self.fill.springs(), self.fill.shape
        arrays = (array.tolist() for array in (self.places, self.angles, self.half_axes, self.radii))
        grains = [{"position": place, "angle": angle, **{
            "ellipses": {"half_axes": axes}, "rigid_pairs": {"discs": [[-r, 0.0, r], [r, 0.0, r]]}
        }.get(shape, {"radius": r})} for place, angle, axes, r in zip(*arrays)]
        walls = {"floor": ([0.0, 0.0], [0.0, 1.0]), "left": ([0.0, 0.0], [1.0, 0.0]),
                 "right": ([self.fill.width, 0.0], [-1.0, 0.0])}
        tables = {"grains": {"density": self.fill.density}, "grain": grains, "springs": {"kN": kN, "kT": kT},
                  "collisions": {"law": "linear_dashpot", "damping": self.fill.damping, "friction": self.fill.friction,
                                 "walls": {"friction": NUMBERS["wall friction"]}},
                  "wall": [{"name": name, "point": at, "normal": normal} for name, (at, normal) in walls.items()]}
        if shape == "ellipses":
            tables["collisions"]["ellipse_contact"] = self.fill.ellipse_contact
        if shape == "bonded_pairs":
            dashpots = 0.5 * self.mass[::2] / self.fill.bond_step  # a tangential force also turns the disc: a third
            tables["bond"] = [{"grains": [2 * k, 2 * k + 1], "normal_dashpot": c, "tangential_dashpot": c / 3}
                              for k, c in enumerate(dashpots.tolist())]
        return tables


class Moment:
    """The box at one time: places in the box, heap, surface, void ratios."""
    def __init__(self, bodies, places, angles, left):
        self.places, self.angles, self.bodies = places - [left, 0.0], angles, bodies
        # The heap: the largest set of bodies of which each is at most a mean diameter from another.
        pairs = cKDTree(places).query_pairs(2 * bodies.reach.max() + bodies.diameter, output_type="ndarray")
        gaps = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1) - bodies.reach[pairs].sum(axis=1)
        i, j = pairs[gaps <= bodies.diameter].T
        sets = connected_components(coo_matrix((np.ones(len(i)), (i, j)), (len(places), len(places))), False)[1]
        self.heap = sets == np.argmax(np.bincount(sets))
        x, heights = self.surface(max(2, int(bodies.fill.width / (4 * NUMBERS["largest radius"]))))
        line = np.polyfit(x, heights, 1)
        self.height, self.slope, self.roughness = heights.mean(), line[0], np.std(heights - np.polyval(line, x))
        self.whole = bodies.fill.width * self.height / bodies.area[self.heap].sum() - 1
        self.centre = np.average(self.places, 0, bodies.mass)

    def parts(self, chosen=slice(None)):
        """Centres, angles and half-axes of discs and ellipses."""
        count, axis = len(self.bodies.offsets), directions(self.angles)
        centres = [(self.places + offset[:, None] * axis)[chosen] for offset in self.bodies.offsets]
        return np.concatenate(centres), *(
            np.concatenate([values[chosen]] * count) for values in (self.angles, self.bodies.half_axes))

    def surface(self, columns):
        """The middles of columns and the highest place of the heap in each."""
        wide = self.bodies.fill.width / columns
        centres, angles, axes = self.parts(self.heap)
        c, s, (p, q) = np.cos(angles), np.sin(angles), axes.T**-2.0
        A, B, C = p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c  # A x² + 2 B x y + C y² = 1
        D = A * C - B * B
        half, left = np.sqrt(C / D), wide * np.arange(columns)[:, None]
        low, high = np.maximum(left - centres[:, 0], -half), np.minimum(left + wide - centres[:, 0], half)
        x = np.clip(-B * np.sqrt(A / D) / A, low, high)
        y = centres[:, 1] + (-B * x + np.sqrt(np.maximum(0, C - D * x * x))) / C
        return left[:, 0] + 0.5 * wide, np.where(low <= high, y, 0.0).max(axis=1)

    def inner(self, pixel=2.5e-4):
        """Void ratio two mean diameters away from walls and floor, three below the lowest place of the surface; by
        pixels. Where bodies overlap, each counts with its whole area, as in `whole`."""
        strip, width = 2 * self.bodies.diameter, self.bodies.fill.width
        lowest = self.surface(max(1, int(width / (4 * self.bodies.reach.max()))))[1].min()
        low, high = np.array([strip, strip]), np.array([width - strip, lowest - 1.5 * strip])
        if min(high - low) < strip:
            return math.nan
        count = ((high - low) / pixel).astype(int)
        solid, step = np.zeros(count), (high - low) / count
        x, y = (low[k] + step[k] * (np.arange(count[k]) + 0.5) for k in (0, 1))
        for centre, angle, (a, b) in zip(*self.parts()):
            first, last = np.clip(((centre + [[-a], [a]] - low) / step).astype(int) + [[0], [1]], 0, count)
            near, c, s = tuple(map(slice, first, last)), math.cos(angle), math.sin(angle)
            dx, dy = x[near[0], None] - centre[0], y[near[1]] - centre[1]
            solid[near] += ((c * dx + s * dy) / a)**2 + ((c * dy - s * dx) / b)**2 <= 1
        return 1 / solid.mean() - 1


class Stage:
    """Samples of the filling or of the shaking, and the motion of grains in the box between them."""
    def __init__(self, first):
        self.rows, self.first, self.last, self.farthest = [], first, first, first
        self.thrown, self.slope = ~first.heap, abs(first.slope)
        self.ways = np.zeros((4, len(first.places)))  # all, along x, in the first 0.1 s, rotation
        self.add(0.0, first)

    def add(self, t, moment):
        moved = moment.places - self.last.places
        way = np.hypot(*moved.T)
        self.ways += [way, np.abs(moved[:, 0]), way * (t < 0.1001), np.abs(moment.angles - self.last.angles)]
        self.last, self.thrown, self.slope = moment, self.thrown | ~moment.heap, max(self.slope, abs(moment.slope))
        if abs(moment.centre[0] - self.first.centre[0]) > abs(self.farthest.centre[0] - self.first.centre[0]):
            self.farthest = moment
        grains = moment.bodies.fill.followed()[0]
        self.rows.append({"time_s": t, "whole_void_ratio": moment.whole, "centre_x_m": moment.centre[0],
                          "slope": moment.slope, "x_m": moment.places[grains, 0], "y_m": moment.places[grains, 1],
                          "angle_rad": moment.angles[grains]})

    def history(self):
        """Columns over the samples, of nine grains each."""
        return {key: np.array([row[key] for row in self.rows]) for key in self.rows[0]}

    def moved(self):
        """Means over all grains."""
        start, way = self.first.places, self.last.places - self.first.places
        middle = start[:, 0] - 0.5 * self.first.bodies.fill.width
        outer = np.abs(middle) > self.first.bodies.fill.width / 6
        layer = np.empty(len(start), int)
        layer[np.lexsort((np.arange(len(start)), start[:, 1]))] = np.arange(len(start)) * 10 // len(start)
        sums, members = np.bincount(layer, way[:, 0], 10), np.maximum(1, np.bincount(layer, minlength=10))
        squares = (way[:, 0]**2).sum()
        names = ("path_m", "path_along_x_m", "first_path_m", "turned_rad")
        return {**dict(zip(names, self.ways.mean(axis=1))), "displaced_x_m": math.sqrt(squares / len(start)),
                "inward_m": (-np.sign(middle) * way[:, 0])[outer].mean() if outer.any() else 0.0,
                "sunk_m": -way[:, 1].mean(),
                "layered": (sums**2 / members).sum() / squares if squares > 0 else 0.0}


def swing_of(history, frequency, cycles):
    """Amplitude of the centre of mass along x in the box at the frequency of shaking, over its last two cycles: least
    squares with a constant."""
    t, x = history["time_s"], history["centre_x_m"]
    chosen = (t * frequency >= cycles - 2) & (t * frequency <= cycles)
    if chosen.sum() < 8:
        return math.nan
    angle = 2 * math.pi * frequency * t[chosen]
    columns = np.stack([np.ones(len(angle)), np.cos(angle), np.sin(angle)], axis=1)
    return math.hypot(*np.linalg.lstsq(columns, x[chosen], rcond=None)[0][1:])


def run_box(fill, gal, frequency, cycles):
    """Fill the box and shake it by a cos(2 pi f t) along x: the numbers, those of the filling, the histories of both
    stages and the moments PICTURES, as lists that JSON can hold."""
    begun, bodies = time.monotonic(), Bodies(fill)
    step, duration, a = bodies.step(), cycles / frequency, 0.01 * gal / (2 * math.pi * frequency)**2
    shaking = {"shaking": {"acceleration": 0.01 * gal, "frequency": frequency, "cycles": int(cycles)}} if gal else {}
    stages = [{"name": "fall", "duration": fill.fall}, {"name": "shake", "duration": duration, **shaking},
              {"name": "rest", "duration": REST}]
    run = eq.simulation(**bodies.tables(), stage=stages, run={"time_step": step, "gravity": [0.0, -NUMBERS["gravity"]],
                                                              "integrator": "velocity_verlet"})

    def moment():
        phase = 2 * math.pi * frequency * min(max(run.time - fill.fall, 0.0), duration)
        return Moment(bodies, np.array(run.positions), np.array(run.angles), a * (1 - math.cos(phase)))

    def advance(stage, begin, end, quiet=-1.0):
        block = max(1, round(SAMPLE / step))
        while run.time < end - 0.5 * step and run.energy["kinetic"] > quiet:
            run.advance(min(block, max(1, round((end - run.time) / step))))
            stage.add(run.time - begin, moment())
        return stage

    falling = advance(Stage(moment()), 0.0, fill.fall)
    filled, bonds, begin, end = moment(), fill.shape == "bonded_pairs", run.time, fill.fall + duration
    quiet = (CREEPING if bonds else RESTING) * bodies.mass.sum() * NUMBERS["gravity"] * bodies.radii.min()
    shaken = advance(Stage(filled), begin, end)
    advance(shaken, begin, end + REST, quiet)
    after, contacts, energy = moment(), run.contacts, run.energy
    i, j = contacts["bodies"].T
    bonded = bonds & (i // 2 == j // 2) & (j >= 0)
    overlap = (-contacts["normal_forces"][~bonded]).max(initial=0.0) / fill.springs()[0]
    numbers = {}
    for when, at in (("_before", filled), ("", after)):
        numbers.update({f"void_ratio{when}": at.inner(), f"whole_void_ratio{when}": at.whole,
                        f"surface_height{when}_m": at.height, f"roughness{when}_m": at.roughness,
                        f"centre_height{when}_m": at.centre[1]})
    numbers.update(
        largest_slope=shaken.slope, swing_m=swing_of(shaken.history(), frequency, cycles), thrown=shaken.thrown.sum(),
        coordination=(1 + (j >= 0))[~bonded].sum() / len(bodies.mass) * (2 if bonds else 1), **shaken.moved(),
        bond_creep=math.nan, bond_roll_rad=math.nan, largest_overlap=overlap / bodies.radii.min(), time_step_s=step,
        steps=run.step - round(fill.fall / step), time_s=run.time - fill.fall,
        energy_error=energy["error"] / abs(energy["potential"]), seconds=time.monotonic() - begun)
    if bonds:
        (before, rolled), (now, rolled_now) = (
            (np.linalg.norm(at.places[1::2] - at.places[::2], axis=1), at.angles[1::2] - at.angles[::2])
            for at in (falling.first, after))
        numbers["bond_creep"] = np.mean(np.abs(now - before) / (2 * bodies.radii[::2]))
        numbers["bond_roll_rad"] = np.mean(np.abs(rolled_now - rolled))
    layers = np.tile(bodies.layers, len(bodies.offsets))
    histories = ({key: column.tolist() for key, column in stage.history().items()} for stage in (falling, shaken))
    return {"numbers": {key: float(value) for key, value in numbers.items()}, "filling": falling.moved(),
            **dict(zip(("falling", "shaking"), histories)), "pictures": [
                [part.tolist() for part in (*at.parts(), layers)]
                for at in (falling.first, filled, shaken.farthest, after)]}
