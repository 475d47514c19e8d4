"""The step in Warp: particles to grid by atomic additions on node records, one kernel for each phase. On a CPU Warp runs a kernel on one thread."""
import numpy as np
from scene import main


def load(threads):
    import warp as wp

    wp.config.quiet = True
    wp.config.max_unroll = 27  # the loops over a stencil
    wp.init()

    class Peer:
        def __init__(self, scene, threads):
            real = {np.float32: wp.float32, np.float64: wp.float64}[scene.type]
            self.wp, self.scene, n = wp, scene, scene.count
            self.vector, matrix = wp.types.vector(scene.dim, real), wp.types.matrix((scene.dim, scene.dim), real)
            self.x = wp.array(scene.position.astype(scene.type), dtype=self.vector, device="cpu")
            self.v = wp.array(scene.velocity.astype(scene.type), dtype=self.vector, device="cpu")
            self.C, self.J = wp.zeros(n, dtype=matrix, device="cpu"), wp.array(np.ones(n, scene.type), dtype=real, device="cpu")
            self.record = wp.types.vector(scene.dim + 1, real)
            self.grid = wp.zeros(int(np.prod(scene.nodes)), dtype=self.record, device="cpu")
            self.kernels = make_kernels(wp, scene, real, self.vector, matrix, self.record)

        def run(self, steps):
            wp, (p2g, update, g2p) = self.wp, self.kernels
            for _ in range(steps):
                self.grid.zero_()
                wp.launch(p2g, self.scene.count, inputs=[self.x, self.v, self.C, self.J, self.grid], device="cpu")
                wp.launch(update, len(self.grid), inputs=[self.grid], device="cpu")
                wp.launch(g2p, self.scene.count, inputs=[self.x, self.v, self.C, self.J, self.grid], device="cpu")

        def state(self):
            return self.x.numpy().astype(float), self.v.numpy().astype(float), self.scene.density / self.J.numpy().astype(float)

    return Peer, wp.config.version


def make_kernels(wp, scene, real, vector, matrix, record):
    dim = scene.dim
    strides = [int(np.prod(scene.nodes[d + 1:])) for d in range(dim)]
    weights = wp.types.matrix((dim, 3), real)
    whole = wp.types.vector(dim, wp.int32)
    stride = whole(*strides)
    inv_dx, dx, dt = real(1 / scene.dx), real(scene.dx), real(scene.dt)
    mass, volume0, rho0, c2, g = (real(a) for a in (scene.mass, scene.mass / scene.density, scene.density, scene.sound_speed**2, scene.gravity))
    half, one, three_quarters, one_and_half, four = real(0.5), real(1), real(0.75), real(1.5), real(4)
    nodes = 3**dim
    axes, last = wp.constant(dim), wp.constant(dim)
    count = wp.constant(nodes)

    @wp.func
    def place(at: vector, base: whole):
        """Weights of the stencil along each axis."""
        w = weights()
        for d in range(axes):
            f = at[d] - real(base[d])
            w[d, 0] = half * (one_and_half - f) * (one_and_half - f)
            w[d, 1] = three_quarters - (f - one) * (f - one)
            w[d, 2] = half * (f - half) * (f - half)
        return w

    @wp.func
    def first_node(at: vector):
        base = whole()
        for d in range(axes):
            base[d] = wp.int32(at[d] - half)
        return base

    @wp.kernel(module="unique")
    def p2g(x: wp.array(dtype=vector), v: wp.array(dtype=vector), C: wp.array(dtype=matrix), J: wp.array(dtype=real), grid: wp.array(dtype=record)):
        p = wp.tid()
        at = x[p] * inv_dx
        base = first_node(at)
        w = place(at, base)
        pressure = c2 * (rho0 / J[p] - rho0)
        affine = mass * C[p] + wp.identity(n=dim, dtype=real) * (dt * volume0 * J[p] * pressure * four * inv_dx * inv_dx)
        momentum = mass * v[p]
        for o in range(count):
            rest, index, weight, offset = o, int(0), one, vector()
            for a in range(axes):
                d = axes - 1 - a
                k = rest % 3
                rest = rest // 3
                index += (base[d] + k) * stride[d]
                weight *= w[d, k]
                offset[d] = (real(base[d] + k) - at[d]) * dx
            q = momentum + affine * offset
            out = record()
            for d in range(axes):
                out[d] = weight * q[d]
            out[last] = weight * mass
            wp.atomic_add(grid, index, out)

    @wp.kernel(module="unique")
    def update(grid: wp.array(dtype=record)):
        i = wp.tid()
        node = grid[i]
        if node[last] > real(0):
            inverse = one / node[last]
            for d in range(axes):
                node[d] = node[d] * inverse
            node[last - 1] = node[last - 1] + dt * g
            grid[i] = node

    @wp.kernel(module="unique")
    def g2p(x: wp.array(dtype=vector), v: wp.array(dtype=vector), C: wp.array(dtype=matrix), J: wp.array(dtype=real), grid: wp.array(dtype=record)):
        p = wp.tid()
        at = x[p] * inv_dx
        base = first_node(at)
        w = place(at, base)
        velocity = vector()
        affine = matrix()
        for o in range(count):
            rest, index, weight, offset = o, int(0), one, vector()
            for a in range(axes):
                d = axes - 1 - a
                k = rest % 3
                rest = rest // 3
                index += (base[d] + k) * stride[d]
                weight *= w[d, k]
                offset[d] = real(base[d] + k) - at[d]
            node = grid[index]
            nv = vector()
            for d in range(axes):
                nv[d] = node[d]
            velocity += weight * nv
            affine += (four * inv_dx * weight) * wp.outer(nv, offset)
        v[p] = velocity
        C[p] = affine
        x[p] = x[p] + dt * velocity
        J[p] = J[p] * (one + dt * wp.trace(affine))

    return p2g, update, g2p


if __name__ == "__main__":
    main("Warp", load)
