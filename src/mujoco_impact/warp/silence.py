"""Contacts that move faster than at rest are taken from MuJoCo's solver.

Bodies that overlap deeper than their depth have rows there. Where they close or part
faster than what rests, the impact is ours (plugin/engine/foresee/silence.cc): a row of
no weight exerts no force.
"""

import warp as wp

from mujoco_impact.warp.closing import carried_rest_speed, resting_gravity
from mujoco_impact.warp.memory import Bodies
from mujoco_impact.warp.path import displacement, of_joint, to_world

wp.set_module_options({"enable_backward": False})


@wp.kernel
def silence(
    bodies: Bodies,
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    timestep: wp.array[float],
    gravity: wp.array[wp.vec3],
    weightless: int,
    pressing_gravity: float,
    contacts: wp.array[int],
    geoms: wp.array[wp.vec2i],
    world_of: wp.array[int],
    dist: wp.array[float],
    margin: wp.array[float],
    frame: wp.array[wp.mat33],
    address: wp.array2d[int],
    weight: wp.array2d[float],
) -> None:
    """Takes the weight from the rows of the contacts that move."""
    i = wp.tid()
    if i >= contacts[0] or margin[i] >= 0.0 or dist[i] > margin[i]:
        return
    if geoms[i][0] < 0 or geoms[i][1] < 0:
        return
    w = world_of[i]
    h = timestep[w % timestep.shape[0]]
    g = gravity[w % gravity.shape[0]]
    if weightless == 1:
        g = wp.vec3(0.0)
    pressing = resting_gravity(g, pressing_gravity)
    rate = float(0.0)
    for side in range(2):
        x = bodies.of_geom[geoms[i][side]]
        if x < 0:
            return
        kind = bodies.kind[x]
        q = of_joint(qpos, w, bodies.qposadr[x], kind) - bodies.zero[x]
        v = of_joint(qvel, w, bodies.dofadr[x], kind)
        u = to_world(bodies, x, displacement(bodies, x, q), v)
        n = wp.vec3(frame[i][0, 0], frame[i][0, 1], frame[i][0, 2])
        rate += float(2 * side - 1) * wp.dot(n, u)
    if wp.abs(rate) > carried_rest_speed(h, pressing, dist[i]):
        for j in range(address.shape[1]):
            if address[i, j] >= 0:
                weight[w, address[i, j]] = 0.0
