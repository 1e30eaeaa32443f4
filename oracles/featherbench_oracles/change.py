"""The change from neutral coordinates to an engine's."""

from __future__ import annotations

from dataclasses import dataclass

from featherbench_oracles.algebra import Array


@dataclass(frozen=True)
class Change:
    """The change from neutral to engine (e) coordinates at one state: v_e = T v, hence a_e = T a + b with b = (dT/dt) v.

    T is block diagonal and every block is orthogonal, so power is kept by tau_e = T^-T tau = T tau, and everything returns by T':
    tau = T' tau_e, M = T' M_e T, h = T' (h_e + M_e b), J = J_e T.

    Attributes
    ----------
    blocks : tuple of (slice, ndarray)
        The blocks of T that are not identity, each with its range in v; a range of n dofs has a block of shape (n, n), without unit.
    b : ndarray, shape (nv,)
        The engine's acceleration where ours is zero, m/s² or rad/s².
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
        """Bring velocities to the engine: v_e = T v, shape (nv,), m/s or rad/s."""
        return self._forth(v)

    def to_engine_a(self, a: Array) -> Array:
        """Bring accelerations to the engine: a_e = T a + b, shape (nv,), m/s² or rad/s²."""
        return self._forth(a) + self.b

    def to_neutral_a(self, a_e: Array) -> Array:
        """Bring accelerations back: a = T' (a_e - b), shape (nv,), m/s² or rad/s²."""
        return self._back(a_e - self.b)

    def to_engine_tau(self, tau: Array) -> Array:
        """Bring forces to the engine: tau_e = T tau, shape (nv,), N or N m."""
        return self._forth(tau)

    def to_neutral_tau(self, tau_e: Array) -> Array:
        """Bring forces back: tau = T' tau_e, shape (nv,), N or N m."""
        return self._back(tau_e)

    def to_neutral_mass(self, mass_e: Array) -> Array:
        """Bring a symmetric mass matrix back: M = T' M_e T, shape (nv, nv), kg, kg m or kg m²."""
        return self._back(self._back(mass_e).T)

    def to_neutral_jacobian(self, jacobian_e: Array) -> Array:
        """Bring a Jacobian back: J = J_e T, shape (6, nv), m or without unit."""
        return self._back(jacobian_e.T).T
