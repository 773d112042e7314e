"""Newton's cradles, and scenes of contact with friction, as MJCF.

``model_path("row_5")`` is a file for MuJoCo; `row` and `two_string` make rows of any
length and mix of balls, `billiards` a pool table with cushions and a rack, `dominoes`
a row of stones, and so on. A model rests when loaded; its keyframe ``release`` lets it
go::

    model = mujoco.MjModel.from_xml_path(str(cradle_models.model_path("row_5")))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("release").id)

The package needs neither MuJoCo nor mujoco_impact to be imported.
"""

from cradle_models.ball import LETTERS, A, B, Ball, balls
from cradle_models.blocks import dominoes, rocking_block
from cradle_models.catalogue import (
    PAPER_PATTERNS,
    list_models,
    make_model,
    model_path,
    write_models,
)
from cradle_models.errors import CradleModelError, ModelValueError, UnknownModelError
from cradle_models.free import free_balls, two_string
from cradle_models.pendulums import lattice, row
from cradle_models.sensor import force_sensor
from cradle_models.spheres import CANNON, RUBBER, bernoulli, cannon, spinning_balls
from cradle_models.table import POOL, SIDE_MOUTH, billiards

__all__ = [
    "CANNON",
    "LETTERS",
    "PAPER_PATTERNS",
    "POOL",
    "RUBBER",
    "SIDE_MOUTH",
    "A",
    "B",
    "Ball",
    "CradleModelError",
    "ModelValueError",
    "UnknownModelError",
    "balls",
    "bernoulli",
    "billiards",
    "cannon",
    "dominoes",
    "force_sensor",
    "free_balls",
    "lattice",
    "list_models",
    "make_model",
    "model_path",
    "rocking_block",
    "row",
    "spinning_balls",
    "two_string",
    "write_models",
]
