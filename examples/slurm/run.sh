#!/bin/bash
# A scene on a cluster with Slurm: sbatch examples/slurm/run.sh scenes/slab.toml OUT. A rank a socket, each with the
# threads of its cores. Ten minutes before the time is over the run is stopped as by Ctrl-C, which leaves a checkpoint,
# and the job is put back into the queue; there it goes on from that. Of nodes that differ, each rank can have its share of
# the liquid (docs/scaling.md, "Unequal machines"): --shares behind --quiet.
#SBATCH --job-name=kappaflow
#SBATCH --nodes=4
#SBATCH --ntasks-per-node=2
#SBATCH --cpus-per-task=16
#SBATCH --time=24:00:00
#SBATCH --signal=TERM@600
#SBATCH --requeue
#SBATCH --open-mode=append
scene=$1 out=$2
if [ -e "$out/checkpoint.bin" ]; then words=(--resume "$out"); else words=("$scene" --out "$out"); fi
srun --mpi=pmix --cpus-per-task="$SLURM_CPUS_PER_TASK" \
  kappaflow run "${words[@]}" --threads "$SLURM_CPUS_PER_TASK" --quiet
code=$?
if [ $code -eq 143 ]; then scontrol requeue "$SLURM_JOB_ID"; fi
exit $code
