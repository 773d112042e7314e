"""A simulation that goes on in real time and that keys command; it knows no window."""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Callable
from functools import cached_property

import mujoco

from mujoco_impact._plugin import PLUGIN_NAME
from mujoco_impact.errors import ImpactError
from mujoco_impact.impact import Impact
from mujoco_impact.mujoco_warnings import collected_warnings
from mujoco_impact.pulses import PulseReader
from mujoco_impact.runner import initial_data
from mujoco_impact.scene import detach
from mujoco_impact.specifications import compile_spec, copy_spec
from mujoco_impact.starts import Keyframe, keyframe_names, start_number, start_told

SPEEDS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""Simulated seconds per second that can be chosen."""

SEEN = 0.4
"""How long an impact is shown [s]."""

MOST_SEEN = 200
"""Most impacts that are shown at a time."""

SMALLEST_CHANGE = 0.1
"""Step of the restitution."""


@dataclasses.dataclass(frozen=True)
class Key:
    """A key of the live view.

    Attributes:
        code: Its code in GLFW.
        name: What stands on it.
        does: What it does.
        act: What is called.
    """

    code: int
    name: str
    does: str
    act: Callable[[Session], None]


class Session:
    """One scene, running.

    All variants of the scene (restitutions, MuJoCo's own contacts) have models of one
    layout, so that one and the same data goes on under another of them.

    Attributes:
        data: The state.
        paused: Whether time stands still.
        native: Whether MuJoCo's own contacts act instead of ours.
        impacts: Number of impacts since the start or the last reset.
        recent: Those of the latest `SEEN` seconds by the clock, with the time when
            they came.
        latest: The latest of them.
        largest: The largest impulse of them all [N s].
        note: What the last key or MuJoCo had to say, else empty.
    """

    impacts: int
    recent: deque[tuple[float, Impact]]
    latest: Impact | None
    largest: float
    _clock: float
    _due: float
    _seen: float
    _energy: float
    _reader: PulseReader

    def __init__(self, spec: mujoco.MjSpec, *, keyframe: Keyframe = None) -> None:
        """Starts where `run` starts.

        Args:
            spec: The scene with the plugin.
            keyframe: What to start from, see `starts`.
        """
        self._spec = spec
        self._models: dict[tuple[float, bool], mujoco.MjModel] = {}
        self._own = _restitution(spec)
        self._restitution = self._own
        self._speed = SPEEDS.index(1.0)
        self.native = False
        self.model = self._model(self._own, native=False)
        self._keyframe = start_number(keyframe_names(self.model), keyframe)
        self.data = initial_data(self.model, keyframe=self._keyframe)
        self.paused = False
        self.note = ""
        self._begin()

    @property
    def restitution(self) -> float:
        """Restitution of the impacts."""
        return self._restitution

    @property
    def speed(self) -> float:
        """Simulated seconds per second."""
        return SPEEDS[self._speed]

    def press(self, code: int) -> None:
        """Does what a key says; other keys are those of MuJoCo's viewer."""
        for key in KEYS:
            if key.code == code:
                self.note = ""
                key.act(self)

    def advance(self, seconds: float) -> None:
        """Lets time pass.

        Args:
            seconds: Time by the clock [s]; the simulated time depends on `speed`.
        """
        if self.data.time < self._seen:
            # the window has a reset of its own
            self._begin()
        self._clock += seconds
        while self.recent and self.recent[0][0] < self._clock - SEEN:
            self.recent.popleft()
        self._due += 0.0 if self.paused else seconds * self.speed
        step = float(self.model.opt.timestep)
        while self._due >= step:
            self._due -= step
            self.step()

    def step(self) -> None:
        """Takes one step."""
        with collected_warnings() as messages:
            mujoco.mj_step(self.model, self.data)
        if messages:
            self.note = f"MuJoCo at {self._seen:.3g} s: {messages[0].strip()}"
        if self.data.time < self._seen:  # MuJoCo starts again after a divergence
            self._begin()
        self._reader.poll()
        self.impacts += len(self._reader.impacts) + self._reader.missed
        self._reader.missed = 0
        for impact in self._reader.impacts:
            self.recent.append((self._clock, impact))
            self.largest = max(self.largest, impact.impulse)
            self.latest = impact
        self._reader.impacts.clear()
        self._seen = float(self.data.time)

    def skip(self, seconds: float) -> None:
        """Leaves time out that the computer could not keep up with [s]."""
        self._due = min(self._due, seconds)

    def lines(self) -> list[tuple[str, str]]:
        """Returns what the window shows: names and values."""
        contacts = "MuJoCo's own" if self.native else "mujoco-impact"
        speed = "paused" if self.paused else f"{self.speed:g} x real time"
        lines = [
            ("contacts", contacts),
            ("restitution", "-" if self.native else f"{self._restitution:.3g}"),
            ("time", f"{self.data.time:.3f} s, {speed}"),
            ("impacts", self._impact_text()),
            ("energy", self._energy_text()),
        ]
        if self.note:
            lines.append(("", self.note))
        return lines

    def toggle_pause(self) -> None:
        """Stops time, or lets it go on."""
        self.paused = not self.paused

    def single_step(self) -> None:
        """Stops time after one more step."""
        self.paused = True
        self.step()

    def next_keyframe(self) -> None:
        """Starts again, at the next keyframe if there are several."""
        if self.model.nkey:
            last = -1 if self._keyframe is None else self._keyframe
            self._keyframe = (last + 1) % self.model.nkey
        self.restart()

    def restart(self) -> None:
        """Starts again where the motion began."""
        mujoco.mj_resetData(self.model, self.data)
        if self._keyframe is not None:
            mujoco.mj_resetDataKeyframe(self.model, self.data, self._keyframe)
        self.note = f"from {start_told(keyframe_names(self.model), self._keyframe)}"
        mujoco.mj_forward(self.model, self.data)
        self._begin()

    def toggle_native(self) -> None:
        """Gives the contacts to MuJoCo, or back to the plugin."""
        self._switch(self._restitution, native=not self.native)

    def less_restitution(self) -> None:
        """Makes impacts lose more."""
        self._switch(max(0.0, round(self._restitution - SMALLEST_CHANGE, 2)))

    def more_restitution(self) -> None:
        """Makes impacts lose less."""
        self._switch(min(1.0, round(self._restitution + SMALLEST_CHANGE, 2)))

    def slower(self) -> None:
        """Slows time down."""
        self._speed = max(0, self._speed - 1)

    def faster(self) -> None:
        """Lets time run faster."""
        self._speed = min(len(SPEEDS) - 1, self._speed + 1)

    def _begin(self) -> None:
        """Counts from the present state."""
        self._reader = PulseReader(self.model, self.data)
        self._due = 0.0
        self._seen = float(self.data.time)
        self._clock = 0.0
        self.impacts = 0
        self.largest = 0.0
        self.recent = deque(maxlen=MOST_SEEN)
        self.latest = None
        mujoco.mj_forward(self.model, self.data)
        self._energy = self._total()

    def _switch(self, restitution: float, *, native: bool = False) -> None:
        """Goes on under another variant of the scene, or notes why not."""
        try:
            self.model = self._model(restitution, native=native)
        except ImpactError as error:
            self.note = str(error)
            return
        self._restitution, self.native = restitution, native

    def _model(self, restitution: float, *, native: bool) -> mujoco.MjModel:
        """Returns a variant of the scene; all have the same layout."""
        key = restitution, native
        if key in self._models:
            return self._models[key]
        spec = copy_spec(self._spec)
        if restitution != self._own:
            for instance in spec.plugins:
                if instance.plugin_name == PLUGIN_NAME:
                    config = {**instance.config, "restitution": repr(restitution)}
                    instance.config = config
        model = compile_spec(spec)
        model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
        if native:
            # the plugin stays and owns nothing
            for name in ("geom_margin", "geom_gap", "pair_margin", "pair_gap"):
                getattr(model, name)[:] = getattr(self._plain, name)
        self._models[key] = model
        return model

    @cached_property
    def _plain(self) -> mujoco.MjModel:
        """The scene without the plugin."""
        return compile_spec(detach(self._spec))

    def _total(self) -> float:
        """Returns potential and kinetic energy of the start of the last step [J]."""
        return float(sum(self.data.energy))

    def _impact_text(self) -> str:
        """Returns how many impacts there were, and the latest."""
        if self.latest is None:
            return str(self.impacts)
        names = " - ".join(self.latest.geoms)
        return f"{self.impacts}, latest {names}: {self.latest.impulse:.3g} N s"

    def _energy_text(self) -> str:
        """Returns the energy and what it was at the start."""
        return f"{self._total():.4g} J, {self._energy:.4g} J at the start"


def _restitution(spec: mujoco.MjSpec) -> float:
    """Returns the restitution of the first instance of the plugin."""
    for instance in spec.plugins:
        if instance.plugin_name == PLUGIN_NAME:
            return float(dict(instance.config).get("restitution", 1.0))
    return 1.0


KEYS = (
    Key(32, "space", "pause, go on", Session.toggle_pause),
    Key(46, ".", "one step", Session.single_step),
    Key(54, "6", "start again", Session.restart),
    Key(55, "7", "next keyframe", Session.next_keyframe),
    Key(56, "8", "less restitution", Session.less_restitution),
    Key(57, "9", "more restitution", Session.more_restitution),
    Key(257, "enter", "MuJoCo's contacts, ours", Session.toggle_native),
    Key(45, "-", "slower", Session.slower),
    Key(61, "=", "faster", Session.faster),
)
"""All keys; letters, 0 to 5 and F1 to F8 are those of MuJoCo's viewer."""
