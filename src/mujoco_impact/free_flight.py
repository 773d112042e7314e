"""Bodies whose free flight gains energy under MuJoCo's Euler integrator.

Euler takes the gyroscopic torque t = I w x w at the start of a step, at a right angle
to w: each step adds h^2/2 t . I^-1 t to the energy, more the faster the body turns.
Under the implicit integrators a body loses about as much; RK4 keeps its energy.
"""

from __future__ import annotations

import mujoco
import numpy as np

UNEQUAL = 1e-3
"""Relative difference of principal inertias from which on a body tumbles."""

NAMED = 3
"""Bodies that a message names."""


def tumbling_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Returns the bodies that turn freely and have unequal principal inertias.

    A body that carries others which move against it counts, too.
    """
    names = []
    for joint in range(model.njnt):
        if model.jnt_type[joint] not in _FREE:
            continue
        body = int(model.jnt_bodyid[joint])
        inertia = model.body_inertia[body]
        unequal = np.ptp(inertia) > UNEQUAL * float(inertia.max())
        # bodies that are welded on share no principal axes in general
        carries = np.any(model.body_parentid[body + 1 :] == body)
        if unequal or carries:
            names.append(model.body(body).name or f"body {body}")
    return tuple(names)


def flight_cause(model: mujoco.MjModel) -> str:
    """Returns why free flight gains energy, and the cure; "" if it does not."""
    if model.opt.integrator != mujoco.mjtIntegrator.mjINT_EULER:
        return ""
    names = tumbling_bodies(model)
    if not names:
        return ""
    shown = ", ".join(map(repr, names[:NAMED])) + (
        ", ..." if len(names) > NAMED else ""
    )
    return (
        f"MuJoCo's Euler integrator adds energy to the free rotation of {shown}; cure: "
        'integrator="RK4" (keeps it) or "implicitfast" (loses as much), or a smaller '
        "timestep"
    )


_FREE = (int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL))
