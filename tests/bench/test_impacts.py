"""What is timed is the impact, and right; no wall time is asserted."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from mujoco_impact.errors import SimulationError
from mujoco_impact_lab.bench import impacts

pytestmark = pytest.mark.usefixtures("library")

# velocities that one ball leaves in a row, from integrations by other programs
PUBLISHED = {
    3: (-0.0710, 0.0764, 0.9945),
    5: (-0.0711, -0.0303, -0.0145, 0.1270, 0.9888),
}


@pytest.mark.parametrize("balls", PUBLISHED)
def test_law_and_loop_solve_the_published_impact(balls: int) -> None:
    """The law to its digits; the loop to 3e-4 RMS, so to 7e-4 for one of 5 balls."""
    truth = np.array(PUBLISHED[balls])
    law = impacts._law(balls, 1e-6)
    # half of the last digit
    assert_allclose(law.velocities, truth, rtol=0, atol=6e-5)
    loop = impacts._coarsest_loop(balls, impacts._truth(balls))
    assert_allclose(loop.velocities, truth, rtol=0, atol=7e-4)
    for solved in (law, loop):
        # momentum and energy; those of the loop to its error
        assert solved.velocities.sum() == pytest.approx(1, abs=1e-9)
        assert (solved.velocities**2).sum() == pytest.approx(1, abs=2e-3)
        assert solved.time() > 0


def test_loop_takes_no_more_steps_than_its_error_needs() -> None:
    """A step that is half as long again exceeds the error allowed."""
    truth = impacts._truth(3)
    steps = impacts._coarsest_loop(3, truth).steps
    chain = impacts._chain(3)
    # the impact lasts as long whatever the step: so does steps * step
    fine = impacts.contact_time(
        chain.masses[0] / 2, chain.stiffness[0], impacts.SPEED
    )  # fmt: skip
    solve = impacts.load_library().impact_timing_loop
    lasts = impacts._solved(solve, 3, fine / 1000, 100_000).steps * fine / 1000
    coarser = impacts._solved(solve, 3, 1.5 * lasts / steps, 100_000)
    assert impacts.rms(coarser.velocities - truth) > impacts.ALLOWED_ERROR


def test_loop_that_does_not_end_is_an_error() -> None:
    """After as many steps as it may take."""
    solve = impacts.load_library().impact_timing_loop
    with pytest.raises(SimulationError, match="3 balls did not end after 5 steps"):
        impacts._solved(solve, 3, 1e-7, 5)


def test_every_row_is_measured_at_every_tolerance() -> None:
    """Tighter tolerances take more steps and leave smaller errors."""
    rows = impacts.impact_times(balls=(3, 4), tolerances=(1e-3, 1e-5), rounds=2)
    assert [(row.balls, row.tolerance) for row in rows] == [
        (3, 1e-3), (3, 1e-5), (4, 1e-3), (4, 1e-5),
    ]  # fmt: skip
    for coarse, fine in (rows[:2], rows[2:]):
        assert fine.steps > coarse.steps
        # measured 4e-5 and 4e-7
        assert fine.error < 2e-6 < coarse.error < 2e-4
        assert 0 < coarse.loop_error < impacts.ALLOWED_ERROR
        assert min(coarse.fastest, coarse.microseconds, coarse.ratio) > 0


def test_steps_of_a_wave_grow_with_the_row() -> None:
    """A row of twice the length takes twice the steps; the shortest is the unit."""
    short, long = impacts.wave_times(balls=(20, 40), rounds=2)
    # the ends of the row take some steps of their own
    assert long.steps / short.steps == pytest.approx(2, abs=0.2)
    assert short.relative == 1
    assert long.per_ball == pytest.approx(long.microseconds / 40, rel=1e-9)
