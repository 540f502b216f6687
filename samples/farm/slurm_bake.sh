#!/usr/bin/env bash
# Bakes a level as N shards on a Slurm cluster: an array for phase 1, an array for phase 2 once all of the first are done,
# and a merge. Run it again to go on: it submits the shards that have no file yet.
#
# usage: slurm_bake.sh N LEVEL.pvs SCENE [options of sightcell bake]
#
# SIGHTCELL         the program, by its path on the nodes (default: sightcell in PATH)
# SIGHTCELL_SBATCH  more options of sbatch for the arrays: "--cpus-per-task=8 --mem=16G --time=4:00:00"
# SBATCH_PARTITION, SBATCH_ACCOUNT and the like: sbatch reads them itself, for arrays and merge
set -euo pipefail
sightcell=${SIGHTCELL:-sightcell}

# On a node: one shard of one phase. Answers what the bake answers; stopped before the time limit, it goes on in a new turn.
run_shard() {
  local phase=$1 n=$2 level=$3 scene=$4 again=no code=0
  shift 4
  # Local to the node, and the same when the task comes back to it. Another node goes on from the copy beside LEVEL.pvs.
  local scratch=${TMPDIR:-/tmp}/sightcell-${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
  mkdir -p "$scratch"
  # USR1 (--signal) comes to this shell alone. TERM (preemption, requeue, scancel) Slurm sends to the bake too, and a second
  # one would end it at once: here it only must not end the shell.
  local bake=
  trap 'again=yes; [ -z "$bake" ] || kill -TERM "$bake" || true' USR1
  trap : TERM
  "$sightcell" bake "$scene" -o "$level" "$@" --shard "array/$n" --phase "$phase" --scratch "$scratch" \
    --threads "${SLURM_CPUS_PER_TASK:-1}" --progress none &
  bake=$!
  while kill -0 "$bake" 2>/dev/null; do wait "$bake" || true; done  # a signal ends a wait
  wait "$bake" || code=$?
  if [ "$code" -eq 0 ]; then
    rm -rf "$scratch"
  elif [ "$again" = yes ]; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
  fi
  return "$code"
}

# Shards of a phase that have no file yet, as sbatch --array takes them. The first one of phase 2 is always among them: where
# it is there, it looks whether it is of this scene and these settings, and merge whether the others are like it.
missing() {
  local phase=$1 i list=
  for ((i = 0; i < n; ++i)); do
    [ -e "$level.shard-$i-of-$n.phase-$phase" ] && [ "$phase-$i" != 2-0 ] || list+=",$i"
  done
  echo "${list#,}"
}

# submit NAME AFTER SBATCH-OPTION... -- COMMAND...: the job's number. AFTER: a job that must succeed first, or nothing
submit() {
  local name=$1 after=$2 options=()
  shift 2
  while [ "$1" != -- ]; do
    options+=("$1")
    shift
  done
  shift
  [ -z "$after" ] || options+=("--dependency=afterok:$after" --kill-on-invalid-dep=yes)
  sbatch --parsable --job-name="$name" --open-mode=append "${options[@]}" "$@"
}

submit_phase() {
  local phase=$1 after=$2 shards
  shift 2
  shards=$(missing "$phase")
  [ -n "$shards" ] || return 0
  # shellcheck disable=SC2086  # several options in one variable
  submit "phase-$phase" "$after" --array="$shards" --requeue --signal=B:USR1@120 \
    --output="$level.logs/phase-$phase.shard-%a.txt" ${SIGHTCELL_SBATCH:-} -- "$0" --on-node "$phase" "$n" "$level" "$@"
}

if [ "${1:-}" = --on-node ]; then
  shift
  run_shard "$@"
  exit
fi

if [ $# -lt 3 ] || ! [[ $1 =~ ^[1-9][0-9]*$ ]]; then
  echo "usage: slurm_bake.sh N LEVEL.pvs SCENE [options of sightcell bake]" >&2
  exit 2
fi
n=$1 level=$(realpath "$2") scene=$(realpath "$3")
shift 3
mkdir -p "$level.logs"
phase_1=$(submit_phase 1 "" "$scene" "$@")
phase_2=$(submit_phase 2 "$phase_1" "$scene" "$@")
merge=$(submit merge "$phase_2" --output="$level.logs/merge.txt" -- --wrap "$(printf '%q ' "$sightcell" merge "$level")")
echo "phase 1: ${phase_1:-all there}, phase 2: $phase_2, merge: $merge; what they say is in $level.logs"
