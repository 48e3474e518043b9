"""Replays the tasks of a run with one thread on several simulated threads.

A trace (src/dvi/core/task_trace.h) has loops and tasks, nested in each other, with the CPU time of each. The replay distributes them
as the program does: an item of a pipeline stays with its thread until a step must wait; a thread that waits for a loop takes tasks of
this loop, or of loops inside its tasks, only. The time for locks, for data that one thread makes while others wait for them, and for
shared caches of the processor is not in the trace, so that the prediction is an upper bound of the speed.
"""
import heapq
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Task:
    """Parts in order: seconds of work, or loops."""
    parts: list = field(default_factory=list)

    def seconds(self) -> float:
        return sum(part if isinstance(part, float) else part.seconds() for part in self.parts)


@dataclass
class Loop:
    """The tasks of each item, one per step."""
    items: list[list[Task]]
    limit: int  # items in progress, 0: any number
    steps: str  # a: any order, o: in order; b: blocks

    def seconds(self) -> float:
        return sum(task.seconds() for item in self.items for task in item)


def read(file: Path) -> list[tuple[str, Task]]:
    """The stages of a run with their work."""
    stages = [("begin", Task())]
    open_tasks, open_loops, before = [stages[0][1]], [], 0.0
    for line in file.read_text(encoding="utf-8").splitlines():
        time, event, *words = line.split(" ")
        now = int(time) / 1e6
        if now > before:
            open_tasks[-1].parts.append(now - before)
        before = now
        if event == "stage" and not open_loops:
            stages.append((" ".join(words), Task()))
            open_tasks = [stages[-1][1]]
        elif event == "loop":
            loop = Loop([[] for _ in range(int(words[0]))], int(words[1]), words[2])
            open_tasks[-1].parts.append(loop)
            open_loops.append(loop)
        elif event == "task":
            task = Task()
            open_loops[-1].items[int(words[0])].append(task)
            open_tasks.append(task)
        elif event == "end":
            open_tasks.pop()
        elif event == "done":
            open_loops.pop()
    return stages


class OpenLoop:
    """A loop in progress: which tasks can begin."""

    def __init__(self, loop: Loop, threads: int, owner: "Thread", parent: "OpenLoop | None"):
        self.loop, self.owner, self.parent = loop, owner, parent
        self.depth = parent.depth + 1 if parent else 0
        items = [item for item in loop.items if item]
        self.items, self.unfinished = items, len(items)
        self.begun = self.in_progress = 0
        self.next_in_order = [0] * len(loop.steps)  # the item that an ordered step takes next
        self.running = [False] * len(loop.steps)
        self.waiting: list[dict[int, int]] = [{} for _ in loop.steps]  # per step, items that finished the step before
        most = threads if loop.steps in ("a", "b") else threads + max(2, threads // 4)
        self.limit = min(most, loop.limit) if loop.limit else most
        self.block_end = self.limit if loop.steps == "b" else len(items)

    def can_take(self, item: int, step: int) -> bool:
        return self.loop.steps[step] != "o" or (self.next_in_order[step] == item and not self.running[step])

    def take(self) -> tuple[int, int] | None:
        """The next task: a later step of an item in progress first, else a new item."""
        for step in range(len(self.loop.steps) - 1, 0, -1):
            for item in self.waiting[step]:
                if self.can_take(item, step):
                    del self.waiting[step][item]
                    return self.start(item, step)
        new = self.begun
        limited = len(self.loop.steps) > 1 and self.in_progress >= self.limit
        if new < min(len(self.items), self.block_end) and not limited and self.can_take(new, 0):
            self.begun += 1
            self.in_progress += 1
            return self.start(new, 0)
        return None

    def start(self, item: int, step: int) -> tuple[int, int]:
        self.running[step] = True if self.loop.steps[step] == "o" else self.running[step]
        return item, step

    def finish(self, item: int, step: int) -> tuple[int, int] | None:
        """Ends a task. Returns the next one of the item if it can begin."""
        if self.loop.steps[step] == "o":
            self.running[step] = False
            self.next_in_order[step] = item + 1
        following = step + 1
        if following == len(self.items[item]):
            self.unfinished -= 1
            self.in_progress -= 1
            if self.loop.steps == "b" and self.in_progress == 0 and self.begun == self.block_end:
                self.block_end += self.limit
            return None
        if self.can_take(item, following):
            return self.start(item, following)
        self.waiting[following][item] = 1
        return None

    def is_within(self, other: "OpenLoop") -> bool:
        loop: OpenLoop | None = self
        while loop is not None and loop is not other:
            loop = loop.parent
        return loop is other


@dataclass
class Running:
    """A task on a thread: the next part of it, and its place in its loop."""
    task: Task
    part: int = 0
    of: OpenLoop | None = None
    item: int = 0
    step: int = 0
    inner: OpenLoop | None = None  # the loop that it waits for


class Thread:
    def __init__(self) -> None:
        self.stack: list[Running] = []


def replay(work: Task, count: int) -> float:
    """Seconds that the work takes with `count` threads."""
    threads = [Thread() for _ in range(count)]
    threads[0].stack.append(Running(work))
    loops: list[OpenLoop] = []
    idle: set[int] = set(range(1, count))
    queue: list[tuple[float, int, int]] = [(0.0, 0, 0)]
    sequence = 1

    def wake(now: float) -> None:
        nonlocal sequence
        for thread in sorted(idle):
            heapq.heappush(queue, (now, sequence, thread))
            sequence += 1
        idle.clear()

    def find_task(thread: Thread) -> bool:
        """Gives the thread a task of an open loop, the innermost first; of its own loop if it waits for one."""
        own = thread.stack[-1].inner if thread.stack else None
        for loop in sorted(loops, key=lambda each: -each.depth):
            if own is not None and not loop.is_within(own):
                continue
            if (taken := loop.take()) is not None:
                item, step = taken
                thread.stack.append(Running(loop.items[item][step], 0, loop, item, step))
                return True
        return False

    now = 0.0
    while queue:
        now, _, number = heapq.heappop(queue)
        thread = threads[number]
        while True:
            if not thread.stack or thread.stack[-1].inner is not None:
                top = thread.stack[-1] if thread.stack else None
                if top is not None and top.inner.unfinished == 0:
                    loops.remove(top.inner)
                    top.inner = None
                    continue
                if find_task(thread):
                    continue
                idle.add(number)
                break
            top = thread.stack[-1]
            if top.part == len(top.task.parts):
                thread.stack.pop()
                if top.of is None:
                    return now
                following = top.of.finish(top.item, top.step)
                if following is not None:
                    item, step = following
                    thread.stack.append(Running(top.of.items[item][step], 0, top.of, item, step))
                wake(now)
                continue
            part = top.task.parts[top.part]
            top.part += 1
            if isinstance(part, float):
                heapq.heappush(queue, (now + part, sequence, number))
                sequence += 1
                break
            if any(part.items):
                top.inner = OpenLoop(part, count, thread, top.of)
                loops.append(top.inner)
                wake(now)
    raise RuntimeError("the replay stopped before the end of the work")
