"""The scenes of contact load by themselves, rest until released, name their parts."""

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pytest

import cradle_models as cm

SCENES = {
    **{
        name: cm.make_model(name)
        for name in (
            "billiards",
            "spinning_balls",
            "dominoes",
            "rocking_block",
            "cannon",
            "bernoulli_2",
            "bernoulli_4",
        )
    },
    "billiards, cue ball alone": cm.billiards(0, length=1.98, offset=0.1),
    "one spin": cm.spinning_balls([50.0], friction=0.0),
    "short stones": cm.dominoes(3, height=0.06, pitch=0.02, push=2.0),
    "stout block": cm.rocking_block(half_width=0.1, half_height=0.1),
    "two balls": cm.cannon(cm.CANNON[:2], gap=0.002),
    "five at once": cm.bernoulli(5, ball=cm.B, friction=0.1),
}


@pytest.fixture(params=list(SCENES))
def model(request: pytest.FixtureRequest) -> mujoco.MjModel:
    """Compiles a scene; any MuJoCo warning is an error."""
    warnings: list[str] = []
    mujoco.set_mju_user_warning(warnings.append)
    try:
        found = mujoco.MjModel.from_xml_string(SCENES[request.param])
    finally:
        mujoco.set_mju_user_warning(None)
    assert warnings == []
    return found


def test_it_lies_still_until_it_is_released(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 100)
    # what rests on a floor of MuJoCo sinks in by its weight, up to half a millimetre
    assert np.abs(data.qpos - model.qpos0).max() < 6e-4
    mujoco.mj_resetDataKeyframe(model, data, model.key("release").id)
    mujoco.mj_step(model, data, 150)
    assert np.abs(data.qpos - model.key("release").qpos).max() > 0.01
    assert not data.warning.number.any()


def test_nothing_overlaps_at_the_start(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    for key in (None, model.key("release").id):
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        # positions are sums of a few decimals of at most a metre
        assert all(contact.dist > -1e-12 for contact in data.contact)


def test_every_element_has_a_name(model: mujoco.MjModel) -> None:
    for kind, count in (
        (mujoco.mjtObj.mjOBJ_BODY, model.nbody),
        (mujoco.mjtObj.mjOBJ_JOINT, model.njnt),
        (mujoco.mjtObj.mjOBJ_GEOM, model.ngeom),
        (mujoco.mjtObj.mjOBJ_MATERIAL, model.nmat),
    ):
        assert all(mujoco.mj_id2name(model, kind, i) for i in range(count))
    assert model.ncam == model.nlight == model.nkey == 1


def test_the_camera_sees_all_that_moves_at_the_release(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    seen = (data.xipos[1:] - data.cam_xpos[0]) @ data.cam_xmat[0].reshape(3, 3)
    edge = -seen[:, 2] * np.tan(np.radians(model.cam_fovy[0]) / 2)
    assert (edge > 0).all()
    assert (np.abs(seen[:, 0]) < 4 / 3 * edge).all()
    assert (np.abs(seen[:, 1]) < edge).all()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: cm.billiards(6), ("rows", "6", "5")),
        (lambda: cm.billiards(length=0.5), ("length", "0.5")),
        (lambda: cm.billiards(width=0.1), ("width", "0.1")),
        (lambda: cm.billiards(nose=1.0), ("nose", "1.0", "0.5")),
        (lambda: cm.billiards(cloth=-0.1), ("cloth", "-0.1", ">= 0")),
        (lambda: cm.billiards(offset=2.0), ("offset", "2.0")),
        (lambda: cm.spinning_balls([]), ("spins", "at least 1")),
        (lambda: cm.spinning_balls(height=0.0), ("height", "0.0", "> 0")),
        (lambda: cm.dominoes(pitch=0.1), ("pitch", "0.1", "0.048")),
        (lambda: cm.dominoes(mass=0.0), ("mass", "0.0", "> 0")),
        (lambda: cm.rocking_block(tilt=1.0), ("tilt", "1.0", "0.99")),
        (lambda: cm.rocking_block(density=-1.0), ("density", "-1.0")),
        (lambda: cm.cannon([]), ("balls", "at least 1")),
        (lambda: cm.cannon(gap=float("nan")), ("gap", "nan")),
        (lambda: cm.bernoulli(6), ("count", "6", "5")),
        (lambda: cm.bernoulli(speed=0.0), ("speed", "0.0")),
    ],
)
def test_a_bad_parameter_is_named_with_its_value_and_what_is_allowed(
    make: Callable[[], Any], words: tuple[str, ...]
) -> None:
    with pytest.raises(cm.ModelValueError) as caught:
        make()
    for word in words:
        assert word in str(caught.value)
