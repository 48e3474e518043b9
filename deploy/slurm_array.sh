#!/bin/bash
# A drive on a Slurm cluster without further tools. For frames 0 to 1999, as listed by `dvi plan`, in 20 tasks of 100:
#   dvi plan DRIVE -o OUT
#   fill=$(sbatch --parsable --array=0-19 deploy/slurm_array.sh OUT 0 100)
#   sbatch --dependency=afterok:$fill --wrap "dvi finish OUT"
# Frames that a failed task finished are kept: `sbatch --array=7 deploy/slurm_array.sh OUT 0 100` fills the rest.
#SBATCH --cpus-per-task=2 --mem=4G --time=2:00:00
out=$1 first=$(($2 + SLURM_ARRAY_TASK_ID * $3))
exec dvi fill "$out" --frames "$first:$((first + $3 - 1))" --threads 2
