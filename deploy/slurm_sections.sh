#!/bin/bash
# The plan of a long drive on a Slurm cluster, in sections that are planned at the same time. For 10 sections:
#   plan=$(sbatch --parsable --array=1-10 deploy/slurm_sections.sh 10 DRIVE -o OUT)
#   join=$(sbatch --parsable --dependency=afterok:$plan --wrap "dvi join OUT")
# then fill and finish as in slurm_array.sh, after $join. A task that failed is repeated alone: sbatch --array=7 ...
#SBATCH --cpus-per-task=4 --mem=4G --time=4:00:00
sections=$1
shift
exec dvi plan "$@" --section "$SLURM_ARRAY_TASK_ID/$sections" --threads 4
