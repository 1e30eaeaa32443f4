"""Derivatives of the dynamics: from an engine's coordinates (e) to neutral ones. This module depends on no engine.

The derivative by dof k of q is along the tangent of the configurations: q moves as the velocity v = e_k moves it, and the numbers in v,
a and tau stay. An engine answers the same in its own coordinates: along v_e = e_k, with the numbers in v_e, a_e and tau_e fixed. With T
and b of `change`, and their own derivatives (`Rates`), the chain rule gives

::

    d_k v_e = T_k v      d_k a_e = T_k a + b_k      d_k tau_e = T_k tau      T_k = d_k T, b_k = d_k b
    d_k tau = T_k' tau_e + T' (dID_e/dq_e T e_k + dID_e/dv_e T_k v + M_e (T_k a + b_k))
    d_k a   = T' (dFD_e/dq_e T e_k + dFD_e/dv_e T_k v + M_e^-1 T_k tau - b_k - T_k a)

The derivatives by v have T and db/dv instead. As T is orthogonal, T_k' is the derivative of T^-1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from featherbench_oracles.core.algebra import Array, skew
from featherbench_oracles.core.change import CoordinateChange
from featherbench_oracles.core.protocol import State


@dataclass(frozen=True)
class Rates:
    """The derivatives of one joint's T and b at a state.

    Attributes
    ----------
    dofs : slice
        The joint's n dofs.
    t_dq : ndarray, shape (n, n, n)
        T_k for each of its dofs k, per rad or m.
    b_dq, b_dv : ndarray, shape (n, n)
        The derivatives of b by its dofs, column after column, with v and with q fixed.
    """

    dofs: slice
    t_dq: Array
    b_dq: Array
    b_dv: Array


def of_turned_free(dofs: slice, r: Array, v: Array, order: Array) -> Rates:
    """Differentiate T = order diag(R, S) and b = order [R (ω × v); 0], with S = R or identity, of a free joint.

    Parameters
    ----------
    dofs : slice
        The joint's six dofs.
    r : ndarray, shape (3, 3)
        R, from body axes to those of the engine's linear velocity. A turn by dof 3 + k changes it by R [e_k]x.
    v : ndarray, shape (6,)
        The neutral velocity [linear; angular], m/s and rad/s.
    order : ndarray, shape (6, 6)
        What follows: identity where the engine's angular velocity stays in body axes; the exchange of the halves where R turns it too.

    Returns
    -------
    Rates
        The derivatives of T and b.
    """
    linear, angular = v[:3], v[3:]
    both = not np.array_equal(order, np.eye(6))
    t_dq, b_dq, b_dv = np.zeros((6, 6, 6)), np.zeros((6, 6)), np.zeros((6, 6))
    for k, unit in enumerate(np.eye(3)):
        turned = r @ skew(unit)
        t_dq[3 + k, :3, :3] = turned
        if both:
            t_dq[3 + k, 3:, 3:] = turned
        b_dq[:3, 3 + k] = turned @ np.cross(angular, linear)
    b_dv[:3, :3], b_dv[:3, 3:] = r @ skew(angular), -r @ skew(linear)
    return Rates(dofs, order @ t_dq, order @ b_dq, order @ b_dv)


def of_turned_ball(dofs: slice, r: Array) -> Rates:
    """Differentiate T = R and b = 0 of a spherical joint, R being its rotation of shape (3, 3)."""
    zero = np.zeros((3, 3))
    return Rates(dofs, np.array([r @ skew(unit) for unit in np.eye(3)]), zero, zero)


@dataclass(frozen=True)
class Differentiated:
    """The derivatives of an engine at one state, and the way back to neutral ones.

    Attributes
    ----------
    change : CoordinateChange
        T and b.
    rates : tuple of Rates
        The derivatives of those blocks of T and b that depend on q.
    """

    change: CoordinateChange
    rates: tuple[Rates, ...]

    def id_dq(self, state: State, tau: Array, by_q: Array, by_v: Array, mass: Array) -> Array:
        """Compute d_q tau, shape (nv, nv).

        Parameters
        ----------
        state : State
            The neutral state.
        tau : ndarray, shape (nv,)
            The engine's tau_e there.
        by_q, by_v, mass : ndarray, shape (nv, nv)
            The engine's derivatives of tau_e by q_e along v_e, by v_e and by a_e.
        """
        columns = self.change.to_neutral_jacobian(by_q)
        for rates in self.rates:
            s = rates.dofs
            columns[:, s] += by_v[:, s] @ (rates.t_dq @ state.v[s]).T
            columns[:, s] += mass[:, s] @ ((rates.t_dq @ state.a[s]).T + rates.b_dq)
        answer = self.change.to_neutral_tau(columns)
        for rates in self.rates:
            s = rates.dofs
            answer[s, s] += np.array([t.T @ tau[s] for t in rates.t_dq]).T
        return answer

    def id_dv(self, by_v: Array, mass: Array) -> Array:
        """Compute d_v tau, shape (nv, nv), from the engine's derivatives of tau_e by v_e and by a_e."""
        columns = self.change.to_neutral_jacobian(by_v)
        for rates in self.rates:
            columns[:, rates.dofs] += mass[:, rates.dofs] @ rates.b_dv
        return self.change.to_neutral_tau(columns)

    def fd_dq(self, state: State, a: Array, by_q: Array, by_v: Array, inverse: Array) -> Array:
        """Compute d_q a, shape (nv, nv).

        Parameters
        ----------
        state : State
            The neutral state.
        a : ndarray, shape (nv,)
            The neutral acceleration that tau causes there.
        by_q, by_v, inverse : ndarray, shape (nv, nv)
            The engine's derivatives of a_e by q_e along v_e, by v_e and by tau_e.
        """
        columns = self.change.to_neutral_jacobian(by_q)
        for rates in self.rates:
            s = rates.dofs
            columns[:, s] += by_v[:, s] @ (rates.t_dq @ state.v[s]).T
            columns[:, s] += inverse[:, s] @ (rates.t_dq @ state.tau[s]).T
            columns[s, s] -= rates.b_dq + (rates.t_dq @ a[s]).T
        return self.change.to_neutral_tau(columns)

    def fd_dv(self, by_v: Array) -> Array:
        """Compute d_v a, shape (nv, nv), from the engine's derivative of a_e by v_e."""
        columns = self.change.to_neutral_jacobian(by_v)
        for rates in self.rates:
            columns[rates.dofs, rates.dofs] -= rates.b_dv
        return self.change.to_neutral_tau(columns)

    def coriolis(self, v: Array, matrix: Array, mass: Array) -> Array:
        """Compute C = T' (C_e T + M_e dT/dt), shape (nv, nv), where a_e is the time derivative of the numbers in v_e.

        With b = (dT/dt) v this keeps C v = h - g, and dM/dt = C + C'.

        Parameters
        ----------
        v : ndarray, shape (nv,)
            The neutral velocity.
        matrix, mass : ndarray, shape (nv, nv)
            The engine's C_e and M_e.
        """
        columns = self.change.to_neutral_jacobian(matrix)
        for rates in self.rates:
            s = rates.dofs
            columns[:, s] += mass[:, s] @ np.tensordot(v[s], rates.t_dq, axes=1)
        return self.change.to_neutral_tau(columns)
