"""Keller's solution of one contact with friction in a plane, piece by piece.

J. B. Keller, Impact with friction, J. Appl. Mech. 53 (1986). Coulomb friction, and a
restitution that is energetic: of the work of the normal force, e^2 comes back.
"""

import numpy as np

STOPPED = 1e-14  # slip that is none [m/s]


def impulses(normal, slip, W, mu, e) -> np.ndarray:
    """Normal and tangential impulse [N s].

    Args:
        normal: Speed at which the surfaces part, negative [m/s].
        slip: [m/s].
        W: Delassus matrix, normal first, (2, 2) [1/kg].
        mu: Coefficient of friction.
        e: Restitution.
    """
    velocity = np.array([normal, slip], dtype=float)
    P, work, due = np.zeros(2), 0.0, None
    while due is None or due > 0:
        ratio = _ratio(velocity[1], W, mu)
        rate = W @ [1.0, ratio]  # of the velocities, by the normal impulse
        ends = []
        if abs(velocity[1]) > STOPPED and rate[1] * velocity[1] < 0:
            ends.append((-velocity[1] / rate[1], "slip stops"))
        if due is None and rate[0] > 0:
            ends.append((-velocity[0] / rate[0], "compressed"))
        if due is not None:
            # work due = u s + u' s^2 / 2
            root = np.sqrt(velocity[0] ** 2 + 2 * rate[0] * due)
            ends.append((2 * due / (velocity[0] + root), "restituted"))
        s, end = min(ends)
        done = velocity[0] * s + rate[0] * s**2 / 2
        P += [s, ratio * s]
        velocity += rate * s
        if end == "slip stops":
            velocity[1] = 0.0
        if due is None:
            work += done
        else:
            due = 0.0 if end == "restituted" else due - done
        if end == "compressed":
            velocity[0], due = 0.0, -(e**2) * work
    return P


def _ratio(slip, W, mu) -> float:
    """Tangential over normal force."""
    if abs(slip) > STOPPED:
        return -mu * np.sign(slip)
    holds = -W[0, 1] / W[1, 1]
    # what friction cannot hold slips the way in which it is driven
    return holds if abs(holds) <= mu else mu * np.sign(holds)
