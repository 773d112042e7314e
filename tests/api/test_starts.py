"""What a run starts from: the same rule in Python and on the command line."""

from __future__ import annotations

import pkgutil

import mujoco
import numpy as np
import pytest

import mujoco_impact
from mujoco_impact import attach, run
from mujoco_impact.errors import SceneError


def test_a_shipped_model_is_known_by_name_and_starts_from_release() -> None:
    """To `attach` and to `run`, as to the commands."""
    motion = run(attach("row_3"), duration=0.3)
    assert motion.start == "keyframe 'release'"
    assert motion.qpos[0, 0] == pytest.approx(-np.pi / 6)
    assert len(motion.impacts) == 2


def test_the_only_keyframe_is_the_start_unless_a_state_is_given(
    two_balls: str,
) -> None:
    """ "none" is the model's initial state."""
    motion = run(attach(two_balls), duration=0.02)
    assert motion.start == "keyframe 'shot'"
    assert motion.qvel[0].tolist() == [1.0, 0.0]
    still = run(attach(two_balls), duration=0.02, keyframe="none")
    assert still.start == "the initial state"
    assert not still.qvel.any()
    given = run(attach(two_balls), duration=0.02, qpos=[-0.1, 0.0])
    assert given.start == "a given state"
    assert not given.qvel[0].any()


def test_one_of_several_keyframes_is_asked_for(two_balls: str) -> None:
    """Two without the name "release" leave the initial state."""
    two = two_balls.replace('<key name="shot"', '<key name="slow" qvel=".1 0"/><key name="shot"')  # fmt: skip # noqa: E501
    assert run(two, duration=0.01).start == "the initial state"
    with pytest.raises(SceneError, match=r"'shoot'; did you mean 'shot'\?.*slow, shot"):
        run(two, duration=0.01, keyframe="shoot")


def test_numpy_scalars_are_numbers(two_balls: str) -> None:
    """As they come out of arrays and sweeps."""
    spec = attach(
        two_balls,
        speed=np.float32(2.0),
        restitution=np.float32(0.5),
        young=np.int64(10**9),
    )
    model = spec.compile()
    motion = run(
        model, duration=np.float32(0.02), keyframe=np.int64(0), every=np.int64(2)
    )
    assert len(motion.time) == 6
    assert attach(two_balls, gap=np.float64(0.01), depth=np.float32(1e-6))


def test_a_run_without_the_plugin_says_so(two_balls: str) -> None:
    """Not as a warning: MuJoCo's contacts may be meant."""
    motion = run(two_balls, duration=0.02)
    assert [remark.kind for remark in motion.remarks] == ["native"]
    assert "MuJoCo's own contacts" in repr(motion)
    ours = run(attach(two_balls), duration=0.02)
    assert repr(ours) == (
        "<Trajectory: 0.02 s, 11 samples, 2 degrees of freedom, 1 impacts>"
    )


def test_the_public_names_are_there() -> None:
    """Those that are imported when they are used, too."""
    assert set(mujoco_impact.__all__) <= set(dir(mujoco_impact))
    for name in mujoco_impact.__all__:
        assert getattr(mujoco_impact, name) is not None
    modules = {one.name for one in pkgutil.iter_modules(mujoco_impact.__path__)}
    functions = {"attach", "compare", "calibrate", "rollout", "run", "detach"}
    # a module of that name would hide the function once it is imported
    assert not modules & functions
    assert mujoco_impact.__version__.count(".") == 2
    assert mujoco_impact.detach(attach("row_3")).compile().nplugin == 0


def test_what_failed_keeps_the_motion_until_then() -> None:
    """And so does what was interrupted."""
    stiff = """<mujoco><option timestep=".01" gravity="0 0 0"/>
      <worldbody><body><joint name="x" type="slide" stiffness="1e9"/>
      <geom size=".1"/></body></worldbody></mujoco>"""
    with pytest.raises(mujoco_impact.ImpactError) as caught:
        run(stiff, duration=1.0, qpos=[0.1])
    kept = caught.value.trajectory  # type: ignore[attr-defined]
    assert kept.time[-1] == pytest.approx(caught.value.time)  # type: ignore[attr-defined]
    assert np.isfinite(kept.qpos).all()

    def stop(_: mujoco.MjModel, data: mujoco.MjData) -> None:
        if data.time > 0.0095:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        run(attach("row_3"), duration=1.0, controller=stop)
    kept = stopped.value.trajectory  # type: ignore[attr-defined]
    whole = run(attach("row_3"), duration=0.01)
    for name in ("time", "qpos", "qvel", "energy"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(whole, name))
