#!/bin/bash
#SBATCH --job-name=gridlock-mpi-run
#SBATCH --nodes=2
#SBATCH --ntasks-per-node=16
#SBATCH --time=24:00:00
#SBATCH --signal=B:USR1@120
#SBATCH --requeue
# One run on all cores of several nodes. SIGUSR1 two minutes before the end, which mpirun hands on, makes the run save itself; the same job again
# continues it, on as many ranks as it has then.
#
#     sbatch examples/slurm_mpi_run.sh big.toml results/big
#
# The directory must be one that all nodes see: every rank writes its part of a checkpoint there.
set -euo pipefail
scene=${1:?usage: sbatch examples/slurm_mpi_run.sh SCENE.toml DIRECTORY}
directory=${2:?usage: sbatch examples/slurm_mpi_run.sh SCENE.toml DIRECTORY}

words=(run "$scene" -o "$directory")
if [ -e "$directory/config.resolved.toml" ]; then words=(resume "$directory"); fi
# In the place of this script, so that the signal comes to mpirun.
exec mpirun "${GRIDLOCK_MPI:-gridlock-mpi}" "${words[@]}"
