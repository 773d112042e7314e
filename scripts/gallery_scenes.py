"""The scenes of the gallery: what they show, their code, and how they are drawn."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Scene:
    """One scene of the gallery.

    Attributes:
        name: Name of its picture, and of its MJCF in docs/gallery if it has a file.
        title: Heading.
        text: What there is to see, and what is left out.
        code: Python that leaves `spec` and `motion`, or `env` and `states`.
        speed: Simulated seconds in a second of the picture.
        eye: Position [m] and axes of a camera, as in MJCF; empty: that of the scene.
    """

    name: str
    title: str
    text: str
    code: str
    speed: float = 0.5
    eye: str = ""


SCENES = (
    Scene(
        name="cradle",
        title="Two balls in, two balls out",
        text="Newton's cradle with two balls let go. They come in together, and two "
        "leave on the other side. The three between them move a little, as steel "
        "balls do.",
        code="""
import cradle_models, mujoco_impact

spec = mujoco_impact.attach(cradle_models.row("AAAAA", released=2))
motion = mujoco_impact.run(spec, duration=1.12, keyframe="release")
met = motion.impacts[0].time
before, after = motion.qvel[motion.time < met][-1], motion.qvel[motion.time > met][1]
print((after / before[0]).round(3))
""",
    ),
    Scene(
        name="strings",
        title="Balls on strings",
        text="The same on two strings each, as it hangs on desks. The balls are free: "
        "only MuJoCo's tendons hold them. The plugin owns the contacts between the "
        "balls, MuJoCo the strings.",
        code="""
import cradle_models, mujoco_impact

spec = mujoco_impact.attach(cradle_models.model_path("two_string_5"))
motion = mujoco_impact.run(spec, duration=1.12, keyframe="release")
way = motion.qpos[:, 28] - motion.qpos[0, 28]
print(f"the last ball goes out by {way.max():.3f} m")
""",
    ),
    Scene(
        name="lattice",
        title="A cradle of two dimensions",
        text="Twenty-five pendulums that swing in both directions and touch in both. "
        "The corner comes in along the diagonal.",
        eye="-.18 -.58 .0  1 -.3 0 .1 .35 1",
        code="""
import cradle_models, mujoco_impact

scene = cradle_models.lattice(5, 5, released="corner")
spec = mujoco_impact.attach(scene)
motion = mujoco_impact.run(spec, duration=1.4, keyframe="release")
""",
    ),
    Scene(
        name="bounce",
        title="Bouncing balls",
        text="Three balls with a restitution of 1, 0.8 and 0.5. Each has an instance "
        "of the plugin. That is allowed because the balls cannot meet each other.",
        code="""
import mujoco_impact

spec = "docs/gallery/bounce.xml"
for name, e in (("elastic", 1.0), ("good", 0.8), ("poor", 0.5)):
    spec = mujoco_impact.attach(spec, geoms=[name], name=name, restitution=e)
motion = mujoco_impact.run(spec, duration=1.9)
""",
        speed=0.6,
    ),
    Scene(
        name="spin",
        title="Bouncing with spin",
        text="Rubber balls thrown alike, but with backspin, without spin and with "
        "topspin. Where they touch the floor friction turns spin into speed: the first "
        "stops, the last runs away.",
        code="""
import cradle_models, mujoco_impact

scene = cradle_models.spinning_balls((-100, 0, 100), friction=0.3)
spec = mujoco_impact.attach(scene, restitution=0.8)
motion = mujoco_impact.run(spec, duration=1.1, keyframe="release")
bounce = motion.impacts[-1].time
print(motion.qvel[motion.time < bounce][-1][[0, 6, 12]].round(2), "m/s")
""",
        speed=0.4,
    ),
    Scene(
        name="cannon",
        title="Galilean cannon",
        text="Three balls above each other, each with a tenth of the mass of the one "
        "below. They fall 4 mm apart, so that one strikes the next, and the smallest "
        "flies off many times as high.",
        eye="0 -3 1.15 1 0 0 0 0 1",
        code="""
import cradle_models, mujoco_impact

scene = cradle_models.cannon(height=0.1, gap=0.004)
spec = mujoco_impact.attach(scene, restitution=0.9)
motion = mujoco_impact.run(spec, duration=1.0, keyframe="release")
fall, rise = motion.qpos[0, 16] - 0.378, motion.qpos[:, 16].max() - 0.378
print(f"falls {fall:.2f} m, flies {rise:.2f} m high: {rise / fall:.1f} times")
""",
        speed=0.3,
    ),
    Scene(
        name="break",
        title="Billiard break",
        text="A pool table with cloth, cushions and pockets. Fifteen touching balls "
        "are struck in the middle at 6 m/s, and their break is its own mirror image. "
        "They slide, roll and spin on the cloth.",
        code="""
