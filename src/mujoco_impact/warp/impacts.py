"""What the impacts of many worlds need on a device, and what went wrong in them."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
import warp as wp

from mujoco_impact.errors import SceneError, SimulationError
from mujoco_impact.pulses import plugin_instances
from mujoco_impact.warp import memory, resolve
from mujoco_impact.warp.scene import Scene, fingerprint, read_scene

LAW_STEPS = 20_000
"""Steps of the law that the impacts of one step of a world may take."""

IMPACTS = 100
"""Impacts that one step of a world may have, one after another."""

_EARTH = 9.81


class Impacts:
    """Tables of a scene, memory of its worlds, and what went wrong in them.

    Nothing in it outlasts a step but counts and flags: states may be set, reset and
    copied as with MuJoCo Warp alone.

    Attributes:
        nworld: Number of worlds.
        contacts: Contacts that one impact of a world may have.
        fingerprint: Of the model, see `mujoco_impact.warp.scene.fingerprint`.
        bytes_per_world: Memory on the device for each world [B].
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        scene: Scene,
        nworld: int,
        contacts: int,
        law_steps: int,
    ) -> None:
        """Puts the tables on the current device of Warp; see `put_impacts`."""
        device = wp.get_device()
        self.nworld = nworld
        self.contacts = contacts
        self.law_steps = law_steps
        self.fingerprint = fingerprint(model)
        self.bodies = memory.put_bodies(model, scene, device)
        self.pairs = memory.put_pairs(scene, device)
        self.paths = memory.make(memory.Paths, len(scene.bodies), nworld, device)
        self.rows = memory.make(memory.Contacts, contacts, nworld, device)
        self.world = memory.make_world(
            len(scene.pairs), int(model.nq), int(model.nv), nworld, device
        )
        of_worlds = memory.size_in_bytes(
            Paths=self.paths, Contacts=self.rows, World=self.world
        )
        self.bytes_per_world = of_worlds / nworld
        self.weightless = int(_is_disabled(model, mujoco.mjtDisableBit.mjDSBL_GRAVITY))
        self.pressing_gravity = _pressing_gravity(model)
        self.implicit = int(_damps_implicitly(model))
        self.sensor = wp.array(_sensor_places(model), dtype=int, device=device)
        self.flags = wp.zeros(1, dtype=int, device=device)
        # a copy that the host reads without waiting for the device
        self.seen = wp.zeros(1, dtype=int, device="cpu", pinned=device.is_cuda)

    @property
    def impact_count(self) -> npt.NDArray[np.int32]:
        """Impacts of each world so far, shape (nworld,); waits for the device."""
        return np.asarray(self.world.impacts.numpy())

    @property
    def law_step_count(self) -> npt.NDArray[np.int32]:
        """Steps of the law of each world so far, shape (nworld,); waits likewise."""
        return np.asarray(self.world.law_steps.numpy())

    def check(self) -> None:
        """Waits for the device and raises what went wrong in any world until now.

        `step` raises it by itself, some steps late on a GPU. After replays of a CUDA
        graph, in which no Python runs, call this.

        Raises:
            SimulationError: If an impact had more contacts than there is room for, did
                not end within its budget, or gave no finite numbers.
        """
        if int(self.flags.numpy()[0]) == 0:
            return
        flag = self.world.flag.numpy()
        said = [
            f"{reason} in {_worlds(flag & bit)}"
            for bit, reason in self._reasons().items()
            if (flag & bit).any()
        ]
        raise SimulationError("; ".join(said), time=float("nan"))

    def reset(self) -> None:
        """Forgets what went wrong, and the counts."""
        for array in (
            self.world.flag,
            self.world.impacts,
            self.world.law_steps,
            self.flags,
            self.seen,
        ):
            array.zero_()

    def check_seen(self) -> None:
        """Raises what the host has seen of it already, without waiting."""
        if int(self.seen.numpy()[0]) != 0:
            self.check()

    def _reasons(self) -> dict[int, str]:
        """Returns what each bit of a flag says."""
        return {
            int(resolve.OVERFLOW): (
                f"an impact had more than {self.contacts} contacts "
                "(put_impacts(contacts=...))"
            ),
            int(resolve.UNFINISHED): (
                f"the impacts of a step took more than {self.law_steps} steps of the "
                f"law, or were more than {IMPACTS} (put_impacts(law_steps=...))"
            ),
            int(resolve.INVALID): "an impulse is not a finite number",
        }


def put_impacts(
    model: mujoco.MjModel,
    *,
    nworld: int = 1,
    contacts: int | None = None,
    law_steps: int = LAW_STEPS,
) -> Impacts:
    """Returns what `step` needs for the impacts of a model.

    Restitution, stiffness and tolerance are those that the model gives its plugin. They
    are read here, as are masses and sizes: after a change of them put impacts anew.

    Args:
        model: A compiled model of `mujoco_impact.attach`.
        nworld: Number of worlds, as of `mujoco_warp.put_data`.
        contacts: Contacts that one impact of a world may have. Default: those of all
            pairs, but no more than twice the bodies.
        law_steps: Steps of the law that the impacts of one step of a world may take.

    Raises:
        SceneError: If something is not supported (docs/gpu.md), or a number is not
            valid.
    """
    scene = read_scene(model)
    if contacts is None:
        contacts = min(len(scene.pairs), 2 * len(scene.bodies))
    for name, value in (
        ("nworld", nworld),
        ("contacts", contacts),
        ("law_steps", law_steps),
    ):
        if not isinstance(value, int) or value < 1:
            raise SceneError(f"{name} = {value!r}: must be a whole number >= 1")
    return Impacts(model, scene, nworld, contacts, law_steps)


def _is_disabled(model: mujoco.MjModel, bit: Any) -> bool:
    """Returns whether a flag of the model is disabled."""
    return bool(model.opt.disableflags & bit)


def _pressing_gravity(model: mujoco.MjModel) -> float:
    """Returns the gravity of rest in worlds without gravity: 0 if nothing presses."""
    presses = model.nu > 0 or model.ntendon > 0 or bool(np.any(model.jnt_stiffness))
    return _EARTH if presses else 0.0


def _damps_implicitly(model: mujoco.MjModel) -> bool:
    """Returns whether the integrator divides by M + h B, B the damping."""
    if _is_disabled(model, mujoco.mjtDisableBit.mjDSBL_DAMPER):
        return False
    euler = model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER
    return not (euler and _is_disabled(model, mujoco.mjtDisableBit.mjDSBL_EULERDAMP))


def _sensor_places(model: mujoco.MjModel) -> list[int]:
    """Returns the numbers of sensordata that are of our sensors."""
    ours = plugin_instances(model)
    return [
        int(model.sensor_adr[number]) + i
        for number in range(model.nsensor)
        if model.sensor_plugin[number] in ours
        for i in range(int(model.sensor_dim[number]))
    ]


def _worlds(flag: npt.NDArray[np.int32]) -> str:
    """Returns which worlds have a flag."""
    worlds = np.flatnonzero(flag)
    shown = ", ".join(str(world) for world in worlds[:5])
    more = f" and {len(worlds) - 5} more" if len(worlds) > 5 else ""
    return f"world {shown}{more}"
