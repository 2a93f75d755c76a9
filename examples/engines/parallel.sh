#!/usr/bin/env bash
# Draws a list in parts with GNU parallel: parallel.sh PARTS OPTIONS OF BATCH ...
#
# After a crash, run it again. The file `joblog` remembers the finished parts, and --resume skips the finished
# pictures of the others. Remove `joblog` if models or options have changed.
set -euo pipefail
parts=$1
shift
mkdir -p reports
# --quote passes the fields of --out unchanged. Parts that still fail are in the report.
parallel --quote --joblog joblog --resume-failed --retries 2 \
  marraztu batch "$@" --shard "{}/$parts" --resume --quiet --threads 1 --report "reports/{}.jsonl" \
  ::: $(seq 0 $((parts - 1))) || true
marraztu merge reports/*.jsonl --out report.jsonl
