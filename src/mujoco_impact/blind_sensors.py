"""MuJoCo's sensors that do not see the forces of the plugin.

They read the forces of MuJoCo's solver, or rebuild them from accelerations less the
external forces that MuJoCo knows of; ours is a passive force and neither. Measured, on
a ball that strikes a plate: `touch` and `contact` read 0, `tactile` the overlap, a
tenth of what MuJoCo's contact needs; `force` and `torque` read the impulse over the
timestep in the joint of the body that was struck, though it did not pass there, and are
right for what hangs on that body. Accelerometers are right, as averages over the step,
but on a single free body that is no ball: its velocity is set when the step ends.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import mujoco
import numpy as np

from mujoco_impact.errors import ImpactWarning
from mujoco_impact.verdict.encounters import Flags, Numbers, meetings

SENSOR = mujoco.mjtSensor

BLIND = {
    int(SENSOR.mjSENS_TOUCH): "touch",
    int(SENSOR.mjSENS_CONTACT): "contact",
    int(SENSOR.mjSENS_TACTILE): "tactile",
    int(SENSOR.mjSENS_FORCE): "force",
    int(SENSOR.mjSENS_TORQUE): "torque",
    int(SENSOR.mjSENS_ACCELEROMETER): "accelerometer",
}
"""Kinds of sensors that impacts of the plugin mislead."""

NAMED = 6
"""Sensors that a message names."""


def warn_of_blind_sensors(model: mujoco.MjModel, owned: Sequence[str]) -> None:
    """Warns once of all sensors that do not see the impacts of the owned geoms."""
    found = blind_sensors(model, owned)
    if not found:
        return
    shown = ", ".join(found[:NAMED]) + (", ..." if len(found) > NAMED else "")
    verb = "reads" if len(found) == 1 else "read"
    warnings.warn(
        "MuJoCo's sensors do not see the impacts of the plugin: in an impact "
        f"{shown} {verb} 0, or a spike that is not the force there; read the plugin's "
        "own sensor: from mujoco_impact.sensor import read_sensor, sensor_slice; "
        "read_sensor(data.sensordata[sensor_slice(model)])",
        ImpactWarning,
        stacklevel=3,
    )


def blind_sensors(model: mujoco.MjModel, owned: Sequence[str]) -> list[str]:
    """Returns the sensors that the impacts of owned geoms mislead, with their kinds.

    Args:
        model: The model.
        owned: Names of the owned geoms.
    """
    geoms = np.array([model.geom(name).id for name in owned], dtype=np.intp)
    mates = meetings(model, geoms)
    struck: Flags = np.any(mates, axis=0, keepdims=False)
    struck[geoms[mates.any(axis=1)]] = True
    bodies: Flags = np.zeros(model.nbody, dtype=bool)
    bodies[model.geom_bodyid[struck]] = True
    found = []
    for sensor in range(model.nsensor):
        kind = BLIND.get(int(model.sensor_type[sensor]))
        if kind is not None and _is_misled(model, sensor, struck, bodies):
            name = model.sensor(sensor).name or f"sensor {sensor}"
            found.append(f"{name!r} ({kind})")
    return found


def _is_misled(
    model: mujoco.MjModel, sensor: int, struck: Flags, bodies: Flags
) -> bool:
    """Returns whether a sensor looks at geoms that are struck, or at their bodies."""
    kind = int(model.sensor_type[sensor])
    place = int(model.sensor_objid[sensor])
    if kind == SENSOR.mjSENS_TOUCH:
        return bool(bodies[model.site_bodyid[place]])
    if kind == SENSOR.mjSENS_ACCELEROMETER:
        body = int(model.site_bodyid[place])
        return bool(bodies[body]) and _tumbles(model, body)
    if kind in (SENSOR.mjSENS_FORCE, SENSOR.mjSENS_TORQUE):
        # what a body passes on to its parent is all that its subtree is struck by
        return bool(bodies[_subtree(model, int(model.site_bodyid[place]))].any())
    ends = [(int(model.sensor_reftype[sensor]), int(model.sensor_refid[sensor]))]
    if kind == SENSOR.mjSENS_CONTACT:
        ends.append((int(model.sensor_objtype[sensor]), place))
    return all(_holds(model, what, number, struck, bodies) for what, number in ends)


def _tumbles(model: mujoco.MjModel, body: int) -> bool:
    """Returns whether a body is a free one by itself, and no ball."""
    tree = int(model.body_treeid[body])
    if tree < 0 or model.tree_dofnum[tree] != 6:
        return False
    joint = int(model.dof_jntid[model.tree_dofadr[tree]])
    inertia = model.body_inertia[body]
    ball = np.ptp(inertia) <= 1e-9 * inertia.max() and not model.body_ipos[body].any()
    return model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE and not ball


def _holds(
    model: mujoco.MjModel, what: int, number: int, struck: Flags, bodies: Flags
) -> bool:
    """Returns whether an object of a sensor holds a geom that is struck."""
    if what == mujoco.mjtObj.mjOBJ_GEOM:
        return bool(struck[number])
    if what == mujoco.mjtObj.mjOBJ_BODY:
        return bool(bodies[number])
    if what == mujoco.mjtObj.mjOBJ_XBODY:
        return bool(bodies[_subtree(model, number)].any())
    # a site selects by place, and nothing selects everything
    return bool(struck.any())


def _subtree(model: mujoco.MjModel, root: int) -> Numbers:
    """Returns the ids of a body and of all that it carries."""
    inside = np.zeros(model.nbody, dtype=bool)
    inside[root] = True
    for body in range(root + 1, model.nbody):
        inside[body] = inside[model.body_parentid[body]]
    return np.flatnonzero(inside)
