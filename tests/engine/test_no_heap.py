"""The hot path takes its memory from MuJoCo's stack, never from the heap."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

# counts calls of malloc while the library steps; built with the compiler of the plugin
COUNTER = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stddef.h>
static void* (*real_malloc)(size_t);
static long counted;
static int counting;
void* malloc(size_t size) {
  if (!real_malloc) real_malloc = (void* (*)(size_t))dlsym(RTLD_NEXT, "malloc");
  if (counting) ++counted;
  return real_malloc(size);
}
void heap_count_start(void) { counted = 0; counting = 1; }
long heap_count_stop(void) { counting = 0; return counted; }
"""

PROGRAM = """
import ctypes, json, sys
sys.path.insert(0, {folder!r})
import mujoco
from scenes import header, pendulums
counter = ctypes.CDLL({library!r})
counts = {{}}
materials = dict(
    materials={{"table": dict(restitution_table={{.1: .95, 1: .9}}, friction=.1)}},
    assign={{"*": "table", "ball_1": "steel"}},
    pairs={{("table", "ball_3"): dict(restitution=.9)}},
)
cases = dict(hertz={{}}, fixed=dict(duration=7.5e-3), materials=materials)
for name, options in cases.items():
    model, data = pendulums("AAAAA", **options)
    mujoco.mj_step(model, data)
    counter.heap_count_start()
    mujoco.mj_step(model, data, 1000)
    allocations = counter.heap_count_stop()
    counts[name] = [allocations, header(model, data).count]
print(json.dumps(counts))
"""


def test_a_thousand_steps_with_impacts_allocate_nothing(tmp_path):
    source = tmp_path / "counter.c"
    library = tmp_path / "libcounter.so"
    source.write_text(COUNTER)
    compiler = subprocess.run(
        ["cc", "-shared", "-fPIC", "-O1", source, "-o", library, "-ldl"], check=False
    )
    if compiler.returncode:
        pytest.skip("no C compiler to build the counter with")
    folder = str(Path(__file__).parent)
    result = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(folder=folder, library=str(library))],
        env={
            "LD_PRELOAD": str(library),
            "PATH": "/usr/bin:/bin",
            "HOME": str(tmp_path),
        },
        capture_output=True,
        text=True,
        check=True,
    )
    counts = json.loads(result.stdout)
    for name, (allocations, impacts) in counts.items():
        assert impacts > 10, f"{name}: the steps counted hold no impacts"
        # calling mj_step makes a few; an allocation in every step would make 1000
        assert allocations < 50, f"{name}: {allocations} allocations"
