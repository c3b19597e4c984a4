#!/usr/bin/env bash
# Two ranks on two hosts, which are network namespaces with a cable between them: they come to the same bits as on one
# host, by TCP; and where a host is lost, the run ends and goes on from its last checkpoint. Needs root and Open MPI.
#   ranks_on_hosts.sh PROGRAM MPIRUN SCENE FOLDER
set -euo pipefail
program=$1 mpirun=$2 scene=$3 folder=$4
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 host_names=kappaflow-$$

skip() { echo "$1 is not installed: skipped"; exit 0; }
fail() { echo "$1"; exit 1; }
"$mpirun" --version 2>/dev/null | grep -qE 'Open MPI|OpenRTE' || skip "Open MPI"
command -v ip unshare >/dev/null || skip "ip or unshare"
trap 'for host in 1 2; do
        ip netns pids $host_names-$host 2>/dev/null | xargs -r kill -KILL || true
        ip netns delete $host_names-$host 2>/dev/null || true
      done' EXIT
{ ip netns add "$host_names-1" && ip netns add "$host_names-2" &&
    ip link add one netns "$host_names-1" type veth peer name two netns "$host_names-2" &&
    ip netns exec "$host_names-1" true; } 2>/dev/null || skip "what makes network namespaces"
ip -n "$host_names-1" addr add 10.77.0.1/24 dev one
ip -n "$host_names-2" addr add 10.77.0.2/24 dev two
for host in 1 2; do ip -n "$host_names-$host" link set lo up; done
ip -n "$host_names-1" link set one up
ip -n "$host_names-2" link set two up

rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
printf '10.77.0.%d slots=1\n' 1 2 >hosts
cat >shell <<'EOF'
#!/bin/sh
# Called as ssh is: ADDRESS COMMAND...
host=${1##*.}; shift
exec ip netns exec "$host_names-$host" unshare --uts sh -c "hostname host-$host; $*"
EOF
chmod +x shell

on_hosts() {
  ./shell 10.77.0.1 exec "$mpirun" --hostfile hosts --bind-to none --mca plm_rsh_agent "$PWD/shell" --mca btl tcp,self \
    --mca btl_tcp_if_include 10.77.0.0/24 --mca oob_tcp_if_include 10.77.0.0/24 -n 2 "$program" "$@"
}
sum() { (cd "$1" && cat particles/*.vtp surface-material/*.vtp | sha256sum); }
words=(run "$scene" --track material --quiet --threads 1)

on_hosts "${words[@]}" --duration 0.08 --out apart
"$mpirun" --oversubscribe --bind-to none -n 2 "$program" "${words[@]}" --duration 0.08 --out together
[ "$(sum apart)" = "$(sum together)" ] || fail "two hosts come to other bits than one"

on_hosts "${words[@]}" --out lost 2>said &
run=$!
until [ -e lost/checkpoint.bin ] && [ -e lost/particles/particles_0002.vtp ]; do
  kill -0 $run 2>/dev/null || fail "it ended by itself: $(cat said)"
  sleep 0.05
done
ip netns pids "$host_names-2" | xargs kill -KILL
wait $run || true  # Open MPI 5 ends with 0 all the same
before=$(ls lost/particles | wc -l)
"$program" run --resume lost --quiet
[ "$(ls lost/particles | wc -l)" -gt "$before" ] || fail "it was not stopped, or did not go on"
