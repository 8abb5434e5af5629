#!/usr/bin/env bash
# sweep.sh BINARY [TASKS]: a sweep of so many tasks (20) on a throw-away Slurm of two nodes, with kills, requeues and preemptions, from 200
# tasks on also with a lost node and limits of time; compared with an undisturbed sweep on this machine. Skips where there is no Slurm.
set -euo pipefail
binary="$(realpath "$1")"
tasks="${2:-20}"
here="$(cd "$(dirname "$0")" && pwd)"
skip() {
    echo "no Slurm here ($1): sweeps over it were not tried"
    exit 0
}
[ "$(uname)" = Linux ] || skip "no Linux"
[ "$(id -u)" = 0 ] || skip "not root"
command -v python3 >/dev/null || skip "no python3"
has_slurm() { for name in munged slurmctld slurmd sbatch; do command -v $name >/dev/null || return 1; done; }
export PATH="$PATH:/usr/sbin:/sbin"
has_slurm || (apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends munge slurmctld slurmd slurm-client) \
    >/dev/null 2>&1 || true
has_slurm || skip "munge, slurmctld, slurmd and slurm-client cannot be installed"

work="$(mktemp -d /tmp/foldline-slurm.XXXXXX)"
export SLURM_LAB="$work/lab" SLURM_PORT_BASE=$((20000 + $$ % 20000)) SLURM_NODE_TIMEOUT=10 SLURM_CPUS=2 SLURM_MEM=500
unset SLURM_CONF SLURM_JOB_ID SLURM_ARRAY_JOB_ID SLURM_ARRAY_TASK_ID
down() {
    "$here/down.sh"
    rm -rf "$work"
}
trap down EXIT
if ! "$here/up.sh" 2 >"$work/up.txt" 2>&1; then
    tail -n 5 "$work/up.txt"
    skip "its daemons do not start"
fi
export SLURM_CONF="$SLURM_LAB/slurm.conf"
python3 "$here/sweep.py" "$binary" "$tasks" "$work"
