"""The witness: rigid-body dynamics in multi-precision by 4x4 matrices, written from the equations of motion and from no engine.

A body's pose is a matrix T, its mass distribution the pseudo-inertia J = ∫ x x' dm of homogeneous points x = (x, y, z, 1), and d'Alembert's
principle for all points of a body is one trace:

    T = T_p U,  U = P A(q)                     P: the joint's placement, A: its displacement, A' = A V with V = Σ E_k v_k
    Ṫ = Ṫ_p U + T V
    T̈ = T̈_p U + 2 Ṫ_p U V + T (V² + V̇)         V̇ = Σ E_k a_k
    τ_k = tr(D_k Σ_b T J (T̈ - G)') + A_k a_k   D_k = T_j E_k T_j^-1, G = (0 | g), b: the bodies that joint j carries, A_k: armature
    M_kl = tr(D_k (Σ_b T J T') D_l') + A_k δ_kl

(Uicker 1967; Hollerbach 1980.) E_k are constant matrices of se(3), because planar and universal joints are written as two or three simple
ones. There are no angular velocities, cross products, Jacobians or inertia tensors; forward dynamics solves with Cholesky's factors of M.

Numbers carry max(448, 106 + 7 n) bits, and answers are the nearest doubles. All of the description's doubles are taken exactly, but where
they stand for a direction or a rotation the nearest one is meant: u / |u| for axes, p / |p| for quaternions, the orthogonal polar factor
for placements' rotations. The question has no answer beyond 1e-16 otherwise.

Started as `python -m featherbench_oracles.truth` it is an oracle (PROTOCOL.md). With `--decimals`, each line {"model", "q", "v", "a",
"tau", "digits"} of the standard input is answered by a line {"id", "bias", "fd", "mass_matrix"} of decimal numbers.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import mpmath
from mpmath import mp, mpf

from featherbench_oracles.algebra import Array
from featherbench_oracles.protocol import Quantities, State, readback_row
from featherbench_oracles.robot import Body, Description
from featherbench_oracles.session import serve

Number = Any  # an mpf: mpmath has no types
Rows = list[list[Number]]  # the first three rows of a 4x4 matrix, or a 4x4 matrix
STANDARD_BITS = 448

ZERO, ONE = mpf(0), mpf(1)


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


# ---- 4x4 matrices ----------------------------------------------------------------------------------------------------------------
# A pose has the last row (0, 0, 0, 1), its derivatives and the matrices of se(3) have (0, 0, 0, 0): only three rows are kept.


def product(a: Rows, b: Rows, bottom: Number) -> Rows:
    """Multiply 4x4 matrices of which three rows are kept.

    Parameters
    ----------
    a : Rows
        Three rows.
    b : Rows
        Three rows.
    bottom : Number
        The last entry of b's last row.

    Returns
    -------
    Rows
        Three rows of a b.
    """
    columns = [[row[j] for row in b] for j in range(4)]
    rows = [[mp.fdot(row[:3], column) for column in columns] for row in a]
    if bottom:
        for result, row in zip(rows, a, strict=True):
            result[3] += row[3]
    return rows


def plus(*terms: Rows) -> Rows:
    """Add matrices of one shape."""
    return [[mp.fsum(entries) for entries in zip(*rows, strict=True)] for rows in zip(*terms, strict=True)]


def times_transposed(a: Rows, b: Rows) -> Rows:
    """Multiply a b' of matrices of four columns."""
    return [[mp.fdot(row, other) for other in b] for row in a]


def inner(a: Rows, b: Rows) -> Number:
    """Compute tr(a b') of matrices of one shape."""
    return mp.fsum(mp.fdot(row, other) for row, other in zip(a, b, strict=True))


def inverse_pose(t: Rows) -> Rows:
    """Invert a pose: T^-1 = (R', -R' p)."""
    rotated = [[t[i][j] for i in range(3)] for j in range(3)]
    return [[*row, -mp.fdot(row, [t[i][3] for i in range(3)])] for row in rotated]


def with_bottom(t: Rows) -> Rows:
    """Append a pose's fourth row."""
    return [*t, [ZERO, ZERO, ZERO, ONE]]


