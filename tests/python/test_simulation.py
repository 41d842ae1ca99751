# SPDX-License-Identifier: GPL-3.0-or-later
"""Simulations are stepped, watched and drawn from Python."""

import re

import numpy as np
import pytest

import equidem as eq
from scenes import CASES, hexagonal


def pulse(group="left", **run):
    return eq.simulation(hexagonal(20, 5), (1e9, 0.5e9), density=2500.0, run={"duration": 2e-4, **run},
                         velocity=[{"group": group, "velocity": (0.1, 0.0)}])


def test_any_division_of_the_steps_gives_the_same_bits():
    at_once, in_parts = pulse(), pulse()
    at_once.advance(90)
    for steps in (1, 2, 30, 57):
        in_parts.advance(steps)
    assert np.array_equal(at_once.displacements, in_parts.displacements)
    assert np.array_equal(at_once.velocities, in_parts.velocities)


@pytest.mark.parametrize(("key", "value", "words"), [("viscoelastic.normal", "maxwell", "maxwell"),
                                                     ("effects.prestress", "on", "prestress")])
def test_a_simulation_refuses_what_a_run_refuses(key, value, words):
    case = eq.Case(CASES / "run_pulse.toml").set(key, value)
    if key.startswith("viscoelastic"):
        case.set("viscoelastic.tauN", 0.1)
    with pytest.raises(eq.BadInput, match=words):
        case.simulation()


def test_frames_follow_the_motion():
    simulation = pulse()
    frames = list(simulation.frames(every=10))
    assert [frame.step for frame in frames][:3] == [0, 10, 20] and frames[-1].step == simulation.steps
    assert np.array_equal(frames[0].positions, simulation.assembly.centres)
    assert np.array_equal(frames[-1].positions, simulation.positions)
    assert frames[1].positions[:, 0].max() >= frames[0].positions[:, 0].max()


def test_energy_is_kept_without_damping():
    simulation = pulse().run()
    energy = simulation.energy
    print(dict(energy))
    assert abs(energy["error"]) <= 1e-12 * energy["initial"]
    assert 0.05 * energy["initial"] < energy["elastic"] < 0.95 * energy["initial"]


def test_momentum_of_bodies_that_collide_is_kept():
    simulation = eq.Case(CASES / "grains_cradle.toml").simulation()
    before = simulation.velocities[:, 0].sum()
    simulation.run()
    assert abs(simulation.velocities[:, 0].sum() - before) <= 1e-9 * abs(before)
    with pytest.raises(eq.BadInput, match="no displacements"):
        simulation.displacements


def test_velocities_are_given_to_discs_by_number():
    named, numbered = (pulse(group, duration=1e-5).run() for group in ("left", hexagonal(20, 5).groups["left"]))
    assert np.array_equal(named.velocities, numbered.velocities)


def test_a_simulation_is_drawn_where_its_discs_are():
    pytest.importorskip("matplotlib")
    simulation = pulse()
    first = simulation.frame
    simulation.advance(50)
    axes = simulation.plot(values=simulation.velocities[:, 0], label="velocity, m/s")
    assert np.allclose(axes.collections[0].get_offsets(), simulation.positions)
    drawn = simulation.plot(frame=first).collections[0]
    assert np.allclose(drawn.get_offsets(), first.positions)


def test_a_callback_sees_the_run_and_ends_it():
    seen = []

    def watch(simulation):
        seen.append(simulation.time)
        return len(seen) < 3

    simulation = pulse().run(watch, every=10)
    assert simulation.step == 30 and seen == pytest.approx([10 * k * simulation.time_step for k in (1, 2, 3)])


def test_forces_of_contacts_are_those_of_their_springs():
    simulation = pulse()
    simulation.advance(50)
    block, contacts = simulation.assembly, simulation.contacts
    i, j = block.contacts.T
    stretch = np.sum((simulation.displacements[j] - simulation.displacements[i]) * block.normals, axis=1)
    bonds = contacts["normal_forces"][:len(stretch)]
    assert abs(bonds - 1e9 * stretch).max() <= 1e-9 * abs(bonds).max()


def test_a_run_that_fails_raises_its_sentence():
    with pytest.raises(eq.EquidemError, match="time_step|step"):
        eq.run(hexagonal(5, 5), (1e9, 0.5e9), density=2500.0, run={"duration": 1e-2, "time_step": 1e-3},
               velocity=[{"group": "left", "velocity": (0.1, 0.0)}])


