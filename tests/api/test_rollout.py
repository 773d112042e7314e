"""`rollout`: the same bits as single steps, on any number of threads."""

import dataclasses
import multiprocessing
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import mujoco
import numpy as np
import pytest

import cradle_models
import mujoco_impact
from mujoco_impact.errors import ImpactWarning, SceneError, SimulationError
from mujoco_impact.rollouts import STATE, initial_states

STEPS = 250


@pytest.fixture(scope="module")
def model():
    spec = mujoco_impact.attach(cradle_models.row("AAA"), restitution=0.9)
    motor = spec.add_actuator(name="motor", target="hinge_1")
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    return spec.compile()


def starts(count):
    """Cradles let go at different angles, so that threads meet different impacts."""
    qpos = np.zeros((count, 3))
    qpos[:, 0] = -np.linspace(0.1, 0.6, count)
    return qpos


def stepped(model, qpos, control):
    """One simulation by single steps: samples of position and sensors, last state."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    positions, sensors = [], []
    for values in control:
        data.ctrl[:] = values
        mujoco.mj_step(model, data)
        positions.append(data.qpos.copy())
        sensors.append(data.sensordata.copy())
    state = np.empty(mujoco.mj_stateSize(model, STATE))
    mujoco.mj_getState(model, data, state, STATE)
    return np.array(positions), np.array(sensors), state


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_it_is_stepping_one_by_one_bit_for_bit(model, threads, monkeypatch):
    # parts of two simulations each, so that threads and parts are crossed
    monkeypatch.setattr("mujoco_impact.rollout_parts.CHUNK_BYTES", 1.0)
    qpos = starts(7)
    control = np.random.default_rng(0).uniform(-0.05, 0.05, (7, STEPS, 1))
    found = mujoco_impact.rollout(
        model,
        duration=STEPS * 0.002,
        qpos=qpos,
        control=control,
        every=5,
        threads=threads,
    )
    assert found.qpos.shape == (7, 50, 3)
    for index in range(7):
        positions, sensors, state = stepped(model, qpos[index], control[index])
        np.testing.assert_array_equal(found.qpos[index], positions[4::5])
        np.testing.assert_array_equal(found.sensordata[index], sensors[4::5])
        np.testing.assert_array_equal(found.final_state[index], state)
        assert sensors[-1, 6] >= 1, "ball 1 has had an impact"


@pytest.mark.parametrize("threads", [1, 2])
def test_mujoco_batch_is_stepping_one_by_one_bit_for_bit(model, threads):
    """MuJoCo 4 has `mujoco.batch`, which keeps one MjData for each thread."""
    batch = pytest.importorskip("mujoco.batch")
    qpos = starts(5)
    simulations = batch.Batch(model, nsim=5, nthread=threads)
    simulations.qpos = qpos
    for _ in range(STEPS):
        simulations.step()
    for index in range(5):
        positions, _, state = stepped(model, qpos[index], np.zeros((STEPS, 1)))
        np.testing.assert_array_equal(simulations.qpos[index], positions[-1])
        numbers = simulations.plugin_state[index]
        np.testing.assert_array_equal(numbers, state[-len(numbers) :])


def test_it_goes_on_from_where_it_ended(model):
    """An impact may be under way: its state is part of the state."""
    whole = mujoco_impact.rollout(model, duration=0.5, qpos=starts(3))
    half = mujoco_impact.rollout(model, duration=0.282, qpos=starts(3))
    rest = mujoco_impact.rollout(model, duration=0.218, initial_state=half.final_state)
    np.testing.assert_array_equal(rest.final_state, whole.final_state)
    np.testing.assert_array_equal(rest.time, whole.time[-len(rest.time) :])


def test_it_is_run_for_one_simulation(model):
    motion = mujoco_impact.run(model, duration=0.6, keyframe="release")
    # the rule of `run`: a keyframe of that name is the start
    found = mujoco_impact.rollout(model, duration=0.6)
    np.testing.assert_array_equal(found.qpos[0], motion.qpos[1:])
    np.testing.assert_array_equal(found.qvel[0], motion.qvel[1:])
    np.testing.assert_array_equal(found.time, motion.time[1:])


def test_progress_rises_to_one(model, monkeypatch):
    monkeypatch.setattr("mujoco_impact.rollout_parts.CHUNK_BYTES", 1.0)
    told = []
    mujoco_impact.rollout(
        model, duration=0.01, qpos=starts(5), threads=2, progress=told.append
    )
    assert told == [0.4, 0.8, 1.0]


def test_an_executor_gives_the_same_bits(model):
    """Also in other processes: the model with its plugin is sent there."""
    qpos = starts(5)
    here = mujoco_impact.rollout(model, duration=0.5, qpos=qpos, every=10)
    told = []
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=context) as processes:
        there = mujoco_impact.rollout(
            model,
            duration=0.5,
            qpos=qpos,
            every=10,
            executor=processes,
            progress=told.append,
        )
        for field in dataclasses.fields(here):
            one, other = (getattr(found, field.name) for found in (here, there))
            np.testing.assert_array_equal(one, other)
        assert told == [0.2, 0.4, 0.6, 0.8, 1.0]
        # and the error of a simulation that breaks down there comes back
        qvel = np.zeros((4, 3))
        qvel[2, 1] = np.nan
        with pytest.raises(
            SimulationError, match=r"simulation 2 by 0\.002 s"
        ) as caught:
            mujoco_impact.rollout(model, duration=0.1, qvel=qvel, executor=processes)
        assert caught.value.time == 0.002
        with pytest.raises(ValueError, match="threads = 2: give one of them"):
            mujoco_impact.rollout(model, duration=0.1, threads=2, executor=processes)


def test_an_executor_of_threads_gives_the_same_bits(model):
    """Its parts run at once, in one process: they share nothing."""
    here = mujoco_impact.rollout(model, duration=0.1, qpos=starts(64), threads=1)
    with ThreadPoolExecutor(4) as threads:
        there = mujoco_impact.rollout(
            model, duration=0.1, qpos=starts(64), executor=threads
        )
    np.testing.assert_array_equal(there.final_state, here.final_state)
    np.testing.assert_array_equal(there.sensordata, here.sensordata)


def test_one_velocity_serves_all_positions(model):
    states = initial_states(model, qpos=starts(4), qvel=[1.0, 2.0, 3.0])
    np.testing.assert_array_equal(states[:, 1:4], starts(4))
    np.testing.assert_array_equal(states[:, 4:7], [[1.0, 2.0, 3.0]] * 4)


def test_a_simulation_that_breaks_down_is_named(model):
    qvel = np.zeros((4, 3))
    qvel[2, 1] = np.nan
    with pytest.raises(SimulationError, match=r"simulation 2 by 0\.002 s") as caught:
        mujoco_impact.rollout(model, duration=0.1, qvel=qvel, threads=2)
    assert caught.value.time == 0.002


@pytest.mark.parametrize(
    ("options", "error", "said"),
    [
        ({"qpos": [[0.0] * 4]}, SceneError, r"qpos has shape \(1, 4\), allowed: \(3,"),
        (
            {"qpos": np.zeros((2, 3)), "qvel": np.zeros((3, 3))},
            SceneError,
            "qpos has 2",
        ),
        ({"initial_state": np.zeros((1, 4))}, SceneError, "initial_state has shape"),
        ({"initial_state": [0.0], "qpos": [0.0]}, SceneError, "give no qpos"),
        ({"control": np.zeros((3, 1))}, SceneError, r"control has shape \(3, 1\)"),
        ({"keyframe": "start"}, SceneError, "no keyframe 'start'"),
        ({"every": 0}, ValueError, "every = 0: must be 1 to 50"),
        ({"threads": 0}, ValueError, "threads = 0: must be >= 1"),
    ],
)
def test_bad_arguments_are_refused_with_a_reason(model, options, error, said):
    with pytest.raises(error, match=said):
        mujoco_impact.rollout(model, duration=0.1, **options)


def test_a_body_too_fast_for_its_gap_is_warned_of_once(two_balls):
    """One of the simulations is: it is looked at, whatever its place."""
    far = two_balls.replace("-.02 0 0", "-.25 0 0")
    model = mujoco_impact.attach(far).compile()
    qvel = np.tile([1.0, 0.0], (40, 1))
    qvel[17, 0] = 100.0
    with pytest.warns(ImpactWarning, match="'left' closes in on 'right' at 100 m/s"):
        mujoco_impact.rollout(model, duration=0.02, qvel=qvel, threads=1)
    seeing = mujoco_impact.attach(far, speed=100.0).compile()
    mujoco_impact.rollout(seeing, duration=0.02, qvel=qvel, threads=1)
