#!/usr/bin/env bash
# A job for SLURM: runs a deck on one GPU, stops in time with a checkpoint, and puts itself back into the queue until the run is done.
#   sbatch scripts/slurm-example.sh inputs/landslide.json
# For a job on processors only: leave --gres out, ask for --cpus-per-task=N, and take --backend cpu.
#SBATCH --job-name=jaxmpm
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=8
#SBATCH --gres=gpu:1
#SBATCH --time=04:00:00
#SBATCH --signal=USR1@300
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%j.log
set -u
deck=${1:?usage: sbatch scripts/slurm-example.sh DECK}
program=${JAXMPM:-build-cuda/jaxmpm}
backend=${JAXMPM_BACKEND:-cuda}

# SLURM's USR1 comes five minutes before the limit: the program writes a checkpoint and ends with 75.
srun "$program" run "$deck" --backend "$backend" --threads "${SLURM_CPUS_PER_TASK:-1}" --resume auto &
job=$!
trap 'kill -USR1 $job' USR1
wait $job; status=$?
while kill -0 $job 2>/dev/null; do wait $job; status=$?; done  # a trapped signal ends `wait` early

if [ "$status" = 75 ]; then
  echo "stopped with a checkpoint; back into the queue"
  scontrol requeue "$SLURM_JOB_ID"
fi
exit "$status"
