#!/usr/bin/env bash
# Submits a sweep as a job array and the merge that waits for it; prints the number of the merge's job.
#
#   bench/slurm/submit.sh SPEC.toml FOLDER FILE SHARDS [options of sbatch for the array, such as --cpus-per-task=8]
#
# PALPATE names the program if it is not on the path of the nodes.
set -euo pipefail
here=$(dirname "$0")
spec=${1:?SPEC.toml} folder=${2:?FOLDER} file=${3:?FILE} shards=${4:?SHARDS}
shift 4
array=$(sbatch --parsable --array="1-$shards" "$@" "$here/sweep.sbatch" "$spec" "$folder")
# afterany: if a task failed for good, the merge says which shards are missing.
sbatch --parsable --dependency="afterany:${array%%;*}" "$here/merge.sbatch" "$spec" "$folder" "$file"
