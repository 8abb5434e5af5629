"""A sweep over Slurm, disturbed: sweep.py BINARY TASKS FOLDER, in the laboratory that sweep.sh brings up."""

import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

BINARY, TASKS, WORK = sys.argv[1], int(sys.argv[2]), Path(sys.argv[3])
LAB = Path(os.environ["SLURM_LAB"])
SEED = int(os.environ.get("FOLDLINE_SEED", time.time_ns() % 1_000_000))
RANDOM = random.Random(SEED)
# What a run costs, and where, is no function of its scene.
COSTS = {"wall_s", "host", "log"}
SWEEP = """
title = "thin tapes"
scene = "tape.toml"
outputs = ["peak_moment_n_mm", "snap_before", "fold_moment_n_mm", "last.strain_energy_n_mm", "error_before", "error_after"]

[reference]
settings = ["adapt.threshold=0.012"]

[[axis]]
key = "material.thickness_mm"
from = 0.08
to = 0.12
count = {count}

[[axis]]
key = "adapt.threshold"
values = [0.016, 0.019, 0.022, 0.025]
"""


def run(*words, ends=(0,), text=True):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=text, cwd=WORK)
    if ends is not None and done.returncode not in ends:
        sys.exit(f"{words} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done


def foldline(*words, ends=(0,)):
    return run(BINARY, *words, ends=ends)


def queue():
    """Elements and jobs that have not ended: (job, element, state, partition)."""
    done = run("squeue", "--noheader", "--array", "--format=%F|%K|%T|%P", ends=None)
    return [tuple(line.strip().split("|")) for line in done.stdout.splitlines()]


def processes(folder):
    """Processes of this sweep's tasks, by number."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if words[1:3] == [b"sweep", b"task"] and str(folder).encode() in words:
            found.append(int(entry.name))
    return found


def environment(number):
    try:
        words = Path(f"/proc/{number}/environ").read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return {}
    return dict(word.split("=", 1) for word in words if "=" in word)


class Watch:
    """Logs of tasks that are on record: they are not touched again."""

    def __init__(self, folder):
        self.folder, self.seen = folder, {}

    def stat(self, key):
        found = (self.folder / "logs" / f"{key}.mcap").stat()
        return found.st_ino, found.st_size, found.st_mtime_ns

    def look(self):
        for row in (self.folder / "rows").glob("*.json"):
            if row.stem not in self.seen:
                self.seen[row.stem] = self.stat(row.stem)
        return len(self.seen)

    def touched(self):
        return [key for key, stat in self.seen.items() if self.stat(key) != stat]


class Disturbance:
    """What happens to the jobs of a sweep while it runs."""

    def __init__(self, folder):
        self.folder = folder
        self.counts = {"kills": 0, "terms": 0, "requeues": 0, "preemptions": 0, "lost nodes": 0}
        self.node_is_lost_until, self.stopped, self.twice = None, [], 0

    def kill(self, _):
        os.kill(RANDOM.choice([number for number in processes(self.folder) if number not in self.stopped]), signal.SIGKILL)
        self.counts["kills"] += 1

    def term(self, running):
        job, element, _, _ = RANDOM.choice(running)
        for _ in range(RANDOM.choice([1, 3])):
            run("scancel", "--batch", "--signal=TERM", f"{job}_{element}", ends=None)
        self.counts["terms"] += 1

    def requeue(self, running):
        job, element, _, _ = RANDOM.choice(running)
        done = run("scontrol", "requeue", f"{job}_{element}", ends=None)
        self.counts["requeues"] += done.returncode == 0

    def preempt(self, running):
        # A node is full of tasks of the low partition.
        run("sbatch", "--partition=high", "--cpus-per-task=2", "--nodes=1", "--output=/dev/null", "--wrap=sleep 1")
        self.counts["preemptions"] += 1

    def lose_node(self):
        """The daemon of a node dies and its tasks hang; Slurm gives them to the other node, too."""
        for number in processes(self.folder):
            if environment(number).get("SLURMD_NODENAME") == "n2":
                try:
                    os.kill(number, signal.SIGSTOP)
                    self.stopped.append(number)
                except ProcessLookupError:
                    pass
        if not self.stopped:
            return
        os.kill(int((LAB / "slurmd-n2.pid").read_text()), signal.SIGKILL)
        self.node_is_lost_until = time.monotonic() + 60
        self.counts["lost nodes"] += 1

    def find_node(self, now=False):
        """Once their second processes are there, the first ones go on, beside those; then the node is back."""
        if not self.node_is_lost_until:
            return
        names = ("SLURM_ARRAY_JOB_ID", "SLURM_ARRAY_TASK_ID")
        elements = [tuple(environment(number).get(name) for name in names) for number in processes(self.folder)]
        elements = [element for element in elements if None not in element]
        twice = len(elements) - len(set(elements))
        self.twice = max(self.twice, twice)
        if now or twice == len(self.stopped) or time.monotonic() > self.node_is_lost_until:
            self.node_is_lost_until = None
            time.sleep(2)
            self.go_on()
            time.sleep(3)
            run("slurmd", "-f", LAB / "slurm.conf", "-N", "n2")

    def go_on(self):
        for number in self.stopped:
            try:
                os.kill(number, signal.SIGCONT)
            except ProcessLookupError:
                pass
        self.stopped = []

    def once(self):
        running = [one for one in queue() if one[2] == "RUNNING" and one[3] == "low" and one[1].isdigit()]
        actions = [self.kill, self.kill, self.term, self.requeue, self.requeue, self.preempt]
        for action in RANDOM.choices(actions, k=RANDOM.randint(1, 3) if running else 0):
            try:
                action(running)
            except (IndexError, ProcessLookupError):
                pass  # It has ended meanwhile.
        self.find_node()


def submit(folder, *words):
    return json.loads(foldline(*words, "--folder", folder, "--slurm", "--json", "--partition=low").stdout)


def all_on_record(folder, tasks):
    return len(list((folder / "rows").glob("*.json"))) >= tasks


def disturbed(folder, tasks, limit_s):
    """Runs the sweep with disturbances to its end; gives back what they were."""
    first = submit(folder, "sweep", "run", "sweep.toml", "--time=00:10:00", "--memory=100")
    assert [job["role"] for job in first["jobs"]] == ["references", "tasks", "collect"], first
    disturbance, watch = Disturbance(folder), Watch(folder)
    begin, submissions = time.monotonic(), 1
    while not all_on_record(folder, tasks):
        if time.monotonic() - begin > limit_s:
            sys.exit(f"not done in {limit_s} s: {watch.look()} of {tasks}, {disturbance.counts}, {queue()}")
        # As many as there are tasks, then it is left in peace.
        if sum(disturbance.counts.values()) < tasks:
            disturbance.once()
        else:
            disturbance.find_node()
        done = watch.look()
        if TASKS >= 200 and done > tasks // 4 and not disturbance.counts["lost nodes"]:
            disturbance.lose_node()
        if not [one for one in queue() if one[3] == "low"] and not all_on_record(folder, tasks):
            foldline("sweep", "resume", folder, "--slurm", "--partition=low", "--time=00:10:00", "--memory=100")
            submissions += 1
        time.sleep(RANDOM.uniform(0.05, 0.3))
    disturbance.find_node(now=True)
    while [one for one in queue() if one[3] == "low"]:
        watch.look()
        if time.monotonic() - begin > limit_s:
            sys.exit(f"the queue is not empty after {limit_s} s: {queue()}")
        time.sleep(0.3)
    assert not watch.touched(), f"run again after their end: {watch.touched()}"
    if disturbance.counts["lost nodes"]:
        assert disturbance.twice, "no task of the lost node was begun again beside its first process"
        disturbance.counts["processes beside each other"] = disturbance.twice
    return disturbance.counts | {"submissions": submissions, "seconds": round(time.monotonic() - begin, 1)}


def of_tasks(path):
    """The table without its costs, and which log has which task."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [{name: value for name, value in row.items() if name not in COSTS} for row in rows], [row["log"] for row in rows]


def hashes(log):
    lines = foldline("inspect", log, "--json").stdout.splitlines()
    return [json.loads(line)["state_hash"] for line in lines]


def compare(plain, other):
    """The tables are the same, and so is every state of every log; each log is sound and nobody writes it."""
    (expected, logs), (found, own) = of_tasks(plain / "table.csv"), of_tasks(other / "table.csv")
    assert expected == found, [(a, b) for a, b in zip(expected, found) if a != b][:3]
    assert logs == own and all(row["ending"] == "done" for row in found)
    for log in logs:
        foldline("verify", other / "logs" / log)
        assert hashes(plain / "logs" / log) == hashes(other / "logs" / log), log
    left = [path.name for path in (other / "logs").iterdir() if path.suffix in (".lock", ".lease")]
    return f"{len(logs)} logs sound and the same state for state", left


def limited(folder, tasks):
    """Elements whose time is over long before they are done put themselves back into the queue."""
    submission = submit(
        folder, "sweep", "run", "sweep.toml", "--time=00:01:00", f"--per-job={max(1, TASKS // 4)}", "--memory=100"
    )
    begin, restarts = time.monotonic(), 0
    jobs = {f"ArrayJobId={job['job']}" for job in submission["jobs"]}
    while queue():
        shown = [line.split() for line in run("scontrol", "--oneliner", "show", "jobs").stdout.splitlines()]
        counts = [word.split("=")[1] for words in shown if jobs & set(words) for word in words if word.startswith("Restarts=")]
        restarts = max(restarts, sum(map(int, counts)))
        if time.monotonic() - begin > 900:
            sys.exit(f"not done in 900 s: {queue()}")
        time.sleep(1)
    assert all_on_record(folder, tasks), f"jobs {jobs} left some of {tasks}"
    return restarts, round(time.monotonic() - begin, 1)


def main():
    print(f"seed {SEED}", flush=True)
    shutil.copy(Path(__file__).parent / "tape.toml", WORK)
    (WORK / "sweep.toml").write_text(SWEEP.format(count=max(2, TASKS // 4)))
    plain, shaken = WORK / "plain", WORK / "shaken"
    begin = time.monotonic()
    foldline("sweep", "run", "sweep.toml", "--folder", plain)
    foldline("sweep", "collect", plain)
    tasks = json.loads((plain / "sweep.json").read_text())["tasks"]
    print(f"{tasks} tasks on this machine: {time.monotonic() - begin:.1f} s", flush=True)
    counts = disturbed(shaken, tasks, 150 if TASKS < 200 else 1500)
    print(f"over Slurm, disturbed: {counts}", flush=True)
    said = foldline("sweep", "status", shaken).stdout
    assert "Slurm: none of the jobs is left" in said, said
    # Whatever was submitted last may have ended before the rest.
    foldline("sweep", "collect", shaken)
    sound, left = compare(plain, shaken)
    print(f"the table is the same; {sound}; {len(left)} locks and leases of killed processes", flush=True)
    said = foldline("sweep", "resume", shaken, "--slurm").stderr
    assert "nothing to submit" in said, said
    if TASKS >= 200:
        restarts, seconds = limited(WORK / "limited", tasks)
        assert restarts > 0, "no element came to its limit of time"
        compare(plain, WORK / "limited")
        print(f"with a minute for each job: the same table after {restarts} requeues of their own, {seconds} s", flush=True)


main()
