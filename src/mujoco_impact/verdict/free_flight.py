"""Bodies whose free flight gains energy under MuJoCo's Euler integrator.

Euler takes the gyroscopic torque t = I w x w at the start of a step, at a right angle
to w: each step adds h^2/2 t . I^-1 t to the energy, more the faster the body turns.
Under the implicit integrators a body loses about as much; RK4 keeps its energy.
"""

from __future__ import annotations

import mujoco
import numpy as np

from mujoco_impact.trajectory import Array

UNEQUAL = 1e-3
"""Relative difference of principal inertias from which on a body tumbles."""

NAMED = 3
"""Bodies that a message names."""


class FreeRotation:
    """The bodies of a model that tumble, and what Euler adds to their energy.

    Attributes:
        names: Bodies that turn freely and have unequal principal inertias, and those
            that carry others which move against them.
        known: Whether the gain of all of them is: of a body that carries others or has
            its centre elsewhere than its joint, it is not.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        """Looks at the joints of a model."""
        self._timestep = float(model.opt.timestep)
        # angular velocities, principal inertias, and their axes in the body's frame
        self._dofs: list[slice] = []
        self._inertias: list[Array] = []
        self._axes: list[Array] = []
        self.known = True
        names = []
        for joint in np.flatnonzero(np.isin(model.jnt_type, _FREE)):
            body = int(model.jnt_bodyid[joint])
            inertia = model.body_inertia[body]
            carries = bool(np.any(model.body_parentid[body + 1 :] == body))
            if not carries and np.ptp(inertia) <= UNEQUAL * float(inertia.max()):
                continue
            names.append(model.body(body).name or f"body {body}")
            if carries or model.body_ipos[body].any():
                self.known = False
                continue
            last = int(model.jnt_dofadr[joint]) + _DOFS[int(model.jnt_type[joint])]
            axes = np.zeros(9)
            mujoco.mju_quat2Mat(axes, model.body_iquat[body])
            self._dofs.append(slice(last - 3, last))
            self._inertias.append(inertia.copy())
            self._axes.append(axes.reshape(3, 3))
        self.names = tuple(names)

    def gain(self, qvel: Array) -> Array:
        """Returns what Euler adds in a step from each state [J], shape (steps,).

        Args:
            qvel: Velocities, shape (steps, nv).
        """
        total = np.zeros(len(qvel))
        for dofs, inertia, axes in zip(
            self._dofs, self._inertias, self._axes, strict=True
        ):
            spin = qvel[:, dofs] @ axes
            torque = np.cross(inertia * spin, spin)
            # h^2/2 t . I^-1 t
            total += self._timestep**2 / 2 * (torque**2 / inertia).sum(axis=1)
        return total

    def cause(self) -> str:
        """Returns why energy grew in free flight, and the cure."""
        shown = ", ".join(map(repr, self.names[:NAMED]))
        more = ", ..." if len(self.names) > NAMED else ""
        return (
            f"MuJoCo's Euler integrator adds energy to the free rotation of {shown}"
            f'{more}; cure: integrator="RK4" (keeps it) or "implicitfast" (loses as '
            "much), or a smaller timestep"
        )


_DOFS = {
    int(mujoco.mjtJoint.mjJNT_FREE): 6,
    int(mujoco.mjtJoint.mjJNT_BALL): 3,
}
_FREE = tuple(_DOFS)
