"""The impact laws of the plugin, callable from Python.

These are the functions of the plugin library itself (its C interface, by ctypes), so
that tests, calibration and users run the very code that a simulation runs. The
formulas stand in the headers of `plugin/law/`.

An island of n contacts is described in contact space: the Delassus matrix
W = J M⁻¹ Jᵀ [1/kg], shape (n, n), closing speeds c = -J v [m/s] (positive:
approaching), gaps [m], and impulses P ≥ 0 [N s], shape (n,).
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from mujoco_impact._plugin import load, plugin_path
from mujoco_impact.errors import LawError

Array = npt.NDArray[np.float64]

_DISSIPATION = {"bistiffness": 0, "viscous": 1}
_DOUBLES: Any = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
_INTS: Any = np.ctypeslib.ndpointer(np.int32, flags="C_CONTIGUOUS")

_SCALAR_FUNCTIONS = {
    "effective_modulus": 2,
    "hertz_stiffness": 2,
    "contact_time": 3,
    "maximum_compression": 3,
    "viscous_damping": 1,
    "waveform_force": 2,
    "waveform_cumulative": 2,
    "waveform_moment": 2,
    "waveform_height": 2,
    "calibrated_duration": 4,
    "calibrated_impulse": 5,
}


@dataclass(frozen=True)
class ImpactSolution:
    """What an impact does to the contacts of an island.

    Attributes:
        impulse: P [N s], shape (n,), ≥ 0.
        moment: ∫ t F dt about the start of the impact [N s²], shape (n,).
        onset: First time with force [s], shape (n,).
        closing_speed: c after the impact [m/s], shape (n,).
        steps: Integration steps taken; 1 for a closed form.
    """

    impulse: Array
    moment: Array
    onset: Array
    closing_speed: Array
    steps: int


def solve_impact(
    delassus: npt.ArrayLike,
    closing_speed: npt.ArrayLike,
    stiffness: npt.ArrayLike,
    *,
    gap: npt.ArrayLike = 0.0,
    restitution: npt.ArrayLike = 1.0,
    dissipation: Literal["bistiffness", "viscous"] = "bistiffness",
    horizon: float = np.inf,
    tolerance: float = 1e-6,
    passive: bool = True,
) -> ImpactSolution:
    """Solves the impact of an island by the law `hertz`.

    Args:
        delassus: W [1/kg], shape (n, n), symmetric; zeros are left out.
        closing_speed: c [m/s], shape (n,), positive where the contact closes.
        stiffness: Hertz stiffness K [N/m^1.5], shape (n,) or one for all.
        gap: Gap still open [m] ≥ 0, shape (n,) or one for all.
        restitution: e in [0, 1], shape (n,) or one for all; at least 0.05 for
            `viscous`.
        dissipation: How energy is lost, see `plugin/law/`.
        horizon: A contact that would close later than this [s], all others open,
            is left alone.
        tolerance: Error allowed per step, relative.
        passive: Whether the guard against gaining energy is on.

    Raises:
        LawError: If an argument is out of range or the impact does not end.
    """
    W = np.ascontiguousarray(delassus, dtype=np.float64)
    c = np.ascontiguousarray(closing_speed, dtype=np.float64)
    n = len(c)
    K = np.ascontiguousarray(np.broadcast_to(stiffness, n), dtype=np.float64)
    y = np.ascontiguousarray(np.broadcast_to(gap, n), dtype=np.float64)
    _check_island(W, c, K, y)
    e = np.ascontiguousarray(np.broadcast_to(restitution, n), dtype=np.float64)
    _check_loss(e, dissipation, tolerance)
    row_start, column, value = _compressed_rows(W)
    P, M, t, after = (np.zeros(n) for _ in range(4))
    steps = _library().mujoco_impact_solve(
        n, row_start, column, value, c, y, K, e, _DISSIPATION[dissipation],
        horizon, tolerance, int(passive), P, M, t, after,
    )  # fmt: skip
    if steps < 0:
        msg = f"the impact of {n} contacts did not end within {-steps} steps"
        raise LawError(msg)
    return ImpactSolution(P, M, t, after, steps)


@dataclass(frozen=True)
class FrictionSolution:
    """What an impact with friction does to the contacts of an island.

    The last axis is (n, t1, t2): along the normal and the two tangents.

    Attributes:
        impulse: P [N s], shape (n, 3); P_n ≥ 0, |P_t| ≤ μ P_n.
        moment: ∫ t F dt about the start of the impact [N s²], shape (n, 3).
        onset: First time with force [s], shape (n,).
        velocity: Relative velocity after the impact [m/s], shape (n, 3).
        steps: Integration steps taken; 1 for a closed form.
    """

    impulse: Array
    moment: Array
    onset: Array
    velocity: Array
    steps: int


def solve_impact_with_friction(
    delassus: npt.ArrayLike,
    velocity: npt.ArrayLike,
    stiffness: npt.ArrayLike,
    mu: npt.ArrayLike,
    *,
    gap: npt.ArrayLike = 0.0,
    restitution: npt.ArrayLike = 1.0,
    dissipation: Literal["bistiffness", "viscous"] = "bistiffness",
    horizon: float = np.inf,
    tolerance: float = 1e-6,
    passive: bool = True,
) -> FrictionSolution:
    """Solves the impact of an island by the law `hertz` with Coulomb friction.

    The rows of contact k are 3 k (normal n), 3 k + 1 and 3 k + 2 (two tangents t1
    and t2, perpendicular to n and to each other): u = J v is the velocity of one side
    relative to the other, positive along n where they part, and impulses P change it
    to u + W P.

    Args:
        delassus: W = J M⁻¹ Jᵀ of all rows [1/kg], shape (3 n, 3 n), symmetric.
        velocity: u before the impact [m/s], shape (n, 3); u_n < 0 closes.
        stiffness: Hertz stiffness K [N/m^1.5], shape (n,) or one for all.
        mu: Coefficient of friction [-] ≥ 0, shape (n,) or one for all.
        gap: Gap still open [m] ≥ 0, shape (n,) or one for all.
        restitution: e in [0, 1], shape (n,) or one for all; at least 0.05 for
            `viscous`. It is energetic: a sticking contact whose tangents couple
            with its normal parts faster than with e |u_n|.
        dissipation: How energy is lost along the normal, see `plugin/law/`.
        horizon: A contact that would close later than this [s], all others open,
            is left alone.
        tolerance: Error allowed per step, relative.
        passive: Whether the guard against gaining energy is on.

    Raises:
        LawError: If an argument is out of range or the impact does not end.
    """
    W = np.ascontiguousarray(delassus, dtype=np.float64)
    u = np.ascontiguousarray(velocity, dtype=np.float64)
    n = len(u)
    if u.shape != (n, 3):
        raise LawError(f"velocity has shape {u.shape}, allowed: (n, 3)")
    if W.shape != (3 * n, 3 * n):
        raise LawError(f"delassus has shape {W.shape}, allowed: ({3 * n}, {3 * n})")
    if not np.all(np.isfinite(W)) or not np.allclose(W, W.T, rtol=1e-9, atol=0):
        raise LawError(f"delassus = {W}: must be finite and symmetric")
    if not np.all(np.isfinite(u)):
        raise LawError(f"velocity = {u}: every number must be finite")
    K, y, friction = (
        np.ascontiguousarray(np.broadcast_to(values, n), dtype=np.float64)
        for values in (stiffness, gap, mu)
    )
    c, slip = np.ascontiguousarray(-u[:, 0]), np.ascontiguousarray(u[:, 1:])
    _check_island(W[::3, ::3], c, K, y)
    e = np.ascontiguousarray(np.broadcast_to(restitution, n), dtype=np.float64)
    _check_loss(e, dissipation, tolerance)
    if not np.all(np.isfinite(friction) & (friction >= 0)):
        raise LawError(f"mu = {friction}: allowed: finite numbers >= 0")
    # (n, n, 3, 3): the couplings of two contacts
    blocks = W.reshape(n, 3, n, 3).swapaxes(1, 2)
    rows, columns = np.nonzero(np.any(blocks != 0, axis=(2, 3)))
    start = np.searchsorted(rows, np.arange(n + 1)).astype(np.int32)
    entries = blocks[rows, columns]
    tangents = np.concatenate([entries[:, 0, 1:], entries[:, 1:, 0]], axis=1)
    block = np.concatenate([tangents, entries[:, 1:, 1:].reshape(-1, 4)], axis=1)
    P, M, t, after = (np.zeros(n) for _ in range(4))
    Q, N, slip_after = (np.zeros((n, 2)) for _ in range(3))
    steps = _library().mujoco_impact_solve_with_friction(
        n, start, columns.astype(np.int32), np.ascontiguousarray(entries[:, 0, 0]),
        np.ascontiguousarray(block), c, slip, y, K, friction, e,
        _DISSIPATION[dissipation], horizon, tolerance, int(passive), P, M, t, after,
        Q, N, slip_after,
    )  # fmt: skip
    if steps < 0:
        msg = f"the impact of {n} contacts did not end within {-steps} steps"
        raise LawError(msg)
    return FrictionSolution(
        np.column_stack([P, Q]),
        np.column_stack([M, N]),
        t,
        np.column_stack([-after, slip_after]),
        steps,
    )


def passive_scale(
    delassus: npt.ArrayLike, closing_speed: npt.ArrayLike, impulse: npt.ArrayLike
) -> float:
    """Returns min(1, s*): the factor at which impulses P do not add energy.

    Args:
        delassus: W [1/kg], shape (n, n).
        closing_speed: c before the impact [m/s], shape (n,).
        impulse: P [N s], shape (n,).
    """
    W = np.ascontiguousarray(delassus, dtype=np.float64)
    c = np.ascontiguousarray(closing_speed, dtype=np.float64)
    P = np.ascontiguousarray(impulse, dtype=np.float64)
    rows = _compressed_rows(W)
    return float(_library().mujoco_impact_passive_scale(len(c), *rows, c, P))


def effective_modulus(young: float, poisson: float) -> float:
    """Returns E* [Pa] of two bodies of one material, E [Pa] and ν given."""
    return _scalar("effective_modulus", young, poisson)


def hertz_stiffness(modulus: float, curvature: float) -> float:
    """Returns K = 4/3 E* √R* [N/m^1.5]; curvature is 1/R₁ + 1/R₂ [1/m]."""
    return _scalar("hertz_stiffness", modulus, curvature)


def contact_time(stiffness: float, reduced_mass: float, speed: float) -> float:
    """Returns the duration [s] of the elastic contact of a pair."""
    return _scalar("contact_time", stiffness, reduced_mass, speed)


def maximum_compression(stiffness: float, reduced_mass: float, speed: float) -> float:
    """Returns the largest compression [m] of a pair."""
    return _scalar("maximum_compression", stiffness, reduced_mass, speed)


def viscous_damping(restitution: float) -> float:
    """Returns the damping x [-] at which a pair restitutes e (Hunt-Crossley)."""
    return _scalar("viscous_damping", restitution)


def waveform_force(t: float, restitution: float) -> float:
    """Returns the force at t of the pulse of unit area and duration, t in its units."""
    return _scalar("waveform_force", t, restitution)


def waveform_cumulative(t: float, restitution: float) -> float:
    """Returns the part of a pulse delivered by t, in units of its duration."""
    return _scalar("waveform_cumulative", t, restitution)


def waveform_moment(t: float, restitution: float) -> float:
    """Returns the first moment by t of the pulse of unit area and duration."""
    return _scalar("waveform_moment", t, restitution)


def waveform_height(impulse: float, duration: float) -> float:
    """Returns the peak H = π P / (2 W) [N] of a pulse."""
    return _scalar("waveform_height", impulse, duration)


def calibrated_duration(
    momentum: float, *, sw: float, w0: float = 7.5e-3, kappa: float = 0.083
) -> float:
    """Returns W [s] of equation (6) at the momentum p [kg m/s]."""
    return _scalar("calibrated_duration", sw, w0, kappa, momentum)


def calibrated_impulse(
    momentum: float, *, sh: float, sw: float, w0: float = 7.5e-3, kappa: float = 0.083
) -> float:
    """Returns P = (2/π) H W [N s] of equation (6), before its scaling by α."""
    return _scalar("calibrated_impulse", sh, sw, w0, kappa, momentum)


def friction_impulse(
    impulse: npt.ArrayLike,
    *,
    mu_s: npt.ArrayLike,
    mu_d: npt.ArrayLike,
    normal_momentum: npt.ArrayLike,
    slip_momentum: npt.ArrayLike,
) -> Array:
    """Returns the tangential impulse Q [N s] of equations (7)-(9), against the slip.

    Args:
        impulse: Normal impulse P of each contact [N s], >= 0; any shape.
        mu_s: Static factor, broadcast with `impulse`, as all that follow.
        mu_d: Dynamic factor.
        normal_momentum: m u_z before the impact [kg m/s], >= 0.
        slip_momentum: m |u_t| before the impact [kg m/s], >= 0.
    """
    P, *given = np.broadcast_arrays(impulse, mu_s, mu_d, normal_momentum, slip_momentum)
    arrays = [np.ascontiguousarray(values, dtype=np.float64) for values in (*given, P)]
    Q = np.zeros(P.shape)
    _library().mujoco_impact_friction_impulse(Q.size, *arrays, Q)
    return Q


@cache
def _library() -> ctypes.CDLL:
    # the library is linked to MuJoCo, so MuJoCo and the plugin come first
    load()
    library = ctypes.CDLL(str(plugin_path()))
    for name, arguments in _SCALAR_FUNCTIONS.items():
        function = getattr(library, f"mujoco_impact_{name}")
        function.restype = ctypes.c_double
        function.argtypes = [ctypes.c_double] * arguments
    number, integer = ctypes.c_double, ctypes.c_int
    rows = [integer, _INTS, _INTS, _DOUBLES]
    library.mujoco_impact_friction_impulse.restype = None
    library.mujoco_impact_friction_impulse.argtypes = [integer, *[_DOUBLES] * 6]
    library.mujoco_impact_passive_scale.restype = number
    library.mujoco_impact_passive_scale.argtypes = [*rows, _DOUBLES, _DOUBLES]
    library.mujoco_impact_solve.restype = integer
    library.mujoco_impact_solve.argtypes = [
        *rows, *[_DOUBLES] * 4, integer, number, number, integer,
        _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES,
    ]  # fmt: skip
    library.mujoco_impact_solve_with_friction.restype = integer
    library.mujoco_impact_solve_with_friction.argtypes = [
        *rows, *[_DOUBLES] * 7, integer, number, number, integer,
        *[_DOUBLES] * 7,
    ]  # fmt: skip
    return library


def _scalar(name: str, *arguments: float) -> float:
    return float(getattr(_library(), f"mujoco_impact_{name}")(*arguments))


def _compressed_rows(
    W: Array,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32], Array]:
    """Returns row starts, columns and values of the non-zeros of W."""
    rows, columns = np.nonzero(W)
    start = np.searchsorted(rows, np.arange(len(W) + 1))
    return start.astype(np.int32), columns.astype(np.int32), W[rows, columns]


def _check_island(W: Array, c: Array, K: Array, gap: Array) -> None:
    n = len(c)
    if W.shape != (n, n):
        raise LawError(f"delassus has shape {W.shape}, allowed: ({n}, {n})")
    for name, values in {"delassus": W, "closing_speed": c, "gap": gap}.items():
        if not np.all(np.isfinite(values)):
            raise LawError(f"{name} = {values}: every number must be finite")
    if not np.allclose(W, W.T, rtol=1e-9, atol=0) or not np.all(np.diag(W) > 0):
        msg = f"delassus = {W}: must be symmetric with a positive diagonal"
        raise LawError(msg)
    if not np.all(np.isfinite(K) & (K > 0)):
        raise LawError(f"stiffness = {K}: allowed: finite numbers > 0 [N/m^1.5]")
    if not np.all(gap >= 0):
        raise LawError(f"gap = {gap}: allowed: numbers >= 0 [m]")


def _check_loss(restitution: Array, dissipation: str, tolerance: float) -> None:
    if dissipation not in _DISSIPATION:
        msg = f"dissipation = {dissipation!r}; allowed: {sorted(_DISSIPATION)}"
        raise LawError(msg)
    low = 0.05 if dissipation == "viscous" else 0.0
    if not np.all((low <= restitution) & (restitution <= 1)):
        values = np.unique(restitution)
        shown = values[0] if len(values) == 1 else restitution
        raise LawError(f"restitution = {shown}; allowed: [{low}, 1]")
    if not 1e-12 <= tolerance <= 1e-2:
        raise LawError(f"tolerance = {tolerance}; allowed: [1e-12, 1e-2]")
