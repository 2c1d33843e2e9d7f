#!/bin/bash
#SBATCH --job-name=gridlock-mpi
#SBATCH --nodes=2
#SBATCH --ntasks-per-node=16
#SBATCH --time=24:00:00
#SBATCH --signal=B:USR1@60
#SBATCH --requeue
# A sweep on all cores of several nodes, one run a rank: each rank takes the next run as soon as it is free. SIGUSR1 a minute before
# the end, which mpirun hands on, lets every run save itself; the same job again continues them.
#
#     sbatch examples/slurm_mpi.sh scenes/density_sweep.toml results/densities
#
# The directory must be one that all nodes see.
set -euo pipefail
scene=${1:?usage: sbatch examples/slurm_mpi.sh SCENE.toml DIRECTORY}
directory=${2:?usage: sbatch examples/slurm_mpi.sh SCENE.toml DIRECTORY}

# In the place of this script, so that the signal comes to mpirun.
exec mpirun "${GRIDLOCK_MPI:-gridlock-mpi}" sweep "$scene" -o "$directory" --no-pictures
