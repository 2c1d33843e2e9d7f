#!/bin/bash
#SBATCH --job-name=gridlock-sweep
#SBATCH --array=1-4
#SBATCH --cpus-per-task=2
#SBATCH --time=24:00:00
#SBATCH --signal=B:TERM@60
#SBATCH --requeue
# A sweep as a job array: each task makes one shard of it in a shared directory. SIGTERM a minute before the end lets every
# run save itself; the same job again goes on where they stopped.
#
#     sbatch examples/slurm_array.sh scenes/density_sweep.toml results/densities
#     gridlock collect results/densities        # when all tasks have ended
set -euo pipefail
scene=${1:?usage: sbatch examples/slurm_array.sh SCENE.toml DIRECTORY}
directory=${2:?usage: sbatch examples/slurm_array.sh SCENE.toml DIRECTORY}
gridlock=${GRIDLOCK:-gridlock}
not_in_array="this script runs as a job array: sbatch --array=1-4 $0 SCENE.toml DIRECTORY; without Slurm: gridlock sweep"
task=${SLURM_ARRAY_TASK_ID:?$not_in_array}
tasks=${SLURM_ARRAY_TASK_COUNT:?$not_in_array}

exec "$gridlock" sweep "$scene" -o "$directory" --shard "$task/$tasks" \
  --threads "${SLURM_CPUS_PER_TASK:-1}"
