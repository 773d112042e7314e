"""Models and data that carry the plugin, in other processes: no one crashes."""

import copy
import multiprocessing
import pickle
import subprocess
import sys

import mujoco
import numpy as np
import pytest

import cradle_models
import mujoco_impact
from mujoco_impact.errors import PluginError
from mujoco_impact.pickling import restore
from mujoco_impact.pulses import plugin_number

PLAIN = (
    "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
)


def mid_impact():
    """A row of three in the middle of a pulse."""
    spec = mujoco_impact.attach(cradle_models.row("AAA"), duration=7.5e-3)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, nstep=141)
    assert data.plugin_state[1] == 2, "two pulses have begun"
    assert np.abs(data.sensordata[0]) > 0, "and are under way"
    return model, data


def advance(pair):
    """Runs in workers, too: steps on, and returns where that ends."""
    model, data = pair
    mujoco.mj_step(model, data, nstep=100)
    return np.concatenate([[data.time], data.qpos, data.qvel, data.plugin_state])


# what a process does that knows no more than MuJoCo
STRANGER = """
import pickle, sys
import mujoco
model, data = pickle.load(open(sys.argv[1], "rb"))
mujoco.mj_step(model, data, nstep=100)
print(data.qpos.tolist())
"""


def test_a_process_that_imported_only_mujoco_can_use_a_pickle(tmp_path):
    """MuJoCo's own pickle of such a model is a segmentation fault there."""
    pair = mid_impact()
    path = tmp_path / "pair.pickle"
    path.write_bytes(pickle.dumps(pair))
    found = subprocess.run(
        [sys.executable, "-c", STRANGER, str(path)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stderr
    advance(pair)
    assert found.stdout.strip() == str(pair[1].qpos.tolist())


def test_without_the_package_the_error_says_what_to_import(tmp_path):
    path = tmp_path / "pair.pickle"
    path.write_bytes(pickle.dumps(mid_impact()))
    hidden = "import sys; sys.modules['mujoco_impact'] = None\n"
    found = subprocess.run(
        [sys.executable, "-c", hidden + STRANGER, str(path)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 1, "an exception, not a crash"
    assert "mujoco_impact" in found.stderr.strip().splitlines()[-1]


@pytest.mark.parametrize("method", ["spawn", "forkserver", "fork"])
# Python 3.12 warns of every fork of a process with threads; numpy has some
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_workers_step_on_bit_for_bit(method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system cannot {method}")
    pairs = [mid_impact() for _ in range(2)]
    with multiprocessing.get_context(method).Pool(2) as pool:
        found = pool.map(advance, pairs)
    for pair, there in zip(pairs, found, strict=True):
        np.testing.assert_array_equal(there, advance(pair))


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_every_protocol_continues_bit_for_bit(protocol):
    pair = mid_impact()
    twin = pickle.loads(pickle.dumps(pair, protocol))
    np.testing.assert_array_equal(advance(twin), advance(pair))


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy])
def test_copies_of_models_and_data_continue_bit_for_bit(duplicate):
    model, data = mid_impact()
    twin = duplicate(model), duplicate(data)
    np.testing.assert_array_equal(advance(twin), advance((model, data)))


def test_models_without_the_plugin_are_pickled_as_ever():
    model = mujoco.MjModel.from_xml_string(PLAIN)
    for thing in (model, mujoco.MjData(model)):
        dumped = pickle.dumps(thing)
        assert b"mujoco_impact" not in dumped
        assert type(pickle.loads(dumped)) is type(thing)


@pytest.mark.parametrize(
    ("number", "version", "said"),
    [
        (plugin_number() + 1, mujoco.mj_versionString(), "in the same order"),
        (plugin_number(), "1.2.3", "pickled with MuJoCo 1.2.3, which"),
    ],
)
def test_a_pickle_of_another_world_is_refused_with_a_reason(number, version, said):
    state = mid_impact()[0].__getstate__()
    with pytest.raises(PluginError, match=said):
        restore(mujoco.MjModel, state, number, version)


def test_a_dm_control_physics_can_be_pickled_and_copied():
    pytest.importorskip("dm_control")
    from mujoco_impact import envs

    env = envs.load("cradle", "strike", task_kwargs={"random": 0})
    env.reset()
    for _ in range(30):
        env.step([1.0])
    for duplicate in (copy.deepcopy, lambda e: pickle.loads(pickle.dumps(e))):
        twin = duplicate(env)
        # dm_control's own copies go back to legacy steps, which show in mid-impact
        assert not twin.physics.legacy_step
        for _ in range(30):
            one, other = env.step([-1.0]), twin.step([-1.0])
        for name, value in one.observation.items():
            np.testing.assert_array_equal(value, other.observation[name])


@pytest.mark.parametrize("legacy", [False, True])
def test_a_copied_dm_control_physics_steps_as_the_original_does(legacy):
    pytest.importorskip("dm_control")
    from mujoco_impact import envs

    env = envs.load("cradle", "strike", environment_kwargs={"legacy_step": legacy})
    physics = env.physics
    for twin in (
        physics.copy(),
        copy.deepcopy(physics),
        physics.copy(share_model=True),
    ):
        assert twin.legacy_step is legacy
