#!/usr/bin/env bash
#SBATCH --array=0-7 --cpus-per-task=1 --requeue --open-mode=append
# Draws a list in parts as a Slurm array: sbatch --array=0-63%16 slurm.sh OPTIONS OF BATCH ...
#
# A part that is preempted, requeued or submitted again skips its finished pictures.
mkdir -p reports
exec marraztu batch "$@" --shard auto --resume --quiet --threads "$SLURM_CPUS_PER_TASK" \
  --report "reports/$SLURM_ARRAY_TASK_ID.jsonl"
