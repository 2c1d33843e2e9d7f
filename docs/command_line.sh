#!/usr/bin/env bash
# The reference page of the command line from the program's own help; a test compares the two.
#
#     docs/command_line.sh build/apps/gridlock/gridlock > docs/reference/command_line.md
set -euo pipefail
program=${1:?usage: docs/command_line.sh PROGRAM}

cat <<'PAGE'
# Command line

`gridlock COMMAND` does one thing. This page is what `gridlock COMMAND --help` prints, for every command.

| exit code | meaning |
|---|---|
| 0 | The command did what it was asked to do. |
| 1 | A run failed or was stopped. The results so far are written. `verify`: a replay differs from the run. |
| 2 | The input cannot be used. Nothing was written. |

Messages go to the standard error stream, results to the standard output. Ctrl-C and SIGTERM stop a run, a sweep or the study
after a checkpoint, SIGUSR1 a run or a sweep; `gridlock resume`, or the same command again, continues it
([stop and continue](../explanation/reliability.md)).

A command that is not on this page is a program of its own: `gridlock greet Anna` runs `gridlock-greet Anna`, the program of that name
beside `gridlock` or, if there is none, on the path. Any language will do. `gridlock --help` lists the programs that it finds, and
`gridlock help COMMAND` is `gridlock COMMAND --help`.
PAGE

section() { printf '\n## `%s`\n\n```text\n%s\n```\n' "gridlock${1:+ $1}" "$(PATH=/usr/bin:/bin "$program" $1 --help)"; }
section ""
for command in $(PATH=/usr/bin:/bin "$program" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do section "$command"; done
# Those that are programs of their own, as far as they are built.
for other in "$(dirname "$program")"/gridlock-*; do
  [[ -x $other ]] && COLUMNS=110 section "${other##*/gridlock-}"
done
exit 0
