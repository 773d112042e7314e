"""Every cradle compiles and runs in stock MuJoCo and shows what it says."""

import mujoco
import numpy as np
import pytest

import cradle_models as cm

CRADLES = [
    name
    for name in cm.list_models()
    if name.startswith(("row", "paper", "two", "force"))
]

SCENES = {
    **{name: cm.make_model(name) for name in CRADLES},
    "row of one": cm.row("A"),
    "mixed row with gaps": cm.row(
        "ABBA", gap=(1e-4, 0.0, 2e-5), released=2, release=60, length=0.5
    ),
    "steep release": cm.row("AA", release=150),
    "mixed strings": cm.two_string("ABA", released=2),
    "lattice": cm.lattice(3, 4),
    "lattice corner": cm.lattice(3, 3, released="corner", release=60),
    "free balls": cm.free_balls(7),
}


Scene = tuple[mujoco.MjModel, mujoco.MjData]


def compiled(xml: str) -> Scene:
    """Compiles a model; any MuJoCo warning is an error."""
    warnings: list[str] = []
    mujoco.set_mju_user_warning(warnings.append)
    try:
        model = mujoco.MjModel.from_xml_string(xml)
    finally:
        mujoco.set_mju_user_warning(None)
    assert warnings == []
    return model, mujoco.MjData(model)


@pytest.fixture(params=list(SCENES))
def scene(request: pytest.FixtureRequest) -> Scene:
    return compiled(SCENES[request.param])


def test_it_runs_without_warning_from_rest_and_from_release(scene: Scene) -> None:
    model, data = scene
    for key in (None, model.key("release").id):
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, data, key)
        for _ in range(round(0.2 / model.opt.timestep)):
            mujoco.mj_step(model, data)
        assert np.isfinite(data.qpos).all()
        assert not data.warning.number.any()
    assert np.abs(data.qpos - model.key("release").qpos).max() > 1e-3


def test_every_element_has_a_name(scene: Scene) -> None:
    model, _ = scene
    for kind, count in (
        (mujoco.mjtObj.mjOBJ_BODY, model.nbody),
        (mujoco.mjtObj.mjOBJ_JOINT, model.njnt),
        (mujoco.mjtObj.mjOBJ_GEOM, model.ngeom),
        (mujoco.mjtObj.mjOBJ_SITE, model.nsite),
        (mujoco.mjtObj.mjOBJ_TENDON, model.ntendon),
        (mujoco.mjtObj.mjOBJ_CAMERA, model.ncam),
        (mujoco.mjtObj.mjOBJ_LIGHT, model.nlight),
    ):
        assert all(mujoco.mj_id2name(model, kind, i) for i in range(count))
    assert model.ncam == model.nlight == 1


def test_the_balls_are_the_only_moving_geoms_and_have_no_friction_or_damping(
    scene: Scene,
) -> None:
    model, _ = scene
    moving = model.geom_bodyid > 0
    assert (model.geom_type[moving] == mujoco.mjtGeom.mjGEOM_SPHERE).all()
    assert moving.sum() == model.nbody - 1
    fixed = [model.geom(i).name for i in np.flatnonzero(~moving)]
    assert fixed in ([], ["plate"])
    assert (model.geom_condim == 1).all()
    assert not model.dof_damping.any()
    assert not model.dof_frictionloss.any()
    assert not model.dof_armature.any()


def test_contacts_are_at_the_defaults_of_mujoco(scene: Scene) -> None:
    model, _ = scene
    plain, _ = compiled(
        "<mujoco><worldbody><body><geom size='.1'/></body></worldbody></mujoco>"
    )
    for field in ("solref", "solimp", "margin", "gap", "solmix", "priority"):
        values = getattr(model, f"geom_{field}")
        np.testing.assert_array_equal(values - getattr(plain, f"geom_{field}"), 0)


def test_the_camera_sees_all_balls_during_the_whole_swing(scene: Scene) -> None:
    model, data = scene
    tangent = np.tan(np.radians(model.cam_fovy[0]) / 2)
    released = model.key("release").qpos
    # The balls swing as far to the right as they were lifted to the left.
    for state in (model.qpos0, released, 2 * model.qpos0 - released):
        if model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE and state is not released:
            state = model.qpos0
        data.qpos[:] = state
        mujoco.mj_forward(model, data)
        seen = (data.geom_xpos - data.cam_xpos[0]) @ data.cam_xmat[0].reshape(3, 3)
        depth = -seen[:, 2]
        radius = model.geom_size[:, 0]
        assert (depth > radius).all()
        assert (np.abs(seen[:, 0]) + radius < 4 / 3 * tangent * depth).all()
        assert (np.abs(seen[:, 1]) + radius < tangent * depth).all()
