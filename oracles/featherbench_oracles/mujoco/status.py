"""What MuJoCo says of its steps: the counters of its warnings."""

from __future__ import annotations

import mujoco as mj


def check_warnings(data: mj.MjData) -> None:
    """Refuse numbers that MuJoCo itself warns of: it counts warnings and goes on, after some of them from its initial state.

    Raises
    ------
    ValueError
        With the names of the warnings, and how often each was given.
    """
    counted = [(mj.mjtWarning(k).name.removeprefix("mjWARN_"), int(warning.number)) for k, warning in enumerate(data.warning)]
    told = [f"{name} {number} times" for name, number in counted if number]
    if told:
        raise ValueError(f"mujoco warns while it computes: {', '.join(told)}")