def generator(angular: list[Number], linear: list[Number]) -> Rows:
    """Make the matrix of se(3): x -> angular × x + linear.

    Parameters
    ----------
    angular : list[Number]
        Three numbers.
    linear : list[Number]
        Three numbers, m.

    Returns
    -------
    Rows
        Three rows of four.
    """
    x, y, z = angular
    return [[ZERO, -z, y, linear[0]], [z, ZERO, -x, linear[1]], [-y, x, ZERO, linear[2]]]


# ---- simple joints ---------------------------------------------------------------------------------------------------------------

NULL = [ZERO] * 3
UNIT = [[ONE if i == j else ZERO for j in range(3)] for i in range(3)]


def screw(axis: list[Number], angle: Number, shift: list[Number]) -> Rows:
    """Compute exp of the angle times the axis' matrix, by Rodrigues' formula 1 + sin K + (1 - cos) K²; then the shift.

    Parameters
    ----------
    axis : list[Number]
        A unit vector.
    angle : Number
        In rad.
    shift : list[Number]
        Three numbers, m.

    Returns
    -------
    Rows
        The pose.
    """
    k = [row[:3] for row in generator(axis, NULL)]
    square = [[mp.fdot(row, column) for column in zip(*k, strict=True)] for row in k]
    sin, versed = mp.sin(angle), 2 * mp.sin(angle / 2) ** 2
    turn = [[UNIT[i][j] + sin * k[i][j] + versed * square[i][j] for j in range(3)] for i in range(3)]
    return [[*row, entry] for row, entry in zip(turn, shift, strict=True)]


def from_quaternion(q: list[Number], position: list[Number]) -> Rows:
    """Make the pose of a quaternion, normalised: R x is the vector part of q x q*.

    Parameters
    ----------
    q : list[Number]
        (x, y, z, w), of any length but 0.
    position : list[Number]
        Three numbers, m.

    Returns
    -------
    Rows
        The pose.
    """
    length = mp.sqrt(mp.fdot(q, q))
    x, y, z, w = (entry / length for entry in q)

    def turned(v: list[Number], s: Number) -> list[Number]:
        """W v + s u + u × v, the vector part of q (v, s), and with the other sign of s that of (v, s) q*."""
        return [w * v[0] + s * x + y * v[2] - z * v[1], w * v[1] + s * y + z * v[0] - x * v[2], w * v[2] + s * z + x * v[1] - y * v[0]]

    # (v, s) = q (e, 0) has s = -u·e; then (v, s) q* has the vector part w v - s u + u × v.
    columns = [turned(turned(e, ZERO), mp.fdot(e, (x, y, z))) for e in UNIT]
    return [[*(column[i] for column in columns), position[i]] for i in range(3)]


@dataclass
class Link:
    """A simple joint and what it carries: a body, or nothing between the parts of a composed joint.

    Attributes
    ----------
    parent : int
        The index of the link before, or -1.
    placement : rows of a 4x4 matrix
        P, lengths in m.
    kind : str
        `turn`, `slide`, `screw`, `ball` or `free`.
    axis : list of 3 numbers
        A unit vector in the joint's frame.
    pitch : number
        Metres per radian.
    q, v : slice
        Its ranges in the neutral coordinates.
    pseudo_inertia : 4x4 matrix, optional
        J of the body, kg, kg m and kg m².
    generators : list of rows of 4x4 matrices
        E_k of each degree of freedom.
    """

    parent: int
    placement: Rows
    kind: str
    axis: list[Number]
    pitch: Number
    q: slice
    v: slice
    pseudo_inertia: Rows | None
    generators: list[Rows] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Make the constant matrices E_k."""
        along = [self.pitch * entry for entry in self.axis]
        generators: dict[str, Callable[[], list[Rows]]] = {
            "turn": lambda: [generator(self.axis, NULL)],
            "slide": lambda: [generator(NULL, self.axis)],
            "screw": lambda: [generator(self.axis, along)],
            "ball": lambda: [generator(e, NULL) for e in UNIT],
            "free": lambda: [*(generator(NULL, e) for e in UNIT), *(generator(e, NULL) for e in UNIT)],
        }
        self.generators = generators[self.kind]()

    def displacement(self, q: list[Number]) -> Rows:
        """Compute A(q) at the link's own coordinates."""
        if self.kind == "ball":
            return from_quaternion(q, NULL)
        if self.kind == "free":
            return from_quaternion(q[3:], q[:3])
        lead = {"turn": ZERO, "slide": ONE, "screw": self.pitch}[self.kind]
        return screw(self.axis, ZERO if self.kind == "slide" else q[0], [lead * q[0] * entry for entry in self.axis])

    def twist(self, rates: list[Number]) -> Rows:
        """Compute V = Σ E_k rate_k at the link's own rates."""
        return plus(*([[rate * entry for entry in row] for row in e] for e, rate in zip(self.generators, rates, strict=True)))


