"""A composer task with the cradle entity."""

import numpy as np
from dm_control import composer

from mujoco_impact.envs import Cradle


class Swing(composer.Task):
    """One ball is let go; every observable of the cradle is enabled."""

    def __init__(self, angle=-0.3, control_timestep=0.02, **options):
        self._arena = composer.Arena()
        self.cradle = Cradle(**options)
        self._arena.attach(self.cradle)
        motor = self._arena.mjcf_model.actuator.add(
            "motor", name="motor", joint=self.cradle.hinges[0], gear=[0.1]
        )
        motor.ctrllimited, motor.ctrlrange = True, [-1, 1]
        self.cradle.observables.enable_all()
        self._angle = angle
        self.set_timesteps(control_timestep, 0.002)

    @property
    def root_entity(self):
        return self._arena

    def initialize_episode(self, physics, random_state):  # noqa: ARG002
        angles = np.zeros(len(self.cradle.balls))
        angles[0] = self._angle
        self.cradle.set_angles(physics, angles)

    def get_reward(self, physics):  # noqa: ARG002
        return 0.0


def environment(time_limit=1.0, **options):
    return composer.Environment(
        Swing(**options),
        time_limit=time_limit,
        random_state=0,
        legacy_step=False,
        strip_singleton_obs_buffer_dim=True,
    )