@pytest.mark.parametrize("steps", [-1, 1.5, "2", None, 10**30])
def test_steps_are_whole_numbers(steps):
    simulation = pulse()
    with pytest.raises(eq.BadInput, match="steps = .*whole number, (0 or more|from 0 to 9223372036854775807)"):
        simulation.advance(steps)
    if steps is not None:
        with pytest.raises(eq.BadInput, match="whole number"):
            simulation.run(steps=steps)
    assert simulation.step == 0


@pytest.mark.parametrize("every", [0, -1, 2.5])
def test_at_least_one_step_lies_between_two_calls(every):
    for call in (pulse().run, pulse().frames):
        with pytest.raises(eq.BadInput, match="every = .*whole number, 1 or more"):
            call(every=every)


def test_a_case_that_goes_to_rest_is_no_simulation():
    with pytest.raises(eq.BadInput, match="goes to rest"):
        eq.Case(CASES / "run_tension.toml").simulation()


def two_stages():
    """Two discs, of which the second stage removes one."""
    discs = [{"position": [k, 1.0], "radius": 0.1, "density": 1000.0, "group": group}
             for k, group in enumerate(("stays", "goes"))]
    return eq.simulation(grain=discs, collisions={"restitution": 0.5, "stiffness": 1e5}, run={"time_step": 1e-4},
                         stage=[{"name": "both", "duration": 1e-3},
                                {"name": "one", "duration": 1e-3, "remove": [{"group": "goes"}]}])


def test_steps_go_on_through_stages():
    at_once, in_parts = two_stages(), two_stages()
    at_once.advance(15)
    in_parts.run(every=4, steps=15)
    assert at_once.step == in_parts.step == 15
    assert np.array_equal(at_once.positions, in_parts.positions, equal_nan=True)
    assert [frame.step for frame in two_stages().frames(every=8)] == [0, 8, 16, 20]
    assert at_once.run().step == at_once.steps == 20


def test_a_run_ends_with_its_last_stage():
    discs = [{"position": [0.0, 1.0], "radius": 0.1, "density": 1000.0}]
    simulation = eq.simulation(grain=discs, collisions={"restitution": 0.5, "stiffness": 1e5}, run={"time_step": 1e-4},
                               wall=[{"name": "lid", "point": [0.0, 3.0], "normal": [0.0, -1.0]}],
                               stage=[{"name": "moves", "duration": 1.0,
                                       "wall": [{"name": "lid", "velocity": [0.0, -0.1]}],
                                       "until": {"wall": "lid", "displacement": 1e-2}}])
    called = []
    simulation.run(called.append, every=1000)
    assert 0 < simulation.step < simulation.steps and len(called) <= 1 + simulation.step // 1000
    simulation.advance(5)
    assert simulation.step < simulation.steps


def test_bodies_that_a_stage_removed_are_not_drawn():
    pytest.importorskip("matplotlib")
    simulation = two_stages().run()
    assert np.isnan(simulation.positions).any(axis=1).tolist() == [False, True]
    axes = simulation.plot(values=np.array([1.0, 2.0]))
    assert np.allclose(axes.collections[0].get_offsets(), simulation.positions[:1])
    assert axes.collections[0].get_array().tolist() == [1.0]


def box(overlap=0.01, **more):
    """A column of discs between a floor and a lid."""
    discs = [{"position": [0.1, 0.1 + (0.2 - overlap) * k], "radius": 0.1, "density": 1000.0} for k in range(4)]
    walls = [{"name": "floor", "point": [0, 0], "normal": [0, 1]},
             {"name": "lid", "point": [0, 0.8 - 3 * overlap], "normal": [0, -1], **more}]
    return eq.simulation(grain=discs, wall=walls, collisions={"restitution": 0.2, "stiffness": 1e6},
                         run={"duration": 8.0, "integrator": "velocity_verlet"})


def test_a_wall_goes_as_fast_as_it_is_steered():
    """From the place at which it stands, whatever it did before; its work is in the ledger, whose error is that of the steps alone."""
    simulation, still = box(), box()
    simulation.advance(100), still.advance(700)
    at, time = 0.77, simulation.time
    for velocity in (-0.05, 0.0, 0.02):
        assert simulation.walls["lid"]["position"] == pytest.approx((0, at), abs=1e-12)
        simulation.steer("lid", velocity=(0, velocity))
        simulation.advance(200)
        at, time = at + velocity * (simulation.time - time), simulation.time
        assert simulation.walls["lid"]["velocity"] == pytest.approx((0, velocity), abs=1e-9)
    energy = simulation.energy
    assert energy["work_of_walls"] > 0
    assert abs(energy["error"] - still.energy["error"]) < 1e-6 * energy["work_of_walls"]
    assert energy["work_of_walls"] == pytest.approx(sum(wall["work"] for wall in simulation.walls.values()))


