"""The change from neutral coordinates to an engine's (e), and back.

The module `coordinates` of each engine begins with the table of its q_e, T and b. It has two functions:

::

    function              parameter  shape   unit                     result
    to_engine_q           robot                                       q_e of shape (nq of the engine,), by the table
                          q          (nq,)   m, rad or quaternions
    change_of_velocities  robot                                       the `CoordinateChange` at that state: T and b of the table
                          q          (nq,)   m, rad or quaternions
                          v          (nv,)   m/s or rad/s

`robot` is the `Description`; q and v are neutral.
"""

from __future__ import annotations

from dataclasses import dataclass

from featherbench_oracles.core.algebra import Array


@dataclass(frozen=True)
class CoordinateChange:
    """The change from neutral to engine (e) coordinates at one state.

    ::

        v_e = T v      a_e = T a + b, b = (dT/dt) v      tau_e = T tau
        a = T' (a_e - b)      tau = T' tau_e      M = T' M_e T      h = T' (h_e + M_e b)      J = J_e T

    T is block diagonal and every block is orthogonal. So T^-1 = T', and tau' v = tau_e' v_e.

    Attributes
    ----------
    blocks : tuple of (slice, ndarray)
        The blocks of T that are not identity, each with its range in v. A range of n dofs has a block of shape (n, n), without unit.
    b : ndarray, shape (nv,)
        The engine's acceleration where the neutral one is zero, m/s² or rad/s².
    """

    blocks: tuple[tuple[slice, Array], ...]
    b: Array

    def _forth(self, x: Array) -> Array:
        y = x.copy()
        for s, t in self.blocks:
            y[s] = t @ x[s]
        return y

    def _back(self, x: Array) -> Array:
        y = x.copy()
        for s, t in self.blocks:
            y[s] = t.T @ x[s]
        return y

    def to_engine_v(self, v: Array) -> Array:
        """Convert velocities to the engine's: v_e = T v, shape (nv,), m/s or rad/s."""
        return self._forth(v)

    def to_engine_a(self, a: Array) -> Array:
        """Convert accelerations to the engine's: a_e = T a + b, shape (nv,), m/s² or rad/s²."""
        return self._forth(a) + self.b

    def to_neutral_a(self, a_e: Array) -> Array:
        """Convert accelerations back: a = T' (a_e - b), shape (nv,), m/s² or rad/s²."""
        return self._back(a_e - self.b)

    def to_engine_tau(self, tau: Array) -> Array:
        """Convert forces to the engine's: tau_e = T tau, shape (nv,), N or N m."""
        return self._forth(tau)

    def to_neutral_tau(self, tau_e: Array) -> Array:
        """Convert forces back: tau = T' tau_e, shape (nv,), N or N m."""
        return self._back(tau_e)

    def to_neutral_mass(self, mass_e: Array) -> Array:
        """Convert a symmetric mass matrix back: M = T' M_e T, shape (nv, nv), kg, kg m or kg m²."""
        return self._back(self._back(mass_e).T)

    def to_neutral_jacobian(self, jacobian_e: Array) -> Array:
        """Convert a Jacobian back: J = J_e T, shape (6, nv), m or without unit."""
        return self._back(jacobian_e.T).T
