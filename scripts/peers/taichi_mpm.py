"""The step in Taichi: node records {mass, momentum} in blocks of 4 nodes along each axis, fast math. Particles to grid runs on one thread, the rest on
all: atomic additions of floating-point numbers are so slow on a CPU that two threads with them took four to five times as long as one without."""
import itertools

import numpy as np
from scene import main


def load(threads):
    import taichi as ti

    class Peer:
        def __init__(self, scene, threads):
            real = {np.float32: ti.f32, np.float64: ti.f64}[scene.type]
            ti.init(arch=ti.cpu, cpu_max_num_threads=threads, default_fp=real, fast_math=True, offline_cache=False, log_level=ti.WARN)
            self.scene, self.step = scene, make_step(ti, scene, real)

        def run(self, steps):
            for _ in range(steps):
                self.step.take()
            self.step.ti.sync()

        def state(self):
            s = self.step
            return s.x.to_numpy().astype(float), s.v.to_numpy().astype(float), self.scene.density / s.J.to_numpy().astype(float)

    return Peer, ti.__version__ if isinstance(ti.__version__, str) else ".".join(map(str, ti.__version__))


def make_step(ti, scene, real):
    dim, n = scene.dim, scene.count
    dx, dt, inv_dx = scene.dx, scene.dt, 1 / scene.dx
    mass, volume0, rho0, c2, g = scene.mass, scene.mass / scene.density, scene.density, scene.sound_speed**2, scene.gravity
    stencil = list(itertools.product(range(3), repeat=dim))
    vector, matrix, record = ti.types.vector(dim, real), ti.types.matrix(dim, dim, real), ti.types.vector(dim + 1, real)

    @ti.data_oriented
    class Step:
        def __init__(self):
            self.ti = ti
            self.x, self.v, self.C, self.J = vector.field(shape=n), vector.field(shape=n), matrix.field(shape=n), ti.field(real, shape=n)
            self.grid = record.field()
            axes, blocks = {2: ti.ij, 3: ti.ijk}[dim], [(m + 3) // 4 for m in scene.nodes]
            ti.root.dense(axes, blocks).dense(axes, [4] * dim).place(self.grid)
            self.x.from_numpy(scene.position.astype(scene.type)), self.v.from_numpy(scene.velocity.astype(scene.type))
            self.J.fill(1.0)

        def take(self):
            self.scatter()
            self.gather()

        @ti.kernel
        def scatter(self):
            for I in ti.grouped(self.grid):
                self.grid[I] = record(0)
            ti.loop_config(serialize=True)
            for p in self.x:
                at = self.x[p] * inv_dx
                base = ti.cast(at - 0.5, ti.i32)
                f = at - ti.cast(base, real)
                w = [0.5 * (1.5 - f) ** 2, 0.75 - (f - 1) ** 2, 0.5 * (f - 0.5) ** 2]
                pressure = c2 * (rho0 / self.J[p] - rho0)
                affine = mass * self.C[p] + ti.Matrix.identity(real, dim) * (dt * volume0 * self.J[p] * pressure * 4 * inv_dx * inv_dx)
                momentum = mass * self.v[p]
                for o in ti.static(stencil):
                    offset = vector([ti.cast(o[d], real) for d in ti.static(range(dim))])
                    weight = ti.cast(1.0, real)
                    for d in ti.static(range(dim)):
                        weight *= w[o[d]][d]
                    q = momentum + affine @ ((offset - f) * dx)
                    out = record(0)
                    for d in ti.static(range(dim)):
                        out[d] = weight * q[d]
                    out[dim] = weight * mass
                    self.grid[base + ti.Vector(o)] = self.grid[base + ti.Vector(o)] + out  # `+=` would be atomic

        @ti.kernel
        def gather(self):
            for I in ti.grouped(self.grid):
                node = self.grid[I]
                if node[dim] > 0:
                    inverse = 1 / node[dim]
                    for d in ti.static(range(dim)):
                        node[d] *= inverse
                    node[dim - 1] += dt * g
                    self.grid[I] = node
            for p in self.x:
                at = self.x[p] * inv_dx
                base = ti.cast(at - 0.5, ti.i32)
                f = at - ti.cast(base, real)
                w = [0.5 * (1.5 - f) ** 2, 0.75 - (f - 1) ** 2, 0.5 * (f - 0.5) ** 2]
                v, C = vector(0), matrix(0)
                for o in ti.static(stencil):
                    offset = vector([ti.cast(o[d], real) for d in ti.static(range(dim))])
                    weight = ti.cast(1.0, real)
                    for d in ti.static(range(dim)):
                        weight *= w[o[d]][d]
                    node = self.grid[base + ti.Vector(o)]
                    nv = vector([node[d] for d in ti.static(range(dim))])
                    v += weight * nv
                    C += (4 * inv_dx * weight) * nv.outer_product(offset - f)
                self.v[p], self.C[p] = v, C
                self.x[p] += dt * v
                self.J[p] *= 1 + dt * C.trace()

    return Step()


if __name__ == "__main__":
    main("Taichi", load)
