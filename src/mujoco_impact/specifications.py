"""Copying and compiling specifications.

What `MjSpec.copy` of MuJoCo 3.17.0 gives is not the same scene:

* A plugin instance that no body, geom, mesh, actuator or sensor names is left out. A
  scene could lose all of its impacts.
* `plugin_name` of each instance of the copy is the text of the source, by its pointer.
  Once the source is gone, whoever reads it reads freed memory. Copies of copies point
  to the first source.
* Elements that name what is not there are left out without a word.

So `copy_spec` adds the lost instances again, keeps the source alive as long as the
copy, and refuses a scene that lost another element.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import mujoco

from mujoco_impact.errors import SceneError

_sources: WeakKeyDictionary[mujoco.MjSpec, mujoco.MjSpec] = WeakKeyDictionary()
"""What each copy with plugin instances was made of, which holds their plugin names."""

_REFERRING = (
    "pairs",
    "excludes",
    "equalities",
    "tendons",
    "actuators",
    "sensors",
    "tuples",
    "skins",
    "flexes",
    "keys",
)
"""Elements that name others; a copy leaves out those that name what is not there."""


def copy_spec(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """Returns a copy of a specification with all that it has.

    Instances that no element names come last in the copy.

    Raises:
        SceneError: If an element names another that is not there.
    """
    if not all(instance.name for instance in spec.plugins):
        # instances that elements have to themselves are copied once they are compiled
        compile_spec(spec)
    copied = spec.copy()
    _check_complete(spec, copied)
    kept = {instance.name for instance in copied.plugins}
    for instance in spec.plugins:
        if instance.name and instance.name not in kept:
            again = copied.add_plugin(
                name=instance.name,
                plugin_name=instance.plugin_name,
                active=instance.active,
                info=instance.info,
            )
            again.config = dict(instance.config)
    if copied.plugins:
        _sources[copied] = spec
    return copied


def compile_spec(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compiles a specification.

    Raises:
        SceneError: With MuJoCo's reason if it cannot be compiled.
    """
    try:
        return spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        msg = f"MuJoCo cannot compile the scene: {one_line(error)}"
        raise SceneError(msg) from error


def one_line(error: BaseException) -> str:
    """Returns the text of an error without line breaks."""
    return " ".join(str(error).split())


def _check_complete(spec: mujoco.MjSpec, copied: mujoco.MjSpec) -> None:
    """Raises SceneError if elements are missing in a copy."""
    for kind in _REFERRING:
        elements, found = getattr(spec, kind), getattr(copied, kind)
        if len(elements) == len(found):
            continue
        names = {element.name for element in found}
        lost = next((one.name for one in elements if one.name not in names), "")
        msg = (
            f"one of the {kind} of the scene{f', {lost!r},' if lost else ''} names an "
            "element that the scene does not have"
        )
        raise SceneError(msg)
