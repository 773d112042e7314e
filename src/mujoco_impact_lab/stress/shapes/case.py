"""One case of shapes: everything that makes a random scene, and its seed."""

from __future__ import annotations

import dataclasses

SHAPES = ("sphere", "box", "capsule", "cylinder", "ellipsoid", "mesh")

FLOORS = ("none", "plane", "tilted plane", "height field", "box")

JOINTS = ("free", "slides", "slide", "planar", "hinge", "ball", "chain", "free chain")
"""How a tree moves: freely, along three axes, along one, in a plane, about an axis,
about a point, as links on hinges that hang on the world, or that fly."""


@dataclasses.dataclass(frozen=True)
class Tree:
    """One kinematic tree.

    Attributes:
        number: Of its own stream of random numbers: a tree stays what it is if others
            are taken away.
        joint: One of `JOINTS`.
        shapes: Of the geoms of each of its bodies, of `SHAPES`.
        links: Number of bodies.
    """

    number: int
    joint: str
    shapes: tuple[str, ...]
    links: int


@dataclasses.dataclass(frozen=True)
class Case:
    """A random scene, reproducible from its numbers.

    Attributes:
        seed: Seed of all that is drawn while the scene is made.
        trees: What moves.
        floor: One of `FLOORS`.
        size: Usual half-width of a geom [m].
        offset: Of the centre of a body from its joint, over `size`.
        density: Of the lightest tree [kg/m^3].
        mass_ratio: Largest density over the smallest.
        gravity: Downwards [m/s^2].
        restitution: Coefficient of restitution.
        condim: Of every geom.
        cone: Of MuJoCo's friction: "pyramidal" or "elliptic".
        jacobian: "dense" or "sparse".
        integrator: Of `mujoco_impact_lab.stress.case.INTEGRATORS`.
        timestep: [s].
        pace: Way of the fastest point in a step, over the gap of the owned geoms.
        spin: Usual surface speed of turning over that of moving.
        clearance: Between trees, and above the floor, over `size`.
        steps: Steps to run.
        materials: How many there are, beside none; `materials_of` draws them.
    """

    seed: int
    trees: tuple[Tree, ...]
    floor: str
    size: float
    offset: float
    density: float
    mass_ratio: float
    gravity: float
    restitution: float
    condim: int
    cone: str
    jacobian: str
    integrator: str
    timestep: float
    pace: float
    spin: float
    clearance: float
    steps: int
    materials: int = 0

    @property
    def has_arms(self) -> bool:
        """Whether any tree has several joints, so that its inertia changes."""
        return any(tree.links > 1 or tree.joint == "planar" for tree in self.trees)

    def describe(self) -> str:
        """Returns the case in one line."""
        trees = ", ".join(
            f"{tree.joint} {'+'.join(tree.shapes)}"
            + (f" x {tree.links}" if tree.links > 1 else "")
            for tree in self.trees
        )
        return (
            f"seed {self.seed}: [{trees}] above {self.floor}, size {self.size:.2g} m, "
            f"offset {self.offset:.2g}, density {self.density:.2g} kg/m^3 "
            f"1:{self.mass_ratio:.2g}, g {self.gravity:.3g}, e {self.restitution:.3g}, "
            f"condim {self.condim} {self.cone} {self.jacobian}, "
            f"h {self.timestep:.2g} s {self.integrator}, pace {self.pace:.2g}, "
            f"spin {self.spin:.2g}, clearance {self.clearance:.2g}, {self.steps} steps"
            + (f", {self.materials} materials" if self.materials else "")
        )
