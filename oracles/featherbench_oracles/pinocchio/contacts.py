"""Pinocchio's solvers of contact problems: projected Gauss-Seidel and ADMM."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from featherbench_oracles.abilities.contacts import ContactProblem, ContactSolution, SolverTable
from featherbench_oracles.core.algebra import Array


class _Solver:
    """One of Pinocchio's solvers with a dense Delassus operator.

    Pinocchio's rows of a contact are tangent, tangent, normal. It wants constraint models beside G. They give it the cones alone.

    Parameters
    ----------
    kinds : tuple
        The classes of the solver, its settings and its result.
    problems : sequence of ContactProblem
        What will be asked.
    tolerance : float
        Of feasibility and complementarity, absolute and relative.
    iterations : int
        The cap.
    """

    def __init__(self, kinds: tuple[Any, Any, Any], problems: Sequence[ContactProblem], tolerance: float, iterations: int) -> None:
        solver, settings, result = kinds
        rows = len(problems[0].free)
        self.order = np.arange(rows).reshape(-1, 3)[:, [1, 2, 0]].ravel()
        self.solver, self.result_of = solver(rows), result
        self.settings = settings()
        for what in ("feasibility", "complementarity"):
            setattr(self.settings, f"absolute_{what}_tol", tolerance)
            setattr(self.settings, f"relative_{what}_tol", tolerance)
        self.settings.max_iterations = iterations
        self.settings.solve_ncp = True  # the true law, with De Saxce's term
        self.settings.measure_timings = True
        body = pin.Model()
        joint = body.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "body")
        self.given = [self._given(body, joint, problem) for problem in problems]

    def _given(self, body: pin.Model, joint: int, problem: ContactProblem) -> tuple[Any, Array, Any, Any]:
        """Make the operator, g, the models and their data."""
        models, data = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        for friction in problem.friction:
            contact = pin.PointContactConstraintModel(body, joint, pin.SE3.Identity())
            contact.setFriction(float(friction))
            models.append(pin.ConstraintModel(contact))
            data.append(pin.ConstraintModel(contact).createData())
        delassus = np.asfortranarray(problem.delassus[np.ix_(self.order, self.order)])
        return pin.DelassusOperatorDense(delassus), problem.free[self.order].copy(), models, data

    def solve(self, problem: int) -> ContactSolution:
        """Solve a problem from impulses of zero, by a result that holds nothing yet."""
        operator, free, models, data = self.given[problem]
        result = self.result_of()
        self.solver.reset()
        self.solver.solve(operator, free, models, data, self.settings, result)
        impulses = np.empty(len(free))
        impulses[self.order] = np.array(result.retrieveConstraintImpulses()).ravel()
        nanoseconds = self.solver.getElapsedTime() * 1e3  # it counts microseconds
        return ContactSolution(impulses, int(result.iterations), bool(result.converged), nanoseconds)


def _pgs(problems: Sequence[ContactProblem], tolerance: float, iterations: int) -> _Solver:
    return _Solver((pin.PGSConstraintSolver, pin.PGSSolverSettings, pin.PGSSolverResult), problems, tolerance, iterations)


def _admm(problems: Sequence[ContactProblem], tolerance: float, iterations: int) -> _Solver:
    return _Solver((pin.ADMMConstraintSolver, pin.ADMMSolverSettings, pin.ADMMSolverResult), problems, tolerance, iterations)


SOLVERS: SolverTable = {"pgs": _pgs, "admm": _admm}
