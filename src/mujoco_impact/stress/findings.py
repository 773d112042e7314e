"""A scene of the user's own, run in many ways: where does it stop being sound?"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence

import mujoco
import numpy as np

from mujoco_impact.errors import SceneError
from mujoco_impact.ownership import owned_geoms
from mujoco_impact.settings import Setting
from mujoco_impact.source import Source, read_spec
from mujoco_impact.specifications import compile_spec
from mujoco_impact.starts import Keyframe, settled
from mujoco_impact.stress.differences import Outcome, differences
from mujoco_impact.stress.variations import Variation, variations, varied
from mujoco_impact.stress.watched_run import WatchedRun, problems_of
from mujoco_impact.text import markdown_table

HEADING = (
    "run",
    "impacts",
    "energy",
    "deepest overlap [m]",
    "way per step / gap",
    "steps with MuJoCo's contacts",
    "verdict",
)
"""Of the table of findings."""

LONG = 60
"""Characters from which a sentence is said once for all runs."""


@dataclasses.dataclass(frozen=True)
class Finding:
    """What one way of running a scene showed.

    Attributes:
        variation: Its name.
        impacts: Impacts of the plugin.
        missed: Impacts without a record, more than the state has slots.
        energy: Change of energy over the largest kinetic energy.
        deepest: Deepest overlap of owned geoms at the end of a step [m].
        farthest: Way of the fastest owned geom in a step, over the gap in which its
            contacts are seen: above 1 an impact may be missed.
        native: Steps in which MuJoCo's own contacts of owned geoms took part.
        same_bits: Whether a second run ended in the same bits.
        problems: What is wrong, in words; empty if nothing is.
        differences: Where it comes to something else than with the finest timestep.
    """

    variation: str
    impacts: int
    missed: int
    energy: float
    deepest: float
    farthest: float
    native: int
    same_bits: bool
    problems: tuple[str, ...]
    differences: tuple[str, ...] = ()


class StressInterrupted(KeyboardInterrupt):
    """A stress test was interrupted by hand (Ctrl-C).

    Attributes:
        findings: The findings until then.
    """

    def __init__(self, findings: list[Finding]) -> None:
        """Stores the findings."""
        super().__init__(f"interrupted after {len(findings)} runs")
        self.findings = findings


def stress_scene(
    source: Source,
    *,
    duration: float,
    keyframe: Keyframe = None,
    settings: Mapping[str, Setting] | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Finding]:
    """Runs a scene in many ways and looks for what goes wrong.

    Args:
        source: Path of a model file, XML text, or a specification (not changed).
        duration: Simulated time of each run [s].
        keyframe: See `run`.
        settings: Settings of the impact law by name, see `attach`; not for a scene
            that has the plugin already.
        progress: Called with the name of each variation as it begins.

    Returns:
        One finding per variation, the scene as it is first.

    Raises:
        SceneError: If the scene cannot take the plugin.
        ConfigError: If a setting is not valid.
        StressInterrupted: On Ctrl-C; it is a KeyboardInterrupt, and holds the findings
            until then.
    """
    spec = read_spec(source)
    if owned_geoms(spec) and settings:
        msg = "the scene has the plugin already: settings have no effect on it"
        raise SceneError(msg)
    keyframe = settled([key.name for key in spec.keys], keyframe)
    ways = variations(spec, keyframe)
    findings: list[Finding] = []
    outcomes: list[Outcome] = []
    try:
        for variation in ways:
            if progress is not None:
                progress(variation.name)
            scene = varied(spec, variation, settings or {})
            finding, outcome = _find(scene, variation, duration, keyframe)
            findings.append(finding)
            outcomes.append(outcome)
    except KeyboardInterrupt:
        if not findings:
            raise
        kept = _compared(ways[: len(findings)], findings, outcomes)
        raise StressInterrupted(kept) from None
    return _compared(ways, findings, outcomes)


def findings_table(findings: Iterable[Finding]) -> str:
    """Returns the findings as a markdown table."""
    return markdown_table(HEADING, findings_rows(findings))


def findings_rows(findings: Iterable[Finding]) -> list[tuple[str, ...]]:
    """Returns a row of cells for each finding, under `HEADING`.

    What is said of several runs in the same words is numbered, and stands once.
    """
    findings = list(findings)
    numbers = _repeated(findings)
    told: set[str] = set()
    return [
        (
            finding.variation,
            str(finding.impacts),
            f"{finding.energy:+.1e}",
            f"{finding.deepest:.1e}",
            f"{finding.farthest:.2g}",
            str(finding.native),
            "; ".join(_once(text, numbers, told) for text in _verdict(finding)),
        )
        for finding in findings
    ]


def _once(text: str, numbers: Mapping[str, str], told: set[str]) -> str:
    """Returns a sentence with its number, or the number alone if it was told."""
    number = numbers.get(text)
    if number is None or text in told:
        return number or text
    told.add(text)
    return f"{text} {number}"


def _verdict(finding: Finding) -> tuple[str, ...]:
    """Returns what is said of one run."""
    return (*(finding.problems or ("sound",)), *finding.differences)


def _repeated(findings: Sequence[Finding]) -> dict[str, str]:
    """Returns sentences that are said of several runs, and the numbers they get."""
    said = Counter(text for finding in findings for text in _verdict(finding))
    long = [text for text, count in said.items() if count > 1 and len(text) > LONG]
    return {text: f"({number})" for number, text in enumerate(long, start=1)}


def _compared(
    ways: Sequence[Variation], findings: Sequence[Finding], outcomes: Sequence[Outcome]
) -> list[Finding]:
    """Returns the findings, those of other timesteps compared with the finest one."""
    finest = min(range(len(ways)), key=lambda index: ways[index].timestep)
    compared = []
    for way, finding, outcome in zip(ways, findings, outcomes, strict=True):
        only_timestep = way == Variation(way.name, timestep=way.timestep)
        if only_timestep and way != ways[finest]:
            told = differences(outcome, outcomes[finest], ways[finest].name)
            finding = dataclasses.replace(finding, differences=told)
        compared.append(finding)
    return compared


def _find(
    spec: mujoco.MjSpec,
    variation: Variation,
    duration: float,
    keyframe: Keyframe,
) -> tuple[Finding, Outcome]:
    """Runs one variation twice and says what it showed, and came to."""
    owned = owned_geoms(spec)
    model = compile_spec(spec)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    names = [name for geoms in owned.values() for name in geoms or ()]
    geoms = np.array(
        [model.geom(name).id for name in names] or range(model.ngeom), dtype=int
    )
    first, second = (
        WatchedRun(model, geoms, variation.speed, duration, keyframe) for _ in range(2)
    )
    same_bits = first.bits == second.bits
    finding = Finding(
        variation=variation.name,
        impacts=first.outcome.count,
        missed=first.pulses.missed,
        energy=first.outcome.energy,
        deepest=first.deepest,
        farthest=first.farthest,
        native=first.native,
        same_bits=same_bits,
        problems=tuple(problems_of(first, same_bits)),
    )
    return finding, first.outcome
