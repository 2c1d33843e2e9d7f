#!/usr/bin/env bash
# fuzz_one.sh SECONDS SEED NAME: what is found new is kept in build-fuzz/corpus, what breaks a target in build-fuzz/crash-….
set -euo pipefail
cd "$(dirname "$0")/../.."
seeds=tests/fuzz/corpus/$3 log=build-fuzz/$3.log
mkdir -p "build-fuzz/corpus/$3"
ASAN_OPTIONS=detect_leaks=1 "build-fuzz/tests/fuzz/gridlock_fuzz_$3" -max_total_time="$1" -seed="$2" -timeout=20 -rss_limit_mb=4096 \
  -print_final_stats=1 -artifact_prefix=build-fuzz/ "build-fuzz/corpus/$3" "$seeds" >"$log" 2>&1 || { tail -40 "$log"; exit 1; }
echo "fuzzed $3 for $1 seconds: $(sed -nE 's/^stat::(number_of_executed_units|new_units_added): */\1 /p' "$log" | xargs)"
