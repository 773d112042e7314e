"""dm_control's suite with our contacts: its own domains, and ours among them.

Importing this module needs dm_control.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import mujoco

from mujoco_impact.envs.domain import DOMAINS
from mujoco_impact.errors import SceneError
from mujoco_impact.extras import require
from mujoco_impact.scene import attach
from mujoco_impact.settings import Setting
from mujoco_impact.specifications import compile_spec, one_line

dm_suite: Any = require("dm_control.suite")
engine: Any = require("dm_control.mujoco.engine")
core: Any = require("dm_control.mujoco.wrapper.core")

_swap = threading.Lock()


def load(
    domain: str,
    task: str,
    *,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    visualize_reward: bool = False,
    geoms: Iterable[str] | None = None,
    gap: float | None = None,
    depth: float | None = None,
    sensor: bool = False,
    **settings: Setting,
) -> Any:
    """Returns an environment of the suite whose impacts the plugin computes.

    Args:
        domain: "cradle", "billiards", or any domain of `dm_control.suite`.
        task: Name of the task in that domain.
        task_kwargs: Arguments of the task, as for `dm_control.suite.load`.
        environment_kwargs: Arguments of `dm_control.rl.control.Environment`;
            `legacy_step` is False unless set.
        visualize_reward: Whether colours show the reward.
        geoms: Geoms to own, see `mujoco_impact.attach`; not for our domains.
        gap: See `mujoco_impact.attach`; not for our domains.
        depth: See `mujoco_impact.attach`; not for our domains.
        sensor: Whether a stock model gets the plugin's sensor, `impact`, as the last
            one; some domains observe all sensors there are. Ours always have it.
        **settings: Settings of the impact law.

    Raises:
        SceneError: If there is no such domain or task, or its model cannot take the
            plugin.
        ConfigError: If a setting is not valid.
    """
    arguments = {
        **(task_kwargs or {}),
        "environment_kwargs": {"legacy_step": False, **(environment_kwargs or {})},
    }
    options = {"geoms": geoms, "gap": gap, "depth": depth}
    if domain in DOMAINS:
        _check_choice("task", task, list(DOMAINS[domain].SUITE))
        _refuse(domain, options)
        environment = DOMAINS[domain].SUITE[task](**arguments, **settings)
    else:
        _check_choice("domain", domain, [*DOMAINS, *dm_suite.TASKS_BY_DOMAIN])
        _check_choice("task", task, dm_suite.TASKS_BY_DOMAIN[domain])
        with _models_with_impacts({**options, **settings}, sensor=sensor) as stock:
            environment = dm_suite.load(domain, task, task_kwargs=arguments)
        start = StockStart(environment.task, stock[-1])
        environment.task.initialize_episode = start
    environment.task.visualize_reward = visualize_reward
    return environment


def register_suite() -> None:
    """Adds our domains to `dm_control.suite`, for `suite.load("cradle", ...)`.

    dm_control has no public way to do this: its private table of domains and the
    constants made of it are set.
    """
    dm_suite._DOMAINS.update(DOMAINS)
    dm_suite.ALL_TASKS = dm_suite._get_tasks(tag=None)
    for name, tag in (
        ("BENCHMARKING", "benchmarking"),
        ("EASY", "easy"),
        ("HARD", "hard"),
        ("NO_REWARD_VIZ", "no_reward_visualization"),
    ):
        setattr(dm_suite, name, dm_suite._get_tasks(tag))
    every = set(dm_suite.ALL_TASKS)
    dm_suite.EXTRA = tuple(sorted(every - set(dm_suite.BENCHMARKING)))
    dm_suite.REWARD_VIZ = tuple(sorted(every - set(dm_suite.NO_REWARD_VIZ)))
    dm_suite.TASKS_BY_DOMAIN = dm_suite._get_tasks_by_domain(dm_suite.ALL_TASKS)


@contextlib.contextmanager
def _models_with_impacts(
    options: dict[str, Any], *, sensor: bool
) -> Iterator[list[mujoco.MjModel]]:
    """Gives the plugin to every model that this thread reads from XML meanwhile.

    Yields a list that receives those models as they were.

    The domains make their XML inside the functions that make their environments, and
    all of them read it by `Physics.from_xml_string`: that is where it can be had.
    """
    owner = threading.get_ident()
    stock_models: list[mujoco.MjModel] = []
    with _swap:
        stock = engine.Physics.__dict__["from_xml_string"]

        def from_xml_string(
            cls: Any, xml_string: str | bytes, assets: Any = None
        ) -> Any:
            if threading.get_ident() != owner:
                return stock.__func__(cls, xml_string, assets)
            stock_spec = _read(xml_string, assets or {})
            spec = attach(stock_spec, **options)
            if not sensor:
                _move_instance_to_world(spec)
            stock_models.append(compile_spec(stock_spec))
            return cls.from_model(core.MjModel(compile_spec(spec)))

        engine.Physics.from_xml_string = classmethod(from_xml_string)
        try:
            yield stock_models
        finally:
            engine.Physics.from_xml_string = stock


def _move_instance_to_world(spec: mujoco.MjSpec) -> None:
    """Has the world name the plugin instance instead of the sensor, which goes.

    The compiler leaves out an instance that nothing names.
    """
    sensor = spec.sensors[-1]
    world = spec.worldbody.plugin
    world.active = True
    world.name, world.plugin_name = sensor.plugin.name, sensor.plugin.plugin_name
    spec.delete(sensor)


def _read(xml: str | bytes, assets: Mapping[str, Any]) -> mujoco.MjSpec:
    """Returns the specification of a model as dm_control passes it on."""
    text = xml.decode() if isinstance(xml, bytes) else xml
    files = {
        name: content.encode() if isinstance(content, str) else content
        for name, content in assets.items()
    }
    included = {name: file for name, file in files.items() if name.endswith(".xml")}
    others = {name: file for name, file in files.items() if name not in included}
    try:
        return mujoco.MjSpec.from_string(text, include=included, assets=others)
    except (ValueError, mujoco.FatalError) as error:
        msg = f"MuJoCo cannot read the model of the domain: {one_line(error)}"
        raise SceneError(msg) from error


def _check_choice(label: str, name: str, available: Iterable[str]) -> None:
    """Raises SceneError if there is no such domain or task."""
    if name not in available:
        msg = f"there is no {label} {name!r} (available: {', '.join(available)})"
        raise SceneError(msg)


def _refuse(domain: str, options: Mapping[str, Any]) -> None:
    """Raises SceneError for options that our domains do not have."""
    for name, value in options.items():
        if value is not None:
            raise SceneError(f"the domain {domain!r} has no option {name!r}")


_MARGINS = ("geom_margin", "geom_gap", "pair_margin", "pair_gap")


class StockStart:
    """Stands in for `task.initialize_episode` of one environment.

    Tasks of dm_control look for a start without contacts by `mjData.ncon`, which counts
    the contacts that the plugin's margins have MuJoCo detect early, too. While an
    episode is set up, the model therefore has the margins it had before, so that it
    starts in the same state, bit for bit.
    """

    def __init__(self, task: Any, stock: mujoco.MjModel) -> None:
        """Remembers the task's own way, and the margins of the stock model."""
        self._task = task
        self._margins = {name: getattr(stock, name).copy() for name in _MARGINS}

    def __call__(self, physics: Any) -> None:
        """Sets up an episode under the stock margins."""
        model = physics.model
        ours = {name: getattr(model, name).copy() for name in _MARGINS}
        self._set(model, self._margins)
        try:
            # the method of the class: that of the instance is this object
            type(self._task).initialize_episode(self._task, physics)
        finally:
            self._set(model, ours)

    def _set(self, model: Any, margins: dict[str, Any]) -> None:
        """Writes margins into a model."""
        for name, values in margins.items():
            getattr(model, name)[:] = values
