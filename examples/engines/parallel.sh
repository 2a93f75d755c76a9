#!/usr/bin/env bash
# Draws a list in parts with GNU parallel: parallel.sh PARTS OPTIONS OF BATCH ...
# The exit status is 0 only if all pictures are there.
#
# After a crash, run it again: --resume skips the finished pictures. A part that fails is tried once more. If it fails
# again, the exit status says so, and the report names the missing pictures.
set -euo pipefail
parts=${1:?write parallel.sh PARTS OPTIONS OF BATCH}
shift
mkdir -p reports
# A part that cannot begin must not pass for one of an earlier run.
rm -f $(seq -f 'reports/%.0f.jsonl' 0 $((parts - 1)))
status=0
# --quote passes the fields of --out unchanged.
parallel --quote --retries 2 \
  marraztu batch "$@" --shard "{}/$parts" --resume --quiet --threads 1 --report "reports/{}.jsonl" \
  ::: $(seq 0 $((parts - 1))) || status=1
# A folder may also hold reports of an earlier run in more parts.
marraztu merge $(seq -f 'reports/%.0f.jsonl' 0 $((parts - 1))) --out report.jsonl
exit $status