import cradle_models, mujoco_impact

spec = mujoco_impact.attach(cradle_models.billiards(speed=6), restitution=0.9)
motion = mujoco_impact.run(spec, duration=2.0, keyframe="release")
""",
        speed=0.4,
    ),
    Scene(
        name="bernoulli",
        title="Bernoulli's problem",
        text="One ball strikes four at once. Without friction it comes back with a "
        "third of its speed, by conservation of momentum and energy; with friction it "
        "is a little less, and the four spin.",
        code="""
import cradle_models, mujoco_impact

for friction in (0.0, 0.1):
    spec = mujoco_impact.attach(cradle_models.bernoulli(4, friction=friction))
    motion = mujoco_impact.run(spec, duration=0.2, keyframe="release")
    print(f"friction {friction}: {motion.qvel[-1, 0]:.3f} m/s")
""",
        speed=0.05,
    ),
    Scene(
        name="dominoes",
        title="Domino row",
        text="Each stone pushes the next. The stones are free. Friction keeps their "
        "feet in place, and rubs where one leans on another.",
        code="""
import warnings
import cradle_models, mujoco_impact

spec = mujoco_impact.attach(cradle_models.dominoes(12), restitution=0.3)
with warnings.catch_warnings():
    # fallen stones rattle: some of the thousands of small impacts have no record
    warnings.simplefilter("ignore", mujoco_impact.ImpactWarning)
    motion = mujoco_impact.run(spec, duration=0.9, keyframe="release")
first = {impact.geoms: impact.time for impact in reversed(motion.impacts)}
wave = first["stone_11", "stone_12"] - first["stone_6", "stone_7"]
print(f"the wave runs at {5 * 0.036 / wave:.1f} m/s")
""",
        speed=0.25,
    ),
    Scene(
        name="block",
        title="Rocking block",
        text="A block is let go on one edge and rocks to the other and back. It loses "
        "energy each time that it comes upright, by the law of Housner (1963), though "
        "no coefficient says so: the restitution is 0.",
        code="""
import cradle_models, mujoco_impact

spec = mujoco_impact.attach(cradle_models.rocking_block(), restitution=0)
motion = mujoco_impact.run(spec, duration=2.0, keyframe="release")
""",
    ),
    Scene(
        name="robot",
        title="A ball on a robot's link",
        text="An arm with three servos holds still while a ball bounces along it. Only "
        "the ball is given to the plugin. The arm gives way at each bounce.",
        code="""
import mujoco_impact

spec = mujoco_impact.attach("docs/gallery/robot.xml", geoms=["ball"], restitution=0.85)
motion = mujoco_impact.run(spec, duration=1.7)
for impact in motion.impacts:
    print(f"{impact.geoms} {impact.impulse:.2f} N s")
""",
    ),
    Scene(
        name="shapes",
        title="Any shape",
        text="A box, a capsule, a cylinder, an ellipsoid and a ball tumble in a tray. "
        "The integrator is RK4, as MuJoCo's Euler adds energy to bodies that tumble.",
        code="""
import mujoco_impact

spec = mujoco_impact.attach("docs/gallery/shapes.xml", restitution=0.9)
motion = mujoco_impact.run(spec, duration=1.5)
""",
        speed=0.4,
    ),
    Scene(
        name="bank",
        title="A bank shot",
        text="Our task `billiards`, `bank`: the yellow ball has to fall into the side "
        "pocket off the cushion opposite. The cue turns, waits, and strikes. The angle "
        "was found by trial on the model.",
        code="""
from mujoco_impact import envs

env = envs.load("billiards", "bank", task_kwargs={"random": 5})
env.reset()
states = []
for step in range(120):
    result = env.step([0.31, float(step > 30)])
    states.append(env.physics.data.qpos.copy())
print(f"reward {result.reward:.0f}")
""",
        speed=0.6,
    ),
    Scene(
        name="dm_control",
        title="A task of dm_control",
        text="`ball_in_cup` of dm_control with our impacts, without a change of its "
        "XML. The cup is moved by two sines, and catches the ball.",
        code="""
import math
from mujoco_impact import envs

env = envs.load("ball_in_cup", "catch", task_kwargs={"random": 1}, restitution=0.8)
env.reset()
states = []
for step in range(150):
    env.step([math.sin(0.26 * step), math.sin(0.06 * step + 0.7)])
    states.append(env.physics.data.qpos.copy())
""",
        speed=1.0,
    ),
)
