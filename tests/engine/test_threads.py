"""The same bits on every thread, every run and every machine."""

import hashlib
import json
import platform
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mujoco import rollout
from scenes import header, pendulums

STEPS = 1500  # 3 s at 2 ms
GOLDEN = Path(__file__).with_name("golden.json")
FULL = mujoco.mjtState.mjSTATE_FULLPHYSICS


def swing(model, steps=STEPS, angle=0.0):
    """The states after each step, stepped one by one."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[0] += angle
    start = state_of(model, data)
    states = []
    for _ in range(steps):
        mujoco.mj_step(model, data)
        states.append(state_of(model, data))
    return start, np.array(states), data


def state_of(model, data):
    state = np.empty(mujoco.mj_stateSize(model, FULL))
    mujoco.mj_getState(model, data, state, FULL)
    return state


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("duration", ["hertz", 7.5e-3])
def test_rollout_on_any_number_of_threads_is_stepping_one_by_one(threads, duration):
    model, _ = pendulums("AAA", duration=duration)
    # five cradles let go at different angles, so that threads meet different impacts
    runs = [swing(model, steps=400, angle=0.02 * i) for i in range(5)]
    workers = [mujoco.MjData(model) for _ in range(threads)]
    states, _ = rollout.rollout(
        model, workers, np.array([start for start, _, _ in runs]), nstep=400
    )
    for one, (_, expected, data) in zip(states, runs, strict=True):
        np.testing.assert_array_equal(one, expected)
        assert header(model, data).count >= 2


def fingerprint(model, data) -> str:
    """Hash of time, positions, velocities and the whole state of the plugin."""
    return hashlib.sha256(state_of(model, data).tobytes()).hexdigest()


def test_two_runs_are_one():
    model, _ = pendulums("AAAAA")
    (_, _, one), (_, _, other) = swing(model), swing(model)
    assert header(model, one).count > 20
    assert fingerprint(model, one) == fingerprint(model, other)


def environment() -> str:
    """What the last bits depend on: MuJoCo, the processor and the C library."""
    libc = " ".join(platform.libc_ver())
    return f"MuJoCo {mujoco.mj_versionString()}, {platform.machine()}, {libc}"


def test_three_seconds_of_five_balls_have_not_changed():
    """A golden number: a change of results must be meant, and told in CHANGELOG.md.

    `python tests/engine/test_threads.py` writes it anew.
    """
    golden = json.loads(GOLDEN.read_text(encoding="utf-8"))
    model, _ = pendulums("AAAAA")
    _, _, data = swing(model)
    # positions hold everywhere: the row makes less of rounding than a factor of 1e4
    assert header(model, data).count == golden["impacts"]
    np.testing.assert_allclose(data.qpos, golden["qpos"], rtol=0, atol=1e-10)
    if golden["environment"] != environment():
        pytest.skip(f"the hash is of {golden['environment']}; this is {environment()}")
    assert fingerprint(model, data) == golden["sha256"]


if __name__ == "__main__":
    model, _ = pendulums("AAAAA")
    _, _, data = swing(model)
    golden = {
        "environment": environment(),
        "impacts": header(model, data).count,
        "sha256": fingerprint(model, data),
        "qpos": data.qpos.tolist(),
    }
    GOLDEN.write_text(json.dumps(golden, indent=2) + "\n", encoding="utf-8")
