#!/usr/bin/env bash
# The figures of docs/explanation/models.md: order of the Vicsek model against noise and density, an epidemic against the SIR
# equations. From the root of the repository; some minutes. Leaves validation/results/*.csv and docs/images/*.svg.
set -euo pipefail
gridlock=build/apps/gridlock/gridlock
out=results/validate_models
rm -rf "$out"

# sweep NAME FILE SETTINGS…
sweep() {
  local name=$1 file=$2
  shift 2
  "$gridlock" sweep "$file" --quiet -o "$out/$name" $(printf -- '--set %s ' "$@")
}

# column FILE NAME: the place of a column.
column() { head -1 "$1" | tr , '\n' | grep -n "^$2\$" | cut -d: -f1; }

# points NAME COUNT SIDE AGAINST: rows of means.csv as they stand in the results.
points() {
  local means=$out/$1/means.csv
  awk -F, -v n="$2" -v side="$3" -v x="$(column "$means" "$4")" -v y="$(column "$means" order)" \
    -v e="$(column "$means" order_error)" 'NR > 1 { printf "%s,%s,%s,%s,%s\n", n, side, $x, $y, $e }' "$means"
}

noise=validation/results/vicsek_noise.csv
echo "agents,side,noise,order,error" >$noise
for size in "40 3.1 20000" "100 5 20000" "400 10 20000" "4000 31.6 20000" "10000 50 10000"; do
  read -r count side steps <<<"$size"
  fewer=()
  [[ $count == 10000 ]] && fewer=("sweep.flocking.noise=[0.5,1.0,1.5,2.0,2.25,2.5,2.75,3.0,3.25,3.5,4.0,4.5]")
  sweep "noise_$count" scenes/vicsek.toml flocking.count="$count" box.side="$side" run.steps="$steps" "${fewer[@]}"
  points "noise_$count" "$count" "$side" flocking.noise >>$noise
done

density=validation/results/vicsek_density.csv
echo "agents,side,density,order,error" >$density
for count in 40 80 160 240 320 400 600 800 1200 1600 2400 3200 4000; do
  sweep "density_$count" scenes/vicsek.toml flocking.count="$count" box.side=20 run.steps=20000 sweep.flocking.noise=[2.0]
  points "density_$count" "$count" 20 flocking.noise | awk -F, -v OFS=, '{ $3 = $1 / ($2 * $2); print }' >>$density
done

sweep epidemic scenes/epidemic_mixed.toml run.steps=1000
epidemic=validation/results/epidemic.csv
echo "seed,time,susceptible,infected,recovered" >$epidemic
for run in "$out"/epidemic/runs/*/series.csv; do
  awk -F, -v run="$(basename "$(dirname "$run")")" -v t="$(column "$run" time)" -v s="$(column "$run" susceptible)" \
    -v i="$(column "$run" infected)" -v r="$(column "$run" recovered)" \
    'NR > 1 { printf "%s,%s,%s,%s,%s\n", run, $t, $s, $i, $r }' "$run" >>$epidemic
done
# dS/dt = −b S I/N, dI/dt = b S I/N − g I with b = 0.05 · 10⁴ π 0.02² and g = 0.2, by Heun's method.
awk 'BEGIN {
  pi = 3.14159265358979; n = 1e4; b = 0.05 * n * pi * 0.02 ^ 2; g = 0.2; s = 0.98 * n; i = 0.02 * n; h = 0.01
  print "time,susceptible,infected,recovered"
  for (k = 0; k <= 5000; ++k) {
    if (k % 50 == 0) printf "%g,%.3f,%.3f,%.3f\n", k * h, s, i, n - s - i
    ds = -b * s * i / n; di = -ds - g * i
    s1 = s + h * ds; i1 = i + h * di
    ds1 = -b * s1 * i1 / n; di1 = -ds1 - g * i1
    s += 0.5 * h * (ds + ds1); i += 0.5 * h * (di + di1)
  }
}' >validation/results/sir.csv

# The environment of ./dev build, in which the Python package has its plots.
PYTHONPATH=build/python build-python-environment/bin/python validation/models.py docs/images
