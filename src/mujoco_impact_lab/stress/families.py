"""The families of random scenes that there are."""

from __future__ import annotations

import dataclasses

from mujoco_impact_lab.stress import shapes
from mujoco_impact_lab.stress.draw import case_of
from mujoco_impact_lab.stress.evidence import Evidence
from mujoco_impact_lab.stress.family import Family
from mujoco_impact_lab.stress.invariants import INVARIANTS
from mujoco_impact_lab.stress.limits import LIMITS
from mujoco_impact_lab.stress.methods import DEFAULTS, METHODS, OURS

BALLS = Family(
    name="balls",
    about="""\
Random scenes of spheres in rows, rings, lattices and free clusters. Timestep 10 us to
20 ms; the integrators Euler, implicit, implicitfast, discrete and RK4; 2 to 200 balls
of 1e-4 to 1e2 m; mass ratios up to 1e6; Young's modulus 1e5 to 1e12 Pa; restitution 0,
and 1e-6 to 1, bi-stiffness and viscous; speeds 1e-6 to 1e3 m/s; pulses of the Hertz
contact, and of 1e-5 to 1 s; gaps 0 to 1e-2 m; starts with overlaps of up to half the
sum of radii; joints with springs, damping, armature, limits, equality constraints,
tendons, motors and MuJoCo's own plugin `pid`; sleeping; two instances of the plugin.
""",
    methods=METHODS,
    case_of=case_of,
    evidence_of=Evidence,
    invariants=INVARIANTS,
    limits=LIMITS,
)

SHAPES = Family(
    name="shapes",
    about="""\
Random scenes of every shape: spheres, boxes, capsules, cylinders, ellipsoids and hulls
of meshes of 1 cm to 30 cm, one or several to a body, on free, hinge, slide, ball and
planar joints and in chains; above a plane, a tilted plane, a height field, a big box,
or in free space; with and without gravity; `condim` 1, 3, 4, 6; both cones; both
jacobians; every integrator; timestep 0.5 to 5 ms; restitution 0 to 1; masses that
differ by up to 1000; centres of mass away from the joint; speeds up to what the gap
sees in a step. The plugin is attached with its default arguments and the restitution.
""",
    methods=(OURS, DEFAULTS),
    case_of=shapes.case_of,
    evidence_of=shapes.Evidence,
    invariants=shapes.INVARIANTS,
    limits=shapes.LIMITS,
    story=shapes.story,
    simplifications=shapes.simplifications,
)

MATERIALS = dataclasses.replace(
    SHAPES,
    name="materials",
    about="""\
The scenes of shapes, by the same seeds, with one to four materials. A geom in five is
of none, and a property in five is left to the settings. Young's modulus 1e6 to 3e11 Pa;
Poisson's ratio 0 to 0.5; friction 0 to 1.5; restitution 0, 1 and between, or falling
with the fifth root of the speed, or a table of up to four speeds. A pair of materials
in five, and a pair of geoms in twenty, has a restitution, friction and contact modulus
of its own.
""",
    methods=(OURS,),
    case_of=shapes.case_with_materials,
    invariants=(*shapes.INVARIANTS, *shapes.MATERIAL_INVARIANTS),
)

FAMILIES = {family.name: family for family in (BALLS, SHAPES, MATERIALS)}
