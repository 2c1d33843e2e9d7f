#!/usr/bin/env bash
# A sweep and a run on eight ranks of four hosts, which are network namespaces of this machine and know each other by TCP alone, against the same
# by one process; then again with a rank killed meanwhile, and with a whole host. Needs root, MPI and the programs in build/.
set -euo pipefail
cd "$(dirname "$0")/.."
directory=$PWD/results/hosts
program=$PWD/build/apps/gridlock/gridlock
mpi_program=$PWD/build/apps/gridlock-mpi/gridlock-mpi
[[ $EUID -eq 0 ]] || { echo "only root can make network namespaces" >&2; exit 2; }
[[ -x $mpi_program ]] || { echo "there is no $mpi_program; ./dev install mpi and build again" >&2; exit 2; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

hosts=(1 2 3 4)
clean_up() {
  for host in "${hosts[@]}"; do ip netns del "gridlock$host" 2>/dev/null || true; done
  ip link del gridlock0 2>/dev/null || true
}
# disturb HOST: what it sends is late, and some of it lost. A kernel without netem can have a bottleneck do it, whose queue is short: what waits comes up to two
# milliseconds later, what does not fit is lost.
disturb() {
  local add=(ip netns exec "gridlock$1" tc qdisc add dev eth0 root)
  "${add[@]}" netem delay 1ms loss 0.5% 2>/dev/null || "${add[@]}" tbf rate 100mbit burst 16kb latency 2ms 2>/dev/null
}
# What became of the packets of all hosts.
report_packets() {
  for host in "${hosts[@]}"; do ip netns exec "gridlock$host" tc -s qdisc show dev eth0; done |
    awk '/Sent/ { sub(/,/, "", $7); sent += $4; lost += $7 } END { printf "packets: %d sent, %d lost\n", sent, lost; exit lost == 0 }'
}
trap clean_up EXIT
clean_up
is_disturbed=true
ip link add gridlock0 type bridge
ip link set gridlock0 up
for host in "${hosts[@]}"; do
  ip netns add "gridlock$host"
  ip link add "gridlock-$host" type veth peer name eth0 netns "gridlock$host"
  ip link set "gridlock-$host" master gridlock0 up
  ip -n "gridlock$host" address add "10.9.0.$host/24" dev eth0
  ip -n "gridlock$host" link set eth0 up
  ip -n "gridlock$host" link set lo up
  disturb "$host" || { echo "host $host: no delay and no loss, for this kernel has neither netem nor tbf"; is_disturbed=false; }
done

rm -rf "$directory"
mkdir -p "$directory"
# In place of ssh.
cat >"$directory/agent" <<'AGENT'
#!/usr/bin/env bash
host=${1##*.}
shift
exec ip netns exec "gridlock$host" unshare --uts bash -c "hostname host$host; $*"
AGENT
chmod +x "$directory/agent"

# on_hosts COMMAND [ARGUMENT…]
on_hosts() {
  "$directory/agent" 10.9.0.1 exec mpirun --mca plm_rsh_agent "$directory/agent" --mca btl tcp,self \
    --mca btl_tcp_if_include 10.9.0.0/24 --mca oob_tcp_if_include 10.9.0.0/24 --oversubscribe \
    --host 10.9.0.1:2,10.9.0.2:2,10.9.0.3:2,10.9.0.4:2 -n 8 "$mpi_program" "$@"
}
sweep=(sweep scenes/density_sweep.toml --set run.steps=40000 --set observe.every=100 --no-pictures --quiet)
sweep_on_hosts() { on_hosts "${sweep[@]}" -o "$1"; }
run=(run scenes/paper.toml --set engine.kind=tiled --set disks.count=20000 --set run.steps=4000 --set observe.every=100
  --set checkpoint.every_seconds=0.5 --no-pictures --quiet)
run_on_hosts() { if [[ -e $1/run.log ]]; then on_hosts resume "$1" --quiet; else on_hosts "${run[@]}" -o "$1"; fi; }
# kill_soon PATTERN SIGNAL: the newest process of it
kill_soon() { sleep 4; pkill "-$2" --newest --full "$1"; }
same() { cmp "$directory/$1/means.csv" "$directory/alone/means.csv" && echo "$1: the same means as one process"; }
same_run() {
  cmp "$directory/$1/series.csv" "$directory/run_alone/series.csv"
  cmp "$directory/$1/final.xyz" "$directory/run_alone/final.xyz"
  echo "$1: the same series and last state as one process"
}
# not_to_the_end SWEEP_OR_RUN NAME VICTIM: what is killed meanwhile fails
not_to_the_end() {
  kill_soon "$3" KILL &
  ! "$1_on_hosts" "$directory/$2" >"$directory/$2.log" 2>&1 || { echo "$2 was not killed in time" >&2; exit 1; }
  wait
}

"$program" "${sweep[@]}" -o "$directory/alone"
sweep_on_hosts "$directory/hosts"
same hosts
for victim in "gridlock-mpi sweep" orted; do
  name=${victim%% *}
  not_to_the_end sweep "$name" "$victim"
  sweep_on_hosts "$directory/$name"
  same "$name"
done

"$program" "${run[@]}" -o "$directory/run_alone"
run_on_hosts "$directory/run"
same_run run
for victim in "gridlock-mpi run" orted; do
  name=run_${victim%% *}
  not_to_the_end run "$name" "$victim"
  run_on_hosts "$directory/$name"
  same_run "$name"
done
! $is_disturbed || report_packets || { echo "no packet was lost" >&2; exit 1; }
