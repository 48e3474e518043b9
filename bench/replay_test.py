#!/usr/bin/env python3
"""Tests of replay.py."""
import tempfile
import unittest
from pathlib import Path

from replay import Loop, Task, read, replay


def loop(*seconds, limit=0):
    return Loop([[Task([float(each)])] for each in seconds], limit, "a")


class Replay(unittest.TestCase):
    def test_serial_work_takes_its_time(self):
        for threads in (1, 2, 16):
            self.assertAlmostEqual(replay(Task([1.0, 2.0]), threads), 3)

    def test_items_of_a_loop_are_shared(self):
        work = Task([1.0, loop(2, 2, 2, 2), 1.0])
        self.assertAlmostEqual(replay(work, 1), 10)
        self.assertAlmostEqual(replay(work, 2), 6)
        self.assertAlmostEqual(replay(work, 4), 4)
        self.assertAlmostEqual(replay(work, 16), 4)

    def test_nested_loops_are_shared(self):
        work = Task([Loop([[Task([1.0, loop(2, 2, 2, 2)])]], 0, "a")])
        self.assertAlmostEqual(replay(work, 1), 9)
        self.assertAlmostEqual(replay(work, 4), 3)

    def test_ordered_steps_wait(self):
        items = [[Task([1.0]), Task([1.0])] for _ in range(4)]
        self.assertAlmostEqual(replay(Task([Loop(items, 0, "ao")]), 1), 8)
        self.assertAlmostEqual(replay(Task([Loop(items, 0, "ao")]), 4), 5)  # the last of four ordered steps

    def test_memory_limits_the_items_in_progress(self):
        items = [[Task([1.0]), Task([1.0])] for _ in range(4)]
        self.assertAlmostEqual(replay(Task([Loop(items, 1, "aa")]), 4), 8)

    def test_blocks_end_together(self):
        items = [[Task([float(each)])] for each in (3, 1, 1, 3)]
        self.assertAlmostEqual(replay(Task([Loop(items, 0, "b")]), 2), 6)
        self.assertAlmostEqual(replay(Task([Loop(items, 0, "a")]), 2), 5)

    def test_traces_are_read(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "trace"
            file.write_text("0 stage read\n1000000 loop 2 0 ao\n1000000 task 0 0\n3000000 end\n3000000 task 0 1\n3500000 end\n"
                            "3500000 task 1 0\n3600000 loop 1 0 a\n3600000 task 0 0\n3900000 end\n4000000 done\n5500000 end\n"
                            "5500000 task 1 1\n6000000 end\n6000000 done\n6000000 stage carve\n7000000 stage map\n")
            stages = read(file)
        self.assertEqual([name for name, _ in stages], ["begin", "read", "carve", "map"])
        self.assertAlmostEqual(stages[1][1].seconds(), 6)
        self.assertAlmostEqual(replay(stages[1][1], 1), 6)
        self.assertAlmostEqual(replay(stages[1][1], 2), 1 + 2 + 0.5 + 0.5)
        self.assertAlmostEqual(stages[2][1].seconds(), 1)


if __name__ == "__main__":
    unittest.main()
