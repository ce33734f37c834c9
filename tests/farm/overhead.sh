#!/usr/bin/env bash
# What a farm costs: a scene by one command, and in 8 parts by a Slurm of two nodes on this machine,
# one core each. Prints both times and compares the bytes. Needs what slurm.sh needs.
#
#   overhead.sh DAPPLE SCENE [FLAGS OF RENDER]
#
# as in: overhead.sh target/release/dapple kitchen.glb --resolution 1024x1024 --spp 256
set -euo pipefail
here=$(realpath "$(dirname "$0")")
dapple=$(realpath "$1") scene=$(realpath "$2")
shift 2
folder=$(mktemp -d)
chmod 755 "$folder" # The user munge must get to its socket.
trap 'bash "$here/slurm.sh" down "$folder/slurm"; rm -rf "$folder"' EXIT
seconds() { date +%s.%N; }

cd "$folder"
begin=$(seconds)
"$dapple" render "$scene" "$@" --threads 2 --reproducible --quiet -o one.exr
one=$(seconds)

SLURM_CONF=$(bash "$here/slurm.sh" up "$folder/slurm" 2)
export SLURM_CONF
submit=$(seconds)
"$dapple" farm slurm "$scene" "$@" --reproducible -o out.exr --parts 8 --dapple "$dapple" --submit
while [ -n "$(squeue -h)" ]; do
  sleep 0.2
done
end=$(seconds)

if ! cmp one.exr out.exr; then
  tail -n 20 out.parts/*.log >&2
  exit 1
fi
awk -v one="$(echo "$one $begin" | awk '{print $1 - $2}')" \
  -v farm="$(echo "$end $submit" | awk '{print $1 - $2}')" 'BEGIN {
    printf "one command, two threads: %.1f s\n", one
    printf "8 parts on 2 nodes:       %.1f s, %+.1f %%; the same bytes\n", farm, 100 * (farm / one - 1)
  }'
grep -ho 'load [0-9.]* s, build [0-9.]* s' out.parts/*.log | sort | uniq -c || true
