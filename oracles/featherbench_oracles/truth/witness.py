"""The equations of motion of a robot in multi-precision, and the witness that answers by them."""

from __future__ import annotations

import mpmath
from mpmath import mp, mpf

from featherbench_oracles.core.algebra import Array
from featherbench_oracles.core.protocol import Quantities, State, readback_row
from featherbench_oracles.core.robot import Description
from featherbench_oracles.truth.links import PARTS, Link, pseudo_inertia
from featherbench_oracles.truth.matrices import (
    ONE,
    UNIT,
    ZERO,
    Number,
    Rows,
    exact,
    inner,
    inverse_pose,
    nearest_rotation,
    plus,
    product,
    times_transposed,
    with_bottom,
)

STANDARD_BITS = 448


def bits_for(nv: int) -> int:
    """Choose enough bits for n degrees of freedom in a chain, whose mass matrix has a condition of n^4, with much to spare for bad masses.

    Parameters
    ----------
    nv : int
        Degrees of freedom.

    Returns
    -------
    int
        Bits of the mantissa.
    """
    return max(STANDARD_BITS, 106 + 7 * nv)


class Truth:
    """A robot in multi-precision. Lists of numbers are of length nq or nv, in the units of the neutral coordinates.

    Parameters
    ----------
    description : Description
        The robot.
    """

    def __init__(self, description: Description) -> None:
        self.description = description
        self.bits = bits_for(description.nv)
        with mp.workprec(self.bits):
            self.gravity = exact(description.gravity)
            self.armature = [entry for body in description.bodies for entry in exact(body.joint.armature)]
            self.links: list[Link] = []
            last: list[int] = []  # the link that carries each body
            for body in description.bodies:
                joint = body.joint
                rotation = nearest_rotation(joint.rotation)
                placement = [[*row, entry] for row, entry in zip(rotation, exact(joint.translation), strict=True)]
                parent = last[body.parent] if body.parent >= 0 else -1
                own = exact(joint.axis)
                length = mp.sqrt(mp.fdot(own, own)) or ONE
                q, v = joint.q.start, joint.v.start
                parts = PARTS[joint.type]
                for k, (kind, axis, nq, nv) in enumerate(parts):
                    carried = pseudo_inertia(body) if k + 1 == len(parts) else None
                    axis = [entry / length for entry in own] if axis is None else axis
                    self.links.append(Link(parent, placement, kind, axis, mpf(joint.pitch), slice(q, q + nq), slice(v, v + nv), carried))
                    parent, placement, q, v = len(self.links) - 1, [[*row, ZERO] for row in UNIT], q + nq, v + nv
                last.append(parent)

    def readback(self) -> list[Array]:
        """Tell the doubles that were given.

        Returns
        -------
        list of ndarray, shape (22,)
            Of each body a row of `readback_row`.
        """
        rows = []
        for body in self.description.bodies:
            rows.append(readback_row(body.mass, body.com, body.inertia, body.joint.rotation, body.joint.translation))
        return rows

    # ---- the equations

    def poses(self, q: list[Number]) -> tuple[list[Rows], list[Rows]]:
        """Compute T of each link, and U = P A."""
        poses: list[Rows] = []
        steps: list[Rows] = []
        for link in self.links:
            step = product(link.placement, link.displacement(q[link.q]), ONE)
            poses.append(step if link.parent < 0 else product(poses[link.parent], step, ONE))
            steps.append(step)
        return poses, steps

    def directions(self, poses: list[Rows]) -> list[Rows]:
        """Compute D_k = T_j E_k T_j^-1 of each degree of freedom."""
        result = []
        for link, pose in zip(self.links, poses, strict=True):
            back = inverse_pose(pose)
            result += [product(product(pose, e, ZERO), back, ONE) for e in link.generators]
        return result

    def gathered(self, shares: list[Rows | None], shape: tuple[int, int]) -> list[Rows]:
        """Add for each link the shares of all that it carries, itself included."""
        sums = [share if share is not None else [[ZERO] * shape[1] for _ in range(shape[0])] for share in shares]
        for i in reversed(range(len(self.links))):
            parent = self.links[i].parent
            if parent >= 0:
                sums[parent] = plus(sums[parent], sums[i])
        return sums

    def inverse(self, q: list[Number], v: list[Number], a: list[Number]) -> list[Number]:
        """Compute τ.

        Parameters
        ----------
        q : list[Number]
            nq coordinates.
        v : list[Number]
            nv velocities, m/s or rad/s.
        a : list[Number]
            nv accelerations, m/s² or rad/s².

        Returns
        -------
        list of numbers
            nv forces, N or N m.
        """
        poses, steps = self.poses(q)
        still = [[ZERO] * 4 for _ in range(3)]
        rates: list[Rows] = []
        accelerations: list[Rows] = []
        shares: list[Rows | None] = []
        for link, pose, step in zip(self.links, poses, steps, strict=True):
            rate_p, acceleration_p = (rates[link.parent], accelerations[link.parent]) if link.parent >= 0 else (still, still)
            twist = link.twist(v[link.v])
            carried = product(rate_p, step, ONE)
            rates.append(plus(carried, product(pose, twist, ZERO)))
            bend = plus(product(twist, twist, ZERO), link.twist(a[link.v]))
            coriolis = [[2 * entry for entry in row] for row in product(carried, twist, ZERO)]
            accelerations.append(plus(product(acceleration_p, step, ONE), coriolis, product(pose, bend, ZERO)))
            if link.pseudo_inertia is None:
                shares.append(None)
                continue
            # (T̈ - G) J T', three rows by four columns
            relative = [[*row[:3], row[3] - g] for row, g in zip(accelerations[-1], self.gravity, strict=True)]
            shares.append(times_transposed(times_transposed(relative, link.pseudo_inertia), with_bottom(pose)))
        sums = self.gathered(shares, (3, 4))
        carrier = [i for i, link in enumerate(self.links) for _ in link.generators]
        directions = self.directions(poses)
        return [inner(d, sums[j]) + armature * acc for d, j, armature, acc in zip(directions, carrier, self.armature, a, strict=True)]

    def mass(self, q: list[Number]) -> Rows:
        """Compute M, both triangles.

        Parameters
        ----------
        q : list[Number]
            nq coordinates.

        Returns
        -------
        Rows
            nv rows of nv entries, kg, kg m or kg m².
        """
        poses, _ = self.poses(q)
        shares: list[Rows | None] = []
        for link, pose in zip(self.links, poses, strict=True):
            whole = with_bottom(pose)
            j = link.pseudo_inertia
            shares.append(None if j is None else times_transposed(times_transposed(whole, j), whole))
        sums = self.gathered(shares, (4, 4))
        directions = self.directions(poses)
        n = self.description.nv
        mass = [[ZERO] * n for _ in range(n)]
        for i, link in enumerate(self.links):
            for k in range(link.v.start, link.v.stop):
                moved = times_transposed(directions[k], sums[i])
                ancestor, stop = i, k + 1
                while ancestor >= 0:
                    for other in range(self.links[ancestor].v.start, stop if ancestor == i else self.links[ancestor].v.stop):
                        mass[k][other] = mass[other][k] = inner(moved, directions[other])
                    ancestor = self.links[ancestor].parent
        for k in range(n):
            mass[k][k] += self.armature[k]
        return mass

    def forward(self, q: list[Number], v: list[Number], tau: list[Number]) -> list[Number]:
        """Compute M^-1 (τ - h) by Cholesky's factors.

        Parameters
        ----------
        q : list[Number]
            nq coordinates.
        v : list[Number]
            nv velocities, m/s or rad/s.
        tau : list[Number]
            nv forces, N or N m.

        Returns
        -------
        list of numbers
            nv accelerations, m/s² or rad/s².

        Raises
        ------
        ValueError
            If M is not positive definite.
        """
        n = self.description.nv
        mass = self.mass(q)
        bias = self.inverse(q, v, [ZERO] * n)
        lower: Rows = []
        y: list[Number] = []
        for i in range(n):
            row: list[Number] = []
            for j in range(i):
                row.append((mass[i][j] - mp.fdot(row, lower[j][:j])) / lower[j][j])
            pivot = mass[i][i] - mp.fdot(row, row)
            if pivot <= 0:
                raise ValueError(f"the mass matrix is not positive definite at degree of freedom {i}")
            row.append(mp.sqrt(pivot))
            lower.append(row)
            y.append((tau[i] - bias[i] - mp.fdot(row[:i], y)) / row[i])
        for i in reversed(range(n)):
            y[i] = (y[i] - mp.fdot([lower[k][i] for k in range(i + 1, n)], y[i + 1 :])) / lower[i][i]
        return y

    # ---- answers

    def nearest(self, values: list[Number]) -> list[float]:
        """Round to doubles.

        Half of the bits are taken off first, so that the noise of a computation decides no tie and makes no zero.
        """
        settled = self.bits // 2
        noise = mp.ldexp(max((abs(value) for value in values), default=ZERO), -settled)
        with mp.workprec(settled):
            values = [+value if abs(value) > noise else ZERO for value in values]
        with mp.workprec(53):
            return [float(+value) for value in values]

    def id(self, ask: State) -> list[float]:
        """Answer `id`: nv forces, N or N m."""
        with mp.workprec(self.bits):
            return self.nearest(self.inverse(exact(ask.q), exact(ask.v), exact(ask.a)))

    def bias(self, ask: State) -> list[float]:
        """Answer `bias`: nv forces, N or N m."""
        with mp.workprec(self.bits):
            return self.nearest(self.inverse(exact(ask.q), exact(ask.v), [ZERO] * self.description.nv))

    def mass_matrix(self, ask: State) -> list[float]:
        """Answer `mass_matrix`: nv rows of nv entries, one after the other, kg, kg m or kg m²."""
        with mp.workprec(self.bits):
            return self.nearest([entry for row in self.mass(exact(ask.q)) for entry in row])

    def mass_matrix_probe(self, ask: State) -> list[float]:
        """Answer `mass_matrix_probe`: M x for the four rows x of `probe`, the diagonal, the last row, one after the other."""
        with mp.workprec(self.bits):
            mass = self.mass(exact(ask.q))
            rows = [[mp.fdot(row, x) for row in mass] for x in map(exact, ask.probe)]
            rows += [[row[i] for i, row in enumerate(mass)], mass[-1]]
            return [entry for row in rows for entry in self.nearest(row)]

    def fd(self, ask: State) -> list[float]:
        """Answer `fd`: nv accelerations, m/s² or rad/s²."""
        with mp.workprec(self.bits):
            return self.nearest(self.forward(exact(ask.q), exact(ask.v), exact(ask.tau)))


class Witness:
    """The engine: what `session.serve` asks."""

    name = "truth"
    version = f"mpmath-{mpmath.__version__}-{int(STANDARD_BITS * 0.30103)}"
    build = {"language": "Python", "mpmath": mpmath.__version__, "bits": f"max({STANDARD_BITS}, 106 + 7 nv)"}
    quantities: Quantities = {
        "id": {"virtual_work": Truth.id},
        "bias": {"virtual_work": Truth.bias},
        "mass_matrix": {"pseudo_inertia": Truth.mass_matrix},
        "mass_matrix_probe": {"pseudo_inertia": Truth.mass_matrix_probe},
        "fd": {"cholesky": Truth.fd},
    }

    def prepare(self, description: Description) -> Truth:
        """Build the robot."""
        return Truth(description)
