"""What is to be done with a library is done once it is there, all of it."""

import sys

from mujoco_impact._import_hook import when_imported


def test_every_action_is_done_whichever_comes_first(tmp_path, monkeypatch):
    (tmp_path / "late_library.py").write_text("value = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    done = []
    finders = list(sys.meta_path)
    for number in (1, 2):
        when_imported(
            "late_library", lambda module, n=number: done.append(n * module.value)
        )
    assert not done
    import late_library  # noqa: F401

    assert sorted(done) == [1, 2]
    assert sys.meta_path == finders
    when_imported("late_library", lambda module: done.append(3 * module.value))
    assert done[-1] == 3
    monkeypatch.delitem(sys.modules, "late_library")
