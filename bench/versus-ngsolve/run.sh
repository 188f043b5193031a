#!/usr/bin/env bash
# The ring electromagnet's curve of 16 currents by NGSolve (plane.py) and by this project's test, in one session on one core;
# prints a markdown table of seconds and errors. PYTHON is the interpreter with ngsolve, CORE the core.
set -euo pipefail
export LC_ALL=C OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 RAYON_NUM_THREADS=1
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
python=${PYTHON:-python3} core=${CORE:-1} repeat=${REPEAT:-3}
log=$(mktemp)
trap 'rm -f "$log"' EXIT

ours=$(cargo test --release -q -p lut-gen --test magnet --no-run --message-format json |
    python3 -c 'import json, sys; print(*filter(None, (json.loads(line).get("executable") for line in sys.stdin)))')
echo "Load $(cut -d' ' -f1 /proc/loadavg), $(awk -F': ' '/model name/ { print $2; exit }' /proc/cpuinfo), core $core."
echo
taskset -c "$core" "$python" "$here/plane.py" --repeat "$repeat"
taskset -c "$core" "$python" "$here/plane.py" --repeat "$repeat" --inverse umfpack --setting 3 1 0.03 | tail -n 1 | sed "s/order 3/umfpack, order 3/"
for _ in $(seq "$repeat"); do
    TIMEFORMAT='CPU %U %S'
    { time (cd lut-gen && taskset -c "$core" "$ours" --nocapture the_ring_electromagnet); } >>"$log" 2>&1
done
"$python" "$here/ours.py" "$log"
