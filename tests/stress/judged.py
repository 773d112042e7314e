"""What a sweep has found, for the tests of each family."""


def violations(outcomes, name: str) -> list[str]:
    """Where the promise of that name was broken."""
    return [
        f"{verdict.value:.3g} in {outcome.case.describe()}"
        for outcome in outcomes
        for verdict in outcome.verdicts
        if verdict.is_violation and verdict.invariant == name
    ]
