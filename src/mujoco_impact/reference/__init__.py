"""References of cradle impacts that know nothing of the plugin or of MuJoCo.

The truth is the Hertz contact of elastic balls: force K delta^1.5 at every contact,
resolved in time with a high-order integrator. `pendulum_row` is a whole swinging row,
`first_impact` the final velocities of the first impact on a straight line.
"""

from mujoco_impact.reference.chain import (
    BallLike,
    Chain,
    ChainError,
    contact_time,
    hertz_stiffness,
    largest_compression,
    release_state,
)
from mujoco_impact.reference.flight import free_flight, time_to_contact
from mujoco_impact.reference.line import (
    Dissipation,
    FirstImpact,
    first_impact,
    hunt_crossley_factor,
)
from mujoco_impact.reference.row import (
    Phase,
    ReferenceTrajectory,
    pendulum_row,
    swing,
)

__all__ = [
    "BallLike",
    "Chain",
    "ChainError",
    "Dissipation",
    "FirstImpact",
    "Phase",
    "ReferenceTrajectory",
    "contact_time",
    "first_impact",
    "free_flight",
    "hertz_stiffness",
    "hunt_crossley_factor",
    "largest_compression",
    "pendulum_row",
    "release_state",
    "swing",
    "time_to_contact",
]
