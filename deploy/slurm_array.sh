#!/bin/bash
# A drive on a Slurm cluster without further tools, in tasks of 100 frames. The number of tasks is that of the frames over 100:
#   dvi plan DRIVE -o OUT
#   fill=$(sbatch --parsable --array=0-19 deploy/slurm_array.sh OUT)
#   sbatch --dependency=afterok:$fill --wrap "dvi finish OUT"
# A task that failed is called again by the same line; what is finished is kept.
#SBATCH --cpus-per-task=2 --mem=4G --time=2:00:00
first=$((SLURM_ARRAY_TASK_ID * 100))
exec dvi fill "$1" --frames "$first:$((first + 99))" --threads 2
