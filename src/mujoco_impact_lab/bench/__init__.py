"""The benchmark of run time against error: what `scripts/bench` runs.

`scenes` says what is simulated, `methods` how, `truths` what is right; `measure` makes
points (run time, error) of them, `summary` says what follows. `steps` and `impacts`
time single steps and the law alone. `results`, `charts` and `page` keep it all.
"""

from mujoco_impact_lab.bench.benchmark import BenchmarkInterrupted, run_benchmark
from mujoco_impact_lab.bench.output import show, write_files
from mujoco_impact_lab.bench.results import Results, read_results

__all__ = [
    "BenchmarkInterrupted",
    "Results",
    "read_results",
    "run_benchmark",
    "show",
    "write_files",
]
