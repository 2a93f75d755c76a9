#!/usr/bin/env bash
# Starts Slurm on this machine alone, runs a command, and stops Slurm: slurm_node.sh COMMAND ...
#
# For trying array jobs, as root, with Debian's packages slurm-wlm and munge.
set -euo pipefail
state=$(mktemp -d)
export SLURM_CONF=$state/slurm.conf
name=$(hostname -s)
# A requeued job waits until its credential expires, by default for 2 minutes.
cat >"$SLURM_CONF" <<TEXT
ClusterName=one
SlurmctldHost=$name
SlurmUser=root
StateSaveLocation=$state
SlurmdSpoolDir=$state
SlurmctldPidFile=$state/slurmctld.pid
SlurmdPidFile=$state/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
AuthInfo=cred_expire=5
SchedulerParameters=sched_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
NodeName=$name CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
TEXT
programs=
trap 'kill $programs || true; wait; rm -rf "$state"' EXIT
install -d -o munge -m 755 /run/munge
setpriv --reuid munge --regid munge --init-groups munged --foreground >"$state/munged.log" 2>&1 &
programs+=" $!"
slurmctld -D >"$state/slurmctld.log" 2>&1 &
programs+=" $!"
slurmd -D >"$state/slurmd.log" 2>&1 &
programs+=" $!"
for _ in $(seq 60); do
  [ "$(sinfo --noheader --format %T 2>"$state/error")" != idle ] || { "$@"; exit; }
  sleep 0.5
done
echo "slurm_node.sh: Slurm did not start:" >&2
tail -n 5 "$state"/*.log "$state/error" >&2
exit 1
