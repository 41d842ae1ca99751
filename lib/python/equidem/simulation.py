# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion in time, step by step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _core
from ._arrays import Floats, whole
from .assembly import Assembly
from .errors import BadInput

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class Frame:
    """The state at one time.

    Attributes
    ----------
    step : int
    time : float
        s.
    positions, velocities : array (n, 2)
        m, m/s.
    angles, spins : array (n,)
        rad, rad/s.
    """

    step: int
    time: float
    positions: Floats
    angles: Floats
    velocities: Floats
    spins: Floats


class Simulation:
    """Bonded discs stepped in time, or bodies that collide; made by `Case.simulation` or `equidem.simulation`.

    Results have the same bits for any number of threads and any division of the steps into calls.
    """

    def __init__(self, steps: _core.Steps) -> None:
        self._steps = steps
        bodies = steps.bodies()
        self._assembly = None if bodies is None else Assembly._of(bodies)

    def __repr__(self) -> str:
        return f"<Simulation at step {self.step} of {self.steps}, t = {self.time:.6g} s>"

    @property
    def step(self) -> int:
        """Steps done."""
        return self._steps.step

    @property
    def steps(self) -> int:
        """Steps of the duration of the case."""
        return self._steps.steps

    @property
    def time(self) -> float:
        """s."""
        return self._steps.time

    @property
    def time_step(self) -> float:
        """s."""
        return self._steps.time_step

    @property
    def assembly(self) -> Assembly | None:
        """The bodies at the start."""
        return self._assembly

    @property
    def displacements(self) -> Floats:
        """(n, 2), m, of bonded discs from the start."""
        if not self._steps.bonded:
            raise BadInput("bodies that collide have no displacements", "they have no reference state",
                           "Use positions")
        return self._steps.motions()[0]

    @property
    def positions(self) -> Floats:
        """(n, 2), m."""
        moved = self._steps.motions()[0]
        if not self._steps.bonded or self._assembly is None:
            return moved
        return self._assembly.centres + moved

    @property
    def angles(self) -> Floats:
        """(n,), rad."""
        return self._steps.motions()[1]

    @property
    def velocities(self) -> Floats:
        """(n, 2), m/s."""
        return self._steps.velocities()[0]

    @property
    def spins(self) -> Floats:
        """(n,), rad/s."""
        return self._steps.velocities()[1]

    @property
    def contacts(self) -> Mapping[str, Floats]:
        """Arrays of the contacts: bodies (m, 2), where j < 0 is wall -1 - j, arms (m, 2) in m from the centre of i,
        forces (m, 2) on i, normal_forces and tangential_forces (m,) in N/m (spheres: N). These are the components of
        forces along the normal n from i, tension positive, and along (-n_y, n_x), for bonded discs and for bodies that
        collide. Frames and contacts.csv of bodies that collide have the opposite sign: the force on j."""
        return self._steps.contacts()

    @property
    def energy(self) -> Mapping[str, float]:
        """Terms of the energy ledger, J per metre of depth (spheres: J), and the error of its balance."""
        return self._steps.energy()

    @property
    def walls(self) -> Mapping[str, Mapping[str, Any]]:
        """Each wall by its name: position and velocity (x, y) in m and m/s, force (x, y) of the bodies on it in the
        last step in N/m (spheres: N), moment, and of bodies that collide impulse and work since the start."""
        return self._steps.walls()

    @property
    def cell(self) -> Mapping[str, Any] | None:
        """The periodic cell of bodies that collide: width, height, shift in m, strain (logarithmic) and mean stress in
        Pa, tension positive, as (xx, yy, xy), void_ratio and coordination_number; None where nothing repeats."""
        return self._steps.cell()

    def steer(self, wall: str, *, velocity: tuple[float, float] | None = None, wanted: float | None = None) -> None:
        """Change the motion of a wall of bodies that collide from the present step to the end of its stage.

        Parameters
        ----------
        wall
            Its name.
        velocity
            (x, y), m/s; a servo of the wall ends.
        wanted
            What its servo keeps: the force in N/m (spheres: N), or the stress in Pa where the case gives a stress.

        Raises
        ------
        BadInput
            No such wall, a wall without servo, a motion that the case refuses too; bonded discs.
        """
        if (velocity is None) == (wanted is None):
            raise BadInput("a wall is steered by one of velocity and wanted", "it has one motion", "Give one of them")
        moved = None if velocity is None else (float(velocity[0]), float(velocity[1]))
        self._steps.steer(wall, moved, {} if wanted is None else {"wanted": float(wanted)})

    def steer_cell(self, **values: float) -> None:
        """Change how the periodic cell deforms from the present step to the end of its stage.

        Parameters
        ----------
        values
            Rates ``xx``, ``yy`` and ``xy`` in 1/s, and stresses ``stress_xx`` and ``stress_yy`` in Pa, tension
            positive, where the case has [cell.servo]. A rate ends the stress of its component, and a stress its rate.

        Raises
        ------
        BadInput
            As `steer`.
        """
        known = ("xx", "yy", "xy", "stress_xx", "stress_yy")
        for name in values:
            if name not in known:
                raise BadInput(f"a cell has no '{name}'", f"it has {', '.join(known)}", "Correct the name")
        if not values:
            raise BadInput("nothing is steered", f"none of {', '.join(known)} is given", "Give one")
        self._steps.steer("", None, {name: float(value) for name, value in values.items()})

    def advance(self, steps: int) -> None:
        """Make that many steps, or those until the last stage ends.

        Raises
        ------
        ComputationFailed
            Where the motion runs away.
        Interrupted
            After Ctrl-C, between two steps.
        """
        self._steps.advance(whole("steps", steps, 0), False)

    def finish_stage(self) -> None:
        """Make steps until the present stage ends; of a case without stages, those that are left of its duration.

        Raises
        ------
        ComputationFailed, Interrupted
            As `advance`; a stage that does not meet its end.
        """
        self._steps.advance(max(0, self.steps - self.step), True)

    @property
    def frame(self) -> Frame:
        """The present state."""
        return Frame(self.step, self.time, self.positions, self.angles, self.velocities, self.spins)

    def frames(self, every: int, steps: int | None = None) -> Iterator[Frame]:
        """The present state, then one after each `every` steps, and the last.

        Parameters
        ----------
        every : int
        steps : int, optional
            In all; left out: what is left of the duration of the case.
        """
        return self._frames(self._parts(every, steps))

    def _frames(self, parts: Iterable[int]) -> Iterator[Frame]:
        yield self.frame
        for _ in parts:
            yield self.frame

    def _parts(self, every: int, steps: int | None) -> Iterator[int]:
        """Make the steps, and stop after each `every` of them."""
        between = whole("every", every, 1)
        left = max(0, self.steps - self.step) if steps is None else whole("steps", steps, 0)
        return self._stops(self.step + left, between)

    def _stops(self, end: int, between: int) -> Iterator[int]:
        before = -1
        while before < self.step < end:
            before = self.step
            self.advance(min(between, end - before))
            if self.step > before:
                yield self.step

    def plot(self, ax: Axes | None = None, *, frame: Frame | None = None, **options: Any) -> Axes:
        """Draw the discs at present, or at a frame, with matplotlib.

        Parameters
        ----------
        ax : matplotlib axes, optional
        options
            Passed on to `equidem.plot.bodies`: ``values``, ``label``, ``cmap``.
        """
        from . import plot

        places = self.positions if frame is None else frame.positions
        if self._assembly is None or len(self._assembly) != len(places):
            raise BadInput("bodies of several discs are not drawn", "a simulation has only their centres of mass",
                           "Draw the frames that the verb run writes")
        return plot.bodies(places, self._assembly.radii, ax, **options)

    def run(self, callback: Callable[[Simulation], object] | None = None, every: int = 100,
            steps: int | None = None) -> Simulation:
        """Make all steps. The callback is called after each `every` of them; where it returns False the run ends."""
        for _ in self._parts(every, steps):
            if callback is not None and callback(self) is False:
                break
        return self
