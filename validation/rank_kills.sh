#!/usr/bin/env bash
# Kills a rank of a run again and again, at random moments, each time continues on another number of ranks, and compares what comes out with one
# process that nobody kills. Once as users run it, and once where the run writes checkpoints nearly all the time. Needs MPI and the programs in
# build/. KILLS=50 of each; SEED=1 of the moments.
set -euo pipefail
cd "$(dirname "$0")/.."
directory=$PWD/results/rank_kills
program=$PWD/build/apps/gridlock/gridlock
mpi_program=$PWD/build/apps/gridlock-mpi/gridlock-mpi
[[ -x $mpi_program ]] || { echo "there is no $mpi_program; ./dev install mpi and build again" >&2; exit 2; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
RANDOM=${SEED:-1}

rm -rf "$directory"
mkdir -p "$directory"
settings=(scenes/paper.toml --set engine.kind=tiled --set disks.count=2000 --set run.steps=160000 --set observe.every=100 --set trajectory.every=10000)
"$program" run "${settings[@]}" --quiet -o "$directory/alone"

# begin_or_resume DIRECTORY SECONDS_BETWEEN_CHECKPOINTS RANKS
begin_or_resume() {
  local command=(resume "$1")
  [[ -e $1/run.log ]] || command=(run "${settings[@]}" --set "checkpoint.every_seconds=$2" -o "$1")
  exec mpirun --oversubscribe -n "$3" "$mpi_program" "${command[@]}" --quiet
}

same() {
  cmp "$directory/alone/series.csv" "$1/series.csv"
  cmp "$directory/alone/final.xyz" "$1/final.xyz"
  diff <(grep '"state_hash"' "$directory/alone/summary.json") <(grep '"state_hash"' "$1/summary.json")
  # The trajectory itself says when it was written.
  for one in "$directory/alone" "$1"; do "$program" export "$one" --to xyz -o "$one.xyz" >"$directory/last.log"; done
  cmp "$directory/alone.xyz" "$1.xyz"
}

for seconds in 0.2 0.001; do
  run=$directory/checkpoints_every_$seconds
  kills=0
  for ((attempt = 0; attempt < ${KILLS:-50}; ++attempt)); do
    ranks=$((2 + RANDOM % 3))
    begin_or_resume "$run" "$seconds" "$ranks" >"$directory/last.log" 2>&1 &
    job=$!
    sleep "$(printf '0.%03d' $((300 + RANDOM % 700)))"
    # Each rank is the child of a process that watches it.
    watchers=$(pgrep --parent "$job" --delimiter , || true)
    mapfile -t processes < <([[ -n $watchers ]] && pgrep --parent "$watchers" || true)
    [[ ${#processes[@]} -gt 0 ]] && kill -KILL "${processes[RANDOM % ${#processes[@]}]}" 2>/dev/null || true
    code=0
    wait "$job" || code=$?
    [[ $code -ne 0 ]] || break
    if grep -q "was ended by signal 9" "$directory/last.log"; then
      [[ $code -eq 1 ]] || { echo "mpirun ended with $code after a rank was killed" >&2; exit 1; }
      kills=$((kills + 1))
    fi
  done
  "$program" resume "$run" --quiet >"$directory/last.log" 2>&1 || true  # where nobody has ended it
  same "$run"
  echo "checkpoints every $seconds s: $kills ranks killed in $attempt attempts; the files of one process"
done