def test_a_servo_keeps_what_it_is_steered_to():
    simulation = box(overlap=0.0, servo={"force": 100.0})
    for wanted in (100.0, 300.0, 50.0):
        if wanted != 100.0:
            simulation.steer("lid", wanted=wanted)
        simulation.advance(6000)
        assert simulation.walls["lid"]["force"][1] == pytest.approx(wanted, rel=0.02)


def test_a_cell_deforms_as_it_is_steered():
    cell = {"periodic": "xy", "width": 0.6, "height": 0.6}
    discs = [{"position": [0.1 + 0.2 * i, 0.1 + 0.2 * j], "radius": 0.101, "density": 1000.0}
             for i in range(3) for j in range(3)]
    simulation = eq.simulation(grain=discs, cell=cell, collisions={"restitution": 0.2, "stiffness": 1e6},
                               run={"duration": 1.0, "integrator": "velocity_verlet"})
    simulation.advance(50)
    assert simulation.cell["strain"] == (0, 0, 0) and simulation.cell["stress"][0] < 0
    simulation.steer_cell(yy=-0.1, xy=0.5)
    start = simulation.time
    simulation.advance(100)
    passed = simulation.time - start
    assert simulation.cell["strain"] == pytest.approx((0, -0.1 * passed, 0.5 * passed), rel=1e-9, abs=1e-15)
    assert simulation.cell["height"] == pytest.approx(0.6 * np.exp(-0.1 * passed), rel=1e-6)


@pytest.mark.parametrize("steer, words", [
    (lambda s: s.steer("led", velocity=(0, 1)), "'led'"), (lambda s: s.steer("lid", wanted=1.0), "no servo"),
    (lambda s: s.steer("lid"), "one of velocity and wanted"), (lambda s: s.steer_cell(xy=1.0), "no periodic cell"),
    (lambda s: s.steer_cell(xz=1.0), "no 'xz'"), (lambda s: s.steer_cell(), "nothing is steered"),
    (lambda s: s.steer("lid", velocity=(0, float("nan"))), "not finite|not a number|finite")])
def test_a_motion_that_is_none_changes_nothing(steer, words):
    simulation, other = box(), box()
    with pytest.raises(eq.BadInput, match=words):
        steer(simulation)
    simulation.advance(50), other.advance(50)
    assert np.array_equal(simulation.positions, other.positions)
    assert simulation.cell is None


def test_bonded_discs_are_not_steered():
    with pytest.raises(eq.BadInput, match="schedules"):
        eq.Case(CASES / "run_pulse.toml").simulation().steer("lid", velocity=(0, 1))


def test_a_stage_is_finished_and_its_motions_end_with_it():
    simulation = two_stages()
    simulation.finish_stage()
    assert simulation.step == 10
    simulation.finish_stage()
    assert simulation.step == simulation.steps == 20


def test_friction_loosens_the_sand_that_is_consolidated():
    """Between the void ratios of friction 0 and 1; what lies outside of them is refused with both."""
    case = eq.Case(CASES / "grains_biaxial.toml")
    with pytest.raises(eq.BadInput, match="out of reach") as refused:
        eq.consolidate(case, void_ratio=0.6)
    densest, loosest = map(float, re.findall(r"to (0\.\d+)", str(refused.value)))
    assert densest < loosest
    wanted = (densest + loosest) / 2
    found = eq.consolidate(case, porosity=wanted / (1 + wanted), tolerance=0.1 * (loosest - densest))
    assert 0 < found.friction < 1 and abs(found.void_ratio - wanted) <= 0.1 * (loosest - densest)
    simulation = found.case.simulation()
    simulation.finish_stage()
    width, height = (abs(simulation.walls[a]["position"][k] - simulation.walls[b]["position"][k])
                     for k, a, b in ((0, "left", "right"), (1, "bottom", "top")))
    solid = np.pi * (simulation.assembly.radii ** 2).sum()
    assert width * height / solid - 1 == pytest.approx(found.void_ratio, rel=1e-12)
    assert found.porosity == pytest.approx(found.void_ratio / (1 + found.void_ratio))
