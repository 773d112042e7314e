"""One stress case: everything that makes a random scene, and its seed."""

from __future__ import annotations

import dataclasses
import math

LAYOUTS = ("row", "ring", "lattice", "cluster")
"""How the balls lie: touching or apart in a row, a ring, a grid or grown at random."""

JOINTS = ("free", "slides", "rail", "pendulum")
"""Six degrees of freedom, three, one along the row, one hinge above the ball."""

FEATURES = (
    "spring",
    "damping",
    "armature",
    "limit",
    "equality",
    "tendon",
    "motor",
    "pid",
    "sleep",
    "two instances",
)
"""What else a scene may hold; `pid` is another plugin, MuJoCo's own."""

CONSERVATIVE = frozenset({"spring", "armature", "two instances"})
"""Features that leave a scene without losses and without work from outside. MuJoCo
takes what is left of the speed of a body that it puts to sleep."""

INTEGRATORS = ("Euler", "implicit", "implicitfast", "discrete", "RK4")


@dataclasses.dataclass(frozen=True)
class Case:
    """A random scene of balls, reproducible from its numbers.

    Attributes:
        seed: Seed of all that is drawn while the scene is made (positions, directions).
        layout: One of `LAYOUTS`.
        joint: One of `JOINTS`; all but "free" and "slides" need the layout "row".
        count: Number of balls.
        radius: Of the largest ball [m].
        radius_ratio: Largest over smallest radius.
        density: Of the lightest ball, before masses are spread [kg/m^3].
        mass_ratio: Heaviest over lightest mass.
        young: Young's modulus [Pa].
        restitution: Coefficient of restitution.
        dissipation: "bistiffness" or "viscous".
        duration: Of the pulses [s]; None for the Hertz contact time.
        timestep: [s].
        integrator: One of `INTEGRATORS`.
        speed: Closing speed of the first impact [m/s].
        gap: Between neighbours at the start [m].
        overlap: Of neighbours at the start, over the sum of their radii.
        features: Of `FEATURES`.
        steps: Steps to run.
    """

    seed: int
    layout: str
    joint: str
    count: int
    radius: float
    radius_ratio: float
    density: float
    mass_ratio: float
    young: float
    restitution: float
    dissipation: str
    duration: float | None
    timestep: float
    integrator: str
    speed: float
    gap: float
    overlap: float
    features: tuple[str, ...]
    steps: int

    @property
    def is_free(self) -> bool:
        """Whether nothing but impacts acts on the balls: momentum is conserved."""
        return self.joint in ("free", "slides") and not set(self.features) - {
            "two instances"
        }

    @property
    def is_conservative(self) -> bool:
        """Whether energy is conserved between impacts."""
        return set(self.features) <= CONSERVATIVE

    @property
    def is_elastic(self) -> bool:
        """Whether impacts conserve energy."""
        return self.restitution == 1.0

    @property
    def pulse_overlap(self) -> float:
        """How far two balls overlap in a half-sine pulse that reverses them [m].

        u W / pi at the closing speed u; 0 for pulses of the Hertz contact, which last
        no longer than balls of this stiffness take to part.
        """
        return 0.0 if self.duration is None else self.speed * self.duration / math.pi

    def describe(self) -> str:
        """Returns the case in one line."""
        pulse = "hertz" if self.duration is None else f"{self.duration:.2g} s"
        return (
            f"seed {self.seed}: {self.layout} of {self.count} ({self.joint}), "
            f"r {self.radius:.2g} m, masses 1:{self.mass_ratio:.2g}, "
            f"E {self.young:.1g} Pa, e {self.restitution:.3g} {self.dissipation}, "
            f"W {pulse}, h {self.timestep:.2g} s {self.integrator}, "
            f"u {self.speed:.2g} m/s, gap {self.gap:.2g} m, "
            f"overlap {self.overlap:.2g}, {', '.join(self.features) or 'no extras'}, "
            f"{self.steps} steps"
        )
