#!/usr/bin/env bash
# A Slurm of its own on this machine, without systemd, for the tests. Needs root and Debian's
# packages slurmctld, slurmd, slurm-client and munge.
#
#   slurm.sh up FOLDER [NODES]    brings it up, with nodes n1, n2 … of one core each; prints the
#                                 SLURM_CONF by which commands find it
#   slurm.sh lose FOLDER NODE     kills a node and all that runs there, as a power cut does
#   slurm.sh return FOLDER NODE   starts that node again
#   slurm.sh down FOLDER          ends it
set -euo pipefail
export PATH=$PATH:/usr/sbin:/sbin
what=$1 folder=$(realpath -m "$2")
export SLURM_CONF=$folder/slurm.conf

write_conf() {
  local nodes=$1 host port
  host=$(hostname -s)
  port=$((20000 + RANDOM % 4000 * 10))
  cat >"$SLURM_CONF" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
# A job that is put back into the queue waits for as long as a credential lives.
AuthInfo=socket=$folder/munge/socket,cred_expire=5
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/%n.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1,sched_min_interval=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=5
SlurmdTimeout=10
MinJobAge=3600
SlurmdParameters=config_overrides
NodeName=n[1-$nodes] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + nodes))] CPUs=1 RealMemory=1000
PartitionName=test Nodes=n[1-$nodes] Default=YES MaxTime=INFINITE State=UP
CONF
}

up() {
  local nodes=${1:-2} node
  mkdir -p "$folder"/{state,spool,log,munge}
  write_conf "$nodes"
  head -c 1024 /dev/urandom >"$folder/munge/key"
  chmod 755 "$folder" "$folder/munge"
  chmod 600 "$folder/munge/key"
  chown -R munge:munge "$folder/munge"
  setpriv --reuid munge --regid munge --clear-groups munged --force \
    --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
    --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
  slurmctld
  for node in $(seq "$nodes"); do
    mkdir -p "$folder/spool/n$node"
    slurmd -N "n$node"
  done
  for _ in $(seq 150); do
    if [ "$(sinfo -h -N -t idle -o %N 2>/dev/null | wc -l)" -ge "$nodes" ]; then
      echo "$SLURM_CONF"
      return
    fi
    sleep 0.2
  done
  echo "Slurm did not come up:" >&2
  tail -n 20 "$folder"/log/* >&2
  exit 1
}

# The processes of jobs on a node, and Slurm's own that look after them.
of_node() {
  local node=$1 environ pid
  for environ in /proc/[0-9]*/environ; do
    pid=${environ#/proc/} pid=${pid%/environ}
    if { tr '\0' '\n' <"$environ"; } 2>/dev/null | grep -qx "SLURMD_NODENAME=$node" &&
      { tr '\0' '\n' <"$environ"; } 2>/dev/null | grep -qx "SLURM_CONF=$SLURM_CONF"; then
      echo "$pid"
      # The parent of a job's first process is slurmstepd.
      local parent
      parent=$(ps -o ppid= -p "$pid" | tr -d ' ')
      if [ "$(ps -o comm= -p "${parent:-0}")" = slurmstepd ]; then
        echo "$parent"
      fi
    fi
  done
}

lose() {
  local pids
  # What looks after jobs goes first: it must not tell that they ended.
  kill -9 "$(cat "$folder/$1.pid")"
  pids=$(of_node "$1" | sort -u)
  for pid in $pids; do
    [ "$(ps -o comm= -p "$pid")" = slurmstepd ] && kill -9 "$pid"
  done
  for pid in $pids; do
    kill -9 "$pid" 2>/dev/null || true
  done
  rm -f "$folder/$1.pid"
}

end() {
  local pid
  [ -s "$1" ] || return 0
  pid=$(cat "$1")
  kill "$pid" 2>/dev/null || return 0
  for _ in $(seq 50); do
    # Where no one asks after orphans, the dead stay as zombies.
    case $(ps -o stat= -p "$pid") in
      '' | Z*) return 0 ;;
    esac
    sleep 0.1
  done
}

down() {
  scancel --user root 2>/dev/null || true
  for _ in $(seq 50); do
    [ -z "$(squeue -h -t running,completing 2>/dev/null)" ] && break
    sleep 0.2
  done
  for pid in "$folder"/n*.pid "$folder/slurmctld.pid" "$folder/munge/pid"; do
    end "$pid"
  done
}

case $what in
  up) up "${3:-2}" ;;
  lose) lose "$3" ;;
  return) slurmd -N "$3" ;;
  down) down ;;
  *) sed -n '2,10s/^# \?//p' "$0" >&2; exit 2 ;;
esac
