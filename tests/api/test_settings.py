"""Text of the settings of the impact law."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mujoco_impact import attach
from mujoco_impact.errors import ConfigError
from mujoco_impact.settings import SETTINGS, attributes

VALID = {
    "law": "hertz",
    "restitution": 0.9,
    "dissipation": "viscous",
    "young": 2e11,
    "poisson": 0.3,
    "duration": 1e-3,
    "touch": 0.0,
    "tolerance": 1e-6,
    "passive": True,
}
CALIBRATED = {
    "law": "calibrated",
    "alpha": [1.0],
    "sh": 60.0,
    "sw": 0.5,
    "w0": 7.5e-3,
    "kappa": 0.083,
    "e": 0.9,
    "friction": "paper",
    "mu_s": 0.1,
    "mu_d": 0.05,
}


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("hertz", "hertz"),
        (True, "true"),
        (np.False_, "false"),
        (2, "2.0"),
        (1e-9, "1e-09"),
        (np.float64(1) / 3, "0.3333333333333333"),
        ([1, 0.5], "1.0 0.5"),
        (np.array([0.1, 0.2]), "0.1 0.2"),
        ((), ""),
    ],
)
def test_values_become_text_without_loss(value: object, text: str) -> None:
    """Numbers read back as the same number."""
    assert attributes({"alpha": value}) == {"alpha": text}  # type: ignore[dict-item]


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("touch", 1j),
        ("touch", None),
        ("restitution", ""),
        ("restitution", []),
        ("restitution", [0.5]),
        ("young", b"1"),
        ("young", np.array([1e9])),
        ("alpha", b"1"),
        ("alpha", {"a": 1}),
        ("alpha", np.array(1.0)),
    ],
)
def test_values_without_text_are_refused(key: str, value: object) -> None:
    """The message names the setting and its value."""
    with pytest.raises(ConfigError, match=f"'{key}' = .* must be") as refusal:
        attributes({key: value})  # type: ignore[dict-item]
    assert repr(value) in str(refusal.value)


def test_a_number_larger_than_any_float_is_refused_as_infinite(two_balls: str) -> None:
    """And not as an overflow."""
    with pytest.raises(ConfigError, match="'young' = 'inf' is refused"):
        attach(two_balls, young=10**400)


@pytest.mark.parametrize("settings", [VALID, CALIBRATED])
def test_the_plugin_knows_every_setting(
    two_balls: str, settings: dict[str, object]
) -> None:
    """MuJoCo refuses attributes that the plugin has not registered."""
    assert attach(two_balls, **settings).compile().nplugin == 1  # type: ignore[arg-type]


def test_every_setting_is_tried_against_the_plugin() -> None:
    """The two examples above leave none out."""
    assert {*VALID, *CALIBRATED} == set(SETTINGS)


def test_the_plugin_knows_no_other_setting(two_balls: str) -> None:
    """A made-up attribute is refused by MuJoCo, so the test above means something."""
    spec = attach(two_balls)
    spec.plugins[0].config = {"colour": "red"}
    with pytest.raises(ValueError, match="unrecognized attribute"):
        spec.compile()
    assert isinstance(spec, mujoco.MjSpec)
