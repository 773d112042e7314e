"""Exudyn: Hertz contacts resolved in time by an adaptive integrator."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from mujoco_impact.errors import SimulationError
from mujoco_impact.trajectory import Array
from mujoco_impact_lab.bench.methods import Candidate, MethodFamily
from mujoco_impact_lab.bench.peers.common import installed, missing
from mujoco_impact_lab.bench.samples import Samples
from mujoco_impact_lab.bench.scenes import BenchScene
from mujoco_impact_lab.bench.truths import Truth

NAME, TITLE, PACKAGE = "exudyn", "Exudyn, Hertz contacts, DOPRI5", "exudyn"

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)

MOST_BALLS = 10
"""50 balls take it minutes: one global step serves all contacts."""

LONGEST_STEP = 0.01
"""Longest integration step, and time between samples [s]."""


class ExudynRow:
    """A row of pendulums in minimal coordinates, solved by one call into Exudyn."""

    def __init__(self, scene: BenchScene, truth: Truth, tolerance: float) -> None:
        """Prepares a scene.

        Args:
            scene: The scene.
            truth: Its truth, for the chain.
            tolerance: Relative tolerance.
        """
        import exudyn

        self._exudyn: Any = exudyn
        self._chain = truth.chain
        spacing = self._chain.spacing - np.array(self._chain.gaps) + scene.gap
        self._pivots: Array = np.concatenate(([0.0], np.cumsum(spacing)))
        self._start, _ = scene.start()
        self._duration = scene.duration
        self._tolerance = tolerance

    def record(self) -> Samples:
        """Runs once, with a sample every 10 ms."""
        system, sensors = self._system(recorded=True)
        self._solve(system)
        stored = [system.GetSensorStoredData(sensor) for sensor in sensors]
        # the joints turn about +y, which moves the hanging balls to -x
        values = -np.stack([column[:, 1] for column in stored], axis=1)
        count = self._chain.count
        return Samples(stored[0][:, 0], values[:, :count], values[:, count:])

    def run_time(self) -> float:
        """Runs once; making the system is not counted."""
        system, _ = self._system(recorded=False)
        begin = time.perf_counter()
        self._solve(system)
        return time.perf_counter() - begin

    def _system(self, *, recorded: bool) -> tuple[Any, list[Any]]:
        """Returns the system and its sensors of angles and velocities."""
        import exudyn.itemInterface as items

        exudyn, chain = self._exudyn, self._chain
        # the container owns the system
        self._container = exudyn.SystemContainer()
        system = self._container.AddSystem()
        nodes, markers = zip(
            *(self._hang(system, index) for index in range(chain.count)), strict=True
        )
        for pair, stiffness in enumerate(chain.stiffness):
            self._touch(system, markers[pair : pair + 2], pair, float(stiffness))
        kinds = exudyn.OutputVariableType
        sensors = [
            system.AddSensor(
                items.SensorNode(
                    nodeNumber=node, storeInternal=True, outputVariableType=kind
                )
            )
            for kind in (kinds.Coordinates, kinds.Coordinates_t)
            for node in nodes
            if recorded
        ]
        system.Assemble()
        return system, sensors

    def _hang(self, system: Any, index: int) -> tuple[Any, Any]:
        """Adds one pendulum; returns its node and the marker in its centre."""
        import exudyn.itemInterface as items

        exudyn, chain = self._exudyn, self._chain
        node = system.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=[0.0],
                initialCoordinates=[-float(self._start[index])],
                initialCoordinates_t=[0.0],
                numberOfODE2Coordinates=1,
            )
        )
        arm = [0.0, 0.0, -chain.length]
        mass, radius = chain.masses[index], chain.radii[index]
        ball = system.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node,
                gravity=[0.0, 0.0, -chain.gravity],
                jointTypes=[exudyn.JointType.RevoluteY],
                linkParents=[-1],
                jointTransformations=exudyn.Matrix3DList([np.eye(3)]),
                jointOffsets=exudyn.Vector3DList(
                    [[float(self._pivots[index]), 0.0, 0.0]]
                ),
                linkInertiasCOM=exudyn.Matrix3DList(
                    [np.eye(3) * 0.4 * mass * radius**2]
                ),
                linkCOMs=exudyn.Vector3DList([arm]),
                linkMasses=[mass],
            )
        )
        centre = items.MarkerKinematicTreeRigid(
            objectNumber=ball, linkNumber=0, localPosition=arm
        )
        return node, system.AddMarker(centre)

    def _touch(
        self, system: Any, markers: Sequence[Any], pair: int, stiffness: float
    ) -> None:
        """Adds the elastic Hertz contact of two neighbours."""
        import exudyn.itemInterface as items

        data = system.AddNode(
            items.NodeGenericData(
                initialCoordinates=[0.0] * 4, numberOfDataCoordinates=4
            )
        )
        system.AddObject(
            items.ObjectContactSphereSphere(
                markerNumbers=list(markers),
                nodeNumber=data,
                spheresRadii=list(self._chain.radii[pair : pair + 2]),
                contactStiffness=stiffness,
                contactStiffnessExponent=1.5,
                contactDamping=0.0,
                restitutionCoefficient=1.0,
                impactModel=0,
            )
        )

    def _solve(self, system: Any) -> None:
        """Integrates a system from its start to the end."""
        exudyn = self._exudyn
        settings = exudyn.SimulationSettings()
        integration = settings.timeIntegration
        integration.endTime = self._duration
        integration.numberOfSteps = round(self._duration / LONGEST_STEP)
        integration.automaticStepSize = True
        integration.relativeTolerance = self._tolerance
        integration.absoluteTolerance = 1e-1 * self._tolerance
        integration.initialStepSize = 1e-5
        integration.minimumStepSize = 1e-12
        integration.verboseMode = 0
        solution = settings.solution
        solution.file.write = False
        solution.file.writePeriod = self._duration
        solution.sensors.writePeriod = LONGEST_STEP
        settings.show.computationTime = False
        solved = system.SolveDynamic(
            settings, solverType=exudyn.DynamicSolverType.DOPRI5
        )
        if solved is False:
            raise SimulationError("Exudyn did not finish", time=self._duration)


def family() -> MethodFamily:
    """Returns Exudyn as a method."""
    version = installed(PACKAGE)
    if version is None:
        return missing(NAME, TITLE, PACKAGE)

    def candidate(tolerance: float) -> Candidate:
        return Candidate(
            NAME,
            f"relative tolerance {tolerance:g}",
            None,
            "DOPRI5",
            lambda scene, truth: ExudynRow(scene, truth, tolerance),
            quick=tolerance == 1e-6,
            rows_only=True,
            lossless_only=True,
            most_balls=MOST_BALLS,
        )

    return MethodFamily(NAME, TITLE, tuple(map(candidate, TOLERANCES)), version)
