#!/bin/bash
# The state of a job in the words of `snakemake --cluster-status`, on a cluster that keeps no accounts.
case $(scontrol show job "$1" --oneliner | sed 's/.*JobState=\([A-Z_]*\).*/\1/') in
  PENDING | CONFIGURING | RUNNING | COMPLETING | SUSPENDED | REQUEUED) echo running ;;
  COMPLETED) echo success ;;
  *) echo failed ;;
esac