# joint type -> its simple joints: kind, axis (None: the joint's own), numbers of q, numbers of v
PARTS: dict[str, list[tuple[str, list[Number] | None, int, int]]] = {
    "revolute": [("turn", None, 1, 1)],
    "prismatic": [("slide", None, 1, 1)],
    "helical": [("screw", None, 1, 1)],
    "spherical": [("ball", UNIT[0], 4, 3)],
    "free": [("free", UNIT[0], 7, 6)],
    "planar": [("slide", UNIT[0], 1, 1), ("slide", UNIT[1], 1, 1), ("turn", UNIT[2], 1, 1)],
    "universal": [("turn", UNIT[0], 1, 1), ("turn", UNIT[1], 1, 1)],
    "translation": [("slide", UNIT[0], 1, 1), ("slide", UNIT[1], 1, 1), ("slide", UNIT[2], 1, 1)],
    "cylindrical": [("turn", None, 1, 1), ("slide", None, 1, 1)],
    "euler_zyx": [("turn", UNIT[2], 1, 1), ("turn", UNIT[1], 1, 1), ("turn", UNIT[0], 1, 1)],
}


# ---- the robot -------------------------------------------------------------------------------------------------------------------


def exact(values: Array) -> list[Number]:
    """Take doubles as they are."""
    return [mpf(float(value)) for value in values]


def nearest_rotation(matrix: Array) -> Rows:
    """Find the orthogonal polar factor by R <- R (3 - R'R) / 2, until nothing changes that counts.

    Parameters
    ----------
    matrix : ndarray, shape (3, 3)
        Nearly a rotation.

    Returns
    -------
    Rows
        Three rows of three.
    """
    r = [exact(row) for row in matrix]
    while True:
        columns = list(zip(*r, strict=True))
        gram = [[mp.fdot(a, b) for b in columns] for a in columns]
        correction = [[((3 if i == j else 0) - gram[i][j]) / 2 for j in range(3)] for i in range(3)]
        r = [[mp.fdot(row, column) for column in zip(*correction, strict=True)] for row in r]
        if max(abs(gram[i][j] - UNIT[i][j]) for i in range(3) for j in range(3)) < mp.ldexp(1, -(2 * mp.prec) // 3):
            return r


def pseudo_inertia(body: Body) -> Rows:
    """Compute ∫ x x' dm in body axes: second moments about the origin, first moments, mass.

    Parameters
    ----------
    body : Body
        The body.

    Returns
    -------
    Rows
        A 4x4 matrix in kg m², kg m and kg.
    """
    mass, com = mpf(body.mass), exact(body.com)
    inertia = [exact(row) for row in body.inertia]
    half_trace = (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 2
    second = [[half_trace * UNIT[i][j] - inertia[i][j] + mass * com[i] * com[j] for j in range(3)] for i in range(3)]
    first = [mass * entry for entry in com]
    return [*([*row, entry] for row, entry in zip(second, first, strict=True)), [*first, mass]]


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


def decimals() -> None:
    """Answer questions on the standard input with decimal numbers, line by line."""
    for line in sys.stdin:
        question = json.loads(line)
        truth = Truth(Description.read(question["model"]))
        with mp.workprec(truth.bits):
            q, v, a, tau = (exact(question[key]) for key in ("q", "v", "a", "tau"))
            values = {
                "id": truth.inverse(q, v, a),
                "bias": truth.inverse(q, v, [ZERO] * len(v)),
                "fd": truth.forward(q, v, tau),
                "mass_matrix": [entry for row in truth.mass(q) for entry in row],
            }
            answer = {key: [mp.nstr(value, question["digits"]) for value in numbers] for key, numbers in values.items()}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["--decimals"]:
        decimals()
    else:
        serve(Witness())
