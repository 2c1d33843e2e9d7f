#!/bin/bash
#SBATCH --job-name=gridlock-mpi
#SBATCH --nodes=2
#SBATCH --ntasks-per-node=16
#SBATCH --time=24:00:00
#SBATCH --signal=B:TERM@120
# A sweep on all cores of several nodes, one run a rank: each rank takes the next run as soon as it is free. SIGTERM two minutes
# before the end lets every run save itself; the same job again continues them.
#
#     sbatch examples/slurm_mpi.sh scenes/density_sweep.toml results/densities
#
# The directory must be one that all nodes see.
set -euo pipefail
scene=${1:?usage: sbatch examples/slurm_mpi.sh SCENE.toml DIRECTORY}
directory=${2:?usage: sbatch examples/slurm_mpi.sh SCENE.toml DIRECTORY}

# mpirun hands SIGTERM on and kills what has not ended after so many seconds, one if nothing is said.
exec mpirun --mca odls_base_sigkill_timeout 100 "${GRIDLOCK_MPI:-gridlock-mpi}" sweep "$scene" -o "$directory" --no-pictures
