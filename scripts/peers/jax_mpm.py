"""The step in JAX: all nodes of all stencils at once, particles to grid by one scatter-add, many steps in one compiled loop; and its gradient by
jax.grad through a scan whose steps are recomputed on the way back."""
import functools
import itertools

import numpy as np
from scene import main


def load(threads):
    import jax

    jax.config.update("jax_enable_x64", True)  # arrays keep the type they are given

    class Peer:
        def __init__(self, scene, threads):
            import jax.numpy as jnp

            self.scene, self.jax = scene, jax
            n, dim = scene.count, scene.dim
            self.s = (jnp.asarray(scene.position.astype(scene.type)), jnp.asarray(scene.velocity.astype(scene.type)),
                      jnp.zeros((n, dim, dim), scene.type), jnp.ones(n, scene.type))
            self.step = make_step(jnp, scene)
            self.loop = jax.jit(lambda state, steps: jax.lax.fori_loop(0, steps, lambda _, s: self.step(s), state))

        def run(self, steps):
            self.s = self.jax.block_until_ready(self.loop(self.s, steps))

        def state(self):
            x, v, _, J = (np.asarray(a, dtype=float) for a in self.s)
            return x, v, self.scene.density / J

        def gradient(self, steps):
            """Half the sum of squares of the final positions, by the initial velocities."""
            jax = self.jax

            @functools.partial(jax.jit, static_argnums=2)
            def value(v, s, steps):
                step = jax.checkpoint(lambda s, _: (self.step(s), None))
                (x, *_), _ = jax.lax.scan(step, (s[0], v, s[2], s[3]), None, length=steps)
                return 0.5 * (x * x).sum()

            return lambda: jax.block_until_ready(jax.jit(jax.grad(value), static_argnums=2)(self.s[1], self.s, steps))

    return Peer, jax.__version__


def make_step(jnp, scene):
    real, dim, dx, dt = scene.type, scene.dim, scene.type(scene.dx), scene.type(scene.dt)
    inv_dx, mass, volume0 = real(1 / scene.dx), real(scene.mass), real(scene.mass / scene.density)
    rho0, c2, four = real(scene.density), real(scene.sound_speed**2), real(4)
    offsets = jnp.asarray(list(itertools.product(range(3), repeat=dim)), dtype=jnp.int32)
    strides = jnp.asarray([int(np.prod(scene.nodes[d + 1:])) for d in range(dim)], dtype=jnp.int32)
    fall = jnp.zeros(dim, real).at[dim - 1].set(real(scene.dt * scene.gravity))
    nodes, identity = int(np.prod(scene.nodes)), jnp.eye(dim, dtype=real)

    def step(state):
        x, v, C, J = state
        at = x * inv_dx
        base = (at - real(0.5)).astype(jnp.int32)
        f = at - base.astype(real)
        w = jnp.stack([real(0.5) * (real(1.5) - f) ** 2, real(0.75) - (f - 1) ** 2, real(0.5) * (f - real(0.5)) ** 2], axis=1)
        weight = functools.reduce(lambda a, b: a * b, [w[:, offsets[:, d], d] for d in range(dim)])  # (N, nodes of a stencil)
        index = ((base[:, None, :] + offsets) * strides).sum(axis=-1)
        away = offsets.astype(real) - f[:, None, :]
        pressure = c2 * (rho0 / J - rho0)
        affine = mass * C + (dt * volume0 * four * inv_dx * inv_dx * J * pressure)[:, None, None] * identity
        momentum = weight[..., None] * (mass * v[:, None, :] + jnp.einsum("pij,pnj->pni", affine, away * dx))
        record = jnp.concatenate([momentum, mass * weight[..., None]], axis=-1)
        grid = jnp.zeros((nodes, dim + 1), real).at[index].add(record)
        velocity = jnp.where(grid[:, dim:] > 0, grid[:, :dim] / jnp.where(grid[:, dim:] > 0, grid[:, dim:], 1) + fall, 0)
        seen = weight[..., None] * velocity[index]
        v = seen.sum(axis=1)
        C = four * inv_dx * jnp.einsum("pni,pnj->pij", seen, away)
        return x + dt * v, v, C, J * (1 + dt * jnp.trace(C, axis1=1, axis2=2))

    return step


if __name__ == "__main__":
    main("JAX", load)
