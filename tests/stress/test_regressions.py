"""Every random scene that once broke a promise keeps them all now.

By what was wrong. A seed is a scene: `python -m mujoco_impact_lab stress --seed N`
tells more.
"""

import pytest

from mujoco_impact_lab.stress import OURS, case_of, judge

FOUND = {
    # pulses longer than a step, whose lines of action turn with the balls
    "a turning pulse added energy": (
        "1305 2093 2181 2378 2476 2732 5920 6059 8071 9528 9777"
    ),
    "one pulse parted what another had yet to stop": "3064 5997 8949",
    # bodies too soft, too fast, or with fixed pulses too long for their depth
    "pulses let balls through": (
        "49 321 342 344 388 465 1027 1367 1378 4028 4477 4718 5603 7688 7776 7869 7930"
    ),
    "virtual contacts of balls that are not neighbours": "762 916 1255 1652",
    "an overlap at the start left no room for a pulse": "454 1434 1469",
    "dents of plastic impacts grew": "702 740 1786 2780 8504",
    "pulses that last were seen at once, on virtual places": "1666 2902 3045",
    "a light ball was thrown by the difference of two pulses": (
        "71 663 4255 5046 8776 9608"
    ),
    "without free slots a part of an impact came at once": "112 1291 1956",
    "short fixed pulses were resolved once a step": "102 1545 1764 1892 1900",
    "bodies were looked at before an impact was over": "2517 3227 3713 9057 9172",
    "contacts that close by rounding used up the rounds": "4637 5471",
    "MuJoCo's contacts pushed between the stages of Runge-Kutta": (
        "3929 4634 4672 5433 7772 8157 9997"
    ),
    "impacts did not see equality constraints": (
        "502 966 1320 1661 4770 5811 6495 6691 8081 9048 9480"
    ),
    "the error of the law passed for one of symmetry": "961 1223 2885 3813 8155 9773",
    "a pulse that outlasts the step kept others from closing": "4244",
    "what closed before an impact was not seen to close after it": "386",
    "a pulse under way left one round for all impacts of a step": "9535",
    "a crowd was one problem of a million couplings": "6586",
    "rounding ended a pulse": "4100",
    "rounding decided how stiff bodies are": "2552 7712",
    "a sleeping tree was read before it was written": "9466",
    "a state was lost, or a pulse too long": "6561 9861",
}


@pytest.mark.parametrize("seeds", FOUND.values(), ids=FOUND)
def test_what_once_was_broken_holds(seeds):
    for seed in map(int, seeds.split()):
        outcome = judge(case_of(seed), (OURS,))
        assert not outcome.failure
        broken = [verdict for verdict in outcome.verdicts if verdict.is_violation]
        assert not broken, outcome.case.describe()
