#!/usr/bin/env bash
# 10⁸ collisions of `exact` with the audit on: a fluid, and a dense one whose disks have lists of neighbours.
set -euo pipefail
cd "$(dirname "$0")/.."
build/apps/gridlock/gridlock run scenes/paper.toml --set engine.kind=exact --set box.edge=periodic \
  --set disks.packing_fraction=0.70 --set engine.audit_every=100000 --set run.steps=1000000000 \
  --set run.collisions_per_disk=237812 --set observe.every=2000 -o results/audit --overwrite --no-pictures
build/apps/gridlock/gridlock run scenes/paper.toml --set engine.kind=exact --set box.edge=periodic \
  --set disks.packing_fraction=0.80 --set disks.start=triangular --set disks.count=840 --set engine.audit_every=100000 \
  --set run.steps=1000000000 --set run.collisions_per_disk=238096 --set observe.every=2000 -o results/audit_lists --overwrite \
  --no-pictures
